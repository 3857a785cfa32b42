//! Place holder for the built-in scenes of their own branch, with their interface.

use crate::desc::SceneDesc;

pub fn all() -> &'static [(&'static str, &'static str)] {
    &[("spheres", "three spheres on a plane")]
}

pub fn scene(_name: &str) -> Option<SceneDesc> {
    None
}
