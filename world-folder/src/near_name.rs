//! A folder that is not there → the world beside it that a typing error may have missed.

use std::fs;
use std::path::{Path, PathBuf};

use crate::names::POPULATIONS;

/// The name that `bake` and the viewer use where none is given: nobody mistyped it.
const DEFAULT_NAME: &str = "world";

/// The world in the same folder whose name is nearest to that of `root`, if `root` does not exist and one is so near that
/// it was probably meant. Names that differ in their numbers alone are both meant: alps1, alps2.
pub fn near_world(root: &Path) -> Option<PathBuf> {
    let name = root.file_name()?.to_str().filter(|name| *name != DEFAULT_NAME)?;
    if fs::symlink_metadata(root).is_ok() {
        return None;
    }
    let folder = root.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let near = fs::read_dir(folder).ok()?.filter_map(|entry| {
        let other = entry.ok()?.file_name().into_string().ok()?;
        let distance = distance(name, &other)?;
        root.with_file_name(&other).join(POPULATIONS).is_dir().then_some((distance, other))
    });
    Some(root.with_file_name(near.min()?.1))
}

/// How many typing errors lie between two names; `None` if they are too many.
fn distance(name: &str, other: &str) -> Option<usize> {
    let letters = |name: &str| name.chars().filter(|c| c.is_alphabetic()).collect::<String>();
    let max = if name.chars().count() < 4 { 1 } else { 2 };
    let distance = strsim::osa_distance(name, other);
    // Two names of a letter or two have too little in common for one to be the other mistyped.
    let shorter = name.chars().count().min(other.chars().count());
    (2 * distance < shorter && distance <= max && letters(name) != letters(other)).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_name_is_found_and_a_new_one_is_not_doubted() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let at = |name: &str| folder.path().join(name);
        for name in ["alps/population", "alps-1/population", "arps", "world/population", "t/population"] {
            fs::create_dir_all(at(name)).expect("made");
        }
        for typo in ["alpz", "apls", "alsp", "alp", "alpss"] {
            assert_eq!(near_world(&at(typo)), Some(at("alps")), "{typo}");
        }
        for fine in ["alps", "arps", "pyrenees", "alps-2", "alps-10", "al", "w", "world", "none/alpz"] {
            assert_eq!(near_world(&at(fine)), None, "{fine}");
        }
        fs::create_dir(at("alpz")).expect("made");
        assert_eq!(near_world(&at("alpz")), None, "whoever made the folder means it");
    }
}
