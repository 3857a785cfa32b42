//! The paper's author's own program beside ours, in one run and on one thread: queries of the scene a second.
//!
//! His sources stay where they are. A copy in a temporary folder gets a smaller picture and a counter, loses the one header
//! that is for Windows alone, and is built by `g++ -O3`.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::shell;

/// Pixels a side, samples a pixel; how often the rays of the bare queries are asked.
const SIDE: &str = "128";
const SAMPLES: &str = "64";
const ROUNDS: &str = "100";
/// Turns of all programs, one after the other.
const TURNS: usize = 5;

/// What was measured, millions of queries a second, by turn.
pub struct Race {
    /// His whole program, our whole render.
    whole: [Vec<f64>; 2],
    /// His function for the nearest of planes and spheres, our `Scene::closest`.
    bare: [Vec<f64>; 2],
    compiler: String,
}

/// Builds both and runs them in turns.
pub fn run(sources: &Path) -> Result<Race> {
    let compiler =
        shell::ask(Command::new("g++").arg("--version")).context("g++ is missing: `apt-get install g++`")?;
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    build_his(sources, folder)?;
    shell::run(shell::cargo("build").args(["--release", "--package", "host-sim", "--example", "queries"]))?;
    let ours = shell::target_dir().join("release/examples/queries");
    let rays = folder.join("rays");
    shell::run(Command::new(&ours).arg("rays").arg(&rays))?;
    let mut race = Race {
        whole: [Vec::new(), Vec::new()],
        bare: [Vec::new(), Vec::new()],
        compiler: compiler.lines().next().unwrap_or_default().to_string(),
    };
    for turn in 1..=TURNS {
        race.whole[0].push(speed(&mut Command::new(folder.join("whole")))?);
        race.whole[1].push(speed(Command::new(&ours).args(["whole", SIDE, SAMPLES]))?);
        race.bare[0].push(speed(Command::new(folder.join("bare")).arg(&rays))?);
        race.bare[1].push(speed(Command::new(&ours).args(["bare", ROUNDS]))?);
        println!("turn {turn} of {TURNS}: {}", race.line());
    }
    Ok(race)
}

impl Race {
    fn line(&self) -> String {
        let last = |turns: &[Vec<f64>; 2]| {
            let [his, ours] = turns;
            let last = |turns: &Vec<f64>| turns.last().copied().unwrap_or_default();
            format!("{:.2} and {:.2}", last(his), last(ours))
        };
        format!(
            "whole {}, bare {} million queries a second",
            last(&self.whole),
            last(&self.bare)
        )
    }

    /// The section of the record.
    pub fn text(&self) -> String {
        let mut page = format!(
            "The program that comes with the paper (f64, no tree; 1110011/SoftwareRayTracing, `{}`, -O3)\n\
            and this one, in one run on one thread by `cargo xtask bench-host --seed-program DIR`: medians of {TURNS} turns, of each program in turn;\n\
            ratios are medians of the turns' own. A query: a nearest hit or a shadow test. Wall clock, so that the machine's load\n\
            moves the rates, and the ratios less.\n\n\
            *Whole*: {SIDE} × {SIDE} pixels of {SAMPLES} samples, 9 segments at most. The programs do not do the same work: his takes\n\
            uniform directions without light samples and a light path's end at the last vertex, ours a light sample with its\n\
            weight at every vertex, so that a query of ours carries more shading.\n\
            *Bare*: nearest hits alone of the same 20,000 rays, which leave surfaces; his function looks at 5 shapes, ours at the\n\
            scene's 8.\n\n",
            self.compiler
        );
        page += "| | his, million queries a second | ours | ratio |\n|---|--:|--:|--:|\n";
        for (name, [his, ours]) in [("whole", &self.whole), ("bare", &self.bare)] {
            let ratios: Vec<f64> = his.iter().zip(ours).map(|(his, ours)| ours / his).collect();
            page += &format!(
                "| {name} | {:.2} | {:.2} | {:.2} |\n",
                median(his),
                median(ours),
                median(&ratios)
            );
        }
        let ratios: Vec<f64> = self.whole[0]
            .iter()
            .zip(&self.bare[1])
            .map(|(his, ours)| ours / his)
            .collect();
        page += &format!(
            "\nOur bare queries over his whole program's, which compares unlike work: {:.2}.\n",
            median(&ratios)
        );
        page
    }
}

