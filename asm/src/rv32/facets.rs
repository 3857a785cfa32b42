use core::arch::naked_asm;
use core::marker::PhantomData;
use core::mem::{MaybeUninit, offset_of};
use core::ptr;

use crate::ray::{Corner, DEPTH_BITS, Met, Ray, number_of};

/// A mesh's triangles as a ray sees them, and the nearest hit so far.
#[repr(C)]
pub struct Facets<'a> {
    vertices: *const [u16; 3],
    vertex_count: MaybeUninit<u32>,
    triangles: *const [u16; 3],
    triangle_count: MaybeUninit<u32>,
    slopes: MaybeUninit<[i32; 2]>,
    offsets: MaybeUninit<[i32; 2]>,
    /// Behind the last triangle.
    end: MaybeUninit<*const [u16; 3]>,
    /// The loop for the dominant axis.
    front: MaybeUninit<usize>,
    plane: i32,
    /// All ones for a ray that goes down the axis.
    flip: i32,
    /// 2^12 and 2^4, negative for such a ray.
    scales: [i32; 2],
    recips: *const [u16; 128],
    /// Whether to stop at what is nearer.
    once: u32,
    nearest: Nearest,
    /// What a walk goes by: where the ray may be met, along the axis, and the largest that may come next.
    range: MaybeUninit<[i32; 2]>,
    limit: MaybeUninit<u32>,
    lists: PhantomData<&'a [[u16; 3]]>,
}

#[repr(C)]
struct Nearest {
    depth: i32,
    /// Q16; of a triangle.
    weights: MaybeUninit<[i32; 2]>,
    /// Where the triangle lies; the last place of all for none.
    triangle: usize,
}

impl Nearest {
    const fn before(depth: i32) -> Nearest {
        Nearest {
            depth,
            weights: MaybeUninit::uninit(),
            triangle: NONE,
        }
    }
}

#[inline(always)]
fn scales(negative: bool) -> [i32; 2] {
    let sign = 1 - 2 * i32::from(negative);
    [sign << 12, sign << 4]
}

const _: () = assert!(size_of::<[Corner; 3]>() == 36);

unsafe extern "C" {
    /// Loops of [`front`] by the dominant axis.
    static microlux_facets_fronts: [usize; 3];
}

const NONE: usize = usize::MAX;
/// Bytes of a triangle, and of a vertex.
const SIZE: usize = 6;

impl<'a> Facets<'a> {
    pub(crate) const SLOPES: usize = offset_of!(Facets, slopes);
    pub(crate) const OFFSETS: usize = offset_of!(Facets, offsets);
    pub(crate) const PLANE: usize = offset_of!(Facets, plane);
    pub(crate) const FLIP: usize = offset_of!(Facets, flip);
    pub(crate) const RECIPS: usize = offset_of!(Facets, recips);
    pub(crate) const DEPTH: usize = offset_of!(Facets, nearest.depth);
    pub(crate) const RANGE: usize = offset_of!(Facets, range);
    pub(crate) const LIMIT: usize = offset_of!(Facets, limit);
    pub(crate) const VERTICES: usize = offset_of!(Facets, vertices);
    pub(crate) const VERTEX_COUNT: usize = offset_of!(Facets, vertex_count);
    pub(crate) const TRIANGLES: usize = offset_of!(Facets, triangles);
    pub(crate) const TRIANGLE_COUNT: usize = offset_of!(Facets, triangle_count);
    pub(crate) const END: usize = offset_of!(Facets, end);
    pub(crate) const FRONT: usize = offset_of!(Facets, front);

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
        // SAFETY: it is what assembly below says.
        let front = unsafe { microlux_facets_fronts[usize::from(ray.axis.min(2))] };
        Facets {
            vertices: vertices.as_ptr(),
            vertex_count: MaybeUninit::new(vertices.len() as u32),
            triangles: triangles.as_ptr(),
            triangle_count: MaybeUninit::new(triangles.len() as u32),
            slopes: MaybeUninit::new(ray.slopes),
            offsets: MaybeUninit::new(ray.offsets),
            end: MaybeUninit::new(triangles.as_ptr_range().end),
            front: MaybeUninit::new(front),
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
            vertex_count: MaybeUninit::uninit(),
            triangles: ptr::null(),
            triangle_count: MaybeUninit::uninit(),
            slopes: MaybeUninit::uninit(),
            offsets: MaybeUninit::uninit(),
            end: MaybeUninit::uninit(),
            front: MaybeUninit::uninit(),
            plane,
            flip: -i32::from(negative),
            scales: scales(negative),
            recips,
            once: once.into(),
            nearest: Nearest::before(depth),
            range: MaybeUninit::uninit(),
            limit: MaybeUninit::uninit(),
            lists: PhantomData,
        }
    }

    /// Looks at the triangle with these corners, of [`Facets::of_corners`]: whether it is nearer, if asked `once`.
    #[inline(always)]
    pub fn test(&mut self, corners: &[Corner; 3], triangle: u32) -> bool {
        // SAFETY: without vertices, no triangle but the one with these corners is looked at.
        !self.has_mesh() && unsafe { test(self, corners, triangle) }
    }

    /// Whether it is not [`Facets::of_corners`].
    #[inline(always)]
    pub(crate) fn has_mesh(&self) -> bool {
        !self.vertices.is_null()
    }

    /// Whether what a leaf names beyond the list lies behind it, and not at the first address again.
    ///
    /// # Safety
    ///
    /// It has a mesh.
    #[inline(always)]
    pub(crate) unsafe fn is_below_last(&self) -> bool {
        // SAFETY: `Facets::new` has written it.
        let end = unsafe { self.end.assume_init() };
        (end as usize) < usize::MAX - 255
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
            weights,
            triangle,
        } = self.nearest;
        let is_met = triangle != NONE;
        let triangle = if self.has_mesh() {
            number_of(triangle, self.triangles)
        } else {
            triangle as u32
        };
        is_met.then(|| Met {
            triangle,
            depth,
            // SAFETY: they come with the triangle.
            weights: unsafe { weights.assume_init() },
        })
    }
}

