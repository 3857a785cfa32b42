//! Light transport: what radiance comes back along a ray.

mod mis;
mod path;

pub use mis::power_heuristic;
pub use path::Path;
