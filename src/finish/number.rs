//! What the illumination computes with: plain numbers, or second-order Taylor expansions over a plane.

use core::ops::{Add, Mul, Sub};

use libm::pow;

/// A number, or something that stands for one at every point.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// One number everywhere.
    fn constant(value: f64) -> Self;

    /// The number itself, or at the point of expansion.
    fn value(self) -> f64;

    /// The number, or 0 where it is below.
    fn at_least_zero(self) -> Self {
        if self.value() > 0.0 {
            self
        } else {
            Self::constant(0.0)
        }
    }

    /// One over the square root of a number above 0.
    fn inverse_root(self) -> Self;

    /// One over a number above 0.
    fn inverse(self) -> Self;

    /// A power of a number of at least 0; the exponent is at least 1.
    fn power(self, exponent: f64) -> Self;
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn inverse_root(self) -> Self {
        1.0 / self.sqrt()
    }

    fn inverse(self) -> Self {
        1.0 / self
    }

    fn power(self, exponent: f64) -> Self {
        pow(self, exponent)
    }
}

/// A second-order Taylor expansion in x and y: its coefficients of 1, x, y, x², x y and y².
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Taylor(pub(super) [f64; 6]);

impl Taylor {
    /// The expansion of `at + x along_x + y along_y`.
    pub(super) fn linear(at: f64, along_x: f64, along_y: f64) -> Self {
        Self([at, along_x, along_y, 0.0, 0.0, 0.0])
    }

    /// Its value at a point.
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        let [c, cx, cy, cxx, cxy, cyy] = self.0;
        c + x * (cx + x * cxx + y * cxy) + y * (cy + y * cyy)
    }

    /// The expansion of a function of this one, by the function's value and first two derivatives.
    fn of(self, value: f64, first: f64, second: f64) -> Self {
        let [_, x, y, xx, xy, yy] = self.0;
        let half = second / 2.0;
        Self([
            value,
            first * x,
            first * y,
            first * xx + half * x * x,
            first * xy + second * x * y,
            first * yy + half * y * y,
        ])
    }

    fn with(self, other: Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        let mut sum = self.0;
        for (a, b) in sum.iter_mut().zip(other.0) {
            *a = combine(*a, b);
        }
        Self(sum)
    }
}

impl Add for Taylor {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Taylor {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Taylor {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let ([a, ax, ay, axx, axy, ayy], [b, bx, by, bxx, bxy, byy]) = (self.0, other.0);
        Self([
            a * b,
            a * bx + ax * b,
            a * by + ay * b,
            a * bxx + ax * bx + axx * b,
            a * bxy + ax * by + ay * bx + axy * b,
            a * byy + ay * by + ayy * b,
        ])
    }
}

impl Number for Taylor {
    fn constant(value: f64) -> Self {
        Self::linear(value, 0.0, 0.0)
    }

    fn value(self) -> f64 {
        self.0[0]
    }

    fn inverse_root(self) -> Self {
        let root = 1.0 / self.value().sqrt();
        let first = -0.5 * root / self.value();
        self.of(root, first, -1.5 * first / self.value())
    }

    fn inverse(self) -> Self {
        let inverse = 1.0 / self.value();
        self.of(
            inverse,
            -inverse * inverse,
            2.0 * inverse * inverse * inverse,
        )
    }

    fn power(self, exponent: f64) -> Self {
        let value = self.value();
        if value <= 0.0 {
            return Self::constant(0.0);
        }
        let power = pow(value, exponent);
        let first = exponent * power / value;
        self.of(power, first, (exponent - 1.0) * first / value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expansions_miss_by_the_third_order() {
        let [x, y] = [
            Taylor::linear(0.7, 1.0, 0.3),
            Taylor::linear(0.4, -0.2, 1.0),
        ];
        let of = |x: f64, y: f64| pow((x * x + y) / (x + y * y).sqrt(), 5.0) + 1.0 / (x + y);
        let expanded = {
            let inner = (x * x + y) * (x + y * y).inverse_root();
            inner.power(5.0) + (x + y).inverse()
        };
        let mut last = f64::INFINITY;
        for step in [0.04, 0.02, 0.01] {
            let (dx, dy) = (step, -0.6 * step);
            let exact = of(0.7 + dx + 0.3 * dy, 0.4 - 0.2 * dx + dy);
            let error = (expanded.at(dx, dy) - exact).abs();
            // Half the step, an eighth of the error: a sixth leaves room for the fourth order.
            assert!(error < last / 6.0, "{step}: {error} after {last}");
            last = error;
        }
    }
}