/// On to `$past` if the three are all below zero, or all above; else on to `$next`, which comes next.
#[rustfmt::skip]
macro_rules! beside {
    ($a:literal, $b:literal, $c:literal, $past:literal, $next:literal) => {
        concat!(
            "bltz ", $a, ", 5f; blez ", $b, ", ", $next, "; blez ", $c, ", ", $next, "; bnez ", $a, ", ", $past, "; j ", $next, ";",
            "5: bgez ", $b, ", ", $next, "; bltz ", $c, ", ", $past, ";",
        )
    };
}

/// Of the vertex with coordinate `$z` along the dominant axis, what the ray sees across: `$x`, which is a coordinate there.
#[rustfmt::skip]
macro_rules! seen {
    ($x:literal, $z:literal, $slope:literal, $offset:literal) => {
        concat!(
            "mul t0, ", $slope, ", ", $z, "; sub t0, ", $offset, ", t0; srai t0, t0, 13; add ", $x, ", ", $x, ", t0;",
        )
    };
}

/// On to the next triangle that lies to no side of the ray: the loop for one dominant axis.
#[rustfmt::skip]
macro_rules! front {
    ($loop:literal, $k:literal, $a:literal, $b:literal) => {
        concat!(
            $loop, ": 41: lhu a4, 0(s10); lhu a5, 2(s10); lhu a6, 4(s10); li t0, 6;",
            "bgeu a4, s6, 40f; bgeu a5, s6, 40f; bgeu a6, s6, 40f;",
            "mul a4, a4, t0; mul a5, a5, t0; mul a6, a6, t0; add a4, a4, a0; add a5, a5, a0; add a6, a6, a0;",
            "lhu s7, ", $k, "(a4); lhu s8, ", $k, "(a5); lhu s9, ", $k, "(a6);",
            "lhu a1, ", $a, "(a4); lhu a2, ", $a, "(a5); lhu a3, ", $a, "(a6);",
            seen!("a1", "s7", "s2", "s4"),
            seen!("a2", "s8", "s2", "s4"),
            seen!("a3", "s9", "s2", "s4"),
            beside!("a1", "a2", "a3", "40f", "6f"),
            "6: lhu a4, ", $b, "(a4); lhu a5, ", $b, "(a5); lhu a6, ", $b, "(a6);",
            seen!("a4", "s7", "s3", "s5"),
            seen!("a5", "s8", "s3", "s5"),
            seen!("a6", "s9", "s3", "s5"),
            beside!("a4", "a5", "a6", "40f", "50b"),
            "j 50b;",
            "40: addi s10, s10, 6; bne s10, s11, 41b; li t0, 0; ret;",
        )
    };
}

