//! What is measured.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::shell;

/// One scene with one integrator.
pub struct Case {
    pub name: String,
    /// As host-sim is told it, in [`Case::folder`].
    pub scene: String,
    pub folder: PathBuf,
    /// `NAME=VALUE` of the scene file.
    pub definition: Option<(&'static str, String)>,
    /// The scene's own if there is none.
    pub integrator: Option<&'static str>,
    /// Where Mitsuba's picture of the scene lies, or will lie once it is made.
    pub reference: Option<PathBuf>,
}

/// A scene that Mitsuba can render.
pub struct MitsubaScene<'a> {
    pub file: PathBuf,
    pub definition: Option<(&'static str, &'a str)>,
    pub reference: &'a Path,
}

impl Case {
    pub fn label(&self) -> String {
        format!(
            "{}, integrator: {}",
            self.name,
            self.integrator.unwrap_or("its own")
        )
    }

    pub fn mitsuba(&self) -> Option<MitsubaScene<'_>> {
        Some(MitsubaScene {
            file: self.folder.join(&self.scene),
            definition: self
                .definition
                .as_ref()
                .map(|(name, value)| (*name, value.as_str())),
            reference: self.reference.as_deref()?,
        })
    }
}

/// Every built-in scene with both integrators.
pub fn built_in(host_sim: &Path) -> Result<Vec<Case>> {
    let list = shell::ask(Command::new(host_sim).arg("scenes")).context("`host-sim scenes` failed")?;
    let names = list.lines().filter_map(|line| line.split_whitespace().next());
    let both = names.flat_map(|name| ["direct", "path"].map(|integrator| (name, integrator)));
    Ok(both
        .map(|(name, integrator)| Case {
            name: name.to_string(),
            scene: name.to_string(),
            folder: shell::root(),
            definition: None,
            integrator: Some(integrator),
            reference: None,
        })
        .collect())
}

/// The scene files of a folder that Mitsuba has rendered into `reference/`, by name; none if there is no such folder.
pub fn files(folder: &Path) -> Result<Vec<Case>> {
    let Ok(entries) = folder.read_dir() else {
        return Ok(Vec::new());
    };
    let mut cases = Vec::new();
    for entry in entries {
        let file = entry?.path();
        let Some(name) = file.file_stem().and_then(|name| name.to_str()) else {
            continue;
        };
        let reference = folder.join("reference").join(name).with_extension("exr");
        if file.extension().is_some_and(|ending| ending == "xml") && reference.is_file() {
            cases.push(Case {
                name: format!("{name}.xml"),
                scene: format!("{name}.xml"),
                folder: folder.to_path_buf(),
                definition: None,
                integrator: None,
                reference: Some(reference),
            });
        }
    }
    cases.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(cases)
}

/// The bunny on a floor, in a scene of our own that is written to `scratch`; nothing if there is no such mesh.
pub fn bunny(mesh: &Path, scratch: &Path) -> Result<Option<Case>> {
    let Ok(mesh) = mesh.canonicalize() else {
        return Ok(None);
    };
    std::fs::write(scratch.join("bunny.xml"), include_str!("bunny.xml"))?;
    Ok(Some(Case {
        name: "bunny.xml".to_string(),
        scene: "bunny.xml".to_string(),
        folder: scratch.to_path_buf(),
        definition: Some(("mesh", mesh.display().to_string())),
        integrator: None,
        reference: Some(shell::target_dir().join("accuracy/bunny.exr")),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_scenes_with_a_picture_are_taken() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("reference")).unwrap();
        for file in [
            "b.xml",
            "a.xml",
            "dark.xml",
            "a.txt",
            "reference/a.exr",
            "reference/b.exr",
        ] {
            std::fs::write(folder.path().join(file), "").unwrap();
        }
        let names: Vec<_> = files(folder.path())
            .unwrap()
            .into_iter()
            .map(|case| case.name)
            .collect();
        assert_eq!(names, ["a.xml", "b.xml"]);
        assert!(files(&folder.path().join("missing")).unwrap().is_empty());
    }

    #[test]
    fn without_a_mesh_there_is_no_bunny() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = folder.path().join("bunny.obj");
        assert!(bunny(&mesh, folder.path()).unwrap().is_none());
        std::fs::write(&mesh, "").unwrap();
        assert!(bunny(&mesh, folder.path()).unwrap().is_some());
        assert!(folder.path().join("bunny.xml").is_file());
    }
}
