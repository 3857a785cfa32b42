//! Rooms of a few shapes, in metres, that bring out what an integrator may get wrong.

use fixed::types::I12F20;
use microlux::bvh::{Node, build_mesh, max_nodes};
use microlux::camera::Camera;
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Octahedral, Point};
use microlux::light::{Environment, Light, Sky};
use microlux::material::{Dielectric, Material};
use microlux::num::{Metres, Share, Turn};
use microlux::scene::{Borrowed, MaterialId, Mesh, Scene, SceneBuilder};
use microlux::shape::{Attributes, Disk, Geometry, Grid, Plane, Rectangle, Sphere, TriangleMesh};

/// Which room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Room {
    /// Matt walls, lit by a ball, a disk and a rectangle; a lens.
    Lamps,
    /// Matt walls and a block, two point lights.
    Points,
    /// A glass and a mirror ball, a lamp in a shade: light that only paths from it find well.
    Caustics,
    /// White walls without a ceiling under a white sky, a white ball.
    Open,
    /// A wall behind lamps that the camera does not see, if it is told so, by a lens.
    Sky,
    /// Matt walls without a ceiling and a ball, under a sky with a broad sun.
    Sun,
    /// Matt walls, lit by a rectangle; the floor's normals lean as if it were a round bowl upside down, by up to half a right
    /// angle.
    Smooth,
    /// A ball and a wall between two endless planes, in low light from behind and in light that one of the planes keeps
    /// out, under a sky.
    Yard,
}

pub const ROOMS: [Room; 7] = [
    Room::Lamps,
    Room::Points,
    Room::Caustics,
    Room::Sky,
    Room::Sun,
    Room::Smooth,
    Room::Yard,
];

type Builder = SceneBuilder<16, 8, 8>;

fn units(metres: f64) -> i32 {
    (metres * 65536.0).round() as i32
}

fn at(p: [f64; 3]) -> Point {
    Point(p.map(units))
}

fn dir(v: [f64; 3]) -> Dir {
    Dir::new(v.map(units)).unwrap()
}

fn light(rgb: [f64; 3]) -> Radiance {
    Radiance::from_bits(rgb.map(|c| (c * 65536.0) as u32), -16)
}

fn matt(builder: &mut Builder, rgb: [f64; 3]) -> MaterialId {
    let albedo = Albedo(rgb.map(|c| Share::from_bits((c * 32768.0) as u16)));
    builder.material(Material::lambert(albedo)).unwrap()
}

