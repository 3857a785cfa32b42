//! Numbers that carry their slope: forward differentiation (Wengert 1964).

use std::ops::{Add, Mul, Sub};

use super::super::vec::Vec3;

/// What a field is computed with.
pub trait Number: Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    fn value(self) -> f64;
    fn sqrt(self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn abs(self) -> Self;

    fn max(self, other: Self) -> Self {
        if self.value() >= other.value() {
            self
        } else {
            other
        }
    }

    fn min(self, other: Self) -> Self {
        if self.value() <= other.value() {
            self
        } else {
            other
        }
    }
}

impl Number for f64 {
    fn value(self) -> f64 {
        self
    }

    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    fn sin(self) -> f64 {
        f64::sin(self)
    }

    fn cos(self) -> f64 {
        f64::cos(self)
    }

    fn abs(self) -> f64 {
        f64::abs(self)
    }
}

/// A value and how it changes with the three coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Dual {
    pub value: f64,
    pub slope: Vec3,
}

impl Dual {
    fn map(self, value: f64, derivative: f64) -> Dual {
        Dual {
            value,
            slope: self.slope * derivative,
        }
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Dual {
        Dual {
            value,
            slope: Vec3::ZERO,
        }
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, other: Dual) -> Dual {
        Dual {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, other: Dual) -> Dual {
        Dual {
            value: self.value - other.value,
            slope: self.slope - other.slope,
        }
    }
}

impl Mul for Dual {
    type Output = Dual;
    fn mul(self, other: Dual) -> Dual {
        Dual {
            value: self.value * other.value,
            slope: self.slope * other.value + other.slope * self.value,
        }
    }
}

impl Number for Dual {
    fn value(self) -> f64 {
        self.value
    }

    /// At 0 the slope is taken to be 0: the tip of a distance has no side.
    fn sqrt(self) -> Dual {
        let root = self.value.sqrt();
        self.map(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    fn sin(self) -> Dual {
        let (sin, cos) = self.value.sin_cos();
        self.map(sin, cos)
    }

    fn cos(self) -> Dual {
        let (sin, cos) = self.value.sin_cos();
        self.map(cos, -sin)
    }

    fn abs(self) -> Dual {
        self.map(self.value.abs(), 1f64.copysign(self.value))
    }
}
