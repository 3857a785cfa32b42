//! Colours of vertices and of textures on a mesh: each hit has the colour of its place.

use microlux::bvh::{Node, build_mesh, max_nodes};
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Point, Ray, Rotation};
use microlux::light::Light;
use microlux::material::{
    BlinnPhong, Conductor, Dielectric, Filter, Material, OrenNayar, OrenNayarModel, Texels, Texture,
    TextureError,
};
use microlux::num::{Metres, Share, Turn};
use microlux::scene::{Borrowed, Mesh, Scene, SceneBuilder, SceneError, Tint};
use microlux::shape::{Attributes, Geometry, Grid, Instance, MeshError, Sphere, TriangleMesh};

const PALETTE: [[u16; 3]; 4] = [
    [32_768, 0, 0],
    [0, 32_768, 0],
    [0, 0, 32_768],
    [20_000, 20_000, 20_000],
];
const COLORS: [[u8; 3]; 4] = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
/// The texture once from corner to corner, v down.
const UVS: [[i16; 2]; 4] = [[0, 4096], [4096, 4096], [4096, 0], [0, 0]];

fn texture() -> Texture<'static> {
    Texture {
        width: 2,
        height: 2,
        palette: &PALETTE,
        texels: Texels::Half(&[0x10, 0x32]),
        filter: Filter::Nearest,
    }
}

fn with<R>(
    tint: Tint,
    attributes: Attributes,
    place: impl Fn(u16) -> Geometry,
    look: impl FnOnce(Result<Scene, SceneError>) -> R,
) -> R {
    with_texture(texture(), tint, attributes, place, look)
}

/// A square of side 2 · 10,000 units about the origin, in the plane z = 0, as `tint` has it.
fn with_texture<R>(
    texture: Texture,
    tint: Tint,
    attributes: Attributes,
    place: impl Fn(u16) -> Geometry,
    look: impl FnOnce(Result<Scene, SceneError>) -> R,
) -> R {
    let grid = Grid::new(Point([-32_768; 3]), 0).unwrap();
    let corners = [
        [-10_000, -10_000],
        [10_000, -10_000],
        [10_000, 10_000],
        [-10_000, 10_000],
    ];
    let vertices = corners.map(|[x, y]| [(x + 32_768) as u16, (y + 32_768) as u16, 32_768]);
    let mut triangles = [[0, 1, 2], [0, 2, 3]];
    let mut tree = [Node::EMPTY; max_nodes(2)];
    let used = build_mesh(&vertices, &mut triangles, &mut tree).unwrap();
    let meshes = [Mesh {
        triangles: TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes,
        }
        .into(),
        nodes: &tree[..used],
    }];
    let textures = [texture];
    let mut builder = SceneBuilder::<1, 1, 1>::new();
    let white = builder.material(Material::lambert(Albedo::WHITE)).unwrap();
    builder.tinted(place(0), white, tint).unwrap();
    let radiance = Radiance::WHITE;
    builder.light(Light::Environment { radiance }).unwrap();
    let borrowed = Borrowed {
        meshes: &meshes,
        textures: &textures,
        ..Borrowed::default()
    };
    let mut nodes = [Node::EMPTY; max_nodes(1)];
    look(builder.build_from(borrowed, &mut nodes))
}

fn color(scene: &Scene, x: i32, y: i32) -> [u16; 3] {
    let ray = Ray {
        origin: Point([x, y, 50_000]),
        dir: -Dir::Z,
    };
    let hit = scene.closest(&ray).unwrap();
    scene.vertex(&ray, &hit).albedo().0.map(Share::to_bits)
}

#[test]
fn a_texture_lies_where_its_coordinates_say() {
    let attributes = Attributes {
        uvs: &UVS,
        ..Attributes::NONE
    };
    with(Tint::Texture(0), attributes, Geometry::Mesh, |scene| {
        let scene = scene.unwrap();
        // v is down: the first row is at the top.
        for (x, y, texel) in [
            (-5000, 5000, 0),
            (5000, 5000, 1),
            (-5000, -5000, 2),
            (5000, -5000, 3),
        ] {
            assert_eq!(color(&scene, x, y), PALETTE[texel], "{x} {y}");
        }
        for edge in [-60, 60] {
            let texel = usize::from(edge > 0);
            assert_eq!(color(&scene, edge, 9000), PALETTE[texel]);
        }
    });
    // Half as large, and turned by a quarter: the first texel's quarter is on the left below.
    let turned = |mesh| {
        let quarter = Rotation::about(Dir::Z, Turn::from_num(0.25));
        Instance::new(mesh)
            .scaled(Metres::from_num(0.5))
            .turned(quarter)
            .into()
    };
    with(Tint::Texture(0), attributes, turned, |scene| {
        let scene = scene.unwrap();
        for (x, y, texel) in [
            (-2500, -2500, 0),
            (-2500, 2500, 1),
            (2500, -2500, 2),
            (2500, 2500, 3),
        ] {
            assert_eq!(color(&scene, x, y), PALETTE[texel], "{x} {y}");
        }
    });
}

