use super::{Point, REACH};
use crate::num::Metres;

/// How many scene units a metre has: `2^fraction_bits`.
///
/// The default, 16, makes a unit 15 µm and the scene ±64 m. Take the finest in which the scene fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    fraction_bits: i8,
}

impl Unit {
    /// 2^16 units a metre.
    pub const DEFAULT: Unit = Unit { fraction_bits: 16 };

    /// `2^fraction_bits` units a metre, −20 ..= 40; others are brought into that range.
    pub const fn new(fraction_bits: i32) -> Unit {
        let bits = if fraction_bits < -20 {
            -20
        } else if fraction_bits > 40 {
            40
        } else {
            fraction_bits
        };
        Unit {
            fraction_bits: bits as i8,
        }
    }

    #[inline]
    pub const fn fraction_bits(self) -> i32 {
        self.fraction_bits as i32
    }

    /// A length in units, rounded down, held within ±2·[`REACH`] (which no finite shape may reach: the border says so).
    pub const fn length(self, metres: Metres) -> i32 {
        let shift = self.fraction_bits as i32 - 16;
        let bits = metres.to_bits() as i64;
        let units = if shift >= 0 { bits << shift } else { bits >> -shift };
        let limit = 2 * REACH as i64;
        (if units > limit {
            limit
        } else if units < -limit {
            -limit
        } else {
            units
        }) as i32
    }

    /// A point from metres.
    pub const fn point(self, x: Metres, y: Metres, z: Metres) -> Point {
        Point([self.length(x), self.length(y), self.length(z)])
    }
}

impl Default for Unit {
    fn default() -> Unit {
        Unit::DEFAULT
    }
}

/// A point from metres in the default unit: `point(q!(0), q!(1), q!(-3))`.
pub const fn point(x: Metres, y: Metres, z: Metres) -> Point {
    Unit::DEFAULT.point(x, y, z)
}
