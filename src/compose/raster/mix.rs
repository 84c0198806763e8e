//! Mixing colours: a shadow's with what it falls on, a surface's with what is below.

use libm::powf;

use crate::tone::{Blending, Tone};

/// Colours in the numbers that are mixed.
pub(super) struct Mixer {
    shadow: [f32; 3],
    /// What each byte stands for.
    decoded: [f32; 256],
    blending: Blending,
}

impl Mixer {
    pub(super) fn new(tone: &Tone) -> Self {
        let blending = tone.blending();
        let mut decoded = [0.0; 256];
        for (byte, value) in decoded.iter_mut().enumerate() {
            *value = match blending {
                Blending::Srgb => byte as f32,
                Blending::Linear => linear(byte as f32 / 255.0),
            };
        }
        let color = tone.color();
        Self {
            shadow: [color.r, color.g, color.b].map(|byte| decoded[usize::from(byte)]),
            decoded,
            blending,
        }
    }

    /// `fill` where `passed` of the light reaches it, over `below` by `alpha`.
    #[inline]
    pub(super) fn mixed(&self, fill: [u8; 3], below: [u8; 3], passed: f32, alpha: f32) -> [u8; 3] {
        // Most pixels of a picture are lit and covered wholly.
        if passed == 1.0 && alpha == 1.0 {
            return fill;
        }
        let mut mixed = [0; 3];
        for (channel, mixed) in mixed.iter_mut().enumerate() {
            let fill = self.decoded[usize::from(fill[channel])];
            let below = self.decoded[usize::from(below[channel])];
            let shadow = self.shadow[channel];
            let shaded = shadow + (fill - shadow) * passed;
            *mixed = self.encoded(below + (shaded - below) * alpha);
        }
        mixed
    }

    #[inline]
    fn encoded(&self, value: f32) -> u8 {
        match self.blending {
            Blending::Srgb => (value + 0.5) as u8,
            Blending::Linear => {
                // The byte that stands for the nearest amount of light.
                let above = self.decoded.partition_point(|&of_byte| of_byte < value);
                let above = above.min(255);
                let below = above.saturating_sub(1);
                let is_nearer_below = value - self.decoded[below] < self.decoded[above] - value;
                (if is_nearer_below { below } else { above }) as u8
            }
        }
    }
}

/// The amount of light, 0 to 1, of an sRGB number from 0 to 1 (IEC 61966-2-1).
fn linear(value: f32) -> f32 {
    if value <= 0.040_45 {
        value / 12.92
    } else {
        powf((value + 0.055) / 1.055, 2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tone::Color;

    #[test]
    fn nothing_mixed_in_changes_nothing() {
        for blending in [Blending::Srgb, Blending::Linear] {
            let mixer = Mixer::new(&Tone::ANDROID.with_blending(blending));
            for byte in 0..=255 {
                assert_eq!(mixer.mixed([byte; 3], [7; 3], 1.0, 1.0), [byte; 3]);
                assert_eq!(mixer.mixed([9; 3], [byte; 3], 0.3, 0.0), [byte; 3]);
            }
        }
    }

    #[test]
    fn half_of_black_and_white_is_188_in_light() {
        let half = |blending| {
            let tone = Tone::ANDROID
                .with_blending(blending)
                .with_color(Color::BLACK);
            Mixer::new(&tone).mixed([255; 3], [255; 3], 0.5, 1.0)
        };
        assert_eq!(half(Blending::Srgb), [128; 3]);
        assert_eq!(half(Blending::Linear), [188; 3]);
    }
}
