//! `host-sim animate`.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::args::AnimateArgs;
use super::progress::Meter;
use super::render::settings;
use super::{Failure, source, stop};
use crate::animate::{Animation, Flight, Shown};
use crate::clean::Denoise;
use crate::picture::{FileError, Format, Picture, Style, Target, animated_png};
use crate::run::{self, Progress};

pub fn animate(args: &AnimateArgs) -> Result<(), Failure> {
    let desc = source::load(&args.scene, args.quiet)?;
    let mut options = args.settings.options(&desc);
    options.cleaning.taa = args.taa;
    if args.taa && options.cleaning.denoise == Denoise::Off {
        return Err(Failure::Wrong(
            "--taa is of denoised frames: add --denoise atrous or neural".into(),
        ));
    }
    let flight = Flight {
        frames: args.frames,
        orbit: args.orbit,
        dolly: args.dolly,
    };
    let is_file = Format::of(&args.output) == Ok(Format::Png);
    if is_file {
        Target::check(&args.output)?;
    } else {
        fs::create_dir_all(&args.output).map_err(|error| FileError::io(&args.output, &error))?;
    }
    let stop = stop::on_ctrl_c()?;
    let shoot = |label: &str, options: &run::Options| -> Result<Animation, Failure> {
        let meter = Meter::new(format!("{} {label}", desc.name), args.quiet);
        let made = crate::animate::animation(&desc, options, flight, &meter as &dyn Progress, &stop);
        meter.finish();
        made.map_err(|error| Failure::of_run(&args.scene.scene, error))
    };
    let animation = shoot("frames", &options)?;
    let truth = match args.reference_spp {
        Some(spp) => Some(shoot(
            "reference",
            &run::Options {
                spp,
                cleaning: Default::default(),
                ..options.clone()
            },
        )?),
        None => None,
    };
    if is_file {
        moving_png(&args.output, &animation.frames, args.fps)?;
    } else {
        stills(&args.output, &animation.frames, &stop)?;
    }
    if args.quiet {
        return Ok(());
    }
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "{}: {} frames of {}, {:.2} s, written to {}",
        desc.name,
        args.frames,
        settings(&options),
        animation.seconds,
        args.output.display()
    )?;
    let flicker = animation.flicker();
    match &truth {
        None => writeln!(out, "flicker {flicker:.5}")?,
        Some(truth) => writeln!(
            out,
            "flicker {flicker:.5}, the reference's own {:.5}; psnr {:.2} dB in the mean, {:.2} dB of the last frame",
            truth.flicker(),
            animation.psnr(truth, 0),
            animation.psnr(truth, animation.frames.len().saturating_sub(1)),
        )?,
    }
    Ok(())
}

/// All frames in one animated PNG that repeats.
fn moving_png(path: &Path, frames: &[Shown], fps: u16) -> Result<(), Failure> {
    let Some(first) = frames.first() else {
        return Ok(());
    };
    let pictures = frames.iter().map(|frame| frame.rgb8.as_slice());
    let bytes = animated_png([first.width, first.height], pictures, fps)
        .map_err(|error| Failure::Wrong(format!("{}: {error}", path.display())))?;
    Ok(Target::check(path)?.write(&bytes)?)
}

/// `000.png`, `001.png`, ... in a folder.
fn stills(folder: &Path, frames: &[Shown], stop: &AtomicBool) -> Result<(), Failure> {
    for (number, frame) in frames.iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            return Err(Failure::Stopped);
        }
        let path = folder.join(format!("{number:03}.png"));
        let picture = Picture {
            width: frame.width,
            height: frame.height,
            display: Some(frame.rgb8.clone()),
            ..Picture::default()
        };
        let bytes = Format::Png.encode(&picture, &Style::default());
        let bytes = bytes.map_err(|error| FileError::new(&path, error))?;
        Target::check(&path)?.write(&bytes)?;
    }
    Ok(())
}
