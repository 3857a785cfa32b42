//! Embree 4 by its C interface, from a library that is loaded: rtcIntersect1, one ray at a time.

use std::ffi::{c_char, c_uint, c_void};
use std::ptr;

use libloading::Library;
use microlux::geom::Ray;

use crate::mesh::Model;
use crate::{Answer, Tracer};

/// RTCRayHit: 12 words of ray, 9 of hit, aligned to 16 bytes; room for more.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    dir: [f32; 3],
    time: f32,
    far: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
    normal: [f32; 3],
    uv: [f32; 2],
    primitive: c_uint,
    geometry: c_uint,
    instance: [c_uint; 9],
}

const NONE: c_uint = c_uint::MAX;
const TRIANGLES: c_uint = 0;
const INDEX: c_uint = 0;
const VERTEX: c_uint = 1;
const UINT3: c_uint = 0x5003;
const FLOAT3: c_uint = 0x9003;

type Handle = *mut c_void;
type NewDevice = unsafe extern "C" fn(*const c_char) -> Handle;
type NewOf = unsafe extern "C" fn(Handle) -> Handle;
type NewGeometry = unsafe extern "C" fn(Handle, c_uint) -> Handle;
type NewBuffer = unsafe extern "C" fn(Handle, c_uint, c_uint, c_uint, usize, usize) -> *mut c_void;
type Commit = unsafe extern "C" fn(Handle);
type Attach = unsafe extern "C" fn(Handle, Handle) -> c_uint;
type Intersect = unsafe extern "C" fn(Handle, *mut RayHit, *const c_void);

pub struct Scene {
    scene: Handle,
    intersect: Intersect,
    /// Kept loaded.
    _library: Library,
}

impl Scene {
    pub fn new(library: &str, model: &Model) -> Result<Scene, String> {
        let told = |error: libloading::Error| format!("{library}: {error}");
        // SAFETY: Embree's library has no initialisers that do more than set itself up; its functions have the types above
        // (rtcore 4), handles come from itself, and buffers are filled to their length.
        unsafe {
            let embree = Library::new(library).map_err(told)?;
            let new_device = *embree.get::<NewDevice>(b"rtcNewDevice\0").map_err(told)?;
            let new_scene = *embree.get::<NewOf>(b"rtcNewScene\0").map_err(told)?;
            let new_geometry = *embree.get::<NewGeometry>(b"rtcNewGeometry\0").map_err(told)?;
            let new_buffer = *embree
                .get::<NewBuffer>(b"rtcSetNewGeometryBuffer\0")
                .map_err(told)?;
            let commit_geometry = *embree.get::<Commit>(b"rtcCommitGeometry\0").map_err(told)?;
            let attach = *embree.get::<Attach>(b"rtcAttachGeometry\0").map_err(told)?;
            let commit_scene = *embree.get::<Commit>(b"rtcCommitScene\0").map_err(told)?;
            let intersect = *embree.get::<Intersect>(b"rtcIntersect1\0").map_err(told)?;

            let device = new_device(c"threads=1".as_ptr());
            if device.is_null() {
                return Err("Embree has no device".to_owned());
            }
            let (scene, geometry) = (new_scene(device), new_geometry(device, TRIANGLES));
            let (vertices, triangles) = (model.vertices.len(), model.triangles.len());
            let places = new_buffer(geometry, VERTEX, 0, FLOAT3, 12, vertices).cast::<[f32; 3]>();
            let corners = new_buffer(geometry, INDEX, 0, UINT3, 12, triangles).cast::<[u32; 3]>();
            if places.is_null() || corners.is_null() {
                return Err("Embree has no buffers".to_owned());
            }
            for (at, vertex) in model.vertices.iter().enumerate() {
                places.add(at).write(vertex.map(f32::from));
            }
            for (at, triangle) in model.triangles.iter().enumerate() {
                corners.add(at).write(triangle.map(u32::from));
            }
            commit_geometry(geometry);
            attach(scene, geometry);
            commit_scene(scene);
            Ok(Scene {
                scene,
                intersect,
                _library: embree,
            })
        }
    }
}

impl Tracer for Scene {
    fn name(&self) -> &'static str {
        "embree"
    }

    fn nearest(&self, ray: &Ray) -> Answer {
        let mut query = RayHit {
            origin: ray.origin.0.map(|c| c as f32),
            near: 0.0,
            dir: ray.dir.0.map(|c| c as f32 / 65_536.0),
            time: 0.0,
            far: f32::INFINITY,
            mask: NONE,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            uv: [0.0; 2],
            primitive: NONE,
            geometry: NONE,
            instance: [NONE; 9],
        };
        // SAFETY: the scene is committed, and the query is as large and as aligned as RTCRayHit.
        unsafe { (self.intersect)(self.scene, &raw mut query, ptr::null()) };
        (query.geometry != NONE).then_some((query.primitive, query.far))
    }
}
