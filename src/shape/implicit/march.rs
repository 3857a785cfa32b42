use super::line::{FINE, Line};

/// A solid's function in its own frame; coordinates and distances in fine steps.
pub(super) trait Field {
    /// Above 0 outside, else inside; in magnitude no more than the way to the surface.
    ///
    /// It may say too much by a step: the march overshoots by no more than its least step allows.
    fn distance(&self, p: [i32; 3]) -> i32;

    /// Outwards across the surface near `p` (under 2^29 in length), and the height of `p` above it.
    fn slope(&self, p: [i32; 3]) -> ([i32; 3], i32);

    /// Least step of the march, steps: 2^4 or more.
    fn step(&self) -> i32;

    /// Whether a ray that has begun to move away from the solid never meets it.
    const CONVEX: bool = false;
}

/// The step that passes by no more than the last step's depth of a silhouette: a chord of √(8ρ) stands a step away from a
/// circle of radius ρ. Both in steps.
#[inline]
pub(super) fn chord(radius: i32) -> i32 {
    crate::num::isqrt(8 * radius.clamp(32, 1 << 15) as u32) as i32
}

/// Distance along the ray, units, to where it first comes to the other side.
///
/// Steps along the ray as far as the function says that there is no surface (Hart, "Sphere Tracing", The Visual Computer
/// 12, 1996), and at least [`Field::step`], until the side has changed; then halves the last step down to one (the
/// paper's search). What counts as the start's side is asked of the function, so a ray inside finds its way out; at the
/// sphere's end all is outside, so it always does. At most 2^17 / [`Field::step`] ≤ 2^13 steps and 16 halvings.
///
/// The answer is the last step on the start's side.
#[inline(always)]
pub(super) fn march<F: Field>(field: &F, line: &Line) -> Option<i32> {
    let least = field.step().max(1);
    let mut s = line.begin;
    let mut value = field.distance(line.point(s));
    let inside = value <= 0;
    while s < line.end.min(line.stop) {
        let step = (value.abs() >> FINE).max(least);
        let next = s.wrapping_add(step).min(line.end);
        let there = field.distance(line.point(next));
        if (there <= 0) != inside {
            return Some(line.distance(bisect(field, line, s, next, inside)));
        }
        // One step more than what rounding can make of a distance that does not grow.
        if F::CONVEX && !inside && there > value + (1 << FINE) {
            return None;
        }
        (s, value) = (next, there);
    }
    None
}

/// The last step on the near side, between one that is and one that is not.
#[inline]
fn bisect<F: Field>(field: &F, line: &Line, mut near: i32, mut far: i32, inside: bool) -> i32 {
    while far - near > 1 {
        let middle = near + ((far - near) >> 1);
        if (field.distance(line.point(middle)) <= 0) == inside {
            near = middle;
        } else {
            far = middle;
        }
    }
    near
}