fn median(turns: &[f64]) -> f64 {
    let mut sorted = turns.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

/// Runs a program that says "N queries T seconds": millions a second.
fn speed(program: &mut Command) -> Result<f64> {
    let told = shell::ask(program.env("OMP_NUM_THREADS", "1"))
        .with_context(|| format!("{} failed", program.get_program().display()))?;
    let words: Vec<&str> = told.split_whitespace().collect();
    let number = |unit: &str| -> Result<f64> {
        let at = words.iter().position(|word| *word == unit);
        let word = at
            .and_then(|at| words.get(at.checked_sub(1)?))
            .context("no number")?;
        Ok(word.parse()?)
    };
    Ok(number("queries")? / number("seconds")? / 1e6)
}

/// His program with a counter, and his nearest hit in a loop of ours.
fn build_his(sources: &Path, folder: &Path) -> Result<()> {
    let read = |name: &str| {
        let file = sources.join(name);
        let text = std::fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        anyhow::Ok(text.replace("\r\n", "\n"))
    };
    for name in [
        "vectorMath.h",
        "math.h",
        "graphicsObjects.h",
        "intersect.h",
        "lightScatteringDistributionSolver.h",
    ] {
        std::fs::write(folder.join(name), read(name)?)?;
    }
    let mut tracer = read("pathTracer.h")?;
    for function in ["bool occlusionTrace(", "vec3 sceneIntersect("] {
        let at = tracer
            .find(function)
            .with_context(|| format!("pathTracer.h has no {function}...)"))?;
        let brace = tracer[at..].find('{').context("no body")? + at + 1;
        tracer.insert_str(brace, "\n    ++queries;\n");
    }
    replace(
        &mut tracer,
        "--recursionLimit;",
        "--recursionLimit;\n    ++queries;",
    )?;
    std::fs::write(folder.join("pathTracer.h"), tracer)?;

    let mut main = read("main.cpp")?;
    let headers = "#include <iostream>\n#include <fstream>\n#include <cmath>\n#include <ctime>\nstatic unsigned long queries = 0;";
    replace(&mut main, "#include \"fileExport.h\"", headers)?;
    let middle = format!("#define imgSizeHalf ({SIDE} / 2.0)");
    replace(&mut main, "#define imgSizeHalf 1024.0d", &middle)?;
    replace(
        &mut main,
        "#define imgSize 2048",
        &format!("#define imgSize {SIDE}"),
    )?;
    replace(
        &mut main,
        "#define numSamples 64",
        &format!("#define numSamples {SAMPLES}"),
    )?;
    let whole = {
        let mut whole = main.clone();
        // The first nearest hit of each pixel, which is written out there.
        replace(
            &mut whole,
            "vec3 hdrColor = vec3(0,0,0);",
            "vec3 hdrColor = vec3(0,0,0); ++queries;",
        )?;
        let export = "exportArrayAsBMP(\"image.bmp\", &buf[0], imgSize, imgSize);";
        let say = "std::cout << queries << \" queries \"\n        \
            << std::chrono::duration<double>(tp2-tp1).count() << \" seconds \";";
        replace(&mut whole, export, say)?;
        whole
    };
    let start = main.find("auto tp1").context("main.cpp has no `auto tp1`")?;
    let mut head = main[..start].to_string();
    replace(&mut head, "int main()", "int main(int, char** argv)")?;
    let bare = head + &BARE.replace("ROUNDS", ROUNDS);
    for (name, text) in [("whole", whole), ("bare", bare)] {
        let file = folder.join(name).with_extension("cpp");
        std::fs::write(&file, text)?;
        // As its author has it, but for the Windows header: -fopenmp, for one thread.
        let mut compile = Command::new("g++");
        compile
            .args(["-O3", "-fopenmp", "-w", "-o"])
            .arg(folder.join(name))
            .arg(&file);
        shell::run(&mut compile)?;
    }
    Ok(())
}

/// The nearest hits of a file of rays; `main`'s head and the scene stand before it.
const BARE: &str = r#"
    std::ifstream file(*++argv, std::ios::binary);
    std::vector<ray> rays;
    double n[6];
    while (file.read((char*)n, sizeof n))
        rays.push_back(ray(vec3(n[0], n[1], n[2]), vec3(n[3], n[4], n[5])));
    vec3 ip, col;
    double sum = 0;
    auto from = std::chrono::steady_clock::now();
    for (int i = 0; i < ROUNDS; ++i)
        for (size_t r = 0; r < rays.size(); ++r)
            sum += sceneIntersect(rays[r], planes, d, spheres, ip, col).x + ip.y;
    std::chrono::duration<double> took = std::chrono::steady_clock::now() - from;
    std::cout << queries << " queries " << took.count() << " seconds " << sum << "\n";
}
"#;

/// Replaces what must be there once.
fn replace(text: &mut String, from: &str, to: &str) -> Result<()> {
    let count = text.matches(from).count();
    ensure!(
        count == 1,
        "the author's sources have {count} times `{from}`, where they should have it once: is it 1110011/SoftwareRayTracing?"
    );
    *text = text.replace(from, to);
    Ok(())
}
