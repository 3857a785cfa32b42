use std::f64::consts::TAU;

use crate::Baked;
use crate::room::Mesh;

/// Steps along the knot and around its tube.
const ALONG: usize = 192;
const AROUND: usize = 8;
/// The knot lies on a torus of these radii; the last is the tube's own.
const TORUS: (f64, f64) = (0.62, 0.27);
const TUBE: f64 = 0.14;

/// A closed tube along the torus knot (2, 3), 3,072 triangles that face outwards.
pub fn knot() -> Result<Baked, String> {
    let (points, faces) = tube(ALONG, AROUND);
    Baked::new(&points, &faces)
}

/// The same in so many steps.
pub(crate) fn tube(steps: usize, around: usize) -> Mesh {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for i in 0..steps {
        let t = TAU * i as f64 / steps as f64;
        let (here, core) = (curve(t, TORUS.1), curve(t, 0.0));
        let along = unit(minus(curve(t + 1e-4, TORUS.1), curve(t - 1e-4, TORUS.1)));
        // Away from the torus' core, so that the cross-section fits itself after one round.
        let out = minus(here, core);
        let lean = dot(out, along);
        let side = unit([0, 1, 2].map(|a| out[a] - lean * along[a]));
        let up = cross(along, side);
        for j in 0..around {
            let (sin, cos) = (TAU * j as f64 / around as f64).sin_cos();
            points.push([0, 1, 2].map(|a| here[a] + TUBE * (side[a] * cos + up[a] * sin)));
            let at = |ahead: usize, up: usize| (i + ahead) % steps * around + (j + up) % around;
            faces.push([at(0, 0), at(0, 1), at(1, 1)]);
            faces.push([at(0, 0), at(1, 1), at(1, 0)]);
        }
    }
    (points, faces)
}

/// Twice about the z axis while the point circles the core three times, at a distance of `minor` from it.
fn curve(t: f64, minor: f64) -> [f64; 3] {
    let from_axis = TORUS.0 + minor * (3.0 * t).cos();
    [
        from_axis * (2.0 * t).cos(),
        from_axis * (2.0 * t).sin(),
        minor * (3.0 * t).sin(),
    ]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|c| c / length)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    /// Each edge is run along once in each direction, and the enclosed volume (divergence theorem) is positive.
    #[test]
    fn is_closed_and_faces_outwards() {
        let knot = super::knot().unwrap();
        let mut edges = BTreeSet::new();
        let mut volume = 0;
        for &[a, b, c] in &knot.triangles {
            assert!(edges.insert((a, b)) && edges.insert((b, c)) && edges.insert((c, a)));
            let [a, b, c] = [a, b, c].map(|v| knot.vertices[v as usize].map(i64::from));
            volume += a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
        }
        assert_eq!(knot.triangles.len(), 3072);
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
        assert!(volume > 0);
    }
}
