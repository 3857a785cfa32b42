//! Each way to be wrong, and what is said of it.

use fixed::types::U1F15;
use microlux::bvh::{CheckError, Node, build_mesh};
use microlux::color::{Albedo, Radiance, Rgb9e5};
use microlux::geom::{Dir, Point, REACH, Unit};
use microlux::light::{Environment, Light, Map, MapError, MapParts, Sky};
use microlux::material::{
    BlinnPhong, Conductor, Dielectric, Material, MaterialError, OrenNayar, OrenNayarModel, RoughDielectric,
};
use microlux::num::{Metres, Turn};
use microlux::q;
use microlux::scene::{Borrowed, MaterialId, Mesh, Parts, Scene, SceneBuilder, SceneError, Shape};
use microlux::shape::{
    Attributes, Blob, Bound, Capsule, Disk, Geometry, Grid, Gyroid, Implicit, MAX_BLOBS, MeshError,
    Metaballs, Plane, Rectangle, RoundedBox, SmoothUnion, Sphere, Torus, TriangleMesh,
};

type Builder = SceneBuilder<8, 4, 4>;

const CENTER: Point = Point([0; 3]);
const BALL: Sphere = Sphere::new(CENTER, 1000);
const SKY: Light = Light::Environment {
    radiance: Radiance::WHITE,
};
const LAMP: Light = Light::Point {
    position: CENTER,
    intensity: Radiance::WHITE,
};

fn builder() -> (Builder, MaterialId) {
    let mut b = Builder::new();
    b.light(LAMP).unwrap();
    let white = b.material(Material::lambert(Albedo::WHITE)).unwrap();
    b.shape(BALL, white).unwrap();
    (b, white)
}

fn built(mut b: Builder) -> Result<(), SceneError> {
    b.build(&mut [Node::EMPTY; 4]).map(|_| ())
}

/// What the border says of a second shape.
fn with_shape(geometry: impl Into<Geometry>) -> Result<(), SceneError> {
    let (mut b, white) = builder();
    b.shape(geometry, white).unwrap();
    built(b)
}

fn rectangle(u: Dir, v: Dir, half: [i32; 2]) -> Rectangle {
    Rectangle {
        center: CENTER,
        u,
        v,
        normal: Dir::Z,
        half,
    }
}

#[test]
fn no_room() {
    let mut b = SceneBuilder::<1, 1, 1>::new();
    let white = b.material(Material::lambert(Albedo::WHITE)).unwrap();
    let full = |what| Err(SceneError::Full { what, needed: 2 });
    assert_eq!(b.material(Material::Black).map(|_| ()), full("materials"));
    b.shape(BALL, white).unwrap();
    assert_eq!(b.shape(BALL, white), full("shapes"));
    b.light(LAMP).unwrap();
    assert_eq!(b.light(LAMP), full("lights"));
    b.light(SKY).unwrap();
    assert_eq!(b.build(&mut [Node::EMPTY]).map(|_| ()), full("lights"));
    // What did not fit leaves nothing behind.
    let mut b = SceneBuilder::<2, 1, 1>::new();
    let white = b.material(Material::lambert(Albedo::WHITE)).unwrap();
    b.light(LAMP).unwrap();
    assert_eq!(b.emitter(BALL, white, Radiance::WHITE), full("lights"));
    b.shape(BALL, white).unwrap();
    b.shape(BALL, white).unwrap();
    assert!(b.build(&mut [Node::EMPTY]).is_ok());
    let full = SceneError::Full {
        what: "shapes",
        needed: 3,
    };
    assert_eq!(full.to_string(), "no room for shapes: 3 are needed");
}

#[test]
fn too_few_nodes() {
    let (mut b, white) = builder();
    for i in 0..7 {
        b.shape(Sphere::new(Point([i * 5000, 0, 0]), 10), white).unwrap();
    }
    let error = b.build(&mut []).map(|_| ()).unwrap_err();
    assert_eq!(error, SceneError::Nodes { needed: 2 });
    assert_eq!(error.to_string(), "too few nodes: 2 are enough");
    assert!(b.build(&mut [Node::EMPTY; 2]).is_ok());
}

/// What the border says of a second shape, a solid of these blobs.
fn with_solid(solid: Implicit, blobs: &[Blob]) -> Result<(), SceneError> {
    let (mut b, white) = builder();
    b.shape(solid, white).unwrap();
    let borrowed = Borrowed {
        blobs,
        ..Borrowed::default()
    };
    b.build_from(borrowed, &mut [Node::EMPTY; 4]).map(|_| ())
}

