//! What the targets share.

pub use host_sim::bake::Aligned;
use microlux::geom::{Dir, Point, Ray};
use microlux::shape::Grid;

/// Bytes with the checksum of a blob that they would have if they were one.
pub fn summed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let mut crc = microlux::num::Crc::new();
    crc.bytes(bytes.get(20..).unwrap_or(&[]));
    if let Some(sum) = bytes.get_mut(16..20) {
        sum.copy_from_slice(&crc.value().to_le_bytes());
    }
    let length = (bytes.len() as u32).to_le_bytes();
    if let Some(says) = bytes.get_mut(12..16) {
        says.copy_from_slice(&length);
    }
    bytes
}

/// Rays at a mesh's cube from around it, the same for the same bytes.
pub struct Rays {
    origin: [i64; 3],
    /// Scene units a side.
    side: i64,
    state: u64,
}

impl Rays {
    pub fn new(grid: &Grid, bytes: &[u8]) -> Rays {
        let state = bytes.iter().fold(0xcbf2_9ce4_8422_2325u64, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        Rays {
            origin: grid.origin().0.map(i64::from),
            side: 1 << (16 + grid.shift()),
            state,
        }
    }

    fn number(&mut self) -> i64 {
        self.state = self
            .state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 40) as i64
    }
}

impl Iterator for Rays {
    type Item = Ray;

    fn next(&mut self) -> Option<Ray> {
        // Within half a side around the cube.
        let mut point =
            || [0, 1, 2].map(|i| self.origin[i] - self.side / 2 + self.number() * self.side / (1 << 23));
        let (from, to) = (point(), point());
        let dir = Dir::new([0, 1, 2].map(|i| (to[i] - from[i]) as i32)).unwrap_or(Dir::Z);
        Some(Ray {
            origin: Point(from.map(|c| c as i32)),
            dir,
        })
    }
}
