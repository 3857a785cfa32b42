//! A lone mesh as a scene: on a floor, under a sky and a sun, seen from a three-quarter angle.

use std::path::Path;

use super::math::{Affine, add, cross, dot, length, scaled, sub, unit};
use super::mesh::Placement;
use super::{ImportError, Loaded, read_mesh, stem};
use crate::desc::{
    BsdfDesc, CameraDesc, GeometryDesc, IntegratorDesc, IntegratorKind, LightDesc, MeshDesc, NamedMaterial,
    SceneDesc, ShapeDesc, Vec3,
};

/// From the mesh towards the camera: from the right, the front and a little above.
const VIEW: Vec3 = [0.55, 0.42, 0.9];
const FOV: f64 = 32.0;
/// Share of the half picture that the mesh may fill.
const FILL: f64 = 0.82;

/// Reads an `.obj` or `.ply` and puts it on show.
pub(super) fn load(path: &Path) -> Result<Loaded, ImportError> {
    let raw = read_mesh(path)?;
    let as_it_is = Placement {
        to_world: Affine::IDENTITY,
        face_normals: false,
        flip_normals: false,
    };
    let (mesh, dropped) = raw.place(as_it_is);
    if mesh.triangles.is_empty() {
        return Err(ImportError::new(path, "no triangle has any area; check the mesh"));
    }
    let mut warnings: Vec<String> = raw
        .notes
        .iter()
        .map(|note| ImportError::new(path, note.clone()).to_string())
        .collect();
    if dropped > 0 {
        warnings.push(
            ImportError::new(path, format!("{dropped} triangles without area are left out")).to_string(),
        );
    }
    let Some(scene) = show(stem(path), mesh) else {
        return Err(ImportError::new(
            path,
            "the mesh is too large to frame; scale it down",
        ));
    };
    Ok(Loaded { scene, warnings })
}

/// `None` where the mesh has no finite extent.
fn show(name: String, mesh: MeshDesc) -> Option<SceneDesc> {
    let (low, high) = bounds(&mesh.vertices);
    let center = scaled(add(low, high), 0.5);
    let radius = length(sub(high, low)) / 2.0;
    let camera = framing(&mesh.vertices, center)?;

    let floor_half = 8.0 * radius;
    let floor = GeometryDesc::Rectangle {
        center: [center[0], low[1], center[2]],
        u: [0.0, 0.0, floor_half],
        v: [floor_half, 0.0, 0.0],
    };
    let material = |name: &str, grey: f64| NamedMaterial {
        name: name.to_string(),
        two_sided: true,
        bsdf: BsdfDesc::Diffuse {
            reflectance: [grey; 3],
        },
    };
    Some(SceneDesc {
        width: 256,
        height: 256,
        spp: None,
        sampler: None,
        integrator: IntegratorDesc {
            kind: IntegratorKind::Path,
            max_depth: Some(5),
            rr_depth: 5,
            hide_emitters: false,
            ao_radius: None,
        },
        camera,
        materials: vec![material("surface", 0.7), material("floor", 0.4)],
        shapes: vec![
            ShapeDesc {
                name: name.clone(),
                geometry: GeometryDesc::Mesh(mesh),
                material: 0,
                emission: None,
            },
            ShapeDesc {
                name: "floor".to_string(),
                geometry: floor,
                material: 1,
                emission: None,
            },
        ],
        lights: vec![
            LightDesc::Constant {
                radiance: [0.4, 0.5, 0.65],
            },
            LightDesc::Directional {
                direction: unit([-0.35, -1.0, -0.5])?,
                irradiance: [1.9, 1.75, 1.5],
            },
        ],
        name,
    })
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let fold = |with: fn(f64, f64) -> f64, start: f64| {
        points.iter().fold([start; 3], |a, b| {
            [with(a[0], b[0]), with(a[1], b[1]), with(a[2], b[2])]
        })
    };
    (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY))
}

/// The camera along [`VIEW`], as near as all points stay within [`FILL`] of the square picture.
fn framing(points: &[Vec3], center: Vec3) -> Option<CameraDesc> {
    let back = unit(VIEW)?;
    let right = unit(cross([0.0, 1.0, 0.0], back))?;
    let up = cross(back, right);
    let tan = FILL * (FOV.to_radians() / 2.0).tan();
    let distance = points
        .iter()
        .map(|&p| sub(p, center))
        .map(|p| dot(p, back) + dot(p, right).abs().max(dot(p, up).abs()) / tan)
        .fold(0.0, f64::max);
    let origin = add(center, scaled(back, distance));
    (distance > 0.0 && distance.is_finite()).then_some(CameraDesc {
        origin,
        right,
        up,
        forward: scaled(back, -1.0),
        fov_x: FOV,
        lens: None,
    })
}