/// The rectangle `center ± u ± v`.
fn rectangle(center: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Rectangle {
    let length = |v: [f64; 3]| units(v.iter().map(|c| c * c).sum::<f64>().sqrt());
    Rectangle::new(at(center), dir(u), dir(v), [length(u), length(v)]).unwrap()
}

/// A box of half sides 1, but for the front, and the ceiling if it is `open`.
fn walls(builder: &mut Builder, materials: [MaterialId; 3], open: bool) {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let minus = |v: [f64; 3]| v.map(|c| -c);
    let mut wall = |center, u, v, material| builder.shape(rectangle(center, u, v), material).unwrap();
    wall(minus(y), z, x, materials[0]);
    if !open {
        wall(y, x, z, materials[0]);
    }
    wall(minus(z), x, y, materials[0]);
    wall(minus(x), y, z, materials[1]);
    wall(x, z, y, materials[2]);
}

fn gradient() -> Sky {
    Sky::new(
        dir([0.0, 1.0, 0.0]),
        light([0.2, 0.3, 0.8]),
        light([0.7, 0.7, 0.6]),
        light([0.1, 0.2, 0.1]),
    )
}

impl Room {
    /// Builds it and lends it out with its camera.
    pub fn with<R>(self, render: impl FnOnce(&Scene, Camera) -> R) -> R {
        let mut builder = Builder::new();
        let white = matt(&mut builder, [0.75, 0.75, 0.75]);
        let red = matt(&mut builder, [0.6, 0.1, 0.1]);
        let green = matt(&mut builder, [0.1, 0.5, 0.2]);
        let black = builder.material(Material::Black).unwrap();
        let tan_half = I12F20::from_num(0.36);
        let mut camera = Camera::look_at(at([0.1, 0.05, 3.9]), at([0.0; 3]), [1, 30, 2], tan_half).unwrap();
        match self {
            Room::Lamps => {
                walls(&mut builder, [white, red, green], false);
                let mut lamp = |shape: microlux::shape::Geometry, rgb| {
                    builder.emitter(shape, white, light(rgb)).unwrap()
                };
                lamp(
                    Sphere::new(at([-0.4, -0.3, -0.2]), units(0.25)).into(),
                    [3.0, 2.0, 1.0],
                );
                lamp(
                    Disk::new(at([0.5, 0.9, 0.0]), dir([0.1, -1.0, 0.0]), units(0.3)).into(),
                    [4.0, 5.0, 6.0],
                );
                lamp(
                    rectangle([0.98, -0.2, 0.1], [0.0, 0.0, 0.3], [0.0, 0.2, 0.0]).into(),
                    [7.0, 7.0, 5.0],
                );
                camera = camera.with_lens(units(0.15), units(3.5));
            }
            Room::Points => {
                walls(&mut builder, [white, red, green], false);
                builder
                    .shape(Sphere::new(at([0.3, -0.5, 0.0]), units(0.4)), white)
                    .unwrap();
                for (position, rgb) in [
                    ([0.4, 0.7, 0.3], [1.0, 0.8, 0.6]),
                    ([-0.7, -0.2, -0.5], [0.2, 0.3, 0.5]),
                ] {
                    let position = at(position);
                    let intensity = light(rgb);
                    builder.light(Light::Point { position, intensity }).unwrap();
                }
            }
            Room::Caustics => {
                walls(&mut builder, [white, red, green], false);
                let glass = builder
                    .material(Material::Dielectric(Dielectric::new(Metres::from_num(1.5))))
                    .unwrap();
                let mirror = Albedo([Share::from_num(0.9); 3]);
                let mirror = builder.material(Material::mirror(mirror)).unwrap();
                builder
                    .shape(Sphere::new(at([0.4, -0.55, 0.3]), units(0.4)), glass)
                    .unwrap();
                builder
                    .shape(Sphere::new(at([-0.4, -0.6, -0.3]), units(0.4)), mirror)
                    .unwrap();
                let down = rectangle([0.0, 0.95, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]);
                builder.emitter(down, black, light([3.0, 3.0, 2.0])).unwrap();
            }
            Room::Open => {
                let white = matt(&mut builder, [1.0; 3]);
                walls(&mut builder, [white; 3], true);
                builder
                    .shape(Sphere::new(at([0.3, -0.5, 0.0]), units(0.4)), white)
                    .unwrap();
                builder
                    .light(Light::Environment {
                        radiance: light([1.0; 3]),
                    })
                    .unwrap();
            }
            Room::Sky => {
                walls(&mut builder, [white, red, green], true);
                builder
                    .emitter(
                        Sphere::new(at([0.2, 0.3, 0.4]), units(0.3)),
                        white,
                        light([2.0, 1.0, 0.5]),
                    )
                    .unwrap();
                builder
                    .light(Light::Directional {
                        direction: dir([0.3, -1.0, -0.4]),
                        irradiance: light([1.0, 0.9, 0.7]),
                    })
                    .unwrap();
                builder
                    .light(Light::Environment {
                        radiance: light([0.3, 0.4, 0.6]),
                    })
                    .unwrap();
            }
            Room::Sun => {
                walls(&mut builder, [white, red, green], true);
                builder
                    .shape(Sphere::new(at([0.3, -0.5, 0.0]), units(0.4)), white)
                    .unwrap();
            }
            Room::Smooth => {
                walls(&mut builder, [white, red, green], false);
                builder.shape(Geometry::Mesh(0), white).unwrap();
                let down = rectangle([0.0, 0.95, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]);
                builder.emitter(down, black, light([3.0, 3.0, 2.0])).unwrap();
            }
            Room::Yard => {
                // Much of the floor behind, which the sun reaches before it could enter a ball about what stands there.
                camera = Camera::look_at(at([0.1, 1.5, 3.5]), at([0.0, -0.8, -1.5]), [1, 30, 2], tan_half)
                    .unwrap();
                builder
                    .shape(Plane::new(at([0.0, -0.8, 0.0]), dir([0.0, 1.0, 0.0])), white)
                    .unwrap();
                builder
                    .shape(Sphere::new(at([0.3, -0.4, 0.0]), units(0.4)), red)
                    .unwrap();
                let wall = rectangle([-0.8, -0.2, -0.2], [0.0, 0.6, 0.0], [0.0, 0.0, 0.7]);
                builder.shape(wall, green).unwrap();
                builder
                    .shape(Plane::new(at([-1.0, 0.0, 0.0]), dir([1.0, 0.0, 0.0])), white)
                    .unwrap();
                for (direction, rgb) in [
                    ([-0.3, -0.2, 1.0], [2.0, 1.7, 1.2]),
                    ([1.0, -0.3, -0.2], [5.0, 6.0, 7.0]),
                ] {
                    let (direction, irradiance) = (dir(direction), light(rgb));
                    builder
                        .light(Light::Directional {
                            direction,
                            irradiance,
                        })
                        .unwrap();
                }
            }
        }
        let sky = match self {
            Room::Sun => Some(gradient().with_sun(
                dir([0.4, 1.0, 0.5]),
                Turn::from_num(0.06),
                light([20.0, 16.0, 12.0]),
            )),
            Room::Yard => Some(gradient()),
            _ => None,
        };
        // A little above the floor's rectangle.
        let corners = [[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]];
        let grid = Grid::around(at([-1.0; 3]), at([1.0; 3]), Grid::MARGIN).unwrap();
        let vertices = corners.map(|[x, z]| grid.enclose(at([x, -0.95, z]), at([x, -0.95, z])).low);
        let normals = corners.map(|[x, z]| Octahedral::encode(dir([0.6 * x, 1.0, 0.6 * z])));
        let mut triangles = [[0, 2, 1], [0, 3, 2]];
        let mut tree = [Node::EMPTY; max_nodes(2)];
        let used = build_mesh(&vertices, &mut triangles, &mut tree).unwrap();
        let bowl = TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes {
                normals: &normals,
                ..Attributes::NONE
            },
        };
        let meshes = [Mesh {
            triangles: bowl.into(),
            nodes: &tree[..used],
        }];
        let borrowed = Borrowed {
            meshes: if self == Room::Smooth { &meshes } else { &[] },
            environment: sky.as_ref().map_or(Environment::None, Environment::Sky),
            ..Borrowed::default()
        };
        let mut nodes = [Node::EMPTY; max_nodes(16)];
        render(&builder.build_from(borrowed, &mut nodes).unwrap(), camera)
    }
}
