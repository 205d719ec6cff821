//! A developer's chores: the whole check (`test`) and what it compares with (`bless`), lines of code (`lines`), times
//! beside those of a peer (`bench`), the wait after a vote (`waits`), set-up of the programs that these need (`setup`),
//! contact sheets of landscapes (`gallery`), and the picture in the README (`pictures`). Knows nothing of landscapes: it runs
//! other programs and reports.
#![expect(clippy::print_stdout, reason = "a command line program")]

mod bench;
mod check;
mod gallery;
mod lines;
mod pictures;
mod setup;
mod source;
#[cfg(test)]
mod tidy;
mod tools;
mod waits;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Genescape's developer chores.
#[derive(Parser)]
#[command(bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Everything that must hold before a change is merged; ends with "N passed, N failed".
    Test(check::Extent),
    /// Write anew what tests compare with, after it was meant to change.
    Bless { what: check::Blessing },
    /// Count lines of Rust: code, tests (folders `tests` and `examples`, and what is behind `cfg(test)`), comments, blank;
    /// as the review of commit 4d67e5a did, which found 31749 lines of code.
    Lines {
        /// Also list that many files with the most code.
        #[arg(long, default_value_t = 0)]
        largest: usize,
    },
    /// Install the programs that `test --interop` and `pictures` need into .interop/.
    Setup,
    /// Time every stage, then a whole bake against ez-tree making as many trees, then the viewer's pictures, alone and
    /// against three.js in Chromium (packages go to .interop/).
    Bench {
        /// Runs of `bake bench`.
        #[arg(long, default_value_t = 3)]
        runs: u32,
    },
    /// Vote in a window as a person does, and time how long the next landscapes take to come. Minutes, best on a machine
    /// that does nothing else.
    Waits {
        /// Generations.
        #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..))]
        rounds: u32,
    },
    /// Contact sheets of random landscapes as they come, and of generations bred by random votes.
    Gallery(gallery::Options),
    /// Bake the starters and render all four with Blender into docs/pictures/starters.jpg.
    Pictures {
        /// Samples a pixel.
        #[arg(long, default_value_t = 48)]
        samples: u32,
    },
}

fn main() -> ExitCode {
    let done = match Cli::parse().chore {
        Chore::Test(extent) => Ok(check::run(extent)),
        Chore::Bless { what } => check::bless(what).map(|()| true),
        Chore::Lines { largest } => lines::run(largest).map(|()| true),
        Chore::Bench { runs } => bench::bench(runs).map(|()| true),
        Chore::Waits { rounds } => waits::waits(rounds).map(|()| true),
        Chore::Gallery(options) => gallery::run(&options).map(|()| true),
        Chore::Setup => setup::all().map(|()| true),
        Chore::Pictures { samples } => pictures::run(samples).map(|()| true),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            println!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
