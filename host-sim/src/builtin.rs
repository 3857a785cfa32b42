//! Scenes that need no file.

mod balls;
mod implicits;
mod torus_knot;

use crate::desc::{
    BsdfDesc, CameraDesc, GeometryDesc, IntegratorDesc, IntegratorKind, LightDesc, NamedMaterial, SceneDesc,
    ShapeDesc, Vec3,
};
use crate::import::math::{cross, scaled, sub, unit};

/// Names and what each shows, in the order they are listed.
pub fn all() -> &'static [(&'static str, &'static str)] {
    &[
        (
            "cornell",
            "a box of coloured walls with two blocks under a square lamp: light between surfaces",
        ),
        (
            "seed",
            "the scene of the paper's author: glass and coloured spheres between unbounded planes",
        ),
        (
            "spheres",
            "a matt, a mirror and a glass ball on a plane, point light and sky",
        ),
        (
            "torus-knot",
            "a knotted tube of 15,360 triangles over a floor, square lamp",
        ),
        (
            "materials",
            "a ball of each material: rough diffuse, gloss, metals, frosted and clear glass",
        ),
        ("sky", "balls on a floor under a sky with a sun"),
        (
            "map",
            "the same balls in a studio with two windows, an environment map",
        ),
        (
            "implicits",
            "six solids given by a function, found by marching: one of glass, one of steel, one that glows",
        ),
        (
            "furnace",
            "a grey ball in a white sky: exactly 0.5 on the ball and 1 around it",
        ),
    ]
}

/// The scene of that name.
pub fn scene(name: &str) -> Option<SceneDesc> {
    match name {
        "cornell" => Some(cornell()),
        "seed" => Some(seed()),
        "spheres" => Some(spheres()),
        "torus-knot" => Some(torus_knot_on_floor()),
        "materials" => Some(balls::materials()),
        "sky" => Some(balls::sky()),
        "map" => Some(balls::map()),
        "implicits" => Some(implicits::implicits()),
        "furnace" => Some(furnace()),
        _ => None,
    }
}

/// A scene under construction: 128 × 128, path.
struct Draft(SceneDesc);

impl Draft {
    fn new(name: &str, max_depth: u32, camera: CameraDesc) -> Self {
        let integrator = IntegratorDesc {
            kind: IntegratorKind::Path,
            max_depth: Some(max_depth),
            rr_depth: 5,
            hide_emitters: false,
            ao_radius: None,
        };
        Self(SceneDesc {
            name: name.to_string(),
            width: 128,
            height: 128,
            spp: None,
            sampler: None,
            integrator,
            camera,
            materials: Vec::new(),
            shapes: Vec::new(),
            lights: Vec::new(),
            baked: None,
        })
    }

    fn material(&mut self, name: &str, two_sided: bool, bsdf: BsdfDesc) -> usize {
        self.0.materials.push(NamedMaterial {
            name: name.to_string(),
            two_sided,
            bsdf,
            tint: None,
        });
        self.0.materials.len() - 1
    }

    fn diffuse(&mut self, name: &str, reflectance: Vec3) -> usize {
        self.material(name, true, BsdfDesc::Diffuse { reflectance })
    }