#[test]
fn solids_whose_sizes_do_not_go_together() {
    let degenerate = Err(SceneError::Degenerate { shape: 1 });
    let torus = |axis, major, minor| with_solid(Implicit::Torus(Torus::new(CENTER, axis, major, minor)), &[]);
    assert_eq!(torus(Dir::Y, 2000, 1000), Ok(()));
    for (major, minor) in [
        (1000, 1000),
        (1000, 2000),
        (1000, 0),
        (0, -1),
        (i32::MIN, i32::MAX),
    ] {
        assert_eq!(torus(Dir::Y, major, minor), degenerate, "{major} {minor}");
    }
    assert_eq!(torus(Dir([0; 3]), 2000, 1000), degenerate);
    let leaning = Torus {
        side: Dir::Y,
        ..Torus::new(CENTER, Dir::Y, 2000, 1000)
    };
    assert_eq!(with_solid(Implicit::Torus(leaning), &[]), degenerate);

    let capsule = |b, radius| with_solid(Implicit::Capsule(Capsule::new(CENTER, Point(b), radius)), &[]);
    assert_eq!(capsule([0, 1000, 0], 100), Ok(()));
    assert_eq!(capsule([0; 3], 100), degenerate);
    assert_eq!(capsule([0, 1000, 0], 0), degenerate);

    let block = |half, radius| {
        let block = RoundedBox::new(CENTER, Dir::X, Dir::Y, half, radius).unwrap();
        with_solid(Implicit::RoundedBox(block), &[])
    };
    assert_eq!(block([500, 900, 700], 500), Ok(()));
    assert_eq!(block([500, 900, 700], 501), degenerate);
    assert_eq!(block([500, 900, 700], 0), degenerate);
    assert_eq!(block([500, -900, 700], 100), degenerate);
    assert_eq!(RoundedBox::new(CENTER, Dir::X, Dir::X, [9; 3], 1), None);

    let gyroid = |cell, thickness, bound| {
        let gyroid = Gyroid::new(CENTER, [Dir::X, Dir::Y], cell, thickness, bound).unwrap();
        with_solid(Implicit::Gyroid(gyroid), &[])
    };
    assert_eq!(gyroid(1000, 300, Bound::ball(1000)), Ok(()));
    assert_eq!(gyroid(1000, 301, Bound::ball(1000)), degenerate);
    assert_eq!(gyroid(4000, 300, Bound::ball(1000)), Ok(()));
    assert_eq!(gyroid(4004, 300, Bound::ball(1000)), degenerate);
    assert_eq!(gyroid(1000, 300, Bound::block([900, 800, 0])), degenerate);
    assert_eq!(gyroid(1000, 300, Bound::ball(0)), degenerate);

    let balls = [Blob::ball(CENTER, 900), Blob::ball(Point([500, 0, 0]), 900)];
    let metaballs = |threshold| {
        with_solid(
            Implicit::Metaballs(Metaballs::new(&balls, 0, 2, threshold)),
            &balls,
        )
    };
    assert_eq!(metaballs(1 << 26), Ok(()));
    assert_eq!(metaballs(0), degenerate);
    assert_eq!(metaballs(1 << 27), degenerate);
    let union = |k| with_solid(Implicit::SmoothUnion(SmoothUnion::new(&balls, 0, 2, k)), &balls);
    assert_eq!(union(100), Ok(()));
    assert_eq!(union(0), degenerate);
    // Made of other blobs than the scene's, its ball may not hold it.
    let larger = [Blob::ball(CENTER, 900), Blob::ball(Point([500, 0, 0]), 901)];
    let solid = Implicit::Metaballs(Metaballs::new(&balls, 0, 2, 1 << 26));
    assert_eq!(with_solid(solid, &larger), degenerate);
}

