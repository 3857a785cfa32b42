//! The program from outside, rendering: the built-in `spheres` at 16 by 16 pixels.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::{contains, ends_with, is_empty, starts_with};
use tempfile::TempDir;

const SMALL: [&str; 6] = ["--width", "16", "--height", "16", "--spp", "4"];

/// `host-sim COMMAND spheres ARGS`, small, in `folder`.
fn host_sim(folder: &TempDir, command: &str, args: &[&str]) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    program
        .current_dir(folder)
        .args([command, "spheres"])
        .args(SMALL)
        .args(args);
    program
}

fn files(folder: &TempDir) -> Vec<String> {
    let names = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

fn png(path: &Path) -> image::RgbImage {
    image::open(path).unwrap().into_rgb8()
}

fn json(path: &Path) -> serde_json::Map<String, serde_json::Value> {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn without_outputs_the_picture_is_named_after_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let summary =
        starts_with("spheres: 16 x 16, 4 spp, ").and(ends_with(" rays/s, written to spheres.png\n"));
    host_sim(&folder, "render", &[])
        .assert()
        .success()
        .stdout(summary);
    assert_eq!(files(&folder), ["spheres.png"]);
    assert_eq!(png(&folder.path().join("spheres.png")).dimensions(), (16, 16));
}

#[test]
fn several_outputs_hold_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let layers = ["--aov", "albedo,normal,depth,id"];
    let outputs = ["-o", "a.png", "-o", "a.exr", "-o", "a.pfm", "--quiet"];
    host_sim(&folder, "render", &[&outputs[..], &layers].concat())
        .assert()
        .success()
        .stdout(is_empty());
    assert_eq!(files(&folder), ["a.exr", "a.pfm", "a.png"]);
    let exr = host_sim::picture::read_exr(&folder.path().join("a.exr")).unwrap();
    let pfm = fs::read(folder.path().join("a.pfm")).unwrap();
    let last_row: Vec<u8> = exr.rgb[240..]
        .as_flattened()
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    assert_eq!(&pfm[b"PF\n16 16\n-1.0\n".len()..][..last_row.len()], last_row);
    // The PNG comes from the core's own sRGB curve.
    let shown = host_sim::picture::display_pixels(&exr, 0.0);
    let png = png(&folder.path().join("a.png"));
    let apart = png
        .as_raw()
        .iter()
        .zip(shown.as_flattened())
        .map(|(a, b)| a.abs_diff(*b))
        .max();
    assert!(apart <= Some(1), "{apart:?}");
    assert!(exr.rgb.iter().any(|rgb| rgb[0] > 0.01), "the picture is black");
}

#[test]
fn exr_layers_are_those_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder, "render", &["-o", "a.exr", "--aov", "depth,id"])
        .assert()
        .success();
    let meta = exr::meta::MetaData::read_from_file(folder.path().join("a.exr"), true).unwrap();
    let names: Vec<String> = meta.headers[0]
        .channels
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    assert_eq!(names, ["B", "G", "R", "depth.Z", "id.I"]);
}

#[test]
fn a_mono_display_shows_black_and_white() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder, "render", &["--display", "mono", "-o", "a.png"])
        .assert()
        .success();
    let picture = png(&folder.path().join("a.png"));
    assert!(picture.pixels().all(|p| p.0 == [0; 3] || p.0 == [255; 3]));
    assert!(picture.pixels().any(|p| p.0 == [255; 3]) && picture.pixels().any(|p| p.0 == [0; 3]));
}

#[test]
fn an_rgb565_display_shows_its_steps() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder, "render", &["--display", "rgb565", "-o", "a.png"])
        .assert()
        .success();
    let step = |x: u8, levels: u32| (u32::from(x) * levels + 127) / 255 * 255 / levels;
    for pixel in png(&folder.path().join("a.png")).pixels() {
        for (c, levels) in [31, 63, 31].into_iter().enumerate() {
            assert!(
                step(pixel[c], levels).abs_diff(u32::from(pixel[c])) <= 1,
                "{pixel:?}"
            );
        }
    }
}

#[test]
fn exposure_brightens_the_png_and_leaves_the_light() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder, "render", &["-o", "a.png", "-o", "a.exr"])
        .assert()
        .success();
    host_sim(
        &folder,
        "render",
        &["-o", "b.png", "-o", "b.exr", "--exposure", "-2"],
    )
    .assert()
    .success();
    let sum = |name: &str| {
        png(&folder.path().join(name))
            .as_raw()
            .iter()
            .map(|&x| u64::from(x))
            .sum::<u64>()
    };
    assert!(sum("b.png") < sum("a.png"));
    let light = |name: &str| host_sim::picture::read_exr(&folder.path().join(name)).unwrap();
    assert_eq!(light("a.exr"), light("b.exr"));
}

