//! The Pico: its firmware in the RP2040 emulator, with the display model on its SPI bus.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::Mutex,
    time::Duration,
};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use firmware_bake::{Aligned, Baked};
use firmware_common::{
    denoise::Way,
    flight::{self, FULL, Flight, Form, FullRoom, Refused, SMALL, SmallRoom},
    mesh,
    stage::{Cornell, NAMES, Pedestal, Stage},
    tile::{self, Frame, Painter, Pass},
};
use microlux::film::denoise::Alone;
use microlux::num::Crc;
use microlux::scene;
use serde_json::Value;

use crate::{
    process, size,
    stack::{self, Depth, Root},
    toolchain::{self, Build},
};

/// Longest emulation, whatever it does.
const LIMIT: Duration = Duration::from_secs(1200);

/// What is wired to the Pico.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Screen {
    #[value(name = "240x240")]
    Square,
    #[value(name = "320x240")]
    Wide,
}

impl Screen {
    const fn frame(self) -> Frame {
        match self {
            Self::Square => tile::SQUARE,
            Self::Wide => tile::WIDE,
        }
    }

    const fn size(self) -> &'static str {
        match self {
            Self::Square => "240x240",
            Self::Wide => "320x240",
        }
    }
}

/// What the firmware draws, and when it has drawn enough.
#[derive(Clone, Copy, Debug)]
pub enum Goal {
    /// A scene by its place in [`NAMES`], and the pass of [`tile::PASSES`] to wait for.
    Still { scene: usize, pass: Pass },
    /// So many frames of a flight, by its place in [`flight::WAYS`]; `full` ones fill the display.
    Flight { flight: usize, frames: u32, full: bool },
}

impl Goal {
    /// What the firmware calls it.
    pub const fn scene(self) -> &'static str {
        match self {
            Self::Still { scene, .. } => NAMES[scene],
            Self::Flight { flight, .. } => flight::NAMES[flight],
        }
    }

    fn is_full(self) -> bool {
        matches!(self, Self::Flight { full: true, .. })
    }

    /// The line that the firmware prints when it is there.
    fn line(self) -> String {
        let scene = self.scene();
        match self {
            Self::Still {
                pass: Pass { block, spp },
                ..
            } => format!("frame scene={scene} block={block} spp={spp} "),
            Self::Flight { frames, .. } => {
                format!("frame scene={scene} number={} ", frames.saturating_sub(1))
            }
        }
    }
}

/// A run of the Pico's firmware.
pub struct Run<'a> {
    pub screen: Screen,
    pub goal: Goal,
    /// OBJ file to bake in instead of the torus knot.
    pub mesh: Option<&'a Path>,
    /// Receives what the display shows.
    pub png: Option<&'a Path>,
    /// Receives times, cycles, stacks and faults.
    pub json: Option<&'a Path>,
    /// Emulated seconds after which to give up.
    pub seconds: u32,
    pub quiet: bool,
}

/// What a run came to.
pub struct Shown {
    /// Red, green, blue of each pixel, as the display shows it.
    pub rgb: Vec<u8>,
    /// Times, cycles, stacks and faults, as `emulator/rp2040/run.mjs` writes them.
    pub report: Value,
    /// Rays that this computer asked of the scene for the same pass; 0 of a flight.
    pub rays: u32,
    /// Both cores' stacks.
    pub depths: Vec<Depth>,
}

/// Bytes of each core's stack: `memory.x` and `firmware/pico/src/app.rs`.
const STACKS: [u64; 2] = [16 * 1024, 10 * 1024];
/// Bytes at the lower end that the guard may take: its own 256, core 1's placed where the protection unit can.
const GUARDS: [u64; 2] = [256, 512];

