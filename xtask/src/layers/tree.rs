//! The core's files, with the paths between modules that each of them has.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};

use super::order;
use super::scan::{self, Used};

/// All files below `src/`, in the order of their names.
#[derive(Debug)]
pub struct Tree {
    pub files: Vec<File>,
    /// Names at the crate's root that are not rooms, with the room they come from.
    aliases: BTreeMap<String, String>,
}

/// One file.
#[derive(Debug)]
pub struct File {
    /// As a message shows it: `src/geom/ray.rs`.
    pub path: String,
    /// Its module, from the crate's root: `geom`, `ray`; empty for `lib.rs`.
    pub module: Vec<String>,
    pub uses: Vec<Used>,
    /// Declared under `#[cfg(test)]`.
    pub test_only: bool,
}

impl Tree {
    /// Reads the files below `src`, which must hold a `lib.rs`.
    pub fn read(src: &Path) -> Result<Tree> {
        let mut names = Vec::new();
        collect(src, "", &mut names)?;
        names.sort();
        let root = std::fs::read_to_string(src.join("lib.rs")).context("src/lib.rs")?;
        let mut aliases = scan::reexports(&root).context("src/lib.rs")?;
        let mut test_modules: Vec<Vec<String>> = Vec::new();
        let mut files = Vec::new();
        for name in names {
            let path = format!("src/{name}");
            let text = std::fs::read_to_string(src.join(&name)).with_context(|| path.clone())?;
            let module = module_of(&name);
            let scan = scan::scan(&text, &module).with_context(|| path.clone())?;
            test_modules.extend(scan.test_modules);
            if let Some(room) = module.first() {
                aliases.extend(scan.exported_macros.into_iter().map(|name| (name, room.clone())));
            }
            files.push(File {
                path,
                module,
                uses: scan.uses,
                test_only: false,
            });
        }
        for file in &mut files {
            file.test_only = test_modules.iter().any(|module| file.module.starts_with(module));
        }
        Ok(Tree { files, aliases })
    }

    /// Every room with its first file, rooms that only tests see left out.
    pub fn rooms(&self) -> BTreeMap<&str, &str> {
        let mut rooms = BTreeMap::new();
        for file in self.files.iter().filter(|file| !file.test_only) {
            if let Some(room) = file.module.first() {
                rooms.entry(room.as_str()).or_insert(file.path.as_str());
            }
        }
        rooms
    }

    /// The room that a name at the crate's root is or comes from.
    pub fn room_of<'a>(&'a self, name: &'a str) -> Option<&'a str> {
        let is_room = order::knows(name)
            || self
                .files
                .iter()
                .any(|file| file.module.first().is_some_and(|room| room == name));
        if is_room {
            Some(name)
        } else {
            self.aliases.get(name).map(String::as_str)
        }
    }
}

/// The `.rs` files below `folder`, as paths from `src` with forward slashes.
fn collect(folder: &Path, prefix: &str, names: &mut Vec<String>) -> Result<()> {
    for entry in folder.read_dir().with_context(|| folder.display().to_string())? {
        let entry = entry?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            collect(&entry.path(), &format!("{name}/"), names)?;
        } else if name.ends_with(".rs") {
            names.push(name);
        }
    }
    Ok(())
}

/// `geom/ray.rs` is `geom::ray`, `geom/mod.rs` is `geom`, `lib.rs` is the root.
fn module_of(name: &str) -> Vec<String> {
    let mut module: Vec<_> = name
        .trim_end_matches(".rs")
        .split('/')
        .map(str::to_string)
        .collect();
    let last = module.last().map_or("", String::as_str);
    if last == "mod" || name == "lib.rs" {
        module.pop();
    }
    module
}
