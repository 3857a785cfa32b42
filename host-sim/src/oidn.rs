//! Intel Open Image Denoise by its own program, `oidnDenoise`: a peer, never a part.
//!
//! The Python package `pyoidn` has it, with its weights (`pip install pyoidn`, the folder `pyoidn/oidn` of its site-packages).

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::picture::{Format, Picture, Style, decode_pfm};

const PROGRAM: &str = "oidnDenoise";

/// Where the program is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Oidn {
    program: PathBuf,
}

/// Which of its networks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// 320 thousand weights.
    Fast,
    /// 920 thousand.
    High,
    /// 3.85 million: albedo and normals have no noise.
    HighClean,
}

/// Light, and what is seen first, a pixel each.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    pub width: usize,
    pub light: &'a [[f32; 3]],
    pub albedo: &'a [[f32; 3]],
    pub normal: &'a [[f32; 3]],
}

impl Oidn {
    /// In a folder: itself, or its `bin`.
    pub fn at(folder: &Path) -> Result<Oidn, String> {
        let places = [folder.join("bin").join(PROGRAM), folder.join(PROGRAM)];
        match places.into_iter().find(|place| place.is_file()) {
            Some(program) => Ok(Oidn { program }),
            None => Err(format!(
                "{}: no {PROGRAM} and no bin/{PROGRAM} is in this folder; pip install pyoidn, and name its folder \
                 pyoidn/oidn",
                folder.display()
            )),
        }
    }

    /// In a folder of `PATH`.
    pub fn found() -> Option<Oidn> {
        let folders = env::var_os("PATH")?;
        let programs = env::split_paths(&folders).map(|folder| folder.join(PROGRAM));
        let program = programs.into_iter().find(|place| place.is_file())?;
        Some(Oidn { program })
    }

    /// The light without its noise.
    pub fn denoise(&self, quality: Quality, input: Input) -> Result<Vec<[f32; 3]>, String> {
        let failed = |what: &dyn std::fmt::Display| format!("{}: {what}", self.program.display());
        let folder = tempfile::tempdir().map_err(|error| failed(&error))?;
        let file = |name: &str| folder.path().join(name);
        for (name, pixels) in [
            ("light.pfm", input.light),
            ("albedo.pfm", input.albedo),
            ("normal.pfm", input.normal),
        ] {
            let picture = Picture {
                width: input.width,
                height: pixels.len() / input.width.max(1),
                rgb: pixels.to_vec(),
                ..Picture::default()
            };
            let bytes = Format::Pfm.encode(&picture, &Style::default())?;
            fs::write(file(name), bytes).map_err(|error| failed(&error))?;
        }
        let mut command = Command::new(&self.program);
        // The package's libraries are beside its programs.
        if let Some(root) = self.program.parent().and_then(Path::parent) {
            command.env("LD_LIBRARY_PATH", root.join("lib"));
        }
        let name = match quality {
            Quality::Fast => "fast",
            Quality::High | Quality::HighClean => "high",
        };
        command
            .args(["-d", "cpu", "-q", name, "--hdr"])
            .arg(file("light.pfm"));
        command.arg("--alb").arg(file("albedo.pfm"));
        command.arg("--nrm").arg(file("normal.pfm"));
        if quality == Quality::HighClean {
            command.arg("--clean_aux");
        }
        let output = command.arg("-o").arg(file("out.pfm")).output();
        let output = output.map_err(|error| failed(&error))?;
        if !output.status.success() {
            return Err(failed(&String::from_utf8_lossy(&output.stderr).trim()));
        }
        let bytes = fs::read(file("out.pfm")).map_err(|error| failed(&error))?;
        Ok(decode_pfm(&bytes).map_err(|error| failed(&error))?.rgb)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_the_program_says_how_to_get_it() {
        let folder = tempfile::tempdir().unwrap();
        let told = Oidn::at(folder.path()).unwrap_err();
        assert!(told.contains("pip install pyoidn"), "{told}");
        fs::create_dir(folder.path().join("bin")).unwrap();
        fs::write(folder.path().join("bin/oidnDenoise"), "").unwrap();
        assert!(Oidn::at(folder.path()).is_ok() && Oidn::at(&folder.path().join("bin")).is_ok());
    }

    /// A program that gives back its first input stands for it.
    #[cfg(unix)]
    #[test]
    fn what_the_program_writes_comes_back() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join(PROGRAM);
        let write = |text: &str| {
            fs::write(&program, text).unwrap();
            fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        };
        // $6 is what comes after --hdr, the last argument what comes after -o.
        write(
            "#!/bin/sh\nfor last; do :; done\n\
             case \"$*\" in *\"-q high \"*\"--alb \"*albedo.pfm\" --nrm \"*normal.pfm\" --clean_aux \"*) ;; *) exit 1 ;; esac\n\
             cp \"$6\" \"$last\"\n",
        );
        let light = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        let input = Input {
            width: 1,
            light: &light,
            albedo: &[[0.5; 3]; 2],
            normal: &[[0.0; 3]; 2],
        };
        let oidn = Oidn::at(folder.path()).unwrap();
        assert_eq!(oidn.denoise(Quality::HighClean, input).unwrap(), light);
        write(
            "#!/bin/sh\ncase \"$*\" in *clean_aux*) ;; *\"-q fast \"*) echo no device >&2 ;; esac\nexit 1\n",
        );
        let told = oidn.denoise(Quality::Fast, input).unwrap_err();
        assert!(told.ends_with("oidnDenoise: no device"), "{told}");
    }
}
