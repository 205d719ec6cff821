//! What tests of the real window share: a display without a screen with hands on its keyboard and mouse ([`display`]),
//! and a viewer whose log is read ([`viewer`]).

pub mod display;
pub mod viewer;

use std::path::{Path, PathBuf};

/// Where pictures of the window go, for people to look at.
pub fn pictures() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/window-test");
    std::fs::create_dir_all(&folder).expect("the target folder is ours");
    folder
}