/// Draws up to the goal and compares what the display shows with what this computer renders.
pub fn run(run: &Run) -> Result<Shown> {
    let mesh = match run.mesh {
        Some(file) => fs::canonicalize(file).with_context(|| file.display().to_string())?,
        None => PathBuf::new(),
    };
    let program = build(run.screen, run.goal.is_full(), run.goal.scene(), "", &mesh)?;
    let size = size::of(&program)?;
    println!(
        "flash {} bytes, RAM {} bytes without core 0's stack",
        size.flash, size.ram
    );
    let rgb = program.with_extension("rgb");
    let json = program.with_extension("json");
    let each = program.with_extension("each");
    for file in [&rgb, &json, &each] {
        remove(file)?;
    }
    let mut emulator = emulator(&program)?;
    emulator.arg("--each").arg(&each);
    emulator
        .args(["--size", run.screen.size(), "--until", &run.goal.line(), "--rgb"])
        .arg(&rgb);
    emulator.args(["--seconds", &run.seconds.to_string()]);
    if let Some(file) = run.png {
        emulator.arg("--png").arg(file);
    }
    emulator.arg("--json").arg(&json);
    if run.quiet {
        emulator.arg("--quiet");
    }
    let finished = process::run(&mut emulator, LIMIT, true)?;
    ensure!(
        finished.status.success(),
        "the emulator ended with {}\n{}",
        finished.status,
        finished.stdout
    );
    print!("{}", finished.stdout);
    let shown = fs::read(&rgb).with_context(|| rgb.display().to_string())?;
    let baked = match run.mesh {
        Some(file) => Some(bake(file)?),
        None => None,
    };
    let width = run.screen.frame().width();
    let rays = match run.goal {
        Goal::Still { scene, pass } => {
            let (expected, rays) = colours(run.screen.frame(), scene, pass, baked.as_ref())?;
            same(&shown, &expected, width)?;
            println!("the display shows what this computer renders, bit for bit");
            rays
        }
        Goal::Flight { flight, frames, full } => {
            let seen = fs::read(&each).with_context(|| each.display().to_string())?;
            let (frame, way) = (run.screen.frame(), flight::WAYS[flight]);
            let expected = if full {
                let mut room = Box::new(FullRoom::EMPTY);
                let flight = Flight::new(FULL.size, &mut room);
                flown::<{ FULL.scale }, { FULL.width() }>(FULL, flight, frame, way, frames)?
            } else {
                let mut room = Box::new(SmallRoom::EMPTY);
                let flight = Flight::new(SMALL.size, &mut room);
                flown::<{ SMALL.scale }, { SMALL.width() }>(SMALL, flight, frame, way, frames)?
            };
            ensure!(
                seen.len() == expected.len() * shown.len(),
                "the display was seen after {} frames, {frames} expected",
                seen.len() / shown.len()
            );
            for (number, (seen, expected)) in seen.chunks_exact(shown.len()).zip(&expected).enumerate() {
                same(seen, expected, width).with_context(|| format!("frame {number}"))?;
                let mut crc = Crc::new();
                crc.bytes(seen);
                println!(
                    "frame {number} crc32={:08x}, as this computer has it",
                    crc.value()
                );
            }
            0
        }
    };
    let report = fs::read_to_string(&json).with_context(|| json.display().to_string())?;
    if let Some(file) = run.json {
        fs::write(file, &report).with_context(|| file.display().to_string())?;
    }
    let report: Value = serde_json::from_str(&report)?;
    if let Some(cycles) = cycles_a_ray(&report, rays) {
        println!(
            "{rays} rays in the last pass; {cycles:.0} cycles of both cores for each, shading and display with them"
        );
    }
    let depths = stacks(&program, run.goal.scene(), &report)?;
    for Depth {
        name,
        measured,
        bound,
        room,
    } in &depths
    {
        println!(
            "{name}: a stack of {measured} bytes, {} at most, {room} there",
            bound.bytes + bound.exception
        );
    }
    Ok(Shown {
        depths,
        rgb: shown,
        report,
        rays,
    })
}

/// Both cores' stacks, measured and bounded; fails if they do not agree or do not fit.
fn stacks(program: &Path, scene: &str, report: &Value) -> Result<Vec<Depth>> {
    let mut depths = bounds(program, &format!("pico, {scene}"))?;
    for (depth, measured) in depths
        .iter_mut()
        .zip([0, 1].map(|core| &report["stack_bytes"][core]))
    {
        depth.measured = measured.as_u64().context("no stack in the emulator's report")?;
        depth.check()?;
    }
    Ok(depths)
}

/// What both cores' stacks can take in a Pico's or a Pico 2's program, where nothing was measured; fails if they do not fit.
pub fn bounds(program: &Path, name: &str) -> Result<Vec<Depth>> {
    let mut depths = Vec::new();
    for (core, root) in [Root::Reset, Root::Core1].into_iter().enumerate() {
        let depth = Depth {
            name: format!("{name}, core {core}"),
            measured: 0,
            bound: stack::bound(program, root)?,
            room: STACKS[core] - GUARDS[core],
        };
        depth.check()?;
        depths.push(depth);
    }
    Ok(depths)
}

/// Between the end of the last pass but one and that of the last.
fn cycles_a_ray(report: &Value, rays: u32) -> Option<f64> {
    let [.., before, last] = &report["frame_ms"].as_array()?[..] else {
        return None;
    };
    let seconds = (last.as_f64()? - before.as_f64()?) / 1e3;
    (rays > 0).then_some(2.0 * seconds * report["clock_hz"].as_f64()? / f64::from(rays))
}

