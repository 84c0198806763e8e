//! What is known of a pixel after some of the casts.

use super::Cast;

/// What is known of a pixel after some of the casts: at first nothing.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pixel {
    /// What they hold back of the light, and what of it has met any of them.
    pub(super) held: f32,
    met: f32,
    /// What the first two that hide a part of the disc hide.
    pub(super) densities: [f32; 2],
    /// The casts that hide a part of the disc, and those that hide all of it, a bit each: the last bit stands for all from there on.
    pub(super) partial: u16,
    pub(super) full: u16,
}

/// Densities within this of 0 and 1 are these.
const ROUNDING: f32 = 1e-6;

/// The first cast that has no bit for itself.
pub(super) const REST: usize = 15;

/// The bit of a cast among those of its group.
pub(super) fn bit(index: usize) -> u16 {
    1 << index.min(REST)
}

/// What rounding leaves beyond a shadow's ends would make a partial cast of none.
fn rounded(density: f32) -> f32 {
    match density {
        ..ROUNDING => 0.0,
        density if density > 1.0 - ROUNDING => 1.0,
        density => density,
    }
}

/// What a cast holds back by itself.
pub(super) fn alone(density: f32, cast: &Cast) -> f32 {
    cast.strength as f32 * (cast.opacity as f32 * rounded(density))
}

impl Pixel {
    pub(super) fn add(&mut self, density: f32, cast: &Cast, bit: u16) {
        let density = rounded(density);
        if density == 0.0 {
            return;
        }
        let hides = cast.opacity as f32 * density * (1.0 - self.met);
        self.held += cast.strength as f32 * hides;
        self.met += hides;
        if density >= 1.0 {
            self.full |= bit;
        } else {
            if let Some(to) = self.densities.get_mut(self.partial.count_ones() as usize) {
                *to = density;
            }
            self.partial |= bit;
        }
    }

    pub(super) fn mend(&mut self, by: f32) {
        self.held = (self.held + by).clamp(0.0, 1.0);
    }

    /// Whether several casts hide a part of the disc.
    pub(super) fn is_shared(&self) -> bool {
        self.partial & (self.partial.wrapping_sub(1) | 1 << REST) != 0
    }
}