/// `$p`·`$q` − `$r`·`$s` in two words.
#[rustfmt::skip]
macro_rules! edge {
    ($high:literal, $low:literal, $p:literal, $q:literal, $r:literal, $s:literal) => {
        concat!(
            "mul ", $low, ", ", $p, ", ", $q, "; mul ", $high, ", ", $r, ", ", $s, ";",
            "sltu t6, ", $low, ", ", $high, "; sub ", $low, ", ", $low, ", ", $high, ";",
            "mulh ", $high, ", ", $p, ", ", $q, "; sub ", $high, ", ", $high, ", t6;",
            "mulh t6, ", $r, ", ", $s, "; sub ", $high, ", ", $high, ", t6;",
        )
    };
}

/// Seven bits less of two words, which leaves one.
#[rustfmt::skip]
macro_rules! shorten {
    ($high:literal, $low:literal) => {
        concat!("srli ", $low, ", ", $low, ", 7; slli ", $high, ", ", $high, ", 25; or ", $low, ", ", $low, ", ", $high, ";")
    };
}

/// On to 53 if it has more than 16 bits; t6 is 2^15.
#[rustfmt::skip]
macro_rules! large {
    ($at:literal) => {
        concat!("add t5, ", $at, ", t6; srli t5, t5, 16; bnez t5, 53f;")
    };
}

/// Zeros above the highest bit of a byte.
static ZEROS: [u8; 256] = {
    let mut table = [0; 256];
    let mut i = 0;
    while i < 256 {
        table[i] = (i as u8).leading_zeros() as u8;
        i += 1;
    }
    table
};

