//! An independent renderer in f64: slow, simple, and the judge of the fixed-point one.
//!
//! Written from the papers named at each formula. It shares no line with the core: not the numbers, not the types, not
//! the sampling; a scene reaches it as plain data (`Scene`). Both mean by that data what Mitsuba 3 means.
//!
//! Russian roulette, strata and the choice of light samples are its own and change the noise, never the mean.

mod bsdf;
mod camera;
mod implicit;
mod integrate;
mod light;
mod mesh;
mod render;
mod rng;
mod scene;
mod shape;
mod sky;
mod strata;
mod texture;
mod tree;
mod vec;
mod warp;

pub use bsdf::{Bounce, Surface};
pub use camera::primary_ray;
pub use implicit::{Ball, Bound, Capsule, Implicit, Part};
pub use mesh::{Mesh, TriangleHit};
pub use render::{Estimator, Image, Rendering, Settings, render};
pub use scene::{Camera, Geometry, Lens, Light, Material, OrenNayarModel, Ray, Scene, Shape, extent};
pub use shape::{Hit, closest, occluded};
pub use sky::{Gradient, Map, Sky, Sun};
pub use texture::{Texture, Tint};
pub use vec::{Rgb, Vec3, vec3};
