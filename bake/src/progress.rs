//! Events → a progress bar for people, or JSON lines for programs.

use std::io::{IsTerminal, Write};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressDrawTarget, ProgressStyle};

use crate::events::{Event, Listener};
use crate::say;

/// One JSON object a line, on standard output.
pub struct JsonLines;

impl Listener for JsonLines {
    fn tell(&self, event: &Event) {
        // Exactly, where `say!` would make control characters visible. The reader may have gone.
        let line = serde_json::to_string(event).expect("events are plain data");
        let _ = writeln!(std::io::stdout().lock(), "{line}");
    }
}

/// A progress bar on standard error.
pub struct ProgressBar {
    bar: indicatif::ProgressBar,
    running: Mutex<Vec<String>>,
}

impl ProgressBar {
    /// Stays hidden until there is something to compute, and where standard error is no terminal.
    pub fn new() -> Self {
        let style =
            ProgressStyle::with_template("{bar:32.green/dim} {pos}/{len} {elapsed:.dim}  {wide_msg:.dim}")
                .expect("a valid template")
                .progress_chars("━━─");
        let bar = indicatif::ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        Self { bar: bar.with_style(style), running: Mutex::default() }
    }

    fn show(&self) {
        if self.bar.is_hidden() && std::io::stderr().is_terminal() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }

    fn update(&self, change: impl FnOnce(&mut Vec<String>)) {
        let mut running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut running);
        self.bar.set_message(running.join(", "));
    }
}

/// Says on standard error, if that is a terminal, what is being done and for how long, until it is cleared.
pub fn spinner(message: String) -> indicatif::ProgressBar {
    let style =
        ProgressStyle::with_template("{spinner} {wide_msg:.dim} {elapsed:.dim}").expect("a valid template");
    let spinner = indicatif::ProgressBar::new_spinner().with_style(style).with_message(message);
    spinner.enable_steady_tick(Duration::from_millis(100));
    spinner
}

impl Listener for ProgressBar {
    fn tell(&self, event: &Event) {
        match event {
            Event::Planned { stages, .. } => self.bar.set_length(*stages as u64),
            Event::Started { stage, scenes } => {
                self.show();
                self.update(|running| running.push(label(stage, scenes)));
            }
            Event::Finished { stage, scenes, .. } => {
                let ended = label(stage, scenes);
                self.update(|running| running.retain(|stage| *stage != ended));
                self.bar.inc(1);
            }
            Event::Notice { message } => self.bar.suspend(|| say::warn(format_args!("note: {message}"))),
            Event::Bred { parent, path } => {
                self.bar
                    .suspend(|| say::warn(format_args!("bred {path} from the votes on generation {parent}")));
            }
            Event::Exporting { files } => {
                self.show();
                self.bar.set_length(*files as u64);
            }
            Event::Written { .. } => self.bar.inc(1),
            Event::SceneReady { .. } | Event::Superseded | Event::Done { .. } | Event::Failed { .. } => {}
        }
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// A stage with its landscape as people count it, if only one uses it.
fn label(stage: &str, scenes: &[usize]) -> String {
    match scenes {
        [one] => format!("{stage} ({})", one + 1),
        _ => stage.to_owned(),
    }
}
