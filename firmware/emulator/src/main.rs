//! `emulator bench`, `emulator run`, `emulator identity`, `emulator count`, `emulator profile`, `emulator rays`, `emulator denoiser`, `emulator raystones`, `emulator size`, `emulator faults`.

use std::{path::PathBuf, process::ExitCode};

use anyhow::{Context, Result};
use clap::{Args, Parser, Subcommand, ValueEnum, builder::PossibleValuesParser};
use emulator::{
    bench, count, denoiser, identity,
    machine::Machine,
    pico::{self, Screen},
    profile, rays, raystones, size,
};
use firmware_common::{
    flight,
    stage::NAMES,
    tile::{PASSES, Pass},
};
use xtask::board::Board;

/// Runs the firmware without a board
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs a board's firmware; fails unless it does what this computer does
    Run(Run),
    /// Runs the jobs on every machine; fails unless all agree
    Identity {
        /// Machines to compare, all if none is given
        #[arg(long, value_delimiter = ',')]
        machine: Vec<Machine>,
    },
    /// Counts instructions and Cortex-M0+ cycles of each job in QEMU; fails unless every run gives the same
    Count {
        /// Machines to count on, all of QEMU's if none is given
        #[arg(long, value_delimiter = ',')]
        machine: Vec<Machine>,
        /// Number of runs that must agree
        #[arg(long, default_value_t = 2)]
        runs: u32,
        /// Folder for a CSV of every address executed
        #[arg(long)]
        histograms: Option<PathBuf>,
    },
    /// Measures what pictures cost on each core, and the Pico's display, memory and stacks
    Bench {
        /// File for the rows: core, scene, instructions, m0plus_cycles, pixels, crc
        #[arg(long)]
        json: Option<PathBuf>,
        /// File for the tables, with date, commit and versions
        #[arg(long)]
        record: Option<PathBuf>,
        /// Number of runs that must agree
        #[arg(long, default_value_t = 2)]
        runs: u32,
    },
    /// Counts what the example `raystones` takes on each core; fails unless all draw the same
    Raystones {
        /// File for the rows: core, scene, instructions, m0plus_cycles, pixels, crc, helpers
        #[arg(long)]
        json: PathBuf,
    },
    /// Counts what each stage of the boards' pictures takes on four cores
    Profile {
        /// File for the rows: core, scene, pixels, rays, crc, stages, helpers, work
        #[arg(long)]
        json: PathBuf,
    },
    /// Counts what primary rays to a mesh in a room take on three cores, and paths in the Cornell box
    Rays {
        /// File for the rows: core, scene, form, rays, mesh, whole, work
        #[arg(long)]
        json: PathBuf,
        /// OBJ file to look at beside the torus knot; any number of times
        #[arg(long)]
        mesh: Vec<PathBuf>,
    },
    /// Counts what each stage of the denoiser takes on four cores
    Denoiser {
        /// File for the rows: core, pixels, crc, stages
        #[arg(long)]
        json: PathBuf,
    },
    /// Builds every board's firmware and prints the flash and RAM it takes
    Size,
    /// Makes the Pico's firmware fail on purpose and checks what it shows
    Faults,
}

const SCENES: [&str; 4] = [NAMES[0], NAMES[1], flight::NAMES[0], flight::NAMES[1]];

#[derive(Args)]
struct Run {
    /// `pico`, or a machine that runs the jobs: microbit, mps2-an385, ...
    #[arg(long, default_value = "pico", value_parser = emulated)]
    board: Board,
    /// File for what the Pico's display shows
    #[arg(long)]
    png: Option<PathBuf>,
    /// File for the Pico's times, cycles, stacks and faults
    #[arg(long)]
    json: Option<PathBuf>,
    /// The Pico's display
    #[arg(long, default_value = "240x240")]
    screen: Screen,
    /// What the Pico draws before its run ends: cornell, mesh, or a flight past the first, denoised by either filter
    #[arg(long, default_value = NAMES[0], value_parser = PossibleValuesParser::new(SCENES))]
    scene: String,
    /// Frames of a flight
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=i64::from(flight::FRAMES)))]
    frames: u32,
    /// Flights fill 240 x 240 pixels, 3 x 3 for each rendered one, instead of 160 x 120, 2 x 2 for each
    #[arg(long)]
    full: bool,
    /// Samples a pixel in the pass after which the run ends, 1 to 16 by powers of two; 0 for the preview
    #[arg(long, default_value_t = 1)]
    spp: u32,
    /// OBJ file to bake in instead of the torus knot; the scene is then `mesh`
    #[arg(long)]
    mesh: Option<PathBuf>,
    /// Emulated seconds after which the Pico counts as hung
    #[arg(long, default_value_t = 600)]
    seconds: u32,
    /// No progress
    #[arg(long)]
    quiet: bool,
}

/// A board that something emulates.
fn emulated(name: &str) -> Result<Board, String> {
    Board::from_str(name, false).and_then(|board| {
        let emulator = board.emulated_by();
        emulator
            .map(|_| board)
            .ok_or_else(|| format!("no emulator runs {name}"))
    })
}

fn run(options: &Run) -> Result<()> {
    match options.board {
        Board::Pico => pico::run(&pico::Run {
            screen: options.screen,
            goal: goal(options)?,
            mesh: options.mesh.as_deref(),
            png: options.png.as_deref(),
            json: options.json.as_deref(),
            seconds: options.seconds,
            quiet: options.quiet,
        })
        .map(|_| ()),
        board => identity::check(&[Machine::Host, Machine::Emulated(board)]),
    }
}

fn goal(options: &Run) -> Result<pico::Goal> {
    if let Some(flight) = flight::NAMES.iter().position(|name| *name == options.scene) {
        return Ok(pico::Goal::Flight {
            flight,
            frames: options.frames,
            full: options.full,
        });
    }
    let is_asked = |pass: &Pass| {
        if options.spp == 0 {
            pass.block > 1
        } else {
            pass.block == 1 && pass.spp == options.spp
        }
    };
    let scene = NAMES.iter().position(|name| {
        *name
            == if options.mesh.is_some() {
                "mesh"
            } else {
                &*options.scene
            }
    });
    Ok(pico::Goal::Still {
        scene: scene.context("no such scene")?,
        pass: PASSES
            .into_iter()
            .find(is_asked)
            .with_context(|| format!("no pass has {} samples a pixel", options.spp))?,
    })
}

fn execute(command: Command) -> Result<()> {
    match command {
        Command::Run(options) => run(&options),
        Command::Bench { json, record, runs } => bench::run(&bench::Options {
            runs,
            json: json.as_deref(),
            record: record.as_deref(),
        }),
        Command::Raystones { json } => raystones::run(&json),
        Command::Profile { json } => profile::run(&json),
        Command::Rays { json, mesh } => rays::run(&json, &mesh),
        Command::Denoiser { json } => denoiser::run(&json),
        Command::Size => size::table(),
        Command::Faults => pico::faults(),
        Command::Identity { machine } => identity::check(if machine.is_empty() {
            &Machine::ALL
        } else {
            &machine
        }),
        Command::Count {
            machine,
            runs,
            histograms,
        } => {
            let machines = if machine.is_empty() {
                Machine::ALL
                    .into_iter()
                    .filter(|machine| machine.in_qemu())
                    .collect()
            } else {
                machine
            };
            count::table(&machines, runs, histograms.as_deref())
        }
    }
}

fn main() -> ExitCode {
    match execute(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("emulator: {error:#}");
            ExitCode::FAILURE
        }
    }
}