#[test]
fn threads_and_tiles_do_not_change_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    for (threads, rows) in [("1", "8"), ("2", "1"), ("5", "16")] {
        let name = format!("{threads}.exr");
        host_sim(
            &folder,
            "render",
            &["--threads", threads, "--tile-height", rows, "-o", &name],
        )
        .assert()
        .success();
    }
    host_sim(&folder, "render", &["--seed", "1", "-o", "seed.exr"])
        .assert()
        .success();
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("1.exr"), bytes("2.exr"));
    assert_eq!(bytes("1.exr"), bytes("5.exr"));
    assert_ne!(bytes("1.exr"), bytes("seed.exr"));
}

#[test]
fn the_reference_renders_too() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder, "render", &["--reference", "-o", "a.exr"])
        .assert()
        .success();
    let picture = host_sim::picture::read_exr(&folder.path().join("a.exr")).unwrap();
    assert!(picture.rgb.iter().any(|rgb| rgb[0] > 0.01));
}

#[test]
fn wrong_outputs_are_told_before_rendering() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("taken.png")).unwrap();
    for (output, what) in [
        (
            "a.jpg",
            "error: a.jpg: cannot write pictures as .jpg; end the name in .png, .exr or .pfm\n",
        ),
        (
            "a",
            "error: a: the name says no kind of picture; end it in .png, .exr or .pfm\n",
        ),
        (
            "missing/a.png",
            "error: missing/a.png: no directory missing; create it first\n",
        ),
        (
            "taken.png",
            "error: taken.png: is a directory; name a file in it\n",
        ),
    ] {
        // A render of this size would take hours.
        let long = [
            "--width", "8192", "--height", "8192", "--spp", "65536", "-o", output,
        ];
        let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
        command
            .current_dir(&folder)
            .timeout(std::time::Duration::from_secs(60));
        command
            .args(["render", "spheres"])
            .args(long)
            .assert()
            .code(1)
            .stdout(is_empty())
            .stderr(what);
        command.args(["-o", "good.png"]).assert().code(1);
    }
    assert_eq!(files(&folder), ["taken.png"]);
    host_sim(&folder, "compare", &["--json", "missing/a.json"])
        .assert()
        .code(1)
        .stderr(contains("create it first"));
    host_sim(&folder, "compare", &["--diff", "a.gif"])
        .assert()
        .code(1)
        .stderr(contains(".gif"));
    host_sim(&folder, "compare", &["--against", "none.exr"])
        .assert()
        .code(1)
        .stderr(contains("none.exr: no such file"));
}

#[test]
fn compare_tells_and_writes_the_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--json", "a.json", "--diff", "a.png", "-o", "fixed.exr"];
    let told = host_sim(&folder, "compare", &args).assert().success();
    told.stdout(contains("fixed against reference"))
        .stdout(contains("hit on one side alone"));
    assert_eq!(files(&folder), ["a.json", "a.png", "fixed.exr"]);
    let json = json(&folder.path().join("a.json"));
    assert_eq!(
        (&json["scene"], &json["width"], &json["spp"]),
        (&"spheres".into(), &16.into(), &4.into())
    );
    assert!(json["primary_rays"].as_u64() >= Some(256), "one a pixel at least");
    let number = |key: &str| json[key].as_f64().unwrap_or_else(|| panic!("{key} is no number"));
    assert!(number("bias").abs() < 0.5 && number("rmse") > 0.0 && number("flip") < 0.5);
    assert!((0.0..1.0).contains(&number("ssim")));
    assert!(number("psnr_db") > 5.0 && number("hit_miss_disagreement") <= 0.01);
    assert!(number("hit_point_error_p99") > 0.0 && number("hit_point_error_p9999") <= 1e-2);
    assert!(number("fixed_rays_per_second") > 0.0 && number("reference_rays_per_second") > 0.0);
}

#[test]
fn compare_against_the_fixed_picture_itself_finds_no_error() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder, "render", &["-o", "fixed.exr"])
        .assert()
        .success();
    let told = host_sim(
        &folder,
        "compare",
        &["--against", "fixed.exr", "--json", "a.json"],
    )
    .assert()
    .success();
    told.stdout(contains("reference against --against"));
    let json = json(&folder.path().join("a.json"));
    assert_eq!(
        (&json["against_fixed_rmse"], &json["against_fixed_flip"]),
        (&0.0.into(), &0.0.into())
    );
    assert!(json["against_reference_rmse"].as_f64().unwrap() > 0.0);
}

#[test]
fn info_tells_and_writes_the_numbers() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder, "info", &["--json", "a.json"])
        .assert()
        .success()
        .stdout(contains("in all"));
    let json = json(&folder.path().join("a.json"));
    let number = |key: &str| json[key].as_u64().unwrap_or_else(|| panic!("{key} is no number"));
    assert!(number("shapes") > 0 && number("nodes") > 0 && number("bytes_total") > 0);
    assert!(number("triangles") == 0 || number("bytes_geometry") > 0);
    host_sim(&folder, "info", &["--json", "b.json", "--tile-height", "1"])
        .assert()
        .success();
    let smaller = self::json(&folder.path().join("b.json"))["ram_bytes"]
        .as_u64()
        .unwrap();
    assert!(smaller < number("ram_bytes"), "a lower tile needs less RAM");
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    // Minutes of work, in tiles of milliseconds.
    let line = "render spheres --width 16 --height 4096 --tile-height 1 --spp 4096 -o a.png --quiet";
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(&folder)
        .args(line.split_whitespace())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(500));
    let sent = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(
        sent.success() && child.try_wait().unwrap().is_none(),
        "it should still be rendering"
    );
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(files(&folder), [""; 0]);
}

