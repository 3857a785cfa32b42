use super::OwnedMesh;
use crate::bvh::max_nodes;
use crate::camera::Camera;
use crate::color::{Radiance, albedo};
use crate::geom::{Dir, Unit, point};
use crate::light::Light;
use crate::material::Material;
use crate::num::{ONE_Q16, Share, Turn, mul_q16, sin_cos};
use crate::q;
use crate::scene::{SceneBuilder, SceneError};
use crate::shape::{Geometry, Grid, Rectangle};

/// Corners of the torus's polygon, and of its tube's.
const AROUND: usize = 12;
const ACROSS: usize = 6;
const VERTICES: usize = AROUND * ACROSS;
const TRIANGLES: usize = 2 * VERTICES;

/// The torus of [`torus`], 144 triangles.
pub type Torus = OwnedMesh<VERTICES, TRIANGLES, { max_nodes(TRIANGLES) }>;
/// The lamp of [`torus`], 4 triangles.
pub type Lamp = OwnedMesh<4, 4, 1>;

/// A torus leaning over a floor, lit by a tetrahedron and a dim sky: names [`torus_mesh`] as mesh 0, [`lamp`] as mesh 1.
pub fn torus() -> Result<(SceneBuilder<3, 3, 2>, Camera), SceneError> {
    let unit = Unit::DEFAULT;
    let mut b = SceneBuilder::with_unit(unit);
    let floor = b.material(Material::lambert(albedo(
        q!(0.5, Share),
        q!(0.5, Share),
        q!(0.5, Share),
    )))?;
    let blue = b.material(Material::lambert(albedo(
        q!(0.2, Share),
        q!(0.42, Share),
        q!(0.62, Share),
    )))?;
    let black = b.material(Material::Black)?;
    let ground = Rectangle {
        center: point(q!(0), q!(0), q!(0)),
        u: Dir::Z,
        v: Dir::X,
        normal: Dir::Y,
        half: [unit.length(q!(4)); 2],
    };
    b.shape(ground, floor)?;
    b.shape(Geometry::Mesh(0), blue)?;
    b.emitter(Geometry::Mesh(1), black, Radiance::new(q!(30), q!(27), q!(22)))?;
    b.light(Light::Environment {
        radiance: Radiance::new(q!(0.1), q!(0.12), q!(0.15)),
    })?;
    let camera = Camera::from_frame(
        point(q!(0), q!(1), q!(4.6)),
        [Dir::X, Dir::Y, -Dir::Z],
        Camera::tan_half(q!(0.1, Turn)),
    );
    Ok((b, camera))
}

/// The torus: 1.9 m across, closed, faces outwards. Its axis leans 45° from y towards z.
pub fn torus_mesh() -> Result<Torus, SceneError> {
    // Steps of two units, a cube of 2 m with its corner at (−1, 0.1, −1) m.
    let corner = point(q!(-1), q!(0.1), q!(-1));
    let grid = Grid::new(corner, 1).unwrap_or(Grid::UNIT);
    let (ring, tube) = (22_000, 8_000);
    let turn = |i: usize, of: usize| sin_cos(Turn::from_bits((u32::MAX / of as u32) * i as u32));
    let mut vertices = [[0; 3]; VERTICES];
    for (i, vertex) in vertices.iter_mut().enumerate() {
        let (around, across) = (turn(i / ACROSS, AROUND), turn(i % ACROSS, ACROSS));
        let out = ring + mul_q16(tube, across.1);
        let (x, y, z) = (
            mul_q16(out, around.1),
            mul_q16(tube, across.0),
            mul_q16(out, around.0),
        );
        // Turned about x by 45°: √½ = 46341 / 2^16.
        let leaning = [x, mul_q16(y - z, 46_341), mul_q16(y + z, 46_341)];
        *vertex = leaning.map(|c| (c + ONE_Q16 / 2) as u16);
    }
    let mut triangles = [[0; 3]; TRIANGLES];
    for (i, triangle) in triangles.iter_mut().enumerate() {
        let at = |ahead: usize, up: usize| {
            let (around, across) = (i / 2 / ACROSS + ahead, i / 2 % ACROSS + up);
            (around % AROUND * ACROSS + across % ACROSS) as u16
        };
        *triangle = if i % 2 == 0 {
            [at(0, 0), at(0, 1), at(1, 1)]
        } else {
            [at(0, 0), at(1, 1), at(1, 0)]
        };
    }
    Torus::new(grid, vertices, triangles)
}

/// A tetrahedron of ½ m, closed, faces outwards.
pub fn lamp() -> Result<Lamp, SceneError> {
    let corner = point(q!(0.5), q!(2), q!(0.5));
    let grid = Grid::new(corner, 0).unwrap_or(Grid::UNIT);
    let (low, high) = (1000, 33_000);
    let vertices = [
        [low, low, low],
        [high, high, low],
        [high, low, high],
        [low, high, high],
    ];
    Lamp::new(grid, vertices, [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use std::collections::BTreeSet;

    /// Each edge is run along once in each direction, and the enclosed volume (divergence theorem) is positive.
    fn assert_closed_and_outward(mesh: Mesh) {
        let triangles = mesh.triangles.plain().unwrap();
        let mut edges = BTreeSet::new();
        let mut volume = 0;
        for (i, [a, b, c]) in triangles.triangles.iter().copied().enumerate() {
            assert!(edges.insert((a, b)) && edges.insert((b, c)) && edges.insert((c, a)));
            let [a, b, c] = triangles.corners(i as u32).unwrap().map(|v| v.map(i64::from));
            volume += a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
        }
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
        assert!(volume > 0);
    }

    #[test]
    fn meshes_are_closed_and_face_outwards() {
        assert_closed_and_outward(torus_mesh().unwrap().mesh());
        assert_closed_and_outward(lamp().unwrap().mesh());
    }
}
