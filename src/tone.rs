//! Tone: how density becomes paint.

use core::fmt;
use core::str::FromStr;

use crate::error::{self, Result};

/// A colour in sRGB with straight (not premultiplied) alpha, 8 bits each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Color {
    /// Red, 0 to 255.
    pub r: u8,
    /// Green, 0 to 255.
    pub g: u8,
    /// Blue, 0 to 255.
    pub b: u8,
    /// Opacity, 0 to 255.
    pub a: u8,
}

impl Color {
    /// Opaque black.
    pub const BLACK: Self = Self::rgb(0, 0, 0);
    /// Opaque white.
    pub const WHITE: Self = Self::rgb(255, 255, 255);

    /// An opaque colour.
    #[must_use]
    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, a: 255 }
    }

    /// The same without its alpha.
    pub(crate) const fn opaque(self) -> Self {
        Self::rgb(self.r, self.g, self.b)
    }
}

/// Why a text is no colour.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a colour: write #rgb, #rrggbb or #rrggbbaa")]
pub struct ParseColorError(String);

impl FromStr for Color {
    type Err = ParseColorError;

    /// Reads `#rgb`, `#rrggbb` or `#rrggbbaa`.
    fn from_str(text: &str) -> core::result::Result<Self, ParseColorError> {
        let refuse = || ParseColorError(text.chars().take(40).collect());
        let digits: Option<Vec<u8>> = text
            .strip_prefix('#')
            .ok_or_else(refuse)?
            .chars()
            .map(|c| c.to_digit(16).map(|digit| digit as u8))
            .collect();
        match *digits.ok_or_else(refuse)?.as_slice() {
            [r, g, b] => Ok(Self::rgb(r * 17, g * 17, b * 17)),
            [r1, r0, g1, g0, b1, b0] => Ok(Self::rgb(r1 * 16 + r0, g1 * 16 + g0, b1 * 16 + b0)),
            [r1, r0, g1, g0, b1, b0, a1, a0] => Ok(Self {
                a: a1 * 16 + a0,
                ..Self::rgb(r1 * 16 + r0, g1 * 16 + g0, b1 * 16 + b0)
            }),
            _ => Err(refuse()),
        }
    }
}

impl fmt::Display for Color {
    /// Writes what is read: `#rrggbb` for an opaque colour, `#rrggbbaa` for any other.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.r, self.g, self.b)?;
        match self.a {
            255 => Ok(()),
            a => write!(f, "{a:02x}"),
        }
    }
}

/// How density becomes paint: a colour, by default black, of strength `key` where the light is wholly hidden, and an ambient
/// shadow of strength `ambient` round each surface that fades as the surface rises. Strengths are from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    key: f32,
    ambient: f32,
    color: Color,
    blending: Blending,
}

/// In what a shadow's colour and what is below are mixed, and a surface's edge with what is around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Blending {
    /// In sRGB's own numbers, as nearly all toolkits do.
    #[default]
    Srgb,
    /// In amounts of light (IEC 61966-2-1), as physics does.
    Linear,
}

impl Tone {
    /// Android's strengths (AOSP, `core/res/res/values/dimens.xml`): key 0.19, ambient 0.039.
    pub const ANDROID: Self = Self::black(0.19, 0.039);
    /// Flutter's strengths: key 0.25, ambient 0.039.
    pub const FLUTTER: Self = Self::black(0.25, 0.039);

    const fn black(key: f32, ambient: f32) -> Self {
        Self {
            key,
            ambient,
            color: Color::BLACK,
            blending: Blending::Srgb,
        }
    }

    /// A tone of its own.
    ///
    /// # Errors
    /// A strength that is not from 0 to 1.
    pub fn new(key: f32, ambient: f32) -> Result<Self> {
        error::within("key", f64::from(key), 0.0, 1.0)?;
        error::within("ambient", f64::from(ambient), 0.0, 1.0)?;
        Ok(Self::black(key, ambient))
    }

    /// The same with shadows of another colour; its alpha is not looked at.
    #[must_use]
    pub fn with_color(mut self, color: Color) -> Self {
        self.color = color;
        self
    }

    /// The same with another way to blend.
    #[must_use]
    pub fn with_blending(mut self, blending: Blending) -> Self {
        self.blending = blending;
        self
    }

    /// The strength of the light's own shadow, 0 to 1.
    #[must_use]
    pub fn key(&self) -> f32 {
        self.key
    }

    /// The strength of the ambient shadow of a surface at its receiver's elevation, 0 to 1.
    #[must_use]
    pub fn ambient(&self) -> f32 {
        self.ambient
    }

    /// The colour of shadows.
    #[must_use]
    pub fn color(&self) -> Color {
        self.color
    }

    /// In what colours are mixed.
    #[must_use]
    pub fn blending(&self) -> Blending {
        self.blending
    }
}

impl Default for Tone {
    fn default() -> Self {
        Self::ANDROID
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_in_three_forms() {
        assert_eq!("#fff".parse(), Ok(Color::WHITE));
        assert_eq!("#0a141e".parse(), Ok(Color::rgb(10, 20, 30)));
        assert_eq!(
            "#0a141e80".parse(),
            Ok(Color {
                a: 128,
                ..Color::rgb(10, 20, 30)
            })
        );
        for bad in ["", "#", "#ff", "fff", "#ggg", "#fffff", "#ffffffff0", "red"] {
            assert!(bad.parse::<Color>().is_err(), "{bad}");
        }
    }

    #[test]
    fn colours_are_read_as_they_are_written() {
        let translucent = |a| Color {
            a,
            ..Color::rgb(10, 20, 30)
        };
        for (color, text) in [
            (Color::WHITE, "#ffffff"),
            (translucent(254), "#0a141efe"),
            (translucent(9), "#0a141e09"),
            (translucent(0), "#0a141e00"),
        ] {
            assert_eq!(color.to_string(), text);
            assert_eq!(text.parse(), Ok(color));
        }
    }
}