/// Corners in a1 to a3 and a4 to a6, along in s7 to s9, of the triangle in s10; then those up to s11, by loops that facets know.
/// a0, s6: vertices and how many; a7: facets; s2 to s5: slopes and offsets; ra. Whether it stopped at what is nearer: t0. Takes
/// a1 to a6, t1 to t6, s7 to s10.
///
/// Cycles: 55 a triangle, 20 less where it lies to one side of the ray; 10 for each edge; 75 what is met, 25 what is nearest.
///
/// # Safety
///
/// To be jumped to by assembly that knows its registers.
#[unsafe(naked)]
pub(crate) unsafe extern "C" fn front() {
    naked_asm!(
        extensions!(),
        "50:",
        // −u = cy bx − cx by, −w = by ax − bx ay, −v = ay cx − ax cy: t1 t0, t3 t2, t5 t4. Most that are met have it so.
        edge!("t1", "t0", "a6", "a2", "a3", "a5"),
        "bltz t1, 55f",
        edge!("t3", "t2", "a5", "a1", "a2", "a4"),
        "bltz t3, 52f",
        edge!("t5", "t4", "a4", "a3", "a1", "a6"),
        "bgez t5, 57f",
        // Below zero; the others must be zero, then.
        "or t6, t0, t1",
        "or t6, t6, t2",
        "or t6, t6, t3",
        "beqz t6, 56f",
        "j 59f",
        "52:",
        "or t6, t0, t1",
        "bnez t6, 59f",
        "j 51f",
        // The same with the other sign.
        "55:",
        "neg t1, t1",
        "snez t6, t0",
        "neg t0, t0",
        "sub t1, t1, t6",
        "51:",
        edge!("t3", "t2", "a2", "a4", "a5", "a1"),
        "bltz t3, 59f",
        "56:",
        edge!("t5", "t4", "a1", "a6", "a4", "a3"),
        "bgez t5, 57f",
        "59:",
        "addi s10, s10, 6",
        "lw t1, {front}(a7)",
        "li t0, 0",
        "beq s10, s11, 58f",
        "jr t1",
        "58:",
        "ret",
        "57:",
        "or t6, t1, t3",
        "or t6, t6, t5",
        "bnez t6, 54f",
        "or t6, t0, t2",
        "or t6, t6, t4",
        "beqz t6, 59b",
        "srli t6, t6, 30",
        "beqz t6, 70f",
        "lui t6, 8",
        large!("a1"),
        large!("a2"),
        large!("a3"),
        large!("a4"),
        large!("a5"),
        large!("a6"),
        "j 70f",
        // u, v, w in t0, t4, t2, their sum in t1; zeros above it in t3, by a table of bytes.
        "70:",
        "add t1, t0, t4",
        "add t1, t1, t2",
        "li t3, 0",
        "srli t5, t1, 16",
        "bnez t5, 71f",
        "slli t1, t1, 16",
        "li t3, 16",
        "j 71f",
        "53:",
        "li t5, 0",
        "54:",
        shorten!("t1", "t0"),
        shorten!("t3", "t2"),
        shorten!("t5", "t4"),
        "add t1, t0, t4",
        "add t1, t1, t2",
        "li t3, 0",
        // Met. 1/(u + v + w): a guess, a Newton step in 16 bits, one in 32.
        "71:",
        "srli t5, t1, 24",
        "lla t6, {zeros}",
        "bnez t5, 72f",
        "slli t1, t1, 8",
        "addi t3, t3, 8",
        "srli t5, t1, 24",
        "72:",
        "add t6, t6, t5",
        "lbu t6, 0(t6)",
        "lw t0, {recips}(a7)",
        "add t3, t3, t6",
        "sll t1, t1, t6",
        "sll a2, t4, t3",
        "sll a3, t2, t3",
        "srli t3, t1, 23",
        "andi t3, t3, 0xfe",
        "add t3, t3, t0",
        "lhu t3, 0(t3)",
        "srli t2, t1, 16",
        "lui t4, 0x80000",
        "mul t2, t2, t3",
        "sub t2, t4, t2",
        "srai t2, t2, 9",
        "mul t2, t2, t3",
        "srai t2, t2, 22",
        "add t3, t3, t2",
        "slli t2, t3, 15",
        "mulhu t0, t1, t2",
        "lui t4, 0x40000",
        "srli t3, t3, 1",
        "sub t0, t4, t0",
        "mul t0, t0, t3",
        "srai t0, t0, 14",
        "add t2, t2, t0",
        "slli t0, t2, 1",
        "bltz t2, 73f",
        // The name is for those who count hits.
        "microlux_facets_met:",
        "74:",
        // Weights of b and c: a2, a3.
        "mulhu a2, a2, t0",
        "mulhu a3, a3, t0",
        "lui t4, 4",
        "lui t5, 16",
        "add a2, a2, t4",
        "add a3, a3, t4",
        "srli a2, a2, 15",
        "srli a3, a3, 15",
        "bgtu a2, t5, 75f",
        "76:",
        "sub t5, t5, a2",
        "bgtu a3, t5, 77f",
        "78:",
        // Depths: of a in t2, and what b and c have more, t0 and t1.
        "lw t3, {scales}(a7)",
        "lw t6, {plane}(a7)",
        "sub t0, s8, s7",
        "sub t1, s9, s7",
        "lw t5, {scales} + 4(a7)",
        "sub t2, s7, t6",
        "mul t0, t0, t3",
        "mul t1, t1, t3",
        "mul t2, t2, t5",
        "slli t3, a2, 12",
        "slli t4, a3, 12",
        "mulh t0, t0, t3",
        "mulh t1, t1, t4",
        "lw t5, {depth}(a7)",
        "add t0, t0, t1",
        "addi t0, t0, 8",
        "srai t0, t0, 4",
        "add t0, t0, t2",
        "blez t0, 59b",
        // The nearest, and of equals the first.
        "bge t0, t5, 80f",
        "79:",
        "sw a2, {b1}(a7)",
        "sw a3, {b2}(a7)",
        "lw t1, {flip}(a7)",
        "lw t5, {once}(a7)",
        "sw t0, {depth}(a7)",
        "sw s10, {triangle}(a7)",
        // A walk's limit.
        "srai t0, t0, {bits}",
        "neg t2, t0",
        "and t2, t2, t1",
        "add t2, t2, t6",
        "add t3, t2, t0",
        "sw t2, {range}(a7)",
        "sw t3, {range} + 4(a7)",
        "lui t1, 16",
        "addi t1, t1, -1",
        "sltu t2, t0, t1",
        "slli t0, t0, 16",
        "add t0, t0, t1",
        "addi t0, t0, -1",
        "add t0, t0, t2",
        "sw t0, {limit}(a7)",
        "li t0, 1",
        "beqz t5, 59b",
        "ret",
        // What is not usual.
        "73:",
        "li t0, -1",
        "j 74b",
        "75:",
        "mv a2, t5",
        "j 76b",
        "77:",
        "mv a3, t5",
        "j 78b",
        "80:",
        "bne t0, t5, 59b",
        "lw t5, {triangle}(a7)",
        "bltu s10, t5, 79b",
        "j 59b",
        front!("30", "0", "2", "4"),
        front!("31", "2", "4", "0"),
        front!("32", "4", "0", "2"),
        "microlux_facets_loop:",
        "lw t0, {front}(a7)",
        "jr t0",
        ".pushsection .rodata.microlux_facets_fronts, \"a\"",
        ".balign 4",
        ".globl microlux_facets_fronts",
        "microlux_facets_fronts:",
        ".word 30b, 31b, 32b",
        ".popsection",
        ".option pop",
        zeros = sym ZEROS,
        front = const Facets::FRONT,
        scales = const offset_of!(Facets, scales),
        range = const Facets::RANGE,
        limit = const Facets::LIMIT,
        bits = const DEPTH_BITS,
        recips = const offset_of!(Facets, recips),
        plane = const offset_of!(Facets, plane),
        flip = const offset_of!(Facets, flip),
        once = const offset_of!(Facets, once),
        depth = const offset_of!(Facets, nearest.depth),
        b1 = const offset_of!(Facets, nearest.weights),
        b2 = const offset_of!(Facets, nearest.weights) + 4,
        triangle = const offset_of!(Facets, nearest.triangle),
    )
}

