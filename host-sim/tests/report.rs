//! `host-sim report` from outside: a tiny page and its numbers, and what is told where there can be none.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::{contains, ends_with, is_empty, starts_with};
use roxmltree::{Document, Node, ParsingOptions};
use serde_json::Value;
use tempfile::TempDir;

const SMALL: [&str; 8] = [
    "--width",
    "8",
    "--spp",
    "4",
    "--reference-spp",
    "8",
    "--integrators",
    "direct,path",
];

fn report(folder: &TempDir, scenes: &[&str], args: &[&str]) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    program.current_dir(folder).arg("report").args(scenes).args(args);
    program
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// The element with this name, or this attribute, whose string value is `text`, is in the page.
fn texts<'a>(document: &'a Document, tag: &str) -> Vec<&'a str> {
    let found = document.descendants().filter(|node| node.has_tag_name(tag));
    found.filter_map(|node| node.text()).collect()
}

/// The reports of a list, by the name that `key` holds.
fn named<'a>(list: &'a Value, key: &str, name: &str) -> &'a Value {
    let list = list.as_array().unwrap();
    list.iter().find(|entry| entry[key] == name).unwrap()
}

fn integrator<'a>(scene: &'a Value, name: &str) -> &'a Value {
    let groups = scene["groups"].as_array().unwrap().iter();
    let mut all = groups.flat_map(|group| group["integrators"].as_array().unwrap());
    all.find(|entry| entry["integrator"] == name).unwrap()
}

#[test]
fn a_page_of_its_own_with_the_numbers_of_compare() {
    let folder = tempfile::tempdir().unwrap();
    report(
        &folder,
        &["spheres"],
        &[&SMALL[..], &["-o", "new/out", "--seed", "3"]].concat(),
    )
    .assert()
    .success()
    .stdout(contains(" checks ok, ").and(contains("report.html and ")));

    // Well-formed, whole, and with nothing from elsewhere.
    let page = fs::read_to_string(folder.path().join("new/out/report.html")).unwrap();
    let allow = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(&page, allow).unwrap();
    no_reference_leaves(&document);
    for outside in ["http:", "https:", "//", "@import", "url(", "file:"] {
        let styles = [texts(&document, "style"), texts(&document, "script")].concat();
        assert!(!styles.iter().any(|text| text.contains(outside)), "{outside}");
    }
    assert_eq!(texts(&document, "h2"), ["spheres"]);
    let images = document.descendants().filter(|node| node.has_tag_name("img"));
    assert!(
        images.count() >= 8,
        "reference, picture and difference of two integrators, and a sampler's each"
    );
    assert!(
        document
            .descendants()
            .filter(|node| node.has_tag_name("polyline"))
            .count()
            >= 8
    );

    // What `compare` says of the same picture.
    let report = json(&folder.path().join("new/out/report.json"));
    let scene = named(&report["scenes"], "scene", "spheres");
    for (name, sampler) in [("path", "stratified"), ("direct", "sobol")] {
        let mut compare = Command::new(env!("CARGO_BIN_EXE_host-sim"));
        compare
            .current_dir(&folder)
            .args(["compare", "spheres", "--seed", "3"]);
        let size = ["--width", "8", "--spp", "4", "--reference-spp", "8"];
        let choice = [
            "--integrator",
            name,
            "--sampler",
            sampler,
            "--json",
            "one.json",
            "--quiet",
        ];
        compare.args(size).args(choice).assert().success();
        let one = json(&folder.path().join("one.json"));
        let cell = named(&integrator(scene, name)["samplers"], "sampler", sampler);
        for key in [
            "bias",
            "rmse",
            "psnr_db",
            "ssim",
            "flip",
            "block_p95",
            "block_max",
        ] {
            assert!(
                one[key].is_number() && cell[key] == one[key],
                "{key}: {} {}",
                cell[key],
                one[key]
            );
        }
        for key in [
            "width",
            "height",
            "hit_miss_disagreement",
            "hit_point_error_p99",
            "hit_point_error_p9999",
        ] {
            assert!(one[key].is_number() && scene[key] == one[key], "{key}");
        }
    }
    let path = integrator(scene, "path");
    assert!(path["mean_bias"].is_number() && path["mean_bias_standard_error"].as_f64() > Some(0.0));
    assert!(path["ram_bytes"].as_u64() > Some(0));
    let levels = named(&path["samplers"], "sampler", "independent")["levels"]
        .as_array()
        .unwrap();
    let spp: Vec<&Value> = levels.iter().map(|level| &level["spp"]).collect();
    assert_eq!(spp, [1, 2, 4]);
}

