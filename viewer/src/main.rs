//! The viewer's program: a window, a picture without one, or measurements.

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;
use genescape_viewer::cli::{Cli, Command};
use genescape_viewer::{app, bench, screenshot};
use genescape_world::Source;

fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(cli: Cli) -> Result<()> {
    if let Some(Command::Bench(args)) = &cli.command {
        return bench::run(args);
    }
    let source = Source::of(cli.path.as_ref().unwrap_or(&cli.world))?;
    match &cli.screenshot {
        Some(out) => screenshot::take(&cli, &source, out),
        None => app::run(cli, source),
    }
}
