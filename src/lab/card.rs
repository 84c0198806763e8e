//! Images as casters: a card in space with an alpha of its own at every point.

use glam::{DVec2, DVec3};

use crate::error::Result;
use crate::image::Image;

/// An image on a flat parallelogram in space, tilted as may be.
#[derive(Debug, Clone)]
pub struct Card {
    image: Image,
    corner: DVec3,
    across: DVec3,
    down: DVec3,
}

impl Card {
    /// The image's first corner at `corner` (x, y, z), its columns along `across`, its rows along `down`, scene units.
    ///
    /// # Errors
    /// Sides that are not finite or span no area.
    pub fn new(image: Image, corner: [f64; 3], across: [f64; 3], down: [f64; 3]) -> Result<Self> {
        let card = Self {
            image,
            corner: DVec3::from_array(corner),
            across: DVec3::from_array(across),
            down: DVec3::from_array(down),
        };
        let area = card.across.cross(card.down).length();
        crate::error::positive("the card's area", area)?;
        crate::error::coordinate("the card's corner", card.corner.abs().max_element())?;
        Ok(card)
    }

    /// Where the line from `from` to `to` meets the card's plane, as a part of its length, and the card's alpha there. None
    /// where they are parallel.
    pub(super) fn met(&self, from: DVec3, to: DVec3) -> Option<(f64, f64)> {
        let normal = self.across.cross(self.down);
        let share = normal.dot(self.corner - from) / normal.dot(to - from);
        if !share.is_finite() {
            return None;
        }
        let at = from + (to - from) * share - self.corner;
        // The plane's own coordinates, by the dual vectors of its sides.
        let square = normal.length_squared();
        let place = DVec2::new(
            self.down.cross(normal).dot(at),
            normal.cross(self.across).dot(at),
        ) / square;
        Some((share, alpha(&self.image, place)))
    }

    /// The part of the light that passes from `light` to `point`, 0 to 1.
    #[must_use]
    pub fn passed(&self, point: [f64; 3], light: [f64; 3]) -> f64 {
        match self.met(DVec3::from_array(point), DVec3::from_array(light)) {
            Some((share, alpha)) if 0.0 < share && share < 1.0 => 1.0 - alpha,
            _ => 1.0,
        }
    }
}

/// The image's alpha at a place from 0 to 1 each way, 0 to 1: between the pixels' centres it changes evenly, outside of the image
/// it is 0.
fn alpha(image: &Image, place: DVec2) -> f64 {
    if !(place.cmpge(DVec2::ZERO).all() && place.cmple(DVec2::ONE).all()) {
        return 0.0;
    }
    let [width, height] = image.size();
    let size = DVec2::new(f64::from(width), f64::from(height));
    let at = (place * size - 0.5).clamp(DVec2::ZERO, size - 1.0);
    let (low, share) = (at.floor(), at - at.floor());
    let texel = |dx: f64, dy: f64| {
        let x = (low.x + dx).min(size.x - 1.0) as usize;
        let y = (low.y + dy).min(size.y - 1.0) as usize;
        f64::from(image.pixels()[4 * (y * width as usize + x) + 3]) / 255.0
    };
    let between = |a: f64, b: f64, share: f64| a + (b - a) * share;
    between(
        between(texel(0.0, 0.0), texel(1.0, 0.0), share.x),
        between(texel(0.0, 1.0), texel(1.0, 1.0), share.x),
        share.y,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_find_their_place_on_a_tilted_card() {
        let mut pixels = vec![0; 64];
        pixels[4 * (4 + 2)..][..4].copy_from_slice(&[9, 9, 9, 255]);
        let image = Image::from_rgba8([4, 4], pixels).unwrap();
        let card = Card::new(image, [0.0, 0.0, 1.0], [4.0, 0.0, 2.0], [1.0, 4.0, 0.0]).unwrap();
        // The middle of the opaque pixel: 2.5 of 4 across, 1.5 of 4 down.
        let middle = card.corner + card.across * (2.5 / 4.0) + card.down * (1.5 / 4.0);
        let way = DVec3::new(0.3, -0.2, 2.0);
        let (share, alpha) = card.met(middle - way, middle + way * 3.0).unwrap();
        assert!((share - 0.25).abs() < 1e-12 && (alpha - 1.0).abs() < 1e-12);
        let [near, far] = [middle + way, middle + way * 3.0].map(|p| p.to_array());
        assert_eq!(card.passed(near, far), 1.0);
        assert!(Image::from_rgba8([2, 2], vec![0; 12]).is_err());
        assert!(Image::from_rgba8([0, 2], Vec::new()).is_err());
    }
}