/// Every address in the page is in the page.
fn no_reference_leaves(document: &Document) {
    let root = document.root();
    let named = |name: &str| root.descendants().any(|node| node.attribute("id") == Some(name));
    let addresses = |node: Node<'_, '_>| {
        let of = ["src", "href", "data", "action", "poster", "srcset", "xlink:href"].map(|name| {
            let value = node.attribute(name)?;
            Some(value.to_string())
        });
        of.into_iter().flatten().collect::<Vec<String>>()
    };
    let mut all = root
        .descendants()
        .filter(Node::is_element)
        .flat_map(addresses)
        .peekable();
    assert!(all.peek().is_some());
    for address in all {
        match address.strip_prefix('#') {
            Some(name) => assert!(named(name), "nothing is called {name}"),
            None => assert!(address.starts_with("data:"), "{address}"),
        }
    }
    let external = ["link", "iframe", "object", "embed", "base", "video", "audio"];
    assert!(
        !root
            .descendants()
            .any(|node| external.contains(&node.tag_name().name()))
    );
    let flips = root.descendants().filter_map(|node| node.attribute("data-flip"));
    assert!(flips.clone().count() > 0 && flips.clone().all(named));
}

/// A scene with a picture beside it, of twice its size.
#[test]
fn a_picture_by_mitsuba_is_found_beside_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="3"/></integrator>
  <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="8"/>
    <rfilter type="box"/></film></sensor>
  <emitter type="constant"><rgb name="radiance" value="0.5 0.25 1.0"/></emitter>
</scene>"#;
    fs::write(folder.path().join("sky.xml"), scene).unwrap();
    fs::create_dir(folder.path().join("reference")).unwrap();
    let sky = [
        "render",
        "sky.xml",
        "--spp",
        "1",
        "-o",
        "reference/sky.exr",
        "--quiet",
    ];
    let mut render = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    render.current_dir(&folder).args(sky).assert().success();
    let args = [
        "--width",
        "8",
        "--spp",
        "2",
        "--samplers",
        "sobol",
        "--integrators",
        "path",
        "--quiet",
    ];
    report(&folder, &["sky.xml"], &[&args[..], &["-o", "out"]].concat())
        .assert()
        .success()
        .stdout(is_empty());
    let found = json(&folder.path().join("out/report.json"));
    let path = integrator(&found["scenes"][0], "path");
    // The sky is the same everywhere: without noise, and equal but for the last bits.
    assert!(
        path["against_rmse"].as_f64().unwrap() < 1e-3,
        "{}",
        path["against_rmse"]
    );
    assert_eq!(path["against_mean_bias_mark"], "ok");

    // One that does not fit is left out, and that is said.
    let wide = [
        "--width",
        "6",
        "--spp",
        "1",
        "--samplers",
        "sobol",
        "--integrators",
        "path",
        "-o",
        "out",
    ];
    report(&folder, &["sky.xml"], &wide).assert().success();
    let found = json(&folder.path().join("out/report.json"));
    assert!(
        found["scenes"][0]["against_skipped"]
            .as_str()
            .unwrap()
            .contains("16 x 8")
    );
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("not compared with Mitsuba"));

    fs::write(folder.path().join("reference/sky.exr"), "no picture").unwrap();
    report(&folder, &["sky.xml"], &wide)
        .assert()
        .code(1)
        .stderr(starts_with("error: reference/sky.exr: ").and(contains("not a readable EXR")));
}

#[test]
fn what_is_wrong_is_told_before_anything_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    // All of it together would take hours.
    let long = ["--width", "4096", "--spp", "65536"];
    let told = |scenes: &[&str], args: &[&str], code: i32, what: &str| {
        let mut command = report(&folder, scenes, &[&long[..], args].concat());
        command.timeout(std::time::Duration::from_secs(60));
        let line = command
            .assert()
            .code(code)
            .stdout(is_empty())
            .stderr(contains(what));
        if code == 1 {
            let text = String::from_utf8(line.get_output().stderr.clone()).unwrap();
            assert!(text.starts_with("error: ") && text.lines().count() == 1, "{text}");
        }
    };
    told(&["spheres", "cornel"], &["-o", "out"], 1, "did you mean cornell?");
    told(&["missing.xml"], &["-o", "out"], 1, "error: missing.xml: ");
    told(&["spheres"], &["-o", "file"], 1, "error: file: is no directory");
    told(&["spheres"], &["-o", "file/out"], 1, "file");
    told(&["spheres"], &[], 2, "--output");
    told(&["spheres"], &["-o", "out", "--samplers", "halton"], 2, "sobol");
    told(&["spheres"], &["-o", "out", "--integrators", "pth"], 2, "'path'");
    assert_eq!(
        fs::read_dir(&folder).unwrap().count(),
        1,
        "something was left behind"
    );
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let line = "report spheres --width 512 --spp 4096 -o out --quiet";
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(&folder)
        .args(line.split_whitespace())
        .stderr(std::process::Stdio::piped())
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
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert!(ends_with("no file was written\n").eval(&String::from_utf8_lossy(&output.stderr)));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

const TINY: [&str; 7] = [
    "--denoisers",
    "--width",
    "16",
    "--reference-spp",
    "2",
    "-o",
    "out",
];

/// Without any program by the name of Open Image Denoise's.
fn denoisers(folder: &TempDir, args: &[&str]) -> Command {
    let mut program = report(folder, &["spheres"], &[&TINY[..], args].concat());
    program.env("PATH", "/nowhere");
    program
}

