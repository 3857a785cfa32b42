use crate::chi2::Patch;
use microlux::bvh::{Node, build_mesh};
use microlux::color::{Radiance, Rgb9e5, albedo};
use microlux::geom::{Dir, Point, Ray, point};
use microlux::light::{Environment, Map, MapParts, Sky};
use microlux::material::Material;
use microlux::num::{Share, Turn, Wide};
use microlux::q;
use microlux::scene::{Mesh, SceneBuilder};
use microlux::shape::{Attributes, Disk, Geometry, Grid, Rectangle, Sphere, Surface, TriangleMesh};

const BRIGHT: Radiance = Radiance::new(q!(3), q!(2), q!(1));

/// A point that is on nothing.
fn seen_from(point: Point) -> Surface {
    Surface {
        point,
        normal: Dir::Y,
        lift: 0,
    }
}

/// Of one emitting shape, seen from `from`.
fn assert_shape(what: &str, geometry: Geometry, meshes: &[Mesh], from: Point, patch: Patch) {
    let mut b = SceneBuilder::<1, 1, 1>::new();
    let matt = b
        .material(Material::lambert(albedo(Share::ONE, Share::ONE, Share::ONE)))
        .unwrap();
    b.emitter(geometry, matt, BRIGHT).unwrap();
    let mut nodes = [Node::EMPTY; 4];
    let scene = b.build_with(meshes, &mut nodes).unwrap();
    patch.assert(
        what,
        0.01,
        |u| {
            scene
                .sample_light(0, &seen_from(from), u)
                .map(|sample| (sample.wi, sample.pdf))
        },
        |dir| match scene.closest(&Ray { origin: from, dir }) {
            Some(hit) => scene.light_pdf(0, from, dir, &hit),
            None => Wide::ZERO,
        },
    );
}

#[test]
fn spheres() {
    for (center, radius, angle) in [
        (point(q!(0.5), q!(2), q!(-1)), q!(0.4), 0.25),
        (point(q!(0.5), q!(2), q!(-1)), q!(0.1), 0.06),
        (point(q!(0.3), q!(0.6), q!(0.2)), q!(0.69), 1.57),
    ] {
        let axis = center.0.map(f64::from);
        let radius = radius.to_bits();
        assert_shape(
            &format!("sphere of {radius} at {center:?}"),
            Sphere::new(center, radius).into(),
            &[],
            Point([0; 3]),
            Patch::new(axis, angle),
        );
    }
}

#[test]
fn flat_shapes() {
    let center = point(q!(0.2), q!(1), q!(-0.3));
    let axis = center.0.map(f64::from);
    let towards = Dir::new([-1 << 16, -3 << 16, 1 << 15]).unwrap();
    assert_shape(
        "disk",
        Disk::new(center, towards, 1 << 15).into(),
        &[],
        Point([0; 3]),
        Patch::new(axis, 0.8),
    );
    let rectangle = Rectangle::new(center, Dir::X, Dir::Z, [1 << 15, 1 << 14]).unwrap();
    assert!(rectangle.normal.0[1] < 0);
    assert_shape(
        "rectangle",
        rectangle.into(),
        &[],
        Point([0; 3]),
        Patch::new(axis, 0.9),
    );
}

/// Of triangles of very different sizes, one of which is seen from behind.
#[test]
fn mesh() {
    let grid = Grid::new(point(q!(-0.5), q!(1), q!(-0.5)), 0).unwrap();
    let vertices = [
        [2000, 9000, 2000],
        [40_000, 9000, 3000],
        [5000, 12_000, 60_000],
        [40_000, 2000, 60_000],
        [50_000, 5000, 30_000],
        [58_000, 7000, 30_000],
        [50_000, 9000, 33_000],
        [50_000, 5000, 40_000],
        [58_000, 7000, 40_000],
        [50_000, 9000, 43_000],
    ];
    let mut triangles = [[0, 1, 2], [1, 3, 2], [4, 5, 6], [7, 9, 8]];
    let mut nodes = [Node::EMPTY; 4];
    let used = build_mesh(&vertices, &mut triangles, &mut nodes).unwrap();
    let mesh = Mesh {
        triangles: TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes::NONE,
        }
        .into(),
        nodes: &nodes[..used],
    };
    assert_shape(
        "mesh",
        Geometry::Mesh(0),
        &[mesh],
        point(q!(0.1), q!(0.2), q!(0)),
        Patch::new([0.0, 1.0, 0.0], 1.1),
    );
}

fn grey(bits: u32) -> Radiance {
    Radiance::from_bits([bits, bits / 2, bits / 3], -16)
}

