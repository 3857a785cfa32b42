//! The core's scene back in f64, exactly as its integers say: what the reference renders.

use crate::picture;
use crate::quantise::{CoreScene, QuantiseError};
use crate::reference;
use crate::reference::{Camera, Geometry, Lens, Light, Mesh, Rgb, Shape, Texture, Tint, Vec3, vec3};
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Octahedral, Point};
use microlux::light::Environment;
use std::sync::Arc;

mod implicit;
mod material;

/// From units of the scene frame to metres.
pub struct Frame {
    origin: [f64; 3],
    /// Metres a unit.
    step: f64,
}

impl Frame {
    pub fn of(core: &CoreScene) -> Frame {
        Frame {
            origin: core.origin,
            step: f64::from(-core.unit.fraction_bits()).exp2(),
        }
    }

    pub fn point(&self, Point(p): Point) -> Vec3 {
        let [x, y, z] = [0, 1, 2].map(|i| self.origin[i] + self.length(p[i]));
        vec3(x, y, z)
    }

    pub fn length(&self, units: i32) -> f64 {
        f64::from(units) * self.step
    }
}

/// A direction as its components stand: of length 1 but for rounding.
pub fn dir(Dir(d): Dir) -> Vec3 {
    let [x, y, z] = d.map(|c| f64::from(c) / 65536.0);
    vec3(x, y, z)
}