#[test]
fn solids_too_fine() {
    let thin = Err(SceneError::Thin { shape: 1 });
    let torus = |major, minor| with_solid(Implicit::Torus(Torus::new(CENTER, Dir::Y, major, minor)), &[]);
    assert_eq!(torus(25_500, 100), Ok(()));
    assert_eq!(torus(25_900, 100), thin);
    assert_eq!(torus(25_200, 25_000), Ok(()));
    assert_eq!(torus(26_090, 26_000), thin);
    assert_eq!(torus(1000, 63), thin);
    let capsule = |length, radius| {
        with_solid(
            Implicit::Capsule(Capsule::new(CENTER, Point([0, 0, length]), radius)),
            &[],
        )
    };
    assert_eq!(capsule(50_000, 100), Ok(()));
    assert_eq!(capsule(52_000, 100), thin);
    let block = RoundedBox::new(CENTER, Dir::X, Dir::Y, [63, 500, 500], 9).unwrap();
    assert_eq!(with_solid(Implicit::RoundedBox(block), &[]), thin);
    let gyroid = Gyroid::new(CENTER, [Dir::X, Dir::Y], 300, 63, Bound::ball(1000)).unwrap();
    assert_eq!(with_solid(Implicit::Gyroid(gyroid), &[]), thin);
    // Alone, this ball shows as one of 900 √(1 − ∛(1 − 2^-10)) = 16 units.
    let balls = [Blob::ball(CENTER, 900)];
    let metaballs = Metaballs::new(&balls, 0, 1, (1 << 27) - (1 << 17));
    assert_eq!(with_solid(Implicit::Metaballs(metaballs), &balls), thin);
    let union = SmoothUnion::new(&balls, 0, 1, 63);
    assert_eq!(with_solid(Implicit::SmoothUnion(union), &balls), thin);
    assert_eq!(
        SceneError::Thin { shape: 1 }.to_string(),
        "shape 1: a part is finer than 1/256 of it, or than 64 units; make it thicker, or several shapes of it"
    );
}

#[test]
fn solids_of_blobs_that_are_not_there() {
    let wrong = Err(SceneError::Blobs { shape: 1 });
    let mut blobs = vec![Blob::ball(CENTER, 900); MAX_BLOBS + 1];
    blobs[2] = Capsule::new(CENTER, Point([0, 0, 1]), 900).into();
    let metaballs = |first, count| {
        let solid = Metaballs::new(&blobs, first, count, 1 << 26);
        with_solid(Implicit::Metaballs(solid), &blobs)
    };
    let union = |first, count| {
        let solid = SmoothUnion::new(&blobs, first, count, 100);
        with_solid(Implicit::SmoothUnion(solid), &blobs)
    };
    assert_eq!((metaballs(0, 2), union(0, 16)), (Ok(()), Ok(())));
    assert_eq!((metaballs(0, 0), union(0, 0)), (wrong, wrong));
    assert_eq!((metaballs(16, 2), union(16, 2)), (wrong, wrong));
    assert_eq!((metaballs(u16::MAX, u16::MAX), union(0, 17)), (wrong, wrong));
    assert_eq!(metaballs(0, 3), wrong);
    assert_eq!(
        SceneError::Blobs { shape: 1 }.to_string(),
        "shape 1: wants 1 to 16 of the scene's blobs, metaballs only balls"
    );
}

#[test]
fn solids_beyond_reach() {
    let far = Err(SceneError::TooFar { shape: 1 });
    let torus = |x| {
        let torus = Torus::new(Point([x, 0, 0]), Dir::Y, 20_000, 10_000);
        with_solid(Implicit::Torus(torus), &[])
    };
    assert_eq!(torus(REACH - 30_100), Ok(()));
    assert_eq!(torus(REACH - 30_000), far);
}

#[test]
fn shapes_without_extent() {
    let degenerate = Err(SceneError::Degenerate { shape: 1 });
    for radius in [0, -1, i32::MIN, REACH + 1, i32::MAX] {
        assert_eq!(with_shape(Sphere::new(CENTER, radius)), degenerate, "{radius}");
        assert_eq!(
            with_shape(Disk::new(CENTER, Dir::X, radius)),
            degenerate,
            "{radius}"
        );
        assert_eq!(
            with_shape(rectangle(Dir::X, Dir::Y, [5, radius])),
            degenerate,
            "{radius}"
        );
        assert_eq!(
            with_shape(rectangle(Dir::X, Dir::Y, [radius, 5])),
            degenerate,
            "{radius}"
        );
    }
    for normal in [
        [0; 3],
        [65536, 65536, 0],
        [65000, 0, 0],
        [i32::MAX; 3],
        [i32::MIN; 3],
        [1 << 24, 0, 0],
    ] {
        assert_eq!(
            with_shape(Disk::new(CENTER, Dir(normal), 5)),
            degenerate,
            "{normal:?}"
        );
        assert_eq!(
            with_shape(Plane::new(CENTER, Dir(normal))),
            degenerate,
            "{normal:?}"
        );
        assert_eq!(
            with_shape(rectangle(Dir(normal), Dir::Y, [5; 2])),
            degenerate,
            "{normal:?}"
        );
    }
    // Parallel sides, and a normal that is not at right angles to them.
    assert_eq!(with_shape(rectangle(Dir::X, Dir::X, [5; 2])), degenerate);
    let aslant = Dir([46341, 0, 46341]);
    let mut leaning = rectangle(Dir::X, Dir::Y, [5; 2]);
    leaning.normal = aslant;
    assert_eq!(with_shape(leaning), degenerate);
    let mut turned = rectangle(Dir::X, Dir::Y, [5; 2]);
    turned.normal = -Dir::Z;
    assert_eq!(with_shape(turned), degenerate);
    assert_eq!(with_shape(Sphere::new(CENTER, 1)), Ok(()));
    assert_eq!(
        SceneError::Degenerate { shape: 1 }.to_string(),
        "shape 1: has no extent"
    );
}