fn bake(file: &Path) -> Result<Baked> {
    let name = || file.display().to_string();
    let text = fs::read_to_string(file).with_context(name)?;
    let baked = firmware_bake::obj(&text)
        .map_err(anyhow::Error::msg)
        .with_context(name)?;
    let bytes = baked.blob().map_err(anyhow::Error::msg)?.len();
    println!("{}: {} triangles, {bytes} bytes", name(), baked.triangles.len());
    Ok(baked)
}

/// Makes the firmware fail on purpose in each way, and checks the line and the colour it ends with.
pub fn faults() -> Result<()> {
    const RED: [u8; 3] = [255, 0, 0];
    const MAGENTA: [u8; 3] = [255, 0, 255];
    const YELLOW: [u8; 3] = [255, 255, 0];
    let cases = [
        ("panic", "stopped: panic", RED),
        ("panic-1", "stopped: panic", RED),
        ("address", "stopped: fault", MAGENTA),
        ("address-1", "stopped: fault", MAGENTA),
        ("stack", "stopped: fault", MAGENTA),
        ("stack-1", "stopped: fault", MAGENTA),
        ("hang", "stopped: watchdog", YELLOW),
    ];
    for (fault, line, colour) in cases {
        let program = build(Screen::Square, false, NAMES[0], fault, Path::new(""))?;
        let rgb = program.with_extension("rgb");
        remove(&rgb)?;
        let mut emulator = emulator(&program)?;
        emulator
            .args([
                "--quiet",
                "--until",
                "stopped",
                "--after",
                "200",
                "--seconds",
                "20",
                "--rgb",
            ])
            .arg(&rgb);
        let finished = process::run(&mut emulator, LIMIT, false)?;
        ensure!(
            finished.status.success(),
            "{fault}: {}\n{}",
            finished.status,
            finished.stderr
        );
        ensure!(
            finished.stdout.lines().any(|l| l == line),
            "{fault}: no line {line:?} in {:?}",
            finished.stdout
        );
        let shown = fs::read(&rgb)?;
        ensure!(
            shown.chunks_exact(3).all(|pixel| pixel == colour),
            "{fault}: the display is not all {colour:?}"
        );
        println!("{fault:<9} {line:<17} display {colour:?}");
    }
    Ok(())
}

/// The emulator for a program of `firmware/qemu`, which prints by semihosting and exits.
pub fn bare(program: &Path) -> Result<Command> {
    let mut emulator = emulator(program)?;
    emulator.arg("--quiet");
    Ok(emulator)
}

/// Builds the firmware, which begins with the scene `first`, flights filling the display if they are `full`; `provoke` names a
/// fault that it then has, `mesh` an OBJ file, unless they are empty.
fn build(screen: Screen, full: bool, first: &str, provoke: &str, mesh: &Path) -> Result<PathBuf> {
    let mesh = mesh.to_str().context("the mesh file's name is not UTF-8")?;
    let features = [("wide", screen == Screen::Wide), ("full", full)];
    let features: Vec<_> = features
        .iter()
        .filter(|(_, is_on)| *is_on)
        .map(|(name, _)| *name)
        .collect();
    let build = Build {
        package: "pico",
        features: &features,
        environment: &[
            ("MICROLUX_PROVOKE", provoke),
            ("MICROLUX_MESH", mesh),
            ("MICROLUX_FIRST", first),
        ],
        name: if mesh.is_empty() { "pico" } else { "pico-mesh" },
    };
    toolchain::build(&build, "thumbv6m-none-eabi", "firmware-pico")
}

/// Node with the emulator's script; installs its two packages the first time.
fn emulator(program: &Path) -> Result<Command> {
    let folder = toolchain::firmware().join("emulator/rp2040");
    if !folder.join("node_modules").is_dir() {
        let mut npm = Command::new("npm");
        npm.args(["ci", "--no-audit", "--no-fund"]).current_dir(&folder);
        let finished = process::run(&mut npm, LIMIT, false)?;
        ensure!(
            finished.status.success(),
            "npm ci: {}\n{}",
            finished.status,
            finished.stderr
        );
    }
    let mut node = Command::new("node");
    node.arg(folder.join("run.mjs")).arg(program);
    Ok(node)
}

/// Removes a file that may be there.
fn remove(file: &Path) -> Result<()> {
    match fs::remove_file(file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error.into()),
        _ => Ok(()),
    }
}

