use super::{Dir, Point};

/// All rays from one point through a rectangle of the film: the space between four planes through that point (Heckbert
/// and Hanrahan, "Beam Tracing Polygonal Objects", SIGGRAPH 1984).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Beam {
    pub origin: Point,
    /// Normals of the planes, inwards: Q14, 1 to √2 long, right to 2^-13 a component.
    pub sides: [[i32; 3]; 4],
    /// Least and largest components of its rays, Q12, by 1 of what is along the view; rounded outwards.
    pub across: [[i32; 2]; 3],
}

impl Beam {
    /// By how much each side is set off outwards at distance 1, Q20: 2^-10.
    ///
    /// What a ray meets is √3 times as far away as it is along the view at most. By that, in parts of the latter: the
    /// normals' rounding is worth 3·2^-13, a ray's direction 2^-16 a component or 2^-13.9, a frame whose directions have
    /// cosines of up to 2^-13 3·2^-13.
    const SPARE: i32 = 1 << 10;

    /// What is seen between `edges`, left, right, bottom and top: Q20 at distance 1 from the middle of a view along its
    /// directions right, up and forward, which have cosines of 2^-13 at most. `None` where that reaches beyond ±1.
    pub fn new(origin: Point, frame: [Dir; 3], edges: [i32; 4]) -> Option<Beam> {
        let [left, right, bottom, top] = edges;
        let spare = Beam::SPARE;
        let edges = [left - spare, right + spare, bottom - spare, top + spare];
        if edges.iter().any(|edge| edge.unsigned_abs() > 1 << 20) {
            return None;
        }
        let mut beam = Beam {
            origin,
            sides: [[0; 3]; 4],
            across: [[0; 2]; 3],
        };
        for a in 0..3 {
            let [r, u, f] = frame.map(|dir| dir.0[a]);
            let mut ends = [f; 2];
            for (i, edge) in edges.into_iter().enumerate() {
                let axis = if i < 2 { r } else { u };
                // 2^14 · 2^16
                let times = |c: i32| ((edge >> 6) * c) >> 14;
                let side = (axis - times(f)) >> 2;
                beam.sides[i][a] = if i % 2 == 0 { side } else { -side };
                // Of each pair the lesser goes to one end, the larger to the other.
                ends[((i % 2 == 0) == (axis < 0)) as usize] += times(axis);
            }
            beam.across[a] = [(ends[0] >> 4) - 1, (ends[1] >> 4) + 2];
        }
        Some(beam)
    }
}
