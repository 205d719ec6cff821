//! The viewer's program: a window, a picture without one, or measurements.

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;
use genescape_schema::printable;
use genescape_viewer::cli::{Cli, Command};
use genescape_viewer::{app, bench, manual, screenshot};
use genescape_world::output::BadOutput;
use genescape_world::{Source, WorldError};

const FAILED: u8 = 1;
/// As for what clap refuses.
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let is_bad_input =
                error.is::<BadOutput>() || error.downcast_ref().is_some_and(WorldError::is_bad_input);
            eprintln!("error: {}", printable(&format!("{error:#}")));
            ExitCode::from(if is_bad_input { BAD_INPUT } else { FAILED })
        }
    }
}

fn run(cli: Cli) -> Result<()> {
    match &cli.command {
        Some(Command::Bench(args)) => return bench::run(args),
        Some(Command::Completions { shell }) => return manual::completions(*shell),
        Some(Command::Man { folder }) => return manual::man(folder.as_deref()),
        None => {}
    }
    let source = Source::of(cli.path.as_ref().unwrap_or(&cli.world))?;
    if let Source::World(root) = &source
        && cli.no_bake
        && !root.exists()
    {
        // Nobody would make it.
        return Err(WorldError::NoWorld(root.clone()).into());
    }
    match &cli.screenshot {
        Some(out) => screenshot::take(&cli, &source, out),
        None => app::run(cli, source),
    }
}
