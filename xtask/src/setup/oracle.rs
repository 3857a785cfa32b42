//! The third opinion: Mitsuba 3 and FLIP, in a Python environment of their own under `target/oracle`.

use std::process::Command;

use anyhow::Result;

use super::apt;
use crate::shell;

/// Pinned: a record that quotes them stays comparable.
const PACKAGES: [&str; 3] = ["mitsuba==3.9.1", "flip-evaluator==1.7", "numpy"];

pub fn install() -> Result<()> {
    let folder = shell::target_dir().join("oracle");
    let python = folder.join("bin/python");
    if !shell::have(&python) {
        if shell::ask(Command::new("python3").args(["-c", "import ensurepip"])).is_none() {
            apt::install(&["python3", "python3-venv"])?;
        }
        shell::run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    }
    shell::run(
        Command::new(&python)
            .args(["-m", "pip", "install", "--quiet"])
            .args(PACKAGES),
    )?;
    let imports = "import mitsuba, flip_evaluator, numpy; print('mitsuba', mitsuba.__version__, 'numpy', numpy.__version__)";
    shell::run(Command::new(&python).args(["-c", imports]))
}
