//! Where the vertices of packed meshes lie: in groups, each at widths of its own.

use zerocopy::{FromBytes, Immutable, KnownLayout};

/// Up to 256 vertices near to each other.
///
/// | byte | what |
/// |---|---|
/// | 0 ..= 5 | base, 3×u16: the lowest coordinate along each axis |
/// | 6, 7 | bits of a vertex's distance from it along x, y, z: 5 bits each, 0 ..= 16 |
/// | 8 ..= 10 | where its vertices begin, bytes |
/// | 11 | vertices − 1 |
///
/// A vertex is its three distances, x in the lowest bits; vertices follow each other without a gap. After the last one's
/// byte comes for each vertex what else it says ([`super::Layers`]), without a gap, too. Little-endian in flash.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, Immutable, KnownLayout)]
pub struct Treelet {
    base: [u16; 3],
    widths: u16,
    start_low: u16,
    start_high: u8,
    last: u8,
}

const _: () = assert!(size_of::<Treelet>() == 12 && align_of::<Treelet>() == 2);

impl Treelet {
    /// `widths` at most 16, `start` under 2^24, `vertices` 1 ..= 256: what is above is cut off.
    pub const fn new(base: [u16; 3], widths: [u32; 3], start: u32, vertices: u32) -> Treelet {
        let [x, y, z] = widths;
        Treelet {
            base,
            widths: (x & 31 | (y & 31) << 5 | (z & 31) << 10) as u16,
            start_low: start as u16,
            start_high: (start >> 16) as u8,
            last: vertices.wrapping_sub(1) as u8,
        }
    }

    /// As it lies in flash: the bytes of the table above.
    pub fn to_le_bytes(self) -> [u8; 12] {
        let mut bytes = [0; 12];
        let [x, y, z] = self.base;
        for (two, value) in bytes
            .chunks_exact_mut(2)
            .zip([x, y, z, self.widths, self.start_low])
        {
            two.copy_from_slice(&value.to_le_bytes());
        }
        (bytes[10], bytes[11]) = (self.start_high, self.last);
        bytes
    }

    /// What [`Treelet::to_le_bytes`] wrote. Whether it makes sense is checked with its scene.
    pub const fn from_le_bytes(b: [u8; 12]) -> Treelet {
        Treelet {
            base: [
                u16::from_le_bytes([b[0], b[1]]),
                u16::from_le_bytes([b[2], b[3]]),
                u16::from_le_bytes([b[4], b[5]]),
            ],
            widths: u16::from_le_bytes([b[6], b[7]]),
            start_low: u16::from_le_bytes([b[8], b[9]]),
            start_high: b[10],
            last: b[11],
        }
    }

    #[inline(always)]
    fn widths(&self) -> [u32; 3] {
        [0, 5, 10].map(|shift| (self.widths >> shift & 31) as u32)
    }

    #[inline(always)]
    pub(super) fn start(&self) -> usize {
        (self.start_high as usize) << 16 | self.start_low as usize
    }

    /// The last vertex.
    pub(super) fn last(&self) -> u8 {
        self.last
    }

    /// Bytes that its vertices' places take.
    pub(super) fn size(&self) -> usize {
        Treelet::bytes(self.widths(), u32::from(self.last) + 1)
    }

    /// Whether its widths are such as there are.
    pub(super) fn is_valid(&self) -> bool {
        self.widths().iter().all(|&width| width <= 16) && self.widths >> 15 == 0
    }

    /// Bytes that the places of so many vertices take.
    pub const fn bytes(widths: [u32; 3], vertices: u32) -> usize {
        ((widths[0] + widths[1] + widths[2]) * vertices).div_ceil(8) as usize
    }

    /// A vertex, grid coordinates, of those of all treelets.
    ///
    /// Its 48 bits at most lie in seven bytes, whatever bit they begin at.
    #[inline(always)]
    pub(super) fn vertex(&self, vertices: &[u8], index: u8) -> Option<[u16; 3]> {
        let [x, y, z] = self.widths();
        let bit = index as u32 * (x + y + z);
        let at = self.start() + (bit >> 3) as usize;
        let Some(&[a, b, c, d, e, f, g]) = vertices.get(at..at + 7).and_then(|bytes| bytes.first_chunk())
        else {
            return self.vertex_apart(vertices, bit);
        };
        let (low, high) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, 0]));
        // 32 bits from one on, of 64; a shift by 32 is two.
        let from = |low: u32, high: u32, bit: u32| low >> bit | (high << 1) << (31 - bit);
        let skip = bit & 7;
        let far = from(low, high, skip);
        let rest = from(far, high >> skip, x);
        let part = |far: u32, width: u32| (far & ((1 << width) - 1)) as u16;
        let [p, q, r] = self.base;
        Some([
            p.wrapping_add(part(far, x)),
            q.wrapping_add(part(rest, y)),
            r.wrapping_add(part(rest >> y, z)),
        ])
    }

    /// The same, each coordinate by itself: among the last bytes of all.
    #[cold]
    #[inline(never)]
    fn vertex_apart(&self, vertices: &[u8], mut bit: u32) -> Option<[u16; 3]> {
        let widths = self.widths();
        let mut vertex = self.base;
        for (coordinate, width) in vertex.iter_mut().zip(widths) {
            let at = self.start() + (bit >> 3) as usize;
            let &[a, b, c] = vertices.get(at..at + 3)?.first_chunk()?;
            let far = u32::from_le_bytes([a, b, c, 0]) >> (bit & 7) & ((1 << width) - 1);
            *coordinate = coordinate.wrapping_add(far as u16);
            bit += width;
        }
        Some(vertex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_a_treelet_are_where_the_table_says() {
        let bytes: [u8; 12] = core::array::from_fn(|at| at as u8);
        let treelet = Treelet::from_le_bytes(bytes);
        assert_eq!(
            (treelet.base[2], treelet.start(), treelet.last),
            (0x504, 0xa0908, 11)
        );
        assert_eq!(treelet.widths(), [0x706 & 31, 0x706 >> 5 & 31, 0x706 >> 10]);
        assert_eq!(treelet.to_le_bytes(), bytes);
        assert_eq!(
            Treelet::new([1, 2, 3], [4, 16, 6], 0x12345, 256).widths(),
            [4, 16, 6]
        );
    }

    /// At any bit, of any widths, seven bytes at once are what three times three are.
    #[test]
    fn a_vertex_is_read_at_once_or_apart() {
        let mut s = 1u32;
        let mut r = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            s ^ (s >> 15)
        };
        for _ in 0..2000 {
            let vertices = [(); 64].map(|()| r() as u8);
            let widths = [(); 3].map(|()| r() % 17);
            let treelet = Treelet::new([r() as u16, r() as u16, r() as u16], widths, r() % 8, 8);
            for index in 0..8u8 {
                let bit = u32::from(index) * widths.iter().sum::<u32>();
                let apart = treelet.vertex_apart(&vertices, bit);
                assert!(apart.is_some());
                assert_eq!(treelet.vertex(&vertices, index), apart, "{widths:?} {index}");
            }
        }
    }
}
