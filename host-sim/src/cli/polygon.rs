//! `host-sim polygon`.

use std::io::{self, Write};

use super::Failure;
use super::args::PolygonArgs;
use crate::picture::Target;
use crate::polygon::{Rings, Steps};

pub fn polygon(args: &PolygonArgs) -> Result<(), Failure> {
    let output = Target::check(&args.output)?;
    let wrong = |what: String| Failure::Wrong(format!("{}: {what}", args.polygon));
    let rings = match Rings::builtin(&args.polygon) {
        Some(rings) => rings,
        None => {
            let text = std::fs::read_to_string(&args.polygon).map_err(|error| {
                wrong(format!(
                    "{error}; give a file, or convex, comb, hole, star or spiral"
                ))
            })?;
            Rings::parse(&text).map_err(|error| wrong(error.to_string()))?
        }
    };
    let steps = Steps::new(&rings).map_err(|error| wrong(error.to_string()))?;
    let svg = steps.svg().map_err(|error| wrong(error.to_string()))?;
    output.write(svg.as_bytes())?;
    if !args.quiet {
        let [cuts, pieces, triangles] = steps.counts();
        let written = args.output.display();
        writeln!(
            io::stdout(),
            "{cuts} cuts, {pieces} convex pieces, {triangles} triangles; written to {written}"
        )?;
    }
    Ok(())
}