fn assert_environment(what: &str, patch: Patch, edges: f64, environment: Environment) {
    patch.assert(
        what,
        edges,
        |u| environment.sample(u).map(|sample| (sample.wi, sample.pdf)),
        |dir| environment.pdf(dir),
    );
}

/// Zenith, horizon, ground: all, and each of them missing.
const GRADIENTS: [[u32; 3]; 6] = [
    [90_000, 40_000, 9000],
    [1000, 80_000, 70_000],
    [90_000, 0, 30_000],
    [0, 50_000, 0],
    [0, 0, 50_000],
    [50_000, 0, 0],
];

#[test]
fn skies() {
    let up = Dir::new([3, 10, -2]).unwrap();
    for colors in GRADIENTS {
        let [zenith, horizon, ground] = colors.map(grey);
        let sky = Sky::new(up, zenith, horizon, ground);
        let what = format!("sky {colors:?}");
        // Where the horizon is black, so small a density is known to few bits.
        assert_environment(
            &what,
            Patch::new([3.0, 10.0, -2.0], std::f64::consts::PI),
            0.02,
            Environment::Sky(&sky),
        );
    }
}

#[test]
fn suns() {
    let up = Dir::Y;
    for degrees in [0.53, 3.0, 40.0, 100.0] {
        let width = Turn::from_num(degrees / 360.0);
        let [zenith, horizon, ground] = GRADIENTS[0].map(grey);
        let towards = [5.0, 3.0, -4.0];
        let dir = Dir::new(towards.map(|c| (c * 65536.0) as i32)).unwrap();
        let radius = f64::to_radians(degrees / 2.0);
        // So bright that it sends as much as the rest, and so that it is drawn as seldom as may be.
        for share in [1.0, 1e-3] {
            let radiance = Radiance::new(q!(1), q!(1), q!(0.5))
                .scale(Wide::new((share * 65536.0 / (1.0 - radius.cos())) as u32, -16));
            let sky = Sky::new(up, zenith, horizon, ground).with_sun(dir, width, radiance);
            let what = format!("sun of {degrees} degrees, {share}");
            assert_environment(
                &what,
                Patch::new(towards, 1.3 * radius),
                0.01,
                Environment::Sky(&sky),
            );
            let black = Sky::new(up, Radiance::BLACK, Radiance::BLACK, Radiance::BLACK);
            let alone = black.with_sun(dir, width, radiance);
            assert_environment(
                &format!("{what}, alone"),
                Patch::new(towards, 1.3 * radius),
                0.01,
                Environment::Sky(&alone),
            );
        }
    }
}

/// A random picture with one bright place, turned askew; every cell has a chance.
#[test]
fn maps() {
    const WIDTH: usize = 16;
    let texels: Vec<Rgb9e5> = (0..WIDTH * 9)
        .map(|i| {
            let exponent = if i == 40 { 20 } else { 10 + i as u32 % 4 };
            Rgb9e5(300 | (i as u32 * 37 % 512) << 9 | 200 << 18 | exponent << 27)
        })
        .collect();
    for (bands, steps) in [(8, 16), (5, 7), (1, 1), (13, 1)] {
        // Chances that have nothing to do with the picture are as good for this.
        let rising = |count: usize, salt: usize| -> Vec<u16> {
            let weights: Vec<f64> = (0..count)
                .map(|i| 1.0 + ((i + salt) * 7 % 5) as f64 * 3.0)
                .collect();
            let total: f64 = weights.iter().sum();
            let sums = weights.iter().scan(0.0, |sum, weight| {
                *sum += weight;
                Some((*sum / total * 65536.0) as u16)
            });
            sums.take(count - 1).collect()
        };
        let band_bounds = rising(bands, 0);
        let step_bounds: Vec<u16> = (0..bands).flat_map(|band| rising(steps, band)).collect();
        let axes = [Dir::new([4, 1, 2]), Dir::new([-1, 4, 0]), Dir::new([-8, -2, 17])].map(Option::unwrap);
        let map = Map::new(MapParts {
            width: WIDTH as u16,
            height: 9,
            texels: &texels,
            exponent: 3,
            axes,
            bands: &band_bounds,
            steps: &step_bounds,
            steps_in_band: steps as u16,
        })
        .unwrap();
        let patch = Patch::new(axes[1].0.map(f64::from), std::f64::consts::PI);
        assert_environment(
            &format!("map, {bands} x {steps}"),
            patch,
            0.02,
            Environment::Map(map),
        );
    }
}
