//! `host-sim report`.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::args::{ReportArgs, SceneArgs, Settings};
use super::progress::Meter;
use super::{Failure, source, stop};
use crate::builtin;
use crate::desc::{IntegratorKind, SamplerKind};
use crate::oidn::Oidn;
use crate::picture::{FileError, Target, read_exr};
use crate::report::{self, Elsewhere, Request, Subject, denoisers};
use crate::run::{self, Options};

/// Names of the files in the folder of `-o`.
const PAGE: &str = "report.html";
const NUMBERS: &str = "report.json";

/// Where a scene file's pictures by Mitsuba are looked for, beside it.
const REFERENCES: &str = "reference";

/// What is taken where nothing is said.
struct Defaults {
    spp: u32,
    /// Pictures are at most this wide.
    width: u32,
}

const NORMAL: Defaults = Defaults { spp: 16, width: 128 };
const QUICK: Defaults = Defaults { spp: 4, width: 64 };

/// The reference has this many times the samples.
const REFERENCE: u32 = 4;

/// The same of the page about denoisers.
const DENOISERS: [&str; 3] = ["denoisers.html", "denoisers.json", "denoisers.md"];

/// Width and the reference's samples a pixel for it, and with --quick.
const SMALL: [(u32, u32); 2] = [(80, 256), (40, 32)];

/// The built-in scene that has nothing to take away: all of its light is 1.
const EVEN: &str = "furnace";

pub fn report(args: &ReportArgs) -> Result<(), Failure> {
    if args.denoisers {
        return denoisers(args);
    }
    let folder = Folder::check(&args.output, &[PAGE, NUMBERS])?;
    let request = request(args)?;
    let stop = stop::on_ctrl_c()?;
    let meter = Meter::new("report", args.quiet);
    let result = report::measure(&request, &meter, &stop);
    meter.finish();
    let report = result.map_err(|error| Failure::of_run("report", error))?;
    nothing_at_all(report.skipped().collect(), report.scenes.len())?;
    let page = report::page(&report).map_err(|error| Failure::Wrong(format!("{PAGE}: {error}")))?;
    let numbers = format!("{:#}\n", report::json(&report));
    let [page_file, numbers_file] = folder.write([(PAGE, page.as_bytes()), (NUMBERS, numbers.as_bytes())])?;
    if !args.quiet {
        let [ok, noise, off] = report.tally();
        let mut out = io::stdout().lock();
        writeln!(out, "{ok} checks ok, {noise} hidden by noise, {off} off")?;
        writeln!(
            out,
            "written to {} and {}",
            page_file.display(),
            numbers_file.display()
        )?;
    }
    Ok(())
}

fn denoisers(args: &ReportArgs) -> Result<(), Failure> {
    let [page_name, numbers_name, tables_name] = DENOISERS;
    let folder = Folder::check(&args.output, &DENOISERS)?;
    let oidn = match &args.oidn {
        Some(folder) => Some(Oidn::at(folder).map_err(Failure::Wrong)?),
        None => Oidn::found(),
    };
    let (width, spp) = SMALL[usize::from(args.quick)];
    let defaults = Defaults { spp, width };
    let subject = |name: &String| {
        let Subject { desc, options, .. } = subject(args, &defaults, name)?;
        Ok(denoisers::Subject { desc, options })
    };
    let scenes = names(args, |name| name != EVEN);
    let request = denoisers::Request {
        scenes: scenes.iter().map(subject).collect::<Result<_, Failure>>()?,
        reference_spp: args.reference_spp.unwrap_or(spp),
        oidn,
    };
    let stop = stop::on_ctrl_c()?;
    let meter = Meter::new("denoisers", args.quiet);
    let result = denoisers::measure(&request, &meter, &stop);
    meter.finish();
    let report = result.map_err(|error| Failure::of_run("report", error))?;
    nothing_at_all(report.skipped().collect(), report.scenes.len())?;
    let page = denoisers::page(&report).map_err(|error| Failure::Wrong(format!("{page_name}: {error}")))?;
    let numbers = format!("{:#}\n", denoisers::json(&report));
    let tables = denoisers::markdown(&report);
    let written = folder.write([
        (page_name, page.as_bytes()),
        (numbers_name, numbers.as_bytes()),
        (tables_name, tables.as_bytes()),
    ])?;
    if !args.quiet {
        let mut out = io::stdout().lock();
        writeln!(out, "{tables}")?;
        let [page, numbers, tables] = written.map(|file| file.display().to_string());
        writeln!(out, "written to {page}, {numbers} and {tables}")?;
    }
    Ok(())
}

/// A report of one scene that cannot be rendered is no report.
fn nothing_at_all(reasons: Vec<(&str, &str)>, scenes: usize) -> Result<(), Failure> {
    match reasons.first() {
        Some((scene, reason)) if reasons.len() == scenes => {
            Err(Failure::of_run(scene, run::Error::Scene(reason.to_string())))
        }
        _ => Ok(()),
    }
}

/// Scenes that were asked for, else all built-in ones that will do.
fn names(args: &ReportArgs, will_do: impl Fn(&str) -> bool) -> Vec<String> {
    if !args.scenes.is_empty() {
        return args.scenes.clone();
    }
    let all = builtin::all().iter().map(|&(name, _)| name);
    all.filter(|name| will_do(name)).map(String::from).collect()
}

