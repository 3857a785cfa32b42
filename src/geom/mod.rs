//! Points, offsets and directions in the scene frame, rays, and frames about a normal.
//!
//! Coordinates are i32 in scene units. A [`Unit`] says how many units a metre has: a power of two, chosen when the
//! scene is made, so that everything finite lies within ±[`REACH`].

mod beam;
mod frame;
mod octahedral;
mod ray;
mod rotation;
mod unit;
mod vec;

pub use beam::Beam;
pub use frame::Frame;
pub use octahedral::Octahedral;
pub use ray::Ray;
pub use rotation::Rotation;
pub use unit::{Unit, point};
pub use vec::{Dir, Norm, Offset, Point, cross};

/// Bound of every finite shape's coordinates, units: 2^22.
///
/// Cameras may stand at twice that. Only an infinite plane is hit farther away, up to [`FAR`].
pub const REACH: i32 = 1 << 22;

/// Largest distance along a ray, units: 2^29. A plane hit beyond it is placed there.
pub const FAR: i32 = 1 << 29;
