//! Shows four baked landscapes at once, walked through together and voted on.
//!
//! Data goes one way: files → [`load`] → [`scene`] (plain values) → [`upload`] (buffers and textures) → [`passes`]
//! (pictures, in a [`view`] each), with events coming in from the person.

pub mod app;
pub mod baker;
pub mod ballots;
pub mod bench;
pub mod camera;
pub mod cli;
pub mod edit_history;
pub mod event;
pub mod export_choice;
#[cfg(feature = "gamepad")]
pub mod gamepad;
pub mod gpu;
pub mod headless;
pub mod image_file;
pub mod input;
pub mod lab;
pub mod load;
pub mod loader;
pub mod lod;
pub mod lod_mode;
pub mod manual;
pub mod measure;
pub mod options;
pub mod passes;
pub mod questionnaire;
pub mod scene;
pub mod scene_loader;
pub mod screenshot;
pub mod settings;
pub mod study;
pub mod ui;
pub mod upload;
pub mod view;
pub mod walk;

/// `println!` that goes on when nothing reads it any more, as in `viewer bench | head`, and in which no name out of a file
/// steers the terminal.
macro_rules! say {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout().lock(), "{}", genescape_schema::printable(&format!($($words)*)));
    }};
}
use say;
