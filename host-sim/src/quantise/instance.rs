//! Meshes that stand in several places.

use std::collections::HashMap;
use std::sync::Arc;

use microlux::geom::{Point, Rotation};
use microlux::num::Metres;
use microlux::shape::Instance;

use super::rounding::Rounding;
use super::{OwnedMesh, QuantiseError};
use crate::desc::{GeometryDesc, InstanceDesc, MeshDesc, SceneDesc, TintDesc, Vec3};

/// The frame that all instances of a mesh share: units as fine as the scene's where the largest of them stands, or up to
/// twice as coarse.
struct Frame {
    rounding: Rounding,
    /// Index of the mesh once it was made.
    made: Option<u16>,
}

/// The frames of all meshes that stand in several places.
pub(super) struct Shared(HashMap<*const MeshDesc, Frame>);

impl Shared {
    pub fn new(scene: &Rounding, desc: &SceneDesc) -> Shared {
        let mut largest: HashMap<*const MeshDesc, (f64, Vec3)> = HashMap::new();
        for shape in &desc.shapes {
            if let GeometryDesc::Instance(instance) = &shape.geometry {
                let middle = || middle(&instance.mesh);
                let entry = largest
                    .entry(Arc::as_ptr(&instance.mesh))
                    .or_insert_with(|| (0.0, middle()));
                entry.0 = entry.0.max(instance.scale);
            }
        }
        let frame = |(scale, origin): (f64, Vec3)| Frame {
            rounding: Rounding {
                origin,
                scale: scene.scale * scale.log2().floor().exp2(),
            },
            made: None,
        };
        Shared(
            largest
                .into_iter()
                .map(|(mesh, found)| (mesh, frame(found)))
                .collect(),
        )
    }

    /// Where an instance stands, its mesh made if it is the first of it; `None` if it is so much smaller than another of the
    /// same mesh that it needs one of its own.
    pub fn place(
        &mut self,
        scene: &Rounding,
        name: &str,
        instance: &InstanceDesc,
        tint: Option<&TintDesc>,
        meshes: &mut Vec<OwnedMesh>,
    ) -> Result<Option<Instance>, QuantiseError> {
        let Some(frame) = self.0.get_mut(&Arc::as_ptr(&instance.mesh)) else {
            return Ok(None);
        };
        let scale = (instance.scale * scene.scale / frame.rounding.scale * 65536.0).round();
        if scale < f64::from(Instance::SMALLEST) {
            return Ok(None);
        }
        let mesh = match frame.made {
            Some(mesh) => mesh,
            None => {
                meshes.push(frame.rounding.mesh(name, &instance.mesh, tint)?);
                *frame.made.insert((meshes.len() - 1) as u16)
            }
        };
        let Point(at) = scene.point(instance.point(frame.rounding.origin));
        let placed = Instance::new(mesh)
            .scaled(Metres::from_bits(scale as i32))
            .turned(rotation(instance.axes))
            .moved(Point(at));
        Ok(Some(placed))
    }
}

/// Of the box around a mesh.
fn middle(mesh: &MeshDesc) -> Vec3 {
    [0, 1, 2].map(|axis| {
        let along = mesh.vertices.iter().map(|v| v[axis]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| {
            (low.min(c), high.max(c))
        });
        if low <= high { 0.5 * (low + high) } else { 0.0 }
    })
}

/// From the matrix with these columns by its quaternion, whose largest component is found first (Shepperd, "Quaternion
/// from Rotation Matrix", Journal of Guidance and Control 1(3), 1978).
fn rotation([x, y, z]: [Vec3; 3]) -> Rotation {
    let trace = x[0] + y[1] + z[2];
    let squares = [
        1.0 + trace,
        1.0 + 2.0 * x[0] - trace,
        1.0 + 2.0 * y[1] - trace,
        1.0 + 2.0 * z[2] - trace,
    ];
    let largest = (0..4)
        .max_by(|&a, &b| squares[a].total_cmp(&squares[b]))
        .unwrap_or(0);
    let (wx, wy, wz) = (y[2] - z[1], z[0] - x[2], x[1] - y[0]);
    let (xy, xz, yz) = (x[1] + y[0], x[2] + z[0], y[2] + z[1]);
    let square = squares[largest];
    let quaternion = match largest {
        0 => [square, wx, wy, wz],
        1 => [wx, square, xy, xz],
        2 => [wy, xy, square, yz],
        _ => [wz, xz, yz, square],
    };
    let length = quaternion.iter().map(|c| c * c).sum::<f64>().sqrt();
    let bits = quaternion.map(|c| (c / length * f64::from(1 << 29)).round() as i32);
    Rotation::new(bits).unwrap_or(Rotation::NONE)
}