    fn glass(&mut self) -> usize {
        let white = [1.0; 3];
        let bsdf = BsdfDesc::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: white,
            specular_transmittance: white,
        };
        self.material("glass", false, bsdf)
    }

    fn shape(&mut self, name: &str, material: usize, geometry: GeometryDesc) {
        self.0.shapes.push(ShapeDesc {
            name: name.to_string(),
            geometry,
            material,
            emission: None,
        });
    }

    fn sphere(&mut self, name: &str, material: usize, center: Vec3, radius: f64) {
        self.shape(name, material, GeometryDesc::Sphere { center, radius });
    }

    /// A shape that only emits.
    fn lamp(&mut self, name: &str, radiance: Vec3, geometry: GeometryDesc) {
        let black = match self.0.materials.iter().position(|m| m.name == "lamp") {
            Some(index) => index,
            None => self.material(
                "lamp",
                false,
                BsdfDesc::Diffuse {
                    reflectance: [0.0; 3],
                },
            ),
        };
        self.shape(name, black, geometry);
        if let Some(lamp) = self.0.shapes.last_mut() {
            lamp.emission = Some(radiance);
        }
    }

    /// An upright box standing on `floor`, turned counter-clockwise about y (seen from above), without its bottom.
    fn block(&mut self, name: &str, material: usize, floor: Vec3, half: Vec3, degrees: f64) {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let axes = [[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]];
        let center = [floor[0], floor[1] + half[1], floor[2]];
        let faces = [
            ("left", 0, -1.0),
            ("right", 0, 1.0),
            ("top", 1, 1.0),
            ("back", 2, -1.0),
            ("front", 2, 1.0),
        ];
        for (face, axis, sign) in faces {
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            let middle = [0, 1, 2].map(|i| center[i] + sign * half[axis] * axes[axis][i]);
            // a × b is the axis itself, so the side is chosen by the sign of one edge.
            let (u, v) = (scaled(axes[a], sign * half[a]), scaled(axes[b], half[b]));
            self.shape(
                &format!("{name} {face}"),
                material,
                GeometryDesc::Rectangle { center: middle, u, v },
            );
        }
    }
}

/// A pinhole at `origin`, the picture's up as near to y as can be.
fn camera(origin: Vec3, target: Vec3, fov_x: f64) -> CameraDesc {
    let forward = unit(sub(target, origin)).unwrap_or([0.0, 0.0, -1.0]);
    let right = unit(cross(forward, [0.0, 1.0, 0.0])).unwrap_or([1.0, 0.0, 0.0]);
    CameraDesc {
        origin,
        right,
        up: cross(right, forward),
        forward,
        fov_x,
        lens: None,
    }
}

/// In the spirit of the Cornell box (Goral et al. 1984); dimensions and colours are our own.
fn cornell() -> SceneDesc {
    let mut draft = Draft::new("cornell", 8, camera([0.0, 1.0, 4.1], [0.0, 1.0, 0.0], 38.0));
    let white = draft.diffuse("white", [0.74, 0.73, 0.70]);
    let red = draft.diffuse("red", [0.60, 0.07, 0.06]);
    let green = draft.diffuse("green", [0.13, 0.44, 0.12]);
    let mut wall = |name: &str, material, center, u, v| {
        draft.shape(name, material, GeometryDesc::Rectangle { center, u, v });
    };
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    wall("floor", white, [0.0, 0.0, 0.0], z, x);
    wall("ceiling", white, [0.0, 2.0, 0.0], x, z);
    wall("back", white, [0.0, 1.0, -1.0], x, y);
    wall("left", red, [-1.0, 1.0, 0.0], y, z);
    wall("right", green, [1.0, 1.0, 0.0], z, y);
    draft.block("tall", white, [-0.36, 0.0, -0.30], [0.29, 0.61, 0.29], 17.0);
    draft.block("short", white, [0.35, 0.0, 0.33], [0.29, 0.28, 0.29], -19.0);
    let lamp = GeometryDesc::Rectangle {
        center: [0.0, 1.985, -0.05],
        u: [0.26, 0.0, 0.0],
        v: [0.0, 0.0, 0.21],
    };
    draft.lamp("lamp", [16.5, 13.6, 8.6], lamp);
    draft.0
}

/// The scene that the author of the paper ships with his program, planes unbounded as there.
fn seed() -> SceneDesc {
    let mut draft = Draft::new("seed", 9, camera([0.0, 0.0, 4.0], [0.0, 0.0, 3.0], 90.0));
    let plane = draft.diffuse("plane", [0.5, 0.4, 0.1]);
    let gray = draft.diffuse("gray", [0.9, 0.8, 0.8]);
    let green = draft.diffuse("green", [0.1, 0.95, 0.1]);
    let blue = draft.diffuse("blue", [0.1, 0.1, 0.95]);
    let glass = draft.glass();
    let floor = GeometryDesc::Plane {
        point: [0.0, -1.0, 0.0],
        normal: [0.0, 1.0, 0.0],
    };
    draft.shape("floor", plane, floor);
    draft.shape(
        "back",
        plane,
        GeometryDesc::Plane {
            point: [0.0, 0.0, -4.0],
            normal: [0.0, 0.0, 1.0],
        },
    );
    draft.sphere("gray sphere", gray, [0.0, 0.0, -3.0], 1.0);
    draft.sphere("green sphere", green, [-3.0, -0.2, -1.5], 0.25);
    draft.sphere("blue sphere", blue, [1.0, -0.2, 2.0], 0.5);
    draft.sphere("glass sphere", glass, [-2.0, -0.5, 0.0], 0.4);
    let big = GeometryDesc::Sphere {
        center: [-2.0, 3.0, -3.0],
        radius: 0.75,
    };
    draft.lamp("white lamp", [0.8, 0.8, 0.8], big);
    let small = GeometryDesc::Sphere {
        center: [-2.0, -0.5, 2.5],
        radius: 0.25,
    };
    draft.lamp("green lamp", [0.09, 0.3, 0.09], small);
    draft.0
}