fn methods(part: &Value) -> Vec<&str> {
    let methods = part["methods"].as_array().unwrap().iter();
    methods.map(|entry| entry["method"].as_str().unwrap()).collect()
}

#[test]
fn denoisers_stand_beside_each_other_and_the_missing_one_is_told() {
    let folder = tempfile::tempdir().unwrap();
    denoisers(&folder, &[])
        .assert()
        .success()
        .stdout(contains("| ours |").and(contains("denoisers.md")));
    let page = fs::read_to_string(folder.path().join("out/denoisers.html")).unwrap();
    let allow = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(&page, allow).unwrap();
    no_reference_leaves(&document);
    let paragraphs = texts(&document, "p");
    let told = |what: &str| paragraphs.iter().any(|text| text.contains(what));
    assert!(told("Open Image Denoise is not here") && told("Open Image Denoise was not trained"));
    let numbers = json(&folder.path().join("out/denoisers.json"));
    assert_eq!(numbers["oidn"], false);
    assert!(numbers["domain"].as_str().unwrap().contains("held out"));
    let parts = numbers["scenes"][0]["parts"].as_array().unwrap();
    let kinds: Vec<&str> = parts.iter().map(|part| part["of"].as_str().unwrap()).collect();
    let expected = [
        "frame_1_spp",
        "frame_4_spp",
        "still_clip",
        "moving_clip",
        "twice_the_size",
    ];
    assert_eq!(kinds, expected);
    let [still, moving] = [0, 3].map(|i| parts[i]["reference_psnr_db"].as_f64().unwrap());
    assert!(
        still > moving + 6.0,
        "16 times the samples: {still} dB, {moving} dB"
    );
    assert_eq!(methods(&parts[0]), ["noisy", "atrous", "joint_bilateral", "ours"]);
    assert_eq!(
        methods(&parts[2]),
        [
            "noisy",
            "atrous",
            "ours_without_history",
            "ours_without_taa",
            "ours"
        ]
    );
    for part in parts {
        for method in part["methods"].as_array().unwrap() {
            let frames = if part["of"].as_str().unwrap().ends_with("clip") {
                8
            } else {
                1
            };
            assert_eq!(method["psnr_db"].as_array().unwrap().len(), frames);
            assert_eq!(method["flicker"].is_number(), frames == 8);
        }
    }
    // What is measured of a single frame is what clips begin with.
    assert_eq!(
        parts[0]["methods"][3]["flip"][0],
        parts[2]["methods"][3]["flip"][0]
    );
    let checks = numbers["checks"].as_array().unwrap();
    let of_oidn = |check: &&Value| check["what"].as_str().unwrap().contains("OIDN");
    assert!(
        checks
            .iter()
            .filter(of_oidn)
            .all(|check| check["mark"] == "unjudged")
    );
    assert!(checks.iter().any(|check| check["mark"] != "unjudged"));
}

/// A program that gives back its input stands for the peer.
#[cfg(unix)]
#[test]
fn the_peer_has_its_columns_where_it_is() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("oidnDenoise");
    fs::write(
        &program,
        "#!/bin/sh\nfor last; do :; done\n/bin/cp \"$6\" \"$last\"\n",
    )
    .unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    denoisers(&folder, &["--oidn", ".", "-q"])
        .assert()
        .success()
        .stdout(is_empty());
    let numbers = json(&folder.path().join("out/denoisers.json"));
    assert_eq!(numbers["oidn"], true);
    let means = numbers["means"].as_array().unwrap();
    let psnr = |of: usize, method: &str| named(&means[of]["methods"], "method", method)["psnr_db"].as_f64();
    assert_eq!(psnr(0, "oidn_high"), psnr(0, "noisy"), "it changes nothing");
    assert_eq!(psnr(3, "oidn_high"), psnr(3, "noisy"));
    assert!(psnr(3, "oidn_high_on_history") > psnr(3, "noisy"));
    assert_eq!(psnr(4, "oidn_high_full_size"), psnr(4, "noisy"));
    assert!(
        psnr(4, "oidn_high_joint_bilateral_upsampling").is_some() && psnr(4, "oidn_high_bilinear").is_some()
    );
    let checks = numbers["checks"].as_array().unwrap();
    let judged = checks.iter().filter(|check| check["mark"] != "unjudged").count();
    assert!(
        judged >= checks.len() - 1,
        "all but uncovered pixels, where there are few"
    );
    // And where it fails nothing is written.
    fs::write(&program, "#!/bin/sh\necho no device >&2\nexit 1\n").unwrap();
    fs::remove_dir_all(folder.path().join("out")).unwrap();
    let told = denoisers(&folder, &["--oidn", "."]).assert().code(1);
    told.stderr(ends_with("oidnDenoise: no device\n"));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn what_does_not_belong_to_denoisers_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let told = denoisers(&folder, &["--oidn", "nothing"]).assert().code(1);
    told.stderr(contains("pip install pyoidn"));
    denoisers(&folder, &["--spp", "4"]).assert().code(2);
    report(&folder, &["spheres"], &["--oidn", ".", "-o", "out"])
        .assert()
        .code(2);
}
