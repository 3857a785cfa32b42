//! A scene as the files say it: f64, in metres, nothing quantised yet.
//!
//! The importers write it, `quantise` turns it into the core's scene. Both renderers mean by it what Mitsuba 3 means:
//! right-handed, radiance in W·sr⁻¹·m⁻² per linear sRGB channel.

mod implicit;

use std::sync::Arc;

use crate::bake::Aligned;

pub use implicit::{BallDesc, BoundDesc, CapsuleDesc, ImplicitDesc, PartDesc};

/// Three numbers: a point (metres), a direction, or a colour.
pub type Vec3 = [f64; 3];

/// A whole scene with the picture it asks for.
#[derive(Clone, Debug)]
pub struct SceneDesc {
    /// File stem or built-in name.
    pub name: String,
    pub width: u32,
    pub height: u32,
    /// Samples a pixel, if the scene names them.
    pub spp: Option<u32>,
    pub sampler: Option<SamplerKind>,
    pub integrator: IntegratorDesc,
    pub camera: CameraDesc,
    pub materials: Vec<NamedMaterial>,
    pub shapes: Vec<ShapeDesc>,
    pub lights: Vec<LightDesc>,
    /// The scene as it lies in flash, if it was read from there: then it alone has shapes, materials and lights.
    pub baked: Option<Arc<Aligned>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerKind {
    Independent,
    Stratified,
    Cmj,
    Sobol,
    Blue,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IntegratorKind {
    /// Ambient occlusion: (1/π) ∫ V(ω) cosθ dω over the hemisphere about the shading normal on the eye's side, the same in
    /// every channel, at the first hit. V is 1 where nothing lies within `IntegratorDesc::ao_radius` along ω. Every material
    /// counts alike, emitters are shapes like others, and where the camera ray meets nothing it is 0.
    Ao,
    Direct,
    Path,
    /// The picture of `Path`, by bidirectional path tracing.
    Bdpt,
    /// The picture of `Path` but for what the camera sees only by a mirror, glass or the background, by paths from the
    /// lights.
    Light,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorDesc {
    pub kind: IntegratorKind,
    /// Paths of at most this many segments (1: emission only, 2: direct light); `None`: no limit but roulette.
    pub max_depth: Option<u32>,
    /// Segments after which Russian roulette may end a path (Mitsuba's default: 5).
    pub rr_depth: u32,
    /// Emitters are not seen directly by the camera.
    pub hide_emitters: bool,
    /// How far `Ao` looks for what hides the sky, metres; `None`: without end.
    pub ao_radius: Option<f64>,
}

/// A perspective camera. `right`, `up` and `forward` are orthonormal; `right` and `up` point right and up in the picture.
#[derive(Clone, Debug)]
pub struct CameraDesc {
    pub origin: Vec3,
    pub right: Vec3,
    pub up: Vec3,
    pub forward: Vec3,
    /// Horizontal field of view, degrees, over the full picture width.
    pub fov_x: f64,
    pub lens: Option<LensDesc>,
}

#[derive(Clone, Copy, Debug)]
pub struct LensDesc {
    pub aperture_radius: f64,
    /// Distance of the plane in focus along `forward`.
    pub focus_distance: f64,
}

#[derive(Clone, Debug)]
pub struct NamedMaterial {
    /// `id` in the file, or a made-up name that says where it stands.
    pub name: String,
    pub two_sided: bool,
    pub bsdf: BsdfDesc,
    /// What its own colour is multiplied by where it covers a mesh: that of the matt part, or of a mirror or metal.
    pub tint: Option<TintDesc>,
}

#[derive(Clone, Debug)]
pub enum TintDesc {
    /// The colours of the mesh's vertices.
    Vertices,
    /// A texture at the mesh's places in it, which `to_uv` moves: its rows are those of Mitsuba's matrix, without the last.
    Texture {
        texture: Arc<TextureDesc>,
        to_uv: [[f64; 3]; 2],
    },
}

impl TintDesc {
    /// `to_uv` that moves nothing.
    pub const IN_PLACE: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
}

/// A picture that is repeated; the first row is at v = 0.
#[derive(Clone, Debug)]
pub struct TextureDesc {
    pub name: String,
    pub width: u32,
    pub height: u32,
    /// Linear, 0 to 1, row after row.
    pub texels: Vec<Vec3>,
    /// Else bilinear, between the texels' middles.
    pub nearest: bool,
}

#[derive(Clone, Debug)]
pub enum BsdfDesc {
    Diffuse {
        reflectance: Vec3,
    },
    /// Smooth metal. `eta_k`: none for a perfect mirror (`material` none).
    Conductor {
        specular_reflectance: Vec3,
        eta_k: Option<(Vec3, Vec3)>,
    },
    Dielectric {
        int_ior: f64,
        ext_ior: f64,
        specular_reflectance: Vec3,
        specular_transmittance: Vec3,
    },
    /// Metal of GGX facets, with Smith's masking as the product of both directions', as in Mitsuba 3:
    /// f = F D G₁(wi) G₁(wo) / (4 cosθi cosθo). `eta_k` as above.
    RoughConductor {
        alpha: f64,
        specular_reflectance: Vec3,
        eta_k: Option<(Vec3, Vec3)>,
    },
    /// Glass of such facets (Walter et al. 2007), as in Mitsuba 3.
    RoughDielectric {
        alpha: f64,
        int_ior: f64,
        ext_ior: f64,
        specular_reflectance: Vec3,
        specular_transmittance: Vec3,
    },
    /// Rough diffuse, after Oren and Nayar; the formulas are `OrenNayarModel`'s.
    OrenNayar {
        reflectance: Vec3,
        /// Standard deviation of the facets' slope angle.
        sigma_degrees: f64,
        model: OrenNayarModel,
    },
    /// With kd, ks, n the fields in turn and H the half vector. `normalized`: f = kd/π + ks (n+8)/(8π) (N·H)ⁿ; else
    /// f cosθi = kd/π cosθi + ks/π (N·H)ⁿ. Zero unless both directions are above the surface.
    BlinnPhong {
        diffuse_reflectance: Vec3,
        specular_reflectance: Vec3,
        exponent: f64,
        normalized: bool,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrenNayarModel {
    /// The sum of both terms of the 1994 paper: direct illumination of the facets and one interreflection.
    Full,
    /// Its section 4.4, with A = 1 − s/(2 (s + 0.33)), s = σ².
    Qualitative,
    /// EON: Portsmouth, Kutz and Hill, "EON: A practical energy-preserving rough diffuse BRDF", JCGT 14(1), 2025: Fujii's
    /// single scattering plus its multiple scattering lobe, with the exact albedo. `reflectance` is its ρ, and its roughness
    /// r, 0 to 1, is σ / 90°.
    EnergyPreserving,
}

#[derive(Clone, Debug)]
pub struct ShapeDesc {
    /// `id` in the file, or "sphere at line 12".
    pub name: String,
    pub geometry: GeometryDesc,
    /// Index into `SceneDesc::materials`.
    pub material: usize,
    /// Radiance emitted on the side of the normal (spheres: outwards).
    pub emission: Option<Vec3>,
}

#[derive(Clone, Debug)]
pub enum GeometryDesc {
    Sphere {
        center: Vec3,
        radius: f64,
    },
    /// Unbounded.
    Plane {
        point: Vec3,
        normal: Vec3,
    },
    Disk {
        center: Vec3,
        normal: Vec3,
        radius: f64,
    },
    /// The parallelogram `center ± u ± v` with `u ⊥ v`; its normal is along `u × v`.
    Rectangle {
        center: Vec3,
        u: Vec3,
        v: Vec3,
    },
    Mesh(MeshDesc),
    Instance(InstanceDesc),
    Implicit(ImplicitDesc),
}

/// Triangles, counter-clockwise seen from the side of the normal.
#[derive(Clone, Debug, Default)]
pub struct MeshDesc {
    pub vertices: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// One unit normal a vertex for smooth shading; empty for flat faces.
    pub normals: Vec<Vec3>,
    /// One linear colour a vertex, or none.
    pub colors: Vec<Vec3>,
    /// One place (u, v) in a texture a vertex, or none.
    pub uvs: Vec<[f64; 2]>,
}

/// A mesh at a place of its own: scaled, turned so that its axes point along `axes`, and moved to `at`. Those of one `mesh`
/// share it.
#[derive(Clone, Debug)]
pub struct InstanceDesc {
    pub mesh: Arc<MeshDesc>,
    pub at: Vec3,
    /// Above 0.
    pub scale: f64,
    /// Where the mesh's axes point: orthonormal and right-handed.
    pub axes: [Vec3; 3],
}

impl InstanceDesc {
    pub fn direction(&self, v: Vec3) -> Vec3 {
        [0, 1, 2].map(|i| (0..3).map(|axis| self.axes[axis][i] * v[axis]).sum())
    }

    pub fn point(&self, q: Vec3) -> Vec3 {
        let turned = self.direction(q);
        [0, 1, 2].map(|i| self.at[i] + self.scale * turned[i])
    }

    /// A mesh of its own, in place.
    pub fn placed(&self) -> MeshDesc {
        MeshDesc {
            vertices: self.mesh.vertices.iter().map(|&v| self.point(v)).collect(),
            normals: self.mesh.normals.iter().map(|&n| self.direction(n)).collect(),
            ..(*self.mesh).clone()
        }
    }
}

#[derive(Clone, Debug)]
pub enum LightDesc {
    /// Radiant intensity, W·sr⁻¹.
    Point { position: Vec3, intensity: Vec3 },
    /// `direction` in which the light travels; irradiance on a plane facing it, W·m⁻².
    Directional { direction: Vec3, irradiance: Vec3 },
    /// The same radiance from everywhere.
    Constant { radiance: Vec3 },
    /// A sky that fades from zenith to horizon and on to the ground, and perhaps a sun in it.
    ///
    /// With s = d·`up`, the sine of the elevation of direction d: horizon + s (zenith − horizon) where s ≥ 0, and
    /// horizon − s (ground − horizon) below. The sun's radiance is added to that within its disk.
    Gradient {
        zenith: Vec3,
        horizon: Vec3,
        ground: Vec3,
        /// Unit.
        up: Vec3,
        sun: Option<SunDesc>,
    },
    /// Latitude-longitude picture, row-major, top row first.
    ///
    /// `to_world` holds the orthonormal directions of its axes: y towards the top row, z towards the picture's middle,
    /// x towards the middle of its left half. So a direction (x, y, z) in that frame meets the picture at
    /// u = atan2(x, -z) / 2π (modulo 1), v = acos(y) / π. As in Mitsuba 3, pixel (i, j) lies at u = (i + ½) / width, which
    /// wraps, and v = j / (height − 1): the top row is the north pole, the bottom one the south pole. Between pixels the
    /// radiance is bilinear.
    EnvMap {
        width: u32,
        height: u32,
        pixels: Vec<Vec3>,
        to_world: [Vec3; 3],
    },
}

/// A disk in the sky, of the same radiance all over: d is in it where the angle between d and `direction` is at most half
/// of `angle`. It is whole even below the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunDesc {
    /// Towards the sun; unit.
    pub direction: Vec3,
    pub radiance: Vec3,
    /// Angular diameter, degrees, above 0 and at most 90. A plane that faces the sun receives π sin²(angle/2) `radiance`.
    pub angle: f64,
}