/// The pass as the panel shows it, and its rays.
fn colours(frame: Frame, scene: usize, pass: Pass, baked: Option<&Baked>) -> Result<(Vec<u8>, u32)> {
    let refused = |error| anyhow::anyhow!("the scene is refused: {error:?}");
    if scene == 0 {
        let mut cornell = Cornell::new().map_err(refused)?;
        let (scene, camera) = cornell.scene().map_err(refused)?;
        let stage = Stage {
            scene: &scene,
            camera,
        };
        return Ok(painted(frame, pass, &stage));
    }
    let bytes = baked.map(Baked::blob).transpose().map_err(anyhow::Error::msg)?;
    let bytes = bytes.map(|bytes| Aligned::new(&bytes));
    let mut pedestal = Pedestal::new(match &bytes {
        Some(bytes) => scene::Baked::open(bytes.bytes())?,
        None => mesh::baked()?,
    });
    let (scene, camera) = pedestal.scene()?;
    let stage = Stage {
        scene: &scene,
        camera,
    };
    Ok(painted(frame, pass, &stage))
}

/// The first frames of a flight as the panel shows them, by one worker.
fn flown<const SCALE: u16, const WIDTH: usize>(
    form: Form,
    flight: Result<Flight<SCALE>, Refused>,
    frame: Frame,
    way: Way,
    frames: u32,
) -> Result<Vec<Vec<u8>>> {
    let refused = |error| anyhow::anyhow!("the scene is refused: {error:?}");
    let mut cornell = Cornell::new().map_err(refused)?;
    let (scene, camera) = cornell.scene().map_err(refused)?;
    let stage = Stage {
        scene: &scene,
        camera,
    };
    let mut flight = flight.map_err(|error| anyhow::anyhow!("the room is refused: {error:?}"))?;
    let (width, height) = (frame.width() as usize, frame.height() as usize);
    let (left, top) = ((width - form.width()) / 2, (height - form.height()) / 2);
    let one = |number| {
        let colours = Mutex::new(vec![0; 3 * width * height]);
        flight.frame(&Alone, &stage, way, number, &|y, row: &[u16; WIDTH]| {
            let place = 3 * ((top + y) * width + left);
            let mut colours = colours.lock().expect("nobody panics");
            for (pixel, colour) in colours[place..].chunks_exact_mut(3).zip(row) {
                pixel.copy_from_slice(&shown_as(*colour));
            }
        });
        colours.into_inner().expect("nobody panics")
    };
    Ok((0..frames).map(one).collect())
}

/// RGB565 as the panel shows it: 8 bits a channel, the highest bits repeated below.
fn shown_as(pixel: u16) -> [u8; 3] {
    let (red, green, blue) = (pixel >> 11, (pixel >> 5) & 63, pixel & 31);
    let wide = [
        red << 3 | red >> 2,
        green << 2 | green >> 4,
        blue << 3 | blue >> 2,
    ];
    wide.map(|channel| channel as u8)
}

/// The pass, and its rays.
fn painted(frame: Frame, pass: Pass, stage: &Stage) -> (Vec<u8>, u32) {
    let mut painter = Painter::new(stage, frame, pass);
    let (width, height) = (frame.width() as usize, frame.height() as usize);
    let mut colours = vec![0; 3 * width * height];
    let mut pixels = [0; tile::PIXELS];
    for index in 0..frame.tiles() {
        painter.render(index, &mut pixels);
        let (left, top) = frame.origin(index);
        for (place, &pixel) in (0..).zip(&pixels) {
            let x = (left + place % tile::SIDE) as usize;
            let y = (top + place / tile::SIDE) as usize;
            colours[3 * (y * width + x)..][..3].copy_from_slice(&shown_as(pixel));
        }
    }
    (colours, painter.rays())
}

/// Fails where the display differs from the picture.
fn same(shown: &[u8], expected: &[u8], width: u32) -> Result<()> {
    match first_difference(shown, expected, width)? {
        Some((x, y)) => bail!("the display differs from this computer's picture at ({x}, {y}) first"),
        None => Ok(()),
    }
}

/// Where two pictures of equal size differ first.
fn first_difference(shown: &[u8], expected: &[u8], width: u32) -> Result<Option<(u32, u32)>> {
    ensure!(
        shown.len() == expected.len(),
        "{} bytes on the display, {} expected",
        shown.len(),
        expected.len()
    );
    let pixels = shown.chunks_exact(3).zip(expected.chunks_exact(3));
    Ok((0..)
        .zip(pixels)
        .find(|(_, (a, b))| a != b)
        .map(|(place, _)| (place % width, place / width)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_first_difference() {
        let (expected, _) = colours(tile::SQUARE, 1, tile::PASSES[0], None).unwrap();
        let mut shown = expected.clone();
        assert_eq!(first_difference(&shown, &expected, 240).unwrap(), None);
        shown[3 * (5 * 240 + 7) + 1] ^= 1;
        assert_eq!(first_difference(&shown, &expected, 240).unwrap(), Some((7, 5)));
        assert!(first_difference(&shown[3..], &expected, 240).is_err());
    }
}
