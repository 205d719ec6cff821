//! The viewer's program: a window, a picture without one, or measurements.

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;
use genescape_schema::printable;
use genescape_viewer::cli::{Cli, Command};
use genescape_viewer::image_file::TooLarge;
use genescape_viewer::load::LoadError;
use genescape_viewer::{app, bench, lab, manual, screenshot, study};
use genescape_world::output::BadOutput;
use genescape_world::{Source, WorldError, file_limit};

const FAILED: u8 = 1;
/// As for what clap refuses.
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    let cli = Cli::parse();
    file_limit::is_an_error();
    #[cfg(target_os = "linux")]
    if cli.screenshot.is_some() || matches!(cli.command, Some(Command::Bench(_) | Command::Lab(_))) {
        leave_the_desktop_alone();
    }
    match run(cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let is_bad_input = error.is::<BadOutput>()
                || error.is::<TooLarge>()
                || error.downcast_ref().is_some_and(WorldError::is_bad_input)
                || error.downcast_ref().is_some_and(LoadError::is_bad_input);
            eprintln!("error: {}", printable(&format!("{error:#}")));
            ExitCode::from(if is_bad_input { BAD_INPUT } else { FAILED })
        }
    }
}

/// Begins again, with one more variable, where no desktop is there. Mesa's layer that orders devices asks Wayland for its
/// opinion as soon as Vulkan is opened, which complains on the terminal of the folder it lacks. A process must not change
/// its own variables while drivers' threads may read them, so it is replaced by one that has another.
#[cfg(target_os = "linux")]
fn leave_the_desktop_alone() {
    use std::os::unix::process::CommandExt;
    const NO_ORDER: &str = "NODEVICE_SELECT";
    let is_set = |name: &str| std::env::var_os(name).is_some();
    if is_set("XDG_RUNTIME_DIR") || is_set(NO_ORDER) {
        return;
    }
    let mut words = std::env::args_os();
    if let (Ok(program), Some(name)) = (std::env::current_exe(), words.next()) {
        // It comes back only if it cannot; then the line is printed, and all else is as it was.
        let _ = std::process::Command::new(program).arg0(name).args(words).env(NO_ORDER, "1").exec();
    }
}

fn run(cli: Cli) -> Result<()> {
    match &cli.command {
        Some(Command::Bench(args)) => return bench::run(args),
        Some(Command::Lab(args)) => return lab::run(args),
        Some(Command::Study(args)) => return study::run(args),
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
