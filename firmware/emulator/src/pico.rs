//! The Pico: its firmware in the RP2040 emulator, with the display model on its SPI bus.
use std::{path::{Path}, process::Command};
use anyhow::Result;
#[derive(clap::Args)]
pub struct Options {}
pub fn run(_: &Options) -> Result<()> { Ok(()) }
pub fn bare(_p: &Path) -> Result<Command> { anyhow::bail!("x") }
