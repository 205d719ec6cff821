//! The viewer's program: a window, a picture without one, or measurements.

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;
use genescape_viewer::app::{self, Start};
use genescape_viewer::baker::BakerOptions;
use genescape_viewer::cli::{Cli, Command};
use genescape_viewer::settings::SettingsFile;
use genescape_viewer::{bench, screenshot};
use genescape_world::Source;

fn main() -> ExitCode {
    match run(&Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(cli: &Cli) -> Result<()> {
    if let Some(Command::Bench(args)) = &cli.command {
        return bench::run(args);
    }
    let path = cli.path.as_ref().unwrap_or(&cli.world);
    let source = Source::of(path)?;
    if let Some(out) = &cli.screenshot {
        return screenshot::take(cli, &source, out);
    }
    let bake = BakerOptions { threads: cli.threads, side: cli.heightfield, poll: cli.poll };
    app::run(Start {
        source,
        settings: cli.settings.clone().or_else(SettingsFile::usual_path),
        bake: (!cli.no_bake).then_some(bake),
        shaders: cli.shaders.clone(),
        poll: cli.poll,
        pictures: cli.pictures.clone(),
        size: cli.size.map(|size| size.map(|side| side as f32)),
        log: cli.log.clone(),
    })
}