fn request(args: &ReportArgs) -> Result<Request, Failure> {
    let defaults = if args.quick { QUICK } else { NORMAL };
    let names = names(args, |_| true);
    let scenes = names.iter().map(|name| subject(args, &defaults, name));
    let spp = args.spp.unwrap_or(defaults.spp);
    Ok(Request {
        scenes: scenes.collect::<Result<_, _>>()?,
        integrators: named(&args.integrators, IntegratorKind::from),
        samplers: named(&args.samplers, SamplerKind::from),
        spp,
        reference_spp: args.reference_spp.unwrap_or(REFERENCE * spp),
    })
}

/// Those that were asked for, once each, else all there are.
fn named<A: ValueEnum + PartialEq, K>(asked_for: &[A], kind: impl Fn(A) -> K) -> Vec<(String, K)> {
    let all = A::value_variants();
    let wanted = |arg: &&A| asked_for.is_empty() || asked_for.contains(arg);
    all.iter()
        .filter(wanted)
        .filter_map(|arg| Some((name_of(arg)?, kind(arg.clone()))))
        .collect()
}

/// What the command line calls it.
fn name_of<A: ValueEnum>(arg: &A) -> Option<String> {
    arg.to_possible_value().map(|value| value.get_name().to_string())
}

fn subject(args: &ReportArgs, defaults: &Defaults, name: &str) -> Result<Subject, Failure> {
    let scene = SceneArgs {
        scene: name.to_string(),
        lenient: args.lenient,
        definitions: Vec::new(),
    };
    let desc = source::load(&scene, true)?;
    let settings = Settings {
        width: Some(args.width.unwrap_or(desc.width.min(defaults.width))),
        seed: args.seed,
        threads: args.threads,
        ..Settings::default()
    };
    let options: Options = settings.options(&desc);
    let elsewhere = match elsewhere_file(args, name) {
        Some(file) => Some(Elsewhere {
            picture: finite(&file)?,
            file: file.display().to_string(),
        }),
        None => None,
    };
    Ok(Subject {
        desc,
        options,
        elsewhere,
    })
}

/// The picture by Mitsuba that belongs to a scene, if there is one.
fn elsewhere_file(args: &ReportArgs, name: &str) -> Option<PathBuf> {
    let scene = Path::new(name);
    let file = Path::new(scene.file_stem()?).with_extension("exr");
    let beside = || Some(scene.parent()?.join(REFERENCES));
    let folder = match &args.reference_dir {
        Some(folder) => folder.clone(),
        None => scene.extension().and_then(|_| beside())?,
    };
    Some(folder.join(file)).filter(|path| path.is_file())
}

fn finite(file: &Path) -> Result<crate::picture::Picture, Failure> {
    let picture = read_exr(file)?;
    let bad = picture.rgb.iter().any(|rgb| !rgb.iter().all(|x| x.is_finite()));
    match bad {
        true => Err(FileError::new(file, "has pixels that are no finite numbers; write it anew").into()),
        false => Ok(picture),
    }
}

/// The folder to write into, which may be made at the end: nothing is left behind where nothing is finished.
struct Folder(PathBuf);

impl Folder {
    /// Looks whether it can be made and written into.
    fn check(path: &Path, names: &[&str]) -> Result<Folder, Failure> {
        let here = |folder: &&Path| folder.as_os_str().is_empty() || folder.exists();
        let there = path.ancestors().find(here).unwrap_or(path);
        if !there.as_os_str().is_empty() && !there.is_dir() {
            return Err(FileError::new(there, "is no directory; name one, it may be new").into());
        }
        if there == path {
            for name in names {
                Target::check(&path.join(name))?;
            }
        } else {
            Target::check(&there.join(NEVER))?;
        }
        Ok(Folder(path.to_path_buf()))
    }

    /// Writes the files, each whole or not at all.
    fn write<const N: usize>(&self, files: [(&str, &[u8]); N]) -> Result<[PathBuf; N], Failure> {
        fs::create_dir_all(&self.0).map_err(|error| FileError::io(&self.0, &error))?;
        for (name, bytes) in files {
            Target::check(&self.0.join(name))?.write(bytes)?;
        }
        Ok(files.map(|(name, _)| self.0.join(name)))
    }
}

/// A name that no file has, to ask whether a folder can be written into.
const NEVER: &str = ".host-sim-report";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::SamplerArg;

    #[test]
    fn all_that_there_is_is_taken_unless_some_is_asked_for() {
        let names = |asked: &[SamplerArg]| -> Vec<String> {
            named(asked, SamplerKind::from)
                .into_iter()
                .map(|(name, _)| name)
                .collect()
        };
        assert_eq!(names(&[]).len(), SamplerArg::value_variants().len());
        assert_eq!(names(&[SamplerArg::Sobol, SamplerArg::Sobol]), ["sobol"]);
    }

    #[test]
    fn a_folder_may_be_new_but_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        assert!(Folder::check(&place("new/and/deep"), &[PAGE]).is_ok());
        assert!(!place("new").exists(), "checking leaves nothing behind");
        fs::write(place("file"), "").unwrap();
        for name in ["file", "file/deep"] {
            assert!(Folder::check(&place(name), &[PAGE]).is_err(), "{name}");
        }
        let files = Folder::check(&place("new"), &[PAGE])
            .unwrap()
            .write([("a", b"1"), ("b", b"2")])
            .unwrap();
        assert_eq!(files.map(|file| fs::read(file).unwrap()), [b"1", b"2"]);
        fs::create_dir(place("new").join(PAGE)).unwrap();
        assert!(
            Folder::check(&place("new"), &[PAGE]).is_err(),
            "a folder has the page's name"
        );
    }
}
