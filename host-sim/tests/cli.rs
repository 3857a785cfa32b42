//! The program from outside: what is wrong is told in one line, before anything is rendered or written.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::{contains, is_empty};

fn host_sim(folder: &tempfile::TempDir) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command.current_dir(folder);
    command
}

/// Runs `host-sim ARGS`, which must end with status 1, one line on the standard error, and no file.
fn told(args: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let assert = host_sim(&folder).args(args).assert().code(1).stdout(is_empty());
    let line = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
    assert!(
        line.starts_with("error: ") && line.ends_with('\n') && line.lines().count() == 1,
        "{line}"
    );
    assert_eq!(
        std::fs::read_dir(&folder).unwrap().count(),
        0,
        "a file was left behind"
    );
    line
}

/// Runs `host-sim ARGS`, which must end with status 2 and say `what` on the standard error.
fn usage(args: &[&str], what: &str) {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder)
        .args(args)
        .assert()
        .code(2)
        .stdout(is_empty())
        .stderr(contains(what));
    assert_eq!(
        std::fs::read_dir(&folder).unwrap().count(),
        0,
        "a file was left behind"
    );
}

#[test]
fn wrong_usage_is_status_2() {
    usage(&["rendr", "spheres"], "render");
    usage(&["render"], "<SCENE>");
    usage(&["render", "spheres", "--width", "0"], "0 is not in 1..=8192");
    usage(&["render", "spheres", "--width", "wide"], "invalid value 'wide'");
    usage(
        &["render", "spheres", "--height", "8193"],
        "8193 is not in 1..=8192",
    );
    usage(&["render", "spheres", "--spp", "-1"], "-1");
    usage(
        &["render", "spheres", "--integrator", "pth"],
        "a similar value exists: 'path'",
    );
    usage(&["render", "spheres", "--sampler", "halton"], "independent");
    usage(&["render", "spheres", "--display", "rgb"], "rgb565");
    usage(&["render", "spheres", "--aov", "depth,colour"], "albedo");
    usage(
        &["render", "spheres", "--exposure", "bright"],
        "a number of stops",
    );
    usage(
        &["render", "spheres", "--reference", "--display", "mono"],
        "cannot be used with",
    );
    usage(&["render", "a.xml", "-D", "spp"], "NAME=VALUE is wanted");
    usage(&["compare", "spheres", "--reference-spp", "0"], "0 is not in");
    usage(&[], "Usage");
}

#[test]
fn layers_need_a_file_that_can_hold_them() {
    usage(
        &["render", "spheres", "--aov", "depth", "-o", "a.png"],
        "--aov writes its layers into an .exr file",
    );
}