#[test]
fn shapes_out_of_reach() {
    let error = SceneError::TooFar { shape: 1 };
    let too_far = Err(error);
    for x in [REACH, -REACH, i32::MAX, i32::MIN] {
        let at = Point([0, x, 0]);
        assert_eq!(with_shape(Sphere::new(at, 1)), too_far, "{x}");
        assert_eq!(with_shape(Disk::new(at, Dir::Y, 1)), too_far, "{x}");
        let mut square = rectangle(Dir::X, Dir::Y, [2; 2]);
        square.center = at;
        assert_eq!(with_shape(square), too_far, "{x}");
    }
    for x in [REACH + 1, -REACH - 1, i32::MAX, i32::MIN] {
        assert_eq!(with_shape(Plane::new(Point([0, 0, x]), Dir::Y)), too_far, "{x}");
    }
    assert_eq!(with_shape(Sphere::new(Point([REACH - 1, 0, 0]), 1)), Ok(()));
    assert_eq!(with_shape(Plane::new(Point([REACH; 3]), Dir::Y)), Ok(()));
    assert_eq!(error.shape(), Some(1));
    assert!(error.to_string().starts_with("shape 1: reaches beyond"));
}

#[test]
fn lights() {
    for x in [2 * REACH + 1, -2 * REACH - 1, i32::MAX, i32::MIN] {
        let (mut b, _) = builder();
        b.light(Light::Point {
            position: Point([x, 0, 0]),
            intensity: Radiance::WHITE,
        })
        .unwrap();
        assert_eq!(built(b), Err(SceneError::LightTooFar { light: 1 }), "{x}");
    }
    for direction in [[0; 3], [65536, 65536, 0], [i32::MAX; 3], [i32::MIN, 0, 0]] {
        let (mut b, _) = builder();
        b.light(Light::Directional {
            direction: Dir(direction),
            irradiance: Radiance::WHITE,
        })
        .unwrap();
        let error = built(b).unwrap_err();
        assert_eq!(error, SceneError::LightDirection { light: 1 }, "{direction:?}");
        assert_eq!(error.to_string(), "light 1: its direction is no unit vector");
    }
    let (mut b, _) = builder();
    b.light(SKY).unwrap();
    let error = b.light(SKY).unwrap_err();
    assert_eq!(error, SceneError::Environment { light: 1 });
    assert_eq!(
        error.to_string(),
        "light 1: one environment, after all other lights"
    );
    let (mut b, white) = builder();
    b.emitter(Plane::new(CENTER, Dir::Y), white, Radiance::WHITE)
        .unwrap();
    let error = built(b).unwrap_err();
    assert_eq!(error, SceneError::PlaneLight { shape: 1 });
    assert_eq!(error.to_string(), "shape 1: an infinite plane can't be a light");
    let mut b = Builder::new();
    b.light(Light::Environment {
        radiance: Radiance::BLACK,
    })
    .unwrap();
    let error = built(b).unwrap_err();
    assert_eq!(error, SceneError::NoLight);
    assert_eq!(error.to_string(), "nothing in the scene emits light");
    assert_eq!(built(Builder::new()), Err(SceneError::NoLight));
    // Too far away.
    let error = SceneError::LightTooFar { light: 3 };
    assert_eq!(error.to_string(), "light 3: stands beyond 2^23 units");
    assert_eq!(error.shape(), None);
}

