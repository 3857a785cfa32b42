//! What a scene is made of beside meshes, as it lies in flash: records of one size each, little-endian, each at a multiple
//! of 4 bytes.
//!
//! What a record's kind has no use for is 0. A record is taken if what it says is said by it alone: it is refused unless
//! writing again what was read gives the same bytes.

mod light;
mod material;
mod shape;

pub use light::{LightRecord, MapRecord, SkyRecord};
pub use material::{MaterialRecord, TextureRecord};
pub use shape::{BlobRecord, ShapeRecord};

use zerocopy::{Immutable, IntoBytes};

/// What was read, if writing it again gives the same record.
fn canonical<R: IntoBytes + Immutable, T>(record: &R, again: &R, value: T) -> Result<T, &'static str> {
    if record.as_bytes() == again.as_bytes() {
        Ok(value)
    } else {
        Err("numbers")
    }
}