/// a0: facets. a1, a2: the first triangle and behind the last. Whether it stopped at what is nearer.
///
/// # Safety
///
/// As [`Facets::new`] made it, or as this has left it.
#[unsafe(naked)]
unsafe extern "C" fn look(facets: &mut Facets, first: u32, end: u32) -> bool {
    naked_asm!(
        extensions!(),
        "lw t0, {triangle_count}(a0)",
        "lw t1, {triangles}(a0)",
        "bleu a2, t0, 1f",
        "mv a2, t0",
        "1:",
        "bltu a1, a2, 2f",
        "li a0, 0",
        "ret",
        "2:",
        "addi sp, sp, -48",
        "sw ra, 0(sp); sw s2, 4(sp); sw s3, 8(sp); sw s4, 12(sp); sw s5, 16(sp); sw s6, 20(sp)",
        "sw s7, 24(sp); sw s8, 28(sp); sw s9, 32(sp); sw s10, 36(sp); sw s11, 40(sp)",
        "li t0, {size}",
        "mul s10, a1, t0",
        "mul s11, a2, t0",
        "add s10, s10, t1",
        "add s11, s11, t1",
        "mv a7, a0",
        "lw s2, {slopes}(a7)",
        "lw s3, {slopes} + 4(a7)",
        "lw s4, {offsets}(a7)",
        "lw s5, {offsets} + 4(a7)",
        "lw s6, {vertex_count}(a7)",
        "lw a0, {vertices}(a7)",
        "jal microlux_facets_loop",
        "mv a0, t0",
        ".pushsection .rodata.microlux_facets, \"a\"; .word {code}; .popsection",
        "lw ra, 0(sp); lw s2, 4(sp); lw s3, 8(sp); lw s4, 12(sp); lw s5, 16(sp); lw s6, 20(sp)",
        "lw s7, 24(sp); lw s8, 28(sp); lw s9, 32(sp); lw s10, 36(sp); lw s11, 40(sp)",
        "addi sp, sp, 48",
        "ret",
        ".option pop",
        code = sym front,
        size = const SIZE,
        slopes = const offset_of!(Facets, slopes),
        offsets = const offset_of!(Facets, offsets),
        vertices = const Facets::VERTICES,
        vertex_count = const Facets::VERTEX_COUNT,
        triangles = const Facets::TRIANGLES,
        triangle_count = const Facets::TRIANGLE_COUNT,
    )
}

/// a0: facets. a1: corners. a2: number. Whether it is nearer, if asked once.
///
/// # Safety
///
/// As [`Facets::of_corners`] made it, or as this has left it.
#[unsafe(naked)]
unsafe extern "C" fn test(facets: &mut Facets, corners: &[Corner; 3], number: u32) -> bool {
    naked_asm!(
        extensions!(),
        "microlux_facets_corners:",
        "mv a7, a0",
        "mv a0, a1",
        "mv t0, a2",
        "lw a1, 0(a0)",
        "lw a2, 12(a0)",
        "lw a3, 24(a0)",
        beside!("a1", "a2", "a3", "9f", "6f"),
        "6:",
        "lw a4, 4(a0)",
        "lw a5, 16(a0)",
        "lw a6, 28(a0)",
        beside!("a4", "a5", "a6", "9f", "6f"),
        "6:",
        "addi sp, sp, -32",
        "sw ra, 0(sp); sw s7, 4(sp); sw s8, 8(sp); sw s9, 12(sp); sw s10, 16(sp); sw s11, 20(sp)",
        "lw s7, 8(a0)",
        "lw s8, 20(a0)",
        "lw s9, 32(a0)",
        "mv s10, t0",
        "addi s11, t0, {size}",
        "jal {front}",
        "mv a0, t0",
        "lw ra, 0(sp); lw s7, 4(sp); lw s8, 8(sp); lw s9, 12(sp); lw s10, 16(sp); lw s11, 20(sp)",
        "addi sp, sp, 32",
        "ret",
        "9:",
        "li a0, 0",
        "ret",
        ".option pop",
        front = sym front,
        size = const SIZE,
    )
}
