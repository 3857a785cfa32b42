//! The command line.

use anyhow::Result;
use clap::{Parser, Subcommand};

use crate::{
    accuracy, bench_bdpt, bench_denoiser, bench_host, ci, device, fuzz, golden, growth, layers, no_float,
    profile, raystones, sampling, setup, shell,
};

/// The chores of microlux.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", arg_required_else_help = true)]
pub struct Xtask {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Check everything that must hold before a change goes in
    ///
    /// Runs the steps in order and stops at the first that fails. `cargo xtask setup` installs what they need.
    Ci(ci::Options),
    /// Install what is missing on this machine
    Setup(setup::Options),
    /// Tell on modules of the core that use one to their right
    ///
    /// The order is num, color, geom, sampler, shape, bvh, material, light, camera, scene, integrator, render,
    /// setup; film uses num and color, and render uses film. Code under #[cfg(test)] is exempt.
    Layers,
    /// Look for soft-float routines in a linked Cortex-M0+ program
    ///
    /// Links tests/no-float, which renders through the public API, for thumbv6m-none-eabi and reads its symbols; then
    /// links it once more with a float planted, which must be found.
    NoFloat,
    /// Run a board's firmware in its emulator; the Pico's display becomes a PNG
    ///
    /// Builds the firmware, runs it with the display model on its SPI bus, and fails unless the display shows, bit for
    /// bit, what this computer renders.
    Device(device::Options),
    /// Measure the firmware on each emulated core and write docs/device.md
    BenchDevice(device::BenchOptions),
    /// Count instructions on this computer and write docs/performance.md
    BenchHost(bench_host::Options),
    /// Count what the example `raystones` takes on each emulated core, beside the C program in floats
    ///
    /// Prints the table and writes it into docs/performance.md.
    Raystones(raystones::Options),
    /// Count what each stage of the boards' pictures takes on emulated cores, beside a lower bound
    ///
    /// Prints the tables and writes them into docs/performance.md.
    Profile(profile::Options),
    /// Count what each stage of the denoiser takes on emulated cores
    ///
    /// Prints the table and writes it into docs/denoiser.md.
    BenchDenoiser(bench_denoiser::Options),
    /// Count what a ray costs as triangles, strips and samples become more
    ///
    /// Writes the tables and a curve into docs/performance.md and docs/img.
    Growth(growth::Options),
    /// Measure what bidirectional path tracing is worth and write docs/transport.md
    BenchBdpt(bench_bdpt::Options),
    /// Measure what the samplers are worth and write docs/sampling.md
    ///
    /// Renders every built-in scene, and scene files, with every sampler at 1 to 64 samples a pixel: the error at equal
    /// samples, how fast it falls, and what is left of it from a distance. Takes about an hour.
    Sampling(sampling::Options),
    /// Compare the golden pictures with the record
    Golden(golden::Options),
    /// Feed the core and the importers with what nobody would write, to see that nothing panics
    ///
    /// Each target of fuzz/ for a while, from the corpus that is kept there. What finds something is written to
    /// fuzz/artifacts.
    Fuzz(fuzz::Options),
    /// Measure the picture's errors and write docs/accuracy.md
    ///
    /// Compares fixed point with the f64 reference on every built-in scene, and on scene files with Mitsuba's pictures
    /// too. Takes some ten minutes; Mitsuba's own error is measured where `cargo xtask setup --what oracle` has put it.
    Accuracy(accuracy::Options),
}

impl Xtask {
    /// Does the chore that was asked for.
    pub fn run(self) -> Result<()> {
        match self.chore {
            Chore::Ci(options) => ci::run(&options),
            Chore::Setup(options) => setup::run(&options),
            Chore::Layers => layers::check(&shell::root()).map(|summary| println!("{summary}")),
            Chore::NoFloat => no_float::check(&shell::root()).map(|summary| println!("{summary}")),
            Chore::Device(options) => device::run(&options),
            Chore::BenchDevice(options) => device::bench(&options),
            Chore::BenchHost(options) => bench_host::run(&options),
            Chore::Raystones(options) => raystones::run(&options),
            Chore::Profile(options) => profile::run(&options),
            Chore::BenchDenoiser(options) => bench_denoiser::run(&options),
            Chore::Growth(options) => growth::run(&options),
            Chore::BenchBdpt(options) => bench_bdpt::run(&options),
            Chore::Sampling(options) => sampling::run(&options),
            Chore::Golden(options) => golden::run(&options),
            Chore::Fuzz(options) => fuzz::run(&options),
            Chore::Accuracy(options) => accuracy::run(&options),
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Xtask::command().debug_assert();
    }
}
