//! Light transport: what radiance comes back along a ray.

mod features;
mod mis;
mod path;

pub use features::{Features, features};
pub use mis::power_heuristic;
pub use path::Path;
