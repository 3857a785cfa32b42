//! Place holder for the importers of their own branch, with their interface.

use std::collections::BTreeMap;
use std::path::Path;

use crate::desc::SceneDesc;

#[derive(Clone, Debug, Default)]
pub struct Options {
    pub lenient: bool,
    pub parameters: BTreeMap<String, String>,
}

#[derive(Clone, Debug)]
pub struct Loaded {
    pub scene: SceneDesc,
    pub warnings: Vec<String>,
}

pub fn load(path: &Path, _options: &Options) -> Result<Loaded, String> {
    Err(format!("{}: this build reads no files; take one that has the importers", path.display()))
}
