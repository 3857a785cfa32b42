//! Pictures that host-sim rendered, as numbers.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};

use crate::accuracy::Case;
use crate::shell;

/// Light above counts as this, as in every error of the project.
pub const CAP: f32 = 8.0;

/// Linear light; rows from the bottom up, as a PFM has them.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub width: usize,
    pub pixels: Vec<[f32; 3]>,
}

/// Lets host-sim render a case.
pub fn render(host_sim: &Path, case: &Case, arguments: &[&str]) -> Result<Picture> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("picture.pfm");
    let mut command = Command::new(host_sim);
    command.args(["render", &case.scene, "--quiet", "-o"]).arg(&file);
    command.args(arguments).current_dir(&case.folder);
    if let Some((name, value)) = &case.definition {
        command.arg("-D").arg(format!("{name}={value}"));
    }
    shell::run(&mut command)?;
    read_pfm(&std::fs::read(&file)?).context("host-sim wrote no picture")
}

/// A colour PFM, little-endian.
fn read_pfm(bytes: &[u8]) -> Option<Picture> {
    let mut rest = bytes;
    let mut words = Vec::new();
    while words.len() < 4 {
        let end = rest.iter().position(u8::is_ascii_whitespace)?;
        words.push(std::str::from_utf8(&rest[..end]).ok()?);
        rest = &rest[end + 1..];
    }
    let (width, height): (usize, usize) = (words[1].parse().ok()?, words[2].parse().ok()?);
    if words[0] != "PF" || !words[3].starts_with('-') || rest.len() != 12 * width * height {
        return None;
    }
    let channel = |b: &[u8]| b.try_into().map(f32::from_le_bytes).unwrap_or_default();
    let pixel = |b: &[u8]| [channel(&b[..4]), channel(&b[4..8]), channel(&b[8..])];
    Some(Picture {
        width,
        pixels: rest.chunks_exact(12).map(pixel).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pfm_is_read() {
        let mut bytes = b"PF\n2 1\n-1.0\n".to_vec();
        for value in [1.0f32, 2.0, 3.0, 4.0, 5.0, 6.0] {
            bytes.extend(value.to_le_bytes());
        }
        let picture = read_pfm(&bytes).unwrap();
        assert_eq!(picture.width, 2);
        assert_eq!(picture.pixels, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        bytes.pop();
        assert!(read_pfm(&bytes).is_none());
    }
}
