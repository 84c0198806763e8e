//! Fewer vertices for a curve of a tilted caster, which comes as lines for the finest tolerance.

use core::f64::consts::PI;

use glam::DVec2;

use super::projected;
use crate::outline::nearest_share;
use crate::tilted::Circle;

/// The most vertices that one line stands for: to try more would take the square of their number.
const MOST_RUN: usize = 64;

/// The loop without vertices that a line past them stands for: nowhere on the light's disc it passes them by more than `share` of its
/// radius. And how much of the disc (density) is on the other side of all those lines at most, wherever it is seen from.
pub(super) fn fewer(circles: &[Circle], share: f64) -> (Vec<Circle>, f64) {
    let count = circles.len();
    let (mut kept, mut lost) = (Vec::with_capacity(count), 0.0);
    let mut first = 0;
    while first < count {
        kept.push(circles[first]);
        let mut run = (first + 1, 0.0);
        for last in first + 2..=count.min(first + MOST_RUN) {
            let to = &circles[last % count];
            let passed = &circles[first + 1..last];
            let furthest = passed
                .iter()
                .map(|over| passes(&circles[first], over, to))
                .fold(0.0, f64::max);
            let loss = furthest * length(&circles[first], to) / PI;
            // Where the caster touches its receiver there is no disc to tell.
            if furthest > share || !loss.is_finite() {
                break;
            }
            run = (last, loss);
        }
        first = run.0;
        lost += run.1;
    }
    if kept.len() < 3 {
        return (circles.to_vec(), 0.0);
    }
    (kept, lost)
}

/// The loops without vertices, all of them together within `most` density, and how far they are from it.
pub(super) fn fewer_within(loops: &[Vec<Circle>], most: f64) -> (Vec<Vec<Circle>>, f64) {
    let mut share = most;
    loop {
        let (kept, lost): (Vec<_>, Vec<_>) =
            loops.iter().map(|circles| fewer(circles, share)).unzip();
        let lost = lost.into_iter().sum();
        if lost <= most {
            return (kept, lost);
        }
        // What is lost is next to proportional.
        share *= 0.9 * most / lost;
    }
}

/// How far the disc's points see the line from one circle to another pass a third, in the disc's radii.
fn passes(from: &Circle, over: &Circle, to: &Circle) -> f64 {
    let [from, over, to] = [from, over, to].map(projected);
    let share = nearest_share(from.center, to.center, over.center);
    let nearest = from.center + (to.center - from.center) * share;
    let radius = from.radius + (to.radius - from.radius) * share;
    ((nearest - over.center).length() + (radius - over.radius).abs()) / over.radius
}

/// How long a line is on the light's disc at most, in its radii.
fn length(from: &Circle, to: &Circle) -> f64 {
    let [from, to] = [from, to].map(projected);
    let way: DVec2 = to.center - from.center;
    (way.length() + (to.radius - from.radius).abs()) / from.radius.min(to.radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::tilted;
    use crate::light::Light;
    use crate::pose::Pose;
    use crate::shape::Shape;

    #[test]
    fn densities_change_by_no_more_than_is_said() {
        const SIDE: u32 = 41;
        let shapes = [
            Shape::rect(50.0, 60.0, 60.0, 40.0).unwrap(),
            Shape::rounded_rect(50.0, 60.0, 60.0, 40.0, 6.0).unwrap(),
            Shape::circle([80.0, 80.0], 30.0).unwrap(),
        ];
        for radius in [4.0, 40.0, 400.0] {
            let light = Light::new([80.0, 30.0, 300.0], radius).unwrap();
            for shape in &shapes {
                for (elevation, degrees) in [(60.0, 0.0), (60.0, 25.0), (50.0, 80.0), (20.0, 60.0)]
                {
                    let angle = f32::to_radians(degrees);
                    let pose = Pose::turned(elevation, [80.0, 80.0], [1.0, 0.4], angle).unwrap();
                    let shadow = light.cast_posed(shape, &pose, 0.0).unwrap();
                    let (loops, lost) = fewer_within(&shadow.loops, 4e-4);
                    let (min, max) = shadow.hull().unwrap();
                    let mut worst: f64 = 0.0;
                    for i in 0..SIDE * SIDE {
                        let at = DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE));
                        let point = min + (max - min) * at / f64::from(SIDE - 1);
                        let [before, after] =
                            [&shadow.loops, &loops].map(|loops| tilted::at_point(loops, point));
                        worst = worst.max((after - before).abs());
                    }
                    let counts = [&shadow.loops, &loops].map(|loops| loops[0].len());
                    println!(
                        "light {radius}, {elevation} up, {degrees} degrees: {counts:?} vertices, {worst:.1e} of {lost:.1e}"
                    );
                    // The closed form's own rounding apart.
                    assert!(worst <= lost + 1e-12 && lost <= 4e-4);
                }
            }
        }
    }
}
