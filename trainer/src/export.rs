//! Weights as Rust source, with their checksum and where they come from.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, anyhow, ensure};
use microlux::film::denoise::network::{BIASES, LAYERS, WEIGHTS, Weights};
use microlux::num::Crc;

use crate::nn::{Mode, Params};
use crate::scenes::Split;
use crate::train::State;

#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// What `train` left
    #[arg(long, default_value = "state.bin")]
    state: PathBuf,
    /// The data it was trained with, for its checksum
    #[arg(long, default_value = "data")]
    data: PathBuf,
    /// How it was trained, as the weights' provenance says it
    #[arg(long, default_value = "trainer/log/train.txt")]
    log_name: String,
    /// The source that is written
    #[arg(long, default_value = "../src/film/denoise/network/weights.rs")]
    out: PathBuf,
}

const NAMES: [&str; LAYERS.len()] = [
    "1/1: what is seen",
    "1/2",
    "1/4",
    "1/8",
    "1/8, once more",
    "1/4: merge",
    "1/4",
    "1/2: merge",
    "1/2",
    "1/1: merge",
    "1/1",
    "1/1: head",
    "1/2: head",
    "1/4: head",
    "1/8: head",
];

/// Weights as the core has them.
pub fn rounded(params: &Params) -> Result<(Box<[i8; WEIGHTS]>, Box<[i16; BIASES]>)> {
    let seen = params.seen(Mode::Integer);
    let weights: Vec<i8> = seen.weights.iter().map(|&w| w as i8).collect();
    let biases: Vec<i16> = seen.biases.iter().map(|&b| b as i16).collect();
    let other = || anyhow!("size {}: the core has size xs", params.size.name());
    let weights: Box<[i8; WEIGHTS]> = weights.try_into().map_err(|_| other())?;
    let biases: Box<[i16; BIASES]> = biases.try_into().map_err(|_| other())?;
    Weights::new(&weights, &biases).map_err(|error| anyhow!("{error:?}: sums do not fit"))?;
    Ok((weights, biases))
}

pub fn run(options: &Options) -> Result<()> {
    let state = State::read(&options.state)?;
    let (weights, biases) = rounded(&state.params)?;
    let mut crc = Crc::new();
    weights.iter().for_each(|&w| crc.bytes(&w.to_le_bytes()));
    biases.iter().for_each(|&b| crc.bytes(&b.to_le_bytes()));
    let commit = output("git", &["rev-parse", "--short=12", "HEAD"])?;
    let date = output("date", &["-u", "+%Y-%m-%d"])?;
    let (scenes, data) = checksum(&options.data.join(Split::Train.name()))?;

    let mut text = String::new();
    writeln!(
        text,
        "//! The network's weights. Written by `trainer export`; not to be edited.
//!
//! {} steps (`{}`) over {scenes} scenes (CRC-32 of their files, in order of names: {data:#010x}); trainer of
//! commit {commit}, {date}.

use super::layer::{{BIASES, WEIGHTS, Weights}};

/// CRC-32 of the weights, then of the biases, little end first.
pub const CHECKSUM: u32 = {:#010x};

/// The weights that come with the crate.
pub static TRAINED: Weights<'static> = match Weights::new(&TABLE, &BIAS) {{
    Ok(weights) => weights,
    Err(_) => panic!(\"sums must fit 16 bits\"),
}};
",
        state.step,
        options.log_name,
        crc.value()
    )?;
    writeln!(text, "#[rustfmt::skip]\nstatic TABLE: [i8; WEIGHTS] = [")?;
    for (number, layer) in LAYERS.iter().enumerate() {
        let (from, _) = state.params.size.place(number);
        let part = &weights[from..][..layer.weights()];
        lines(&mut text, NAMES[number], part.iter().map(|w| i32::from(*w)))?;
    }
    writeln!(text, "];\n\n#[rustfmt::skip]\nstatic BIAS: [i16; BIASES] = [")?;
    for (number, layer) in LAYERS.iter().enumerate() {
        let (_, from) = state.params.size.place(number);
        lines(
            &mut text,
            NAMES[number],
            biases[from..][..layer.outputs].iter().map(|b| i32::from(*b)),
        )?;
    }
    writeln!(text, "];")?;
    fs::write(&options.out, text).with_context(|| format!("{}", options.out.display()))?;
    println!(
        "{}: {} weights, {} biases, CRC-32 {:#010x}",
        options.out.display(),
        WEIGHTS,
        BIASES,
        crc.value()
    );
    Ok(())
}

fn lines(text: &mut String, name: &str, numbers: impl Iterator<Item = i32>) -> Result<()> {
    writeln!(text, "    // {name}")?;
    let mut line = String::from("   ");
    for number in numbers {
        let more = format!(" {number},");
        if line.len() + more.len() > 110 {
            writeln!(text, "{line}")?;
            line = String::from("   ");
        }
        line += &more;
    }
    Ok(writeln!(text, "{line}")?)
}

fn output(program: &str, arguments: &[&str]) -> Result<String> {
    let output = Command::new(program)
        .args(arguments)
        .output()
        .with_context(|| program.to_string())?;
    ensure!(output.status.success(), "{program}: {}", output.status);
    Ok(String::from_utf8(output.stdout)?.trim().to_string())
}

/// How many files a folder has, and the checksum of all.
fn checksum(folder: &std::path::Path) -> Result<(usize, u32)> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .with_context(|| format!("{}", folder.display()))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<_>>()?;
    files.retain(|file| file.extension().is_some_and(|e| e == "shot"));
    files.sort();
    let mut crc = Crc::new();
    for file in &files {
        crc.bytes(&fs::read(file)?);
    }
    Ok((files.len(), crc.value()))
}
