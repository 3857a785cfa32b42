//! Light transport: what radiance comes back along a ray.

mod ambient_occlusion;
mod bdpt;
mod features;
mod integrate;
mod light_tracer;
mod mis;
mod path;

pub use ambient_occlusion::AmbientOcclusion;
pub use bdpt::{Bdpt, Strategy, Tally};
pub use features::{Features, First, NoWitness, Witness, features, first};
pub use integrate::{Integrator, NoSplats, SplatSink, View};
pub use light_tracer::LightTracer;
pub use mis::power_heuristic;
pub use path::Path;
