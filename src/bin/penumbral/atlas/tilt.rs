//! A card that turns until it passes the light's plane: the closed form on pixels and the penumbra map, against the closed form
//! at points.

use penumbral::lab::{Card, DiscLight, Errors, Family, Kernel, PenumbraMap, Region};
use penumbral::{Grid, Image, Light, PixelOptions, Pose, Result, Shape};

use super::families::Own;

/// The card's half side, its middle's height, and the light.
const HALF: f64 = 24.0;
const MIDDLE: [f64; 3] = [50.0, 50.0, 60.0];
const LIGHT: [f64; 3] = [50.0, 30.0, 80.0];
const RADIUS: f64 = 30.0;

/// What is drawn of the card turned by so many degrees about its middle line.
pub(super) fn measure(degrees: f64) -> Result<Vec<Own>> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let corner = [
        MIDDLE[0] - HALF * cos,
        MIDDLE[1] - HALF,
        MIDDLE[2] - HALF * sin,
    ];
    let across = [cos, 0.0, sin];
    let grid = Grid::new([-50.0, -50.0], [200, 200], 1.0)?;
    let mut drawn = vec![0.0; 200 * 200];

    let pose = Pose::new(
        corner.map(|v| v as f32),
        across.map(|v| v as f32),
        [0.0, 1.0, 0.0],
    )?;
    let side = (2.0 * HALF) as f32;
    let light = Light::new(LIGHT.map(|v| v as f32), RADIUS as f32)?;
    let shadow = light.cast_posed(&Shape::rect(0.0, 0.0, side, side)?, &pose, 0.0)?;
    let exact: Vec<f32> = (0..200 * 200_u16)
        .map(|i| {
            let (x, y) = (f32::from(i % 200), f32::from(i / 200));
            shadow.density_at([x - 49.5, y - 49.5]) as f32
        })
        .collect();
    shadow.fill_f32(&grid, &mut drawn, &PixelOptions::default())?;
    let ours = Own {
        method: "tilted",
        family: Family::Ours,
        errors: Errors::between(&drawn, &exact),
        promised_levels: Some(1.0),
    };

    let solid = Image::from_rgba8([1, 1], vec![0, 0, 0, 255])?;
    let card = Card::new(
        solid,
        corner,
        across.map(|v| v * 2.0 * HALF),
        [0.0, 2.0 * HALF, 0.0],
    )?;
    let disc = DiscLight {
        center: LIGHT,
        radius: RADIUS,
        power: 1.0,
    };
    let map = PenumbraMap::new(Kernel::Box, Region::Circle, 1.0)?;
    map.shade(&[disc], &[card], &grid, &mut drawn)?;
    let map = Own {
        method: "penumbra-map",
        family: Family::Maps,
        errors: Errors::between(&drawn, &exact),
        promised_levels: None,
    };
    Ok(vec![ours, map])
}
