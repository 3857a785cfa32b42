//! Data, training, export and evaluation of microlux's denoiser, one command each.

mod classical;
mod curve;
mod data;
mod evaluate;
mod export;
mod nn;
mod picture;
mod scenes;
mod size;
mod train;

use anyhow::Result;
use clap::Parser;

/// Trains the weights of microlux's denoiser: data, then train, then export; evaluate tells how good they are
#[derive(Debug, Parser)]
enum Trainer {
    /// Make scenes by program and render them: noisy samples and references
    Data(data::Options),
    /// Learn from the data; goes on where it was interrupted
    Train(train::Options),
    /// Write the weights as source of the core
    Export(export::Options),
    /// Measure on scenes that training never saw, beside other filters
    Evaluate(evaluate::Options),
    /// Train networks of several sizes alike and measure them: size against quality
    Curve(curve::Options),
}

fn main() -> Result<()> {
    match Trainer::parse() {
        Trainer::Data(options) => data::run(&options),
        Trainer::Train(options) => train::run(&options),
        Trainer::Export(options) => export::run(&options),
        Trainer::Evaluate(options) => evaluate::run(&options),
        Trainer::Curve(options) => curve::run(&options),
    }
}