fn spheres() -> SceneDesc {
    let mut draft = Draft::new("spheres", 8, camera([0.0, 1.6, 5.2], [0.0, 0.55, 0.0], 34.0));
    let floor = draft.diffuse("floor", [0.45, 0.45, 0.42]);
    let matt = draft.diffuse("matt", [0.62, 0.22, 0.12]);
    let mirror = BsdfDesc::Conductor {
        specular_reflectance: [0.95, 0.93, 0.88],
        eta_k: None,
    };
    let mirror = draft.material("mirror", true, mirror);
    let glass = draft.glass();
    draft.shape(
        "floor",
        floor,
        GeometryDesc::Plane {
            point: [0.0; 3],
            normal: [0.0, 1.0, 0.0],
        },
    );
    draft.sphere("matt ball", matt, [-1.15, 0.5, 0.1], 0.5);
    draft.sphere("mirror ball", mirror, [0.1, 0.7, -0.9], 0.7);
    draft.sphere("glass ball", glass, [0.95, 0.45, 0.6], 0.45);
    draft.0.lights.push(LightDesc::Point {
        position: [-1.5, 3.2, 2.6],
        intensity: [16.0, 14.5, 12.0],
    });
    draft.0.lights.push(LightDesc::Constant {
        radiance: [0.32, 0.42, 0.58],
    });
    draft.0
}

fn torus_knot_on_floor() -> SceneDesc {
    let mut draft = Draft::new("torus-knot", 6, camera([1.1, 2.3, 4.6], [0.0, 0.98, 0.0], 36.0));
    let floor = draft.diffuse("floor", [0.5, 0.5, 0.5]);
    let tube = draft.diffuse("tube", [0.2, 0.42, 0.62]);
    let half = 6.0;
    let ground = GeometryDesc::Rectangle {
        center: [0.0; 3],
        u: [0.0, 0.0, half],
        v: [half, 0.0, 0.0],
    };
    draft.shape("floor", floor, ground);
    draft.shape(
        "knot",
        tube,
        GeometryDesc::Mesh(torus_knot::mesh([0.0, 1.1, 0.0])),
    );
    let lamp = GeometryDesc::Rectangle {
        center: [0.0, 3.6, 0.6],
        u: [0.8, 0.0, 0.0],
        v: [0.0, 0.0, 0.8],
    };
    draft.lamp("lamp", [9.0, 8.6, 8.0], lamp);
    draft.0
}

