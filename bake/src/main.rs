//! The `bake` command: reads the command line, does it, and turns the outcome into messages and an exit code.

use std::process::ExitCode;

use clap::Parser;
use genescape_bake::cli::Cli;
use genescape_bake::commands;

fn main() -> ExitCode {
    ExitCode::from(commands::run(Cli::parse()))
}