/// A normalised direction.
fn unit(d: Dir) -> Vec3 {
    let v = dir(d);
    let length = (v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
    vec3(v.x / length, v.y / length, v.z / length)
}

pub fn albedo(Albedo(a): Albedo) -> [f64; 3] {
    a.map(|c| f64::from(c.to_bits()) / 32768.0)
}

pub fn radiance(light: Radiance) -> [f64; 3] {
    let (mantissa, exponent) = light.to_parts();
    mantissa.map(|m| f64::from(m) * f64::from(i32::from(exponent) - 15).exp2())
}

/// The whole scene. The core's order of shapes is kept; `id` is the number in the file.
pub fn scene(core: &CoreScene) -> Result<reference::Scene, QuantiseError> {
    let lent = core.lend();
    let checked = core.scene(&lent)?;
    let parts = checked.parts();
    let frame = Frame::of(core);
    let lights = parts.lights;
    let emission = |index: u16| match lights[index as usize] {
        microlux::light::Light::Area { radiance: r, .. } => Some(radiance(r).into()),
        _ => None,
    };
    let textures: Vec<Arc<Texture>> = parts.textures.iter().map(|t| Arc::new(texture(t))).collect();
    let shapes = parts.shapes.iter().map(|shape| Shape {
        geometry: geometry(&frame, &shape.geometry, parts.meshes, parts.blobs),
        material: shape.material as usize,
        emission: shape.light.and_then(emission),
        tint: match shape.tint {
            microlux::scene::Tint::None => None,
            microlux::scene::Tint::Vertices => Some(Tint::Vertices),
            microlux::scene::Tint::Texture(index) => {
                Some(Tint::Texture(Arc::clone(&textures[index as usize])))
            }
        },
        id: u32::from(shape.id),
    });
    let [right, up, forward] = core.camera.frame().map(unit);
    let (aperture, focus) = core.camera.lens();
    Ok(reference::Scene {
        camera: Camera {
            origin: frame.point(core.camera.origin()),
            right,
            up,
            forward,
            fov_x: core.camera.half_width().to_num::<f64>().atan().to_degrees() * 2.0,
            lens: core.camera.has_lens().then(|| Lens {
                aperture_radius: frame.length(aperture),
                focus_distance: frame.length(focus),
            }),
        },
        shapes: shapes.collect(),
        materials: parts.materials.iter().map(material::material).collect(),
        lights: lights
            .iter()
            .filter_map(|light| free_light(&frame, light))
            .chain(background(checked.environment()))
            .collect(),
    })
}

fn geometry(
    frame: &Frame,
    geometry: &microlux::shape::Geometry,
    meshes: &[microlux::scene::Mesh],
    blobs: &[microlux::shape::Blob],
) -> Geometry {
    use microlux::shape::Geometry as Core;
    match *geometry {
        Core::Sphere(s) => Geometry::Sphere {
            center: frame.point(s.center),
            radius: frame.length(s.radius),
        },
        Core::Plane(p) => Geometry::Plane {
            point: frame.point(p.point),
            normal: dir(p.normal),
        },
        Core::Disk(d) => Geometry::Disk {
            center: frame.point(d.center),
            normal: dir(d.normal),
            radius: frame.length(d.radius),
        },
        Core::Rectangle(r) => {
            let side = |d: Dir, half: i32| {
                let (d, half) = (unit(d), frame.length(half));
                vec3(d.x * half, d.y * half, d.z * half)
            };
            Geometry::Rectangle {
                center: frame.point(r.center),
                u: side(r.u, r.half[0]),
                v: side(r.v, r.half[1]),
            }
        }
        Core::Implicit(ref solid) => Geometry::Implicit(Arc::new(implicit::implicit(frame, solid, blobs))),
        Core::Mesh(index) => {
            let mesh = &meshes[index as usize].triangles;
            let point = |v: [u16; 3]| frame.point(mesh.grid().to_scene(v));
            Geometry::Mesh(Arc::new(mesh_of(mesh, point, |normal| normal)))
        }
        Core::Instance(ref instance) => {
            let mesh = &meshes[instance.mesh as usize].triangles;
            let rows = instance
                .rotation
                .rows()
                .map(|row| row.map(|c| f64::from(c) / f64::from(1 << 30)));
            let turn = |v: Vec3| {
                let [x, y, z] = rows.map(|row| row[0] * v.x + row[1] * v.y + row[2] * v.z);
                vec3(x, y, z)
            };
            let scale = f64::from(instance.scale()) / 65536.0 * frame.step;
            let at = frame.point(instance.at);
            let point = |v: [u16; 3]| {
                let [x, y, z] = mesh.grid().to_scene(v).0.map(f64::from);
                let turned = turn(vec3(x, y, z));
                vec3(
                    at.x + scale * turned.x,
                    at.y + scale * turned.y,
                    at.z + scale * turned.z,
                )
            };
            Geometry::Mesh(Arc::new(mesh_of(mesh, point, turn)))
        }
    }
}

/// A mesh whose vertices lie where `point` says, its normals turned.
fn mesh_of(
    mesh: &microlux::shape::Triangles,
    point: impl Fn([u16; 3]) -> Vec3,
    turn: impl Fn(Vec3) -> Vec3,
) -> Mesh {
    use microlux::shape::Triangles;
    let normal = |normal: &Octahedral| turn(octahedral(normal));
    let color = |signal: &[u8; 3]| -> Rgb { signal.map(from_srgb).into() };
    let uv = |uv: &[i16; 2]| uv.map(|part| f64::from(part) / 4096.0);
    match mesh {
        Triangles::Plain(mesh) => Mesh::new(
            mesh.vertices.iter().map(|&v| point(v)).collect(),
            mesh.triangles.iter().map(|t| t.map(u32::from)).collect(),
            mesh.attributes.normals.iter().map(normal).collect(),
        )
        .with_tints(
            mesh.attributes.colors.iter().map(color).collect(),
            mesh.attributes.uvs.iter().map(uv).collect(),
        ),
        Triangles::Packed(_) => {
            let corners: Vec<_> = mesh.numbers().filter_map(|number| mesh.corners(number)).collect();
            let normals = mesh.numbers().filter_map(|number| mesh.normals(number));
            let colors = mesh.numbers().filter_map(|number| mesh.colors(number));
            let uvs = mesh.numbers().filter_map(|number| mesh.uvs(number));
            let threes = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
            Mesh::new(
                corners.iter().flatten().map(|&v| point(v)).collect(),
                threes.collect(),
                normals.flatten().map(|n| normal(&n)).collect(),
            )
            .with_tints(
                colors.flatten().map(|c| color(&c)).collect(),
                uvs.flatten().map(|place| uv(&place)).collect(),
            )
        }
    }
}

/// To the 2^-15 of the core's table.
fn from_srgb(signal: u8) -> f64 {
    let light = picture::from_srgb(f64::from(signal) / 255.0);
    (light * 32768.0).round() / 32768.0
}

fn texture(texture: &microlux::material::Texture) -> Texture {
    use microlux::material::{Filter, Texels};
    let (width, height) = (usize::from(texture.width), usize::from(texture.height));
    let number = |place: usize| match texture.texels {
        Texels::Half(bytes) => {
            bytes[place / width * width.div_ceil(2) + place % width / 2] >> (place % width % 2 * 4) & 15
        }
        Texels::Byte(bytes) => bytes[place],
    };
    let color = |place| -> Rgb {
        texture.palette[usize::from(number(place))]
            .map(|c| f64::from(c) / 32768.0)
            .into()
    };
    Texture {
        width,
        height,
        texels: (0..width * height).map(color).collect(),
        nearest: texture.filter == Filter::Nearest,
    }
}

/// A point of the octahedron |x| + |y| + |z| = 1, unfolded: Cigolle et al. 2014, listing 1.
fn octahedral(&Octahedral(bytes): &Octahedral) -> Vec3 {
    let [x, y] = bytes.map(|b| (f64::from(b) / 127.0).max(-1.0));
    let z = 1.0 - x.abs() - y.abs();
    if z >= 0.0 {
        return vec3(x, y, z);
    }
    vec3((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y), z)
}

/// A sky, its sun, or a map; a constant environment is one of the lights.
fn background(environment: &Environment) -> Vec<Light> {
    match environment {
        Environment::None | Environment::Constant(_) => Vec::new(),
        Environment::Sky(sky) => {
            let [zenith, horizon, ground] = sky.colors().map(|color| radiance(color).into());
            let gradient = Light::Gradient(reference::Gradient {
                zenith,
                horizon,
                ground,
                up: dir(sky.up()),
            });
            let sun = sky.sun().map(|sun| {
                let versine = wide(sun.cone.versine());
                Light::Sun(reference::Sun {
                    direction: dir(sun.direction),
                    radiance: radiance(sun.radiance).into(),
                    // 1 − cos α = 2 sin² (α/2)
                    angle: 4.0 * (versine / 2.0).sqrt().asin().to_degrees(),
                })
            });
            std::iter::once(gradient).chain(sun).collect()
        }
        Environment::Map(map) => {
            let parts = map.parts();
            let [width, height] = [parts.width, parts.height].map(usize::from);
            let pixels = parts
                .texels
                .iter()
                .map(|texel| radiance(texel.scaled(i32::from(parts.exponent))).into());
            vec![Light::Map(Arc::new(reference::Map {
                width,
                height,
                pixels: pixels.collect(),
                axes: parts.axes.map(unit),
            }))]
        }
    }
}

fn wide(x: microlux::num::Wide) -> f64 {
    f64::from(x.mantissa()) * f64::from(i32::from(x.exponent()) - 15).exp2()
}

fn free_light(frame: &Frame, light: &microlux::light::Light) -> Option<Light> {
    use microlux::light::Light as Core;
    match *light {
        Core::Point { position, intensity } => Some(Light::Point {
            position: frame.point(position),
            intensity: radiance(intensity).into(),
        }),
        Core::Directional {
            direction,
            irradiance,
        } => Some(Light::Directional {
            direction: dir(direction),
            irradiance: radiance(irradiance).into(),
        }),
        Core::Area { .. } => None,
        Core::Environment { radiance: r } => Some(Light::Constant {
            radiance: radiance(r).into(),
        }),
    }
}
