//! Where a program writes what a person asked for: never over what it was made from, never into a world's own folders.

use std::fs;
use std::path::{Path, PathBuf};

use crate::names;

/// Why a file is not written.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadOutput {
    #[error("{}: the name of the file to write must end in .{ending}", .path.display())]
    Ending { path: PathBuf, ending: &'static str },
    #[error("{} is what is being read: give another name to write to", .0.display())]
    Input(PathBuf),
    #[error("{} lies in {}, which holds what a world is made of: write elsewhere", .path.display(), .folder.display())]
    OfWorld { path: PathBuf, folder: PathBuf },
}

/// Whether `path`, which need not exist, may be written: its name ends in `ending`, it is none of `inputs`, and it lies
/// in no world's folder of populations, of kinds or of baked files.
///
/// # Errors
/// What is wrong with it.
pub fn check(path: &Path, ending: &'static str, inputs: &[PathBuf]) -> Result<(), BadOutput> {
    if path.extension().is_none_or(|found| !found.eq_ignore_ascii_case(ending)) {
        return Err(BadOutput::Ending { path: path.to_owned(), ending });
    }
    let real = real(path);
    if inputs.iter().any(|input| self::real(input) == real) {
        return Err(BadOutput::Input(path.to_owned()));
    }
    match real.ancestors().skip(1).find(|folder| is_of_world(folder)) {
        Some(folder) => Err(BadOutput::OfWorld { path: path.to_owned(), folder: folder.to_owned() }),
        None => Ok(()),
    }
}

/// The path with links resolved, as far as it exists.
fn real(path: &Path) -> PathBuf {
    if let Ok(real) = fs::canonicalize(path) {
        return real;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match path.file_name() {
        Some(name) if folder != path => real(folder).join(name),
        _ => path.to_owned(),
    }
}

/// Whether a folder is a world's `population`, `kinds` or `baked`.
fn is_of_world(folder: &Path) -> bool {
    let is_named = [names::POPULATIONS, names::BAKED, names::KINDS].iter().any(|name| folder.ends_with(name));
    let world = folder.parent().filter(|_| is_named);
    world.is_some_and(|world| world.join(names::SPACE).is_file() || world.join(names::CURRENT).is_file())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;

    #[test]
    fn an_output_is_no_input_and_no_file_of_a_world() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let at = |name: &str| folder.path().join(name);
        let world = World::open_or_create(&at("world")).expect("made");
        world.begin().expect("begun");
        fs::write(at("model.glb"), "mine").expect("written");
        let check = |path: &Path| check(path, "glb", &[at("model.glb")]);

        for fine in ["new.glb", "NEW.GLB", "new/folder/a.glb", "world/a.glb", "world/pictures/a.glb"] {
            assert_eq!(check(&at(fine)), Ok(()), "{fine}");
        }
        for wrong in ["model.obj", "glb", "model", "world/space.ron", "world/population/g0000.ron", "a.png"] {
            assert!(matches!(check(&at(wrong)), Err(BadOutput::Ending { .. })), "{wrong}");
        }
        for input in ["model.glb", "./model.glb", "world/../model.glb"] {
            assert!(matches!(check(&at(input)), Err(BadOutput::Input(_))), "{input}");
        }
        for of_world in [
            "world/population/a.glb",
            "world/baked/blobs/ab/a.glb",
            "world/population/x/a.glb",
            "world/kinds/a.glb",
        ] {
            assert!(matches!(check(&at(of_world)), Err(BadOutput::OfWorld { .. })), "{of_world}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_an_input_is_that_input() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (model, link) = (folder.path().join("model.glb"), folder.path().join("link.glb"));
        fs::write(&model, "mine").expect("written");
        std::os::unix::fs::symlink(&model, &link).expect("linked");
        assert!(matches!(check(&link, "glb", &[model]), Err(BadOutput::Input(_))));
    }
}