#[test]
fn materials() {
    let (mut b, _) = builder();
    let mut bright = Albedo::WHITE;
    bright.0[1] = U1F15::from_bits(32769);
    for material in [Material::lambert(bright), Material::mirror(bright)] {
        let mut b = b.clone();
        b.material(material).unwrap();
        let error = built(b).unwrap_err();
        assert_eq!(
            error,
            SceneError::Material {
                material: 1,
                error: MaterialError::Reflectance
            }
        );
        assert_eq!(error.to_string(), "material 1: a reflectance is above 1");
    }
    // Each of a material's numbers, at the edge and just beyond.
    let refusal = |material: Material| {
        let mut b = b.clone();
        b.material(material).unwrap();
        match built(b) {
            Ok(()) => None,
            Err(SceneError::Material { material: 1, error }) => Some(error),
            Err(other) => panic!("{other}"),
        }
    };
    let (white, share) = (Albedo::WHITE, U1F15::from_bits);
    for model in [
        OrenNayarModel::Full,
        OrenNayarModel::Qualitative,
        OrenNayarModel::EnergyPreserving,
    ] {
        let rough = |albedo, bits| Material::OrenNayar(OrenNayar::new(model, albedo, Turn::from_bits(bits)));
        assert_eq!(refusal(rough(white, 1 << 30)), None);
        assert_eq!(
            refusal(rough(white, (1 << 30) + (1 << 15))),
            Some(MaterialError::Sigma)
        );
        assert_eq!(refusal(rough(white, u32::MAX)), Some(MaterialError::Sigma));
        assert_eq!(refusal(rough(bright, 0)), Some(MaterialError::Reflectance));
    }
    let phong = |d, s, exponent| Material::BlinnPhong(BlinnPhong::new(d, s, exponent));
    assert_eq!(refusal(phong(white, white, q!(16384))), None);
    assert_eq!(
        refusal(phong(white, white, q!(16385))),
        Some(MaterialError::Exponent)
    );
    assert_eq!(
        refusal(phong(white, white, q!(-1))),
        Some(MaterialError::Exponent)
    );
    assert_eq!(
        refusal(phong(white, bright, q!(1))),
        Some(MaterialError::Reflectance)
    );
    assert_eq!(
        refusal(phong(bright, white, q!(1))),
        Some(MaterialError::Reflectance)
    );
    let metal = |albedo, alpha| Material::Conductor(Conductor::new(albedo).rough(share(alpha)));
    assert_eq!(
        [0, 32, 32768].map(|alpha| refusal(metal(white, alpha))),
        [None; 3]
    );
    for alpha in [1, 31, 32769] {
        assert_eq!(refusal(metal(white, alpha)), Some(MaterialError::Roughness));
    }
    assert_eq!(refusal(metal(bright, 100)), Some(MaterialError::Reflectance));
    let glass = |eta, alpha| {
        let smooth = Dielectric::new(Metres::from_bits(eta));
        Material::RoughDielectric(RoughDielectric::new(smooth, share(alpha)))
    };
    assert_eq!(refusal(glass(98304, 32)), None);
    assert_eq!(refusal(glass(65536 + 512, 100)), None);
    assert_eq!(refusal(glass(98304, 0)), Some(MaterialError::Roughness));
    assert_eq!(refusal(glass(98304, 32769)), Some(MaterialError::Roughness));
    assert_eq!(refusal(glass(65536 + 511, 100)), Some(MaterialError::Index));
    assert_eq!(refusal(glass(65536 - 511, 100)), Some(MaterialError::Index));
    let tinted = Dielectric::new(q!(1.5)).tinted(white, bright);
    for material in [
        Material::Dielectric(tinted),
        Material::RoughDielectric(RoughDielectric::new(tinted, share(100))),
    ] {
        assert_eq!(refusal(material), Some(MaterialError::Reflectance));
    }
    // A material of another builder's.
    let mut other = Builder::new();
    other.material(Material::Black).unwrap();
    let second = other.material(Material::Black).unwrap();
    b.shape(BALL, second).unwrap();
    let error = built(b).unwrap_err();
    assert_eq!(
        error,
        SceneError::NoSuchMaterial {
            shape: 1,
            material: 1
        }
    );
    assert_eq!(error.to_string(), "shape 1: there is no material 1");
    assert_eq!(error.shape(), Some(1));
}

