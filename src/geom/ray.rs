use super::{Dir, Point};

/// A ray: all points `origin + t·dir`, t > 0 in scene units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(rectangles, derive(zerocopy::IntoBytes, zerocopy::Immutable))]
#[repr(C)]
pub struct Ray {
    pub origin: Point,
    pub dir: Dir,
}

impl Ray {
    #[inline]
    pub const fn at(&self, t: i32) -> Point {
        self.origin.along(self.dir, t)
    }
}