/// A convex surface in uniform light of radiance 1 shows its reflectance.
fn furnace() -> SceneDesc {
    let mut draft = Draft::new("furnace", 8, camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 40.0));
    let grey = draft.diffuse("grey", [0.5; 3]);
    draft.sphere("ball", grey, [0.0; 3], 1.0);
    draft.0.lights.push(LightDesc::Constant { radiance: [1.0; 3] });
    draft.0
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::desc::MeshDesc;
    use crate::import::math::{add, dot};

    fn shapes() -> Vec<(String, SceneDesc)> {
        all()
            .iter()
            .map(|&(name, _)| (name.to_string(), scene(name).unwrap()))
            .collect()
    }

    #[test]
    fn every_listed_scene_exists_and_is_lit() {
        for (name, scene) in shapes() {
            assert_eq!(scene.name, name);
            assert!(
                !scene.lights.is_empty() || scene.shapes.iter().any(|s| s.emission.is_some()),
                "{name} is dark"
            );
            assert!(scene.shapes.iter().all(|s| s.material < scene.materials.len()));
        }
        assert!(scene("teapot").is_none());
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn cameras_and_rectangles_have_right_angles() {
        for (_, scene) in shapes() {
            let c = &scene.camera;
            assert!(near(dot(c.right, c.up), 0.0) && near(dot(c.right, c.forward), 0.0));
            assert!(near(dot(c.right, c.right), 1.0) && near(dot(c.forward, c.forward), 1.0));
            assert!(
                cross(c.right, c.up)
                    .iter()
                    .zip(c.forward)
                    .all(|(a, b)| near(*a, -b))
            );
            for shape in &scene.shapes {
                if let GeometryDesc::Rectangle { u, v, .. } = shape.geometry {
                    assert!(near(dot(u, v), 0.0), "{}", shape.name);
                }
            }
        }
    }

    /// Walls face into the box, blocks and lamp out of themselves: towards a point in free air between them.
    #[test]
    fn the_box_faces_inwards_and_the_blocks_outwards() {
        let scene = cornell();
        let normals: HashMap<_, _> = scene
            .shapes
            .iter()
            .map(|shape| match shape.geometry {
                GeometryDesc::Rectangle { center, u, v } => (shape.name.as_str(), (center, cross(u, v))),
                _ => panic!("{} is no rectangle", shape.name),
            })
            .collect();
        let towards = |name: &str, point: Vec3| {
            let (center, normal) = normals[name];
            dot(normal, sub(point, center)) > 0.0
        };
        for wall in ["floor", "ceiling", "back", "left", "right", "lamp"] {
            assert!(towards(wall, [0.0, 1.0, 0.0]), "{wall}");
        }
        for (block, inside) in [("tall", [-0.36, 0.6, -0.3]), ("short", [0.35, 0.3, 0.33])] {
            for face in ["left", "right", "top", "back", "front"] {
                assert!(!towards(&format!("{block} {face}"), inside), "{block} {face}");
            }
        }
    }

    /// Each edge is shared by exactly two triangles that run along it in opposite directions.
    fn assert_closed(mesh: &MeshDesc) {
        let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
        for t in &mesh.triangles {
            for k in 0..3 {
                *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
            }
        }
        for (&(a, b), &count) in &edges {
            assert_eq!((count, edges.get(&(b, a))), (1, Some(&1)), "edge {a} {b}");
        }
    }

    /// Positive where triangles are counter-clockwise seen from outside (divergence theorem).
    fn volume(mesh: &MeshDesc) -> f64 {
        let corners = mesh
            .triangles
            .iter()
            .map(|t| t.map(|i| mesh.vertices[i as usize]));
        corners.map(|[a, b, c]| dot(a, cross(b, c)) / 6.0).sum()
    }

    #[test]
    fn made_meshes_are_closed_and_face_outwards() {
        let mut meshes = 0;
        for (_, scene) in shapes() {
            for shape in &scene.shapes {
                let GeometryDesc::Mesh(mesh) = &shape.geometry else {
                    continue;
                };
                meshes += 1;
                assert_closed(mesh);
                assert!(volume(mesh) > 0.0);
                for t in &mesh.triangles {
                    let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
                    let smooth = t
                        .iter()
                        .fold([0.0; 3], |sum, &i| add(sum, mesh.normals[i as usize]));
                    assert!(dot(cross(sub(b, a), sub(c, a)), smooth) > 0.0);
                }
                assert!(
                    mesh.vertices.iter().all(|v| v[1] > 0.0),
                    "the mesh dips under the floor"
                );
            }
        }
        assert_eq!(meshes, 1);
    }

    #[test]
    fn the_description_counts_right() {
        let scene = torus_knot_on_floor();
        let GeometryDesc::Mesh(mesh) = &scene.shapes[1].geometry else {
            panic!("no mesh")
        };
        let (_, text) = all().iter().find(|(name, _)| *name == "torus-knot").unwrap();
        assert!(text.contains("15,360") && mesh.triangles.len() == 15_360);
    }
}