#[test]
fn vertices_colours_are_mixed_as_light() {
    let attributes = Attributes {
        colors: &COLORS,
        ..Attributes::NONE
    };
    with(Tint::Vertices, attributes, Geometry::Mesh, |scene| {
        let scene = scene.unwrap();
        let near = |found: [u16; 3], wanted: [f64; 3]| {
            found
                .iter()
                .zip(wanted)
                .all(|(f, w)| (f64::from(*f) / 32768.0 - w).abs() < 3e-4)
        };
        // On the lower edge, a quarter from the first corner; and on the diagonal between red and blue.
        assert!(near(color(&scene, -5000, -9999), [0.75, 0.25, 0.0]));
        assert!(near(color(&scene, 1, 0), [0.5, 0.0, 0.5]));
        assert!(near(color(&scene, -9998, 9997), [1.0, 1.0, 1.0]));
    });
}

#[test]
fn every_colour_of_its_own_is_multiplied_and_glass_has_none() {
    let share = |c: f64| Share::from_num(c);
    let (half, tint) = (
        Albedo([share(0.5); 3]),
        Albedo([share(1.0), share(0.5), share(0.25)]),
    );
    let product = Albedo([share(0.5), share(0.25), share(0.125)]);
    let sigma = Turn::from_num(0.07);
    for model in [
        OrenNayarModel::Full,
        OrenNayarModel::Qualitative,
        OrenNayarModel::EnergyPreserving,
    ] {
        let rough = |color| Material::OrenNayar(OrenNayar::new(model, color, sigma).one_sided());
        assert_eq!(rough(half).tinted(tint), rough(product));
    }
    assert_eq!(Material::lambert(half).tinted(tint), Material::lambert(product));
    assert_eq!(Material::mirror(half).tinted(tint), Material::mirror(product));
    let metal = |color| Material::Conductor(Conductor::new(color).rough(share(0.3)));
    assert_eq!(metal(half).tinted(tint), metal(product));
    let glossy = BlinnPhong::new(half, half, Metres::from_num(20));
    let Material::BlinnPhong(tinted) = Material::BlinnPhong(glossy).tinted(tint) else {
        panic!("it is still glossy")
    };
    assert_eq!((tinted.diffuse(), tinted.specular()), (product, half));
    let glass = Material::Dielectric(Dielectric::new(Metres::from_num(1.5)));
    assert_eq!(glass.tinted(tint), glass);
}

#[test]
fn what_is_not_there_is_named() {
    let refused = |tint, attributes, place: &dyn Fn(u16) -> Geometry| {
        with(tint, attributes, place, |scene| scene.unwrap_err())
    };
    let shape = 0;
    let placed = Attributes {
        uvs: &UVS,
        ..Attributes::NONE
    };
    let mesh = &Geometry::Mesh;
    assert_eq!(
        refused(Tint::Vertices, placed, mesh),
        SceneError::NoTint { shape }
    );
    assert_eq!(
        refused(Tint::Texture(0), Attributes::NONE, mesh),
        SceneError::NoTint { shape }
    );
    let texture = 7;
    assert_eq!(
        refused(Tint::Texture(7), placed, mesh),
        SceneError::NoSuchTexture { shape, texture }
    );
    let ball = |_| Sphere::new(Point([0; 3]), 100).into();
    assert_eq!(
        refused(Tint::Vertices, placed, &ball),
        SceneError::NoTint { shape }
    );
    let few = Attributes {
        uvs: &UVS[..3],
        ..Attributes::NONE
    };
    let error = refused(Tint::Texture(0), few, mesh);
    assert!(
        error.to_string().contains(&MeshError::Attributes.to_string()),
        "{error}"
    );
    let broken = Texture {
        palette: &[],
        ..self::texture()
    };
    let error = TextureError::Palette { colors: 0 };
    let texture = 0;
    let found = with_texture(broken, Tint::Texture(0), placed, mesh, |scene| scene.unwrap_err());
    assert_eq!(found, SceneError::Texture { texture, error });
}