#[test]
fn a_denoised_picture_is_another_and_the_same_whoever_renders_it() {
    let folder = tempfile::tempdir().unwrap();
    let made = |name: &str, args: &[&str]| {
        let out = ["-q", "-o", name];
        host_sim(&folder, "render", &[&out, args].concat())
            .assert()
            .success();
        png(&folder.path().join(name)).into_raw()
    };
    let noisy = made("noisy.png", &[]);
    let clean = made("clean.png", &["--denoise", "atrous"]);
    let threads = made("threads.png", &["--denoise", "atrous", "--threads", "3"]);
    let fine = made("fine.png", &["--denoise", "atrous", "--upscale", "2"]);
    let plain = made("plain.png", &["--denoise", "off", "--upscale", "1"]);
    let neural = made("neural.png", &["--denoise", "neural"]);
    let other = made("other.png", &["--denoise", "neural", "--threads", "3"]);
    assert_eq!((&clean, &noisy, &neural), (&threads, &plain, &other));
    assert!(neural != noisy && neural != clean);
    assert!(clean != noisy && fine != clean && fine.len() == noisy.len());
    // 16 are five times three, and one.
    host_sim(&folder, "render", &["--denoise", "atrous", "--upscale", "3"])
        .assert()
        .code(1)
        .stderr(contains("multiples of 3").and(contains("--width 18 --height 18")));
    host_sim(&folder, "render", &["--denoise", "atrous", "--integrator", "ao"])
        .assert()
        .code(1)
        .stderr(contains("only direct and path can be denoised"));
}

#[test]
fn a_size_that_nobody_asked_for_is_a_multiple() {
    let folder = tempfile::tempdir().unwrap();
    let size = |args: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_host-sim"));
        program
            .current_dir(&folder)
            .args(["render", "spheres", "--spp", "1", "-q", "-o", "a.png"]);
        program.args(args).assert().success();
        png(&folder.path().join("a.png")).dimensions()
    };
    let (width, height) = size(&["--upscale", "3"]);
    assert!(width % 3 == 0 && height % 3 == 0, "{width} x {height}");
    // Its shape is kept as nearly as can be.
    let (width, height) = size(&["--upscale", "3", "--width", "30"]);
    assert!(width == 30 && height % 3 == 0, "{width} x {height}");
    let (width, height) = size(&["--upscale", "3", "--height", "30"]);
    assert!(height == 30 && width % 3 == 0, "{width} x {height}");
}

/// By a quarter and a ninth of the pixels, each another picture.
#[test]
fn a_picture_of_fewer_pixels_is_as_bright() {
    let folder = tempfile::tempdir().unwrap();
    let mean = |scale: &str| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_host-sim"));
        program.current_dir(&folder).args([
            "render", "spheres", "--width", "18", "--height", "18", "--spp", "16", "-q", "-o", "a.png",
        ]);
        program
            .args(["--denoise", "neural", "--upscale", scale])
            .assert()
            .success();
        let bytes = png(&folder.path().join("a.png")).into_raw();
        assert_eq!(bytes.len(), 3 * 18 * 18);
        let sum: f64 = bytes.iter().map(|byte| f64::from(*byte)).sum();
        (bytes, sum)
    };
    let [one, two, three] = ["1", "2", "3"].map(mean);
    assert!(one.0 != two.0 && one.0 != three.0 && two.0 != three.0);
    for (_, sum) in [two, three] {
        assert!((sum / one.1 - 1.0).abs() < 0.03, "{sum} {}", one.1);
    }
}

#[test]
fn a_flight_is_an_animated_png_or_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let flight = ["--frames", "3", "--orbit", "5", "-o"];
    host_sim(&folder, "animate", &[&flight[..], &["clip.png"]].concat())
        .assert()
        .success()
        .stdout(contains("3 frames").and(contains("flicker")));
    let bytes = fs::read(folder.path().join("clip.png")).unwrap();
    assert!(bytes.windows(4).any(|w| w == b"acTL"), "an animated PNG");
    host_sim(
        &folder,
        "animate",
        &[&flight[..], &["stills", "--denoise", "atrous", "--taa"]].concat(),
    )
    .assert()
    .success();
    assert_eq!(fs::read_dir(folder.path().join("stills")).unwrap().count(), 3);
    host_sim(
        &folder,
        "animate",
        &[&flight[..], &["noisy.png", "--taa"]].concat(),
    )
    .assert()
    .code(1)
    .stderr(contains("--denoise atrous"));
    assert!(!folder.path().join("noisy.png").exists());
}