#[test]
fn help_is_for_newcomers() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(&folder)
        .arg("--help")
        .assert()
        .success()
        .stdout(contains("Examples:").and(contains("spheres.png")));
    for command in ["render", "compare", "info"] {
        let help = host_sim(&folder).args([command, "--help"]).assert().success();
        help.stdout(contains("Examples:").and(contains("--max-depth")));
    }
    let help = host_sim(&folder).args(["report", "--help"]).assert().success();
    help.stdout(
        contains("Examples:")
            .and(contains("--quick"))
            .and(contains("bdpt").or(contains("direct"))),
    );
    host_sim(&folder)
        .arg("--version")
        .assert()
        .success()
        .stdout(contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn scenes_are_listed_a_line_each() {
    let folder = tempfile::tempdir().unwrap();
    let assert = host_sim(&folder)
        .arg("scenes")
        .assert()
        .success()
        .stderr(is_empty());
    let text = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
    assert!(text.lines().any(|line| line.starts_with("spheres ")), "{text}");
    assert!(
        text.lines().all(|line| line.split_whitespace().count() > 2),
        "{text}"
    );
}

#[test]
fn an_unknown_scene_is_told_with_the_nearest_name() {
    for command in ["render", "compare", "info"] {
        let line = told(&[command, "sphres"]);
        assert_eq!(
            line,
            "error: sphres: no such built-in scene; did you mean spheres?\n"
        );
    }
    assert!(told(&["render", "qwertyuiop"]).contains("host-sim scenes"));
}

#[test]
fn a_missing_file_is_told_by_its_name() {
    assert!(told(&["render", "missing.xml"]).starts_with("error: missing.xml: "));
    assert!(told(&["info", "folder/missing.obj"]).starts_with("error: folder/missing.obj: "));
}

/// A whole scene goes into one file, which is a scene again, and is not baked twice.
#[test]
fn scenes_are_baked_and_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let run = |line: &str| host_sim(&folder).args(line.split(' ')).assert().success();
    run("bake cornell -o box.mlx --json bake.json --preview box.png --rust box.rs")
        .stdout(contains("for a Room::<16, 4, 1, 0>").and(contains("written to box.mlx")));
    let blob = std::fs::read(folder.path().join("box.mlx")).unwrap();
    let text = std::fs::read_to_string(folder.path().join("bake.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["bytes_total"], blob.len());
    assert!(json["bytes_scene"].as_u64().unwrap() > 1000);
    assert!(folder.path().join("box.png").exists());
    let code = std::fs::read_to_string(folder.path().join("box.rs")).unwrap();
    assert!(code.contains("pub static SCENE: &[u8]"));
    run("render box.mlx --width 16 --spp 1 -o one.pfm -q");
    run("render cornell --width 16 --spp 1 -o other.pfm -q");
    let picture = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(picture("one.pfm") == picture("other.pfm"));
    host_sim(&folder)
        .args("bake box.mlx -o again.mlx".split(' '))
        .assert()
        .code(1)
        .stderr("error: box.mlx: it is baked already\n");
}

/// What is baked can be looked at, has the size that was told, and is refused when a byte is lost.
#[test]
fn meshes_are_baked_and_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let bake = "bake torus-knot -o knot.mlx --rust knot.rs --scene-rust scene.rs --json bake.json --preview knot.png";
    host_sim(&folder).args(bake.split(' ')).assert().success().stdout(
        contains("each of 15,360 triangles")
            .and(contains("moved by"))
            .and(contains("heuristic")),
    );
    let blob = std::fs::read(folder.path().join("knot.mlx")).unwrap();
    let json = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(folder.path().join(name)).unwrap()).unwrap()
    };
    let baked = json("bake.json");
    assert_eq!(baked["bytes_total"], blob.len());
    let each = baked["meshes"][0]["bytes_a_triangle"].as_f64().unwrap();
    // Smooth normals are 1.2 of them.
    assert!(each > 9.0 && each < 12.0, "{each}");
    let [rounded, exact] =
        ["sah_cost", "sah_cost_exact"].map(|key| baked["meshes"][0][key].as_f64().unwrap());
    assert!(
        exact > 1.0 && rounded > exact && rounded < 1.1 * exact,
        "{rounded} {exact}"
    );
    // Steps of 2^-15 m: rounding moves a vertex by half a step an axis at most, and some by nearly that.
    let step = 2f64.powi(-15);
    let moved = |key: &str| baked["meshes"][0][key].as_f64().unwrap() / step;
    assert!(moved("displacement_worst") > 0.7 && moved("displacement_worst") <= 0.867);
    assert!((moved("displacement_rms") - 0.5).abs() < 0.01);
    assert!(std::fs::metadata(folder.path().join("knot.png")).unwrap().len() > 10_000);
    let source = std::fs::read_to_string(folder.path().join("knot.rs")).unwrap();
    assert!(source.contains("pub static MESHES: &[u8]"));
    let scene = std::fs::read_to_string(folder.path().join("scene.rs")).unwrap();
    assert!(scene.contains("pub fn scene()") && scene.contains("Geometry::Mesh(0)"));

    host_sim(&folder)
        .args("info knot.mlx --json info.json".split(' '))
        .assert()
        .success();
    let info = json("info.json");
    for key in ["bytes_bvh", "triangles"] {
        assert_eq!(info[key], baked[key], "{key}");
    }
    let geometry = info["bytes_geometry"].as_u64().unwrap() + info["bytes_bvh"].as_u64().unwrap();
    assert!(
        blob.len() as u64 - geometry < 100,
        "head, table and filling: {geometry}"
    );

    std::fs::write(folder.path().join("short.mlx"), &blob[..3000]).unwrap();
    let expected = format!(
        "error: short.mlx: 3000 bytes instead of {}; bake it again\n",
        blob.len()
    );
    host_sim(&folder)
        .args(["render", "short.mlx"])
        .assert()
        .code(1)
        .stderr(expected);
}

#[test]
fn what_cannot_be_baked_is_told() {
    let line = told(&["bake", "spheres", "--meshes-only", "-o", "a.mlx"]);
    assert!(line.contains("spheres: it has no mesh to bake"), "{line}");
    let line = told(&["bake", "torus-knot", "-o", "a.mlx", "--preview", "a.exr"]);
    assert!(line.contains("a preview is a .png"), "{line}");
    usage(&["bake", "torus-knot"], "--output <BLOB>");
}