/// A tetrahedron.
const VERTICES: [[u16; 3]; 4] = [[100, 100, 100], [900, 900, 100], [900, 100, 900], [100, 900, 900]];
const TRIANGLES: [[u16; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

/// What the border says of a ball and a mesh.
fn with_mesh(
    grid: Grid,
    vertices: &[[u16; 3]],
    triangles: &[[u16; 3]],
    nodes: usize,
) -> Result<(), SceneError> {
    let mut tree = [Node::EMPTY; 1];
    let mut sorted = TRIANGLES;
    build_mesh(&VERTICES, &mut sorted, &mut tree).unwrap();
    let triangles = if triangles.is_empty() { &sorted } else { triangles };
    let meshes = [Mesh {
        triangles: TriangleMesh {
            grid,
            vertices,
            triangles,
            attributes: Attributes::NONE,
        }
        .into(),
        nodes: &tree[..nodes],
    }];
    let (mut b, white) = builder();
    b.shape(Geometry::Mesh(0), white).unwrap();
    b.build_with(&meshes, &mut [Node::EMPTY; 4]).map(|_| ())
}

#[test]
fn meshes() {
    assert_eq!(with_mesh(Grid::UNIT, &VERTICES, &[], 1), Ok(()));
    assert_eq!(
        with_shape(Geometry::Mesh(0)),
        Err(SceneError::NoSuchMesh { shape: 1, mesh: 0 })
    );
    let error = |error| Err(SceneError::Mesh { mesh: 0, error });
    let index = MeshError::Index { triangle: 0 };
    assert_eq!(
        with_mesh(Grid::UNIT, &VERTICES, &[[0, 1, 4]], 1),
        error(CheckError::Mesh(index))
    );
    let mut low = VERTICES;
    low[3][2] = Grid::MARGIN - 1;
    let margin = CheckError::Mesh(MeshError::Margin { vertex: 3 });
    assert_eq!(with_mesh(Grid::UNIT, &low, &[], 1), error(margin));
    let mut moved = VERTICES;
    moved[2][0] = 1000;
    assert!(matches!(
        with_mesh(Grid::UNIT, &moved, &[], 1),
        Err(SceneError::Mesh {
            mesh: 0,
            error: CheckError::Outside { .. }
        })
    ));
    assert_eq!(
        with_mesh(Grid::UNIT, &VERTICES, &[], 0),
        error(CheckError::NoNode { node: 0 })
    );
    let fewer = [[0, 1, 2], [0, 3, 1], [0, 2, 3]];
    assert!(matches!(
        with_mesh(Grid::UNIT, &VERTICES, &fewer, 1),
        Err(SceneError::Mesh { mesh: 0, .. })
    ));
    assert_eq!(
        SceneError::Mesh {
            mesh: 0,
            error: margin
        }
        .to_string(),
        "mesh 0: vertex 3 lies too near a face of its cube"
    );
    let far = Grid::new(Point([0, 0, REACH - 900]), 0).unwrap();
    assert_eq!(with_mesh(far, &VERTICES, &[], 1), Ok(()));
    let far = Grid::new(Point([0, 0, REACH - 899]), 0).unwrap();
    assert_eq!(
        with_mesh(far, &VERTICES, &[], 1),
        Err(SceneError::TooFar { shape: 1 })
    );
    assert_eq!(
        SceneError::NoSuchMesh { shape: 1, mesh: 0 }.to_string(),
        "shape 1: there is no mesh 0"
    );
}

/// Parts put together by hand: a ball that is a light, and a plane.
fn with_parts(change: impl Fn(&mut Parts, &mut [Shape; 2], &mut [Light; 2])) -> Result<(), SceneError> {
    let mut b = Builder::new();
    let white = b.material(Material::lambert(Albedo::WHITE)).unwrap();
    b.emitter(BALL, white, Radiance::WHITE).unwrap();
    b.shape(Plane::new(CENTER, Dir::Y), white).unwrap();
    b.light(LAMP).unwrap();
    let mut nodes = [Node::EMPTY; 1];
    let scene = b.build(&mut nodes).unwrap();
    let mut parts = *scene.parts();
    let mut shapes: [Shape; 2] = parts.shapes.try_into().unwrap();
    let mut lights: [Light; 2] = parts.lights.try_into().unwrap();
    change(&mut parts, &mut shapes, &mut lights);
    let parts = Parts {
        shapes: &shapes,
        lights: &lights,
        ..parts
    };
    Scene::new(parts).map(|_| ())
}

#[test]
fn parts_by_hand() {
    assert_eq!(with_parts(|_, _, _| ()), Ok(()));
    let error = with_parts(|_, shapes, _| shapes.swap(0, 1)).unwrap_err();
    assert_eq!(error, SceneError::Order { shape: 1 });
    assert_eq!(
        error.to_string(),
        "shape 1: finite shapes come first, then planes"
    );
    let bounded = |n| with_parts(move |parts, _, _| parts.bounded = n);
    assert_eq!(bounded(0), Err(SceneError::Order { shape: 0 }));
    assert_eq!(bounded(2), Err(SceneError::Order { shape: 1 }));
    assert_eq!(bounded(u16::MAX), Err(SceneError::Order { shape: 1 }));
    // A shape and its light name each other.
    let error = with_parts(|_, shapes, _| shapes[0].light = Some(7)).unwrap_err();
    assert_eq!(error, SceneError::NoSuchLight { shape: 0, light: 7 });
    assert_eq!(error.to_string(), "shape 0: light 7 is not its area light");
    let other = with_parts(|_, shapes, _| shapes[0].light = Some(1));
    assert_eq!(other, Err(SceneError::NoSuchLight { shape: 0, light: 1 }));
    let unnamed = with_parts(|_, shapes, _| shapes[0].light = None).unwrap_err();
    assert_eq!(unnamed, SceneError::LightShape { light: 0 });
    assert_eq!(unnamed.to_string(), "light 0: its shape does not name it");
    let no_shape = with_parts(|_, shapes, lights| {
        shapes[0].light = None;
        lights[0] = Light::Area {
            shape: 9,
            radiance: Radiance::WHITE,
        };
    });
    assert_eq!(no_shape, Err(SceneError::LightShape { light: 0 }));
    let sky_first = with_parts(|_, shapes, lights| {
        shapes[0].light = None;
        lights[0] = SKY;
    });
    assert_eq!(sky_first, Err(SceneError::Environment { light: 0 }));
    // Trees that are not over these shapes.
    let missing = with_parts(|parts, _, _| parts.nodes = &[]).unwrap_err();
    assert_eq!(missing, SceneError::Tree(CheckError::NoNode { node: 0 }));
    assert_eq!(
        missing.to_string(),
        "the tree over the shapes: there is no node 0"
    );
    let moved = |x| {
        with_parts(move |_, shapes, _| {
            shapes[0].geometry = Sphere::new(Point([x, 0, 0]), 1000).into();
        })
    };
    let outside = Err(SceneError::Tree(CheckError::Outside { primitive: 0 }));
    assert_eq!(moved(60), outside);
    let elsewhere = with_parts(|parts, _, _| parts.grid = Grid::new(Point([5000; 3]), 0).unwrap());
    assert_eq!(elsewhere, outside);
    let coarse = with_parts(|parts, _, _| parts.unit = Unit::new(-99));
    assert_eq!(coarse, Ok(()));
}

#[test]
fn skies_and_choices() {
    let grey = Radiance::WHITE;
    for (up, sun) in [(Dir([0; 3]), Dir::X), (Dir::Y, Dir([1 << 20, 0, 0]))] {
        let sky = Sky::new(up, grey, grey, grey).with_sun(sun, Turn::from_bits(1 << 25), grey);
        let with = |sky| with_parts(move |parts, _, _| parts.environment = Environment::Sky(sky));
        let sky: &'static Sky = Box::leak(Box::new(sky));
        let error = with(sky).unwrap_err();
        assert_eq!(error, SceneError::SkyDirection);
        assert!(error.to_string().starts_with("the sky: up"));
    }
    let table = |choice: &'static [u32]| with_parts(move |parts, _, _| parts.choice = choice);
    assert_eq!(table(&[1]), Ok(()));
    let wrong = Err(SceneError::Choice { needed: 1 });
    assert_eq!(table(&[0]), wrong);
    assert_eq!(table(&[1, 2]), wrong);
    assert!(table(&[0]).unwrap_err().to_string().contains("1 bounds"));
    // Two environments.
    let even: &'static Sky = Box::leak(Box::new(Sky::new(Dir::Y, grey, grey, grey)));
    let two = with_parts(|parts, _, lights| {
        lights[1] = SKY;
        parts.environment = Environment::Sky(even);
    });
    assert_eq!(two, Err(SceneError::Environment { light: 1 }));
}

#[test]
fn maps() {
    let texels = [Rgb9e5(0x8000_0001); 6];
    let parts = MapParts {
        width: 2,
        height: 3,
        texels: &texels,
        exponent: 0,
        axes: [Dir::X, Dir::Y, Dir::Z],
        bands: &[9],
        steps: &[7, 7],
        steps_in_band: 2,
    };
    let error = |parts| Map::new(parts).map(|_| ()).err();
    assert_eq!(error(parts), None);
    let short = MapParts { height: 4, ..parts };
    assert_eq!(error(short), Some(MapError::Texels { needed: 8 }));
    assert_eq!(
        MapError::Texels { needed: 8 }.to_string(),
        "8 texels are needed; 1 to 16384 columns, 2 to 16384 rows"
    );
    let flat = MapParts {
        height: 1,
        width: 6,
        ..parts
    };
    assert_eq!(error(flat), Some(MapError::Texels { needed: 6 }));
    for (bands, steps, steps_in_band) in [
        (&[0][..], &[7, 7][..], 2),
        (&[9, 9], &[7, 7, 7], 2),
        (&[9], &[7, 0], 2),
        (&[9], &[7], 2),
        (&[9], &[7, 7], 3),
        (&[9], &[], 0),
    ] {
        let table = MapParts {
            bands,
            steps,
            steps_in_band,
            ..parts
        };
        assert_eq!(
            error(table),
            Some(MapError::Table),
            "{bands:?} {steps:?} {steps_in_band}"
        );
    }
    for axes in [
        [Dir::X; 3],
        [Dir([0; 3]), Dir::Y, Dir::Z],
        [Dir([1 << 30; 3]), Dir::Y, Dir::Z],
    ] {
        assert_eq!(
            error(MapParts { axes, ..parts }),
            Some(MapError::Frame),
            "{axes:?}"
        );
    }
}

/// The first node is where every ray begins: with nothing to check it against, it has to be missing.
#[test]
fn trees_over_less_than_there_is() {
    let mut b = Builder::new();
    b.light(LAMP).unwrap();
    let white = b.material(Material::lambert(Albedo::WHITE)).unwrap();
    b.shape(BALL, white).unwrap();
    b.shape(BALL, white).unwrap();
    let mut nodes = [Node::EMPTY; 1];
    let scene = b.build(&mut nodes).unwrap();
    let parts = *scene.parts();
    let error = Scene::new(Parts { bounded: 3, ..parts });
    let error = error.map(|_| ()).unwrap_err();
    assert_eq!(error, SceneError::Bounded { shapes: 2 });
    assert_eq!(error.to_string(), "2 shapes are fewer than are said to be finite");
    let nothing = Parts {
        shapes: &[],
        bounded: 0,
        ..parts
    };
    let over_nothing = Scene::new(nothing).map(|_| ());
    assert!(
        matches!(over_nothing, Err(SceneError::Tree(_))),
        "{over_nothing:?}"
    );
    assert!(
        Scene::new(Parts {
            nodes: &[],
            ..nothing
        })
        .is_ok()
    );
}

#[test]
fn a_mesh_coarser_than_the_scene() {
    let mut tree = [Node::EMPTY; 1];
    let mut triangles = TRIANGLES;
    build_mesh(&VERTICES, &mut triangles, &mut tree).unwrap();
    let mesh = |shift| Mesh {
        triangles: TriangleMesh {
            grid: Grid::new(CENTER, shift).unwrap(),
            vertices: &VERTICES,
            triangles: &triangles,
            attributes: Attributes::NONE,
        }
        .into(),
        nodes: &tree,
    };
    let mut b = Builder::new();
    b.light(LAMP).unwrap();
    let white = b.material(Material::lambert(Albedo::WHITE)).unwrap();
    b.shape(Geometry::Mesh(0), white).unwrap();
    let (coarse, mut nodes) = ([mesh(5)], [Node::EMPTY; 1]);
    let scene = b.build_with(&coarse, &mut nodes).unwrap();
    let parts = *scene.parts();
    assert_eq!(parts.grid.shift(), 5);
    let coarser = [mesh(6)];
    let error = Scene::new(Parts {
        meshes: &coarser,
        ..parts
    });
    let error = error.map(|_| ()).unwrap_err();
    assert_eq!(error, SceneError::Grid { mesh: 0 });
    assert_eq!(error.to_string(), "mesh 0: its grid is coarser than the scene's");
}
