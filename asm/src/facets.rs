use core::marker::PhantomData;
use core::mem::{MaybeUninit, offset_of};
use core::ptr;

#[cfg(armv6m)]
use super::armv6m::{facets::look, walk::follow};
#[cfg(armv7m)]
use super::armv7m::facets::Scratch;
#[cfg(armv7m)]
use super::armv7m::{facets::look, walk::follow};
use super::ray::{Corner, Met, Ray, number_of};

/// A mesh's triangles as a ray sees them, and the nearest hit so far, in the order in which [`look`] reads it.
#[repr(C)]
pub struct Facets<'a> {
    pub(crate) vertices: *const [u16; 3],
    /// Of both axes across: steps aside for one along, Q13, negated; what that lacks to the ray, and ½.
    pub(crate) across: MaybeUninit<[Across; 2]>,
    pub(crate) vertex_count: MaybeUninit<u32>,
    pub(crate) triangles: *const [u16; 3],
    pub(crate) triangle_count: MaybeUninit<u32>,
    /// Four times the dominant axis.
    pub(crate) axis: u32,
    pub(crate) plane: i32,
    pub(crate) negative: u32,
    pub(crate) recips: *const [u16; 128],
    /// Whether to stop at what is nearer.
    pub(crate) once: u32,
    pub(crate) nearest: Nearest,
    /// For [`look`] to keep things in.
    #[cfg(armv7m)]
    pub(crate) scratch: MaybeUninit<Scratch>,
    lists: PhantomData<&'a [[u16; 3]]>,
}

#[repr(C)]
pub(crate) struct Across {
    slope: i32,
    offset: i32,
}

#[repr(C)]
pub(crate) struct Nearest {
    pub(crate) depth: i32,
    b1: i32,
    b2: i32,
    /// Where the triangle lies; the last place of all for none.
    pub(crate) triangle: usize,
}

impl Nearest {
    const fn before(depth: i32) -> Nearest {
        Nearest {
            depth,
            b1: 0,
            b2: 0,
            triangle: NONE,
        }
    }
}

const _: () = assert!(size_of::<[Corner; 3]>() == 36);

const NONE: usize = usize::MAX;
/// Bytes of a triangle, and of a vertex.
pub(crate) const SIZE: usize = 6;

impl<'a> Facets<'a> {
    /// Where the nearest hit's depth lies.
    pub(crate) const DEPTH: usize = offset_of!(Facets, nearest.depth);

    /// Nothing yet, and nothing beyond `depth`. `recips` are first guesses 2^47/n by n's seven bits below the top one.
    #[inline(always)]
    pub fn new(
        vertices: &'a [[u16; 3]],
        triangles: &'a [[u16; 3]],
        recips: &'a [u16; 128],
        ray: &Ray,
        depth: i32,
        once: bool,
    ) -> Facets<'a> {
        let across = |a: usize| Across {
            slope: ray.slopes[a].wrapping_neg(),
            offset: ray.offsets[a],
        };
        Facets {
            vertices: vertices.as_ptr(),
            across: MaybeUninit::new([across(0), across(1)]),
            vertex_count: MaybeUninit::new(vertices.len() as u32),
            triangles: triangles.as_ptr(),
            triangle_count: MaybeUninit::new(triangles.len() as u32),
            axis: u32::from(ray.axis.min(2)) * 4,
            ..Facets::of_corners(recips, ray.plane, ray.negative, depth, once)
        }
    }

    /// Looks at the triangles `first` .. `end`, those that there are: up to the first that is nearer than what there was,
    /// if only `once`; whether it stopped there. One with a vertex that there is not is met by nothing.
    #[inline(always)]
    pub fn look(&mut self, first: u32, end: u32) -> bool {
        // SAFETY: pointers and counts are those of slices that outlive this, the axis is 0 to 2.
        self.has_mesh() && unsafe { look(self, first, end) }
    }

    /// Looks at the triangles of all leaves of a tree that the ray may meet before what it has met, in its mesh; of nodes and
    /// `recips` as `Walk::begin` takes them.
    ///
    /// The ray is that of [`Facets::new`].
    #[inline(always)]
    pub fn follow(&mut self, nodes: &[u8], count: usize, ray: &Ray, recips: &[u16; 128]) {
        follow(self, nodes, count, ray, recips);
    }

    /// The same without a mesh: whose triangles are told by their corners.
    #[inline(always)]
    pub fn of_corners(
        recips: &'a [u16; 128],
        plane: i32,
        negative: bool,
        depth: i32,
        once: bool,
    ) -> Facets<'a> {
        Facets {
            vertices: ptr::null(),
            across: MaybeUninit::uninit(),
            vertex_count: MaybeUninit::uninit(),
            triangles: ptr::null(),
            triangle_count: MaybeUninit::uninit(),
            axis: 0,
            plane,
            negative: negative.into(),
            recips,
            once: once.into(),
            nearest: Nearest::before(depth),
            #[cfg(armv7m)]
            scratch: MaybeUninit::uninit(),
            lists: PhantomData,
        }
    }

    /// Looks at the triangle with these corners, of [`Facets::of_corners`]: whether it is nearer, if asked `once`.
    #[inline(always)]
    pub fn test(&mut self, corners: &[Corner; 3], triangle: u32) -> bool {
        // SAFETY: without vertices, what is looked at are three corners.
        !self.has_mesh() && unsafe { look(self, ptr::from_ref(corners) as u32, triangle) }
    }

    /// Whether it is not [`Facets::of_corners`].
    #[inline(always)]
    pub(crate) fn has_mesh(&self) -> bool {
        !self.vertices.is_null()
    }

    /// Of the nearest hit, or beyond which nothing is wanted.
    #[inline(always)]
    pub fn depth(&self) -> i32 {
        self.nearest.depth
    }

    #[inline(always)]
    pub fn met(&self) -> Option<Met> {
        let Nearest {
            depth,
            b1,
            b2,
            triangle,
        } = self.nearest;
        let is_met = triangle != NONE;
        let triangle = if self.has_mesh() {
            number_of(triangle, self.triangles)
        } else {
            triangle as u32
        };
        is_met.then_some(Met {
            triangle,
            depth,
            weights: [b1, b2],
        })
    }
}
