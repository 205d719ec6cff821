//! Bytes → file by temporary file and rename, so that a crash, a full disk or a pulled plug leaves either the old file
//! or the new one, whole. A missing folder is made.

use std::fs;
use std::io::{Error, ErrorKind, Result, Write};
use std::path::Path;

use tempfile::NamedTempFile;

/// Writes a file that must not exist yet, synced: what a person made.
///
/// # Errors
/// What the system says; [`ErrorKind::AlreadyExists`] for a file that is there.
pub fn create(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    let draft = draft(path, bytes.as_ref())?;
    draft.as_file().sync_all()?;
    draft.persist_noclobber(path).map_err(|error| error.error)?;
    Ok(())
}

/// Replaces or creates a file, synced. A link is followed, permissions are kept.
///
/// # Errors
/// What the system says, and [`ErrorKind::PermissionDenied`] for a read-only file, which its owner wants left alone.
/// The old file is then untouched.
pub fn replace(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    let path = &fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let draft = draft(path, bytes.as_ref())?;
    if let Ok(old) = fs::metadata(path) {
        if old.permissions().readonly() {
            return Err(Error::new(ErrorKind::PermissionDenied, "the file is read-only"));
        }
        draft.as_file().set_permissions(old.permissions())?;
    }
    draft.as_file().sync_all()?;
    draft.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// Replaces or creates a file that can be made again: not synced.
///
/// # Errors
/// What the system says; the old file is then untouched.
pub fn replace_unsynced(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    draft(path, bytes.as_ref())?.persist(path).map_err(|error| error.error)?;
    Ok(())
}

fn draft(path: &Path, bytes: &[u8]) -> Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder)?;
    let mut builder = tempfile::Builder::new();
    // A temporary file is private by default; what is renamed into place is for everyone to read.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    let mut draft = builder.prefix(".draft-").tempfile_in(folder)?;
    draft.write_all(bytes)?;
    Ok(draft)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("new/file.ron");
        create(&path, "one").expect("created with its folder");
        assert_eq!(create(&path, "again").expect_err("there").kind(), ErrorKind::AlreadyExists);
        replace(&path, "two").expect("replaced");
        assert_eq!(fs::read_to_string(&path).expect("there"), "two");
        let mut locked = fs::metadata(&path).expect("there").permissions();
        locked.set_readonly(true);
        fs::set_permissions(&path, locked).expect("locked");
        replace(&path, "three").expect_err("read-only");
        assert_eq!(fs::read_to_string(&path).expect("there"), "two");
        replace_unsynced(&folder.path().join("baked/scene.gltf"), "{}").expect("created with its folder");
        let left = fs::read_dir(path.parent().expect("a folder")).expect("a folder").count();
        assert_eq!(left, 1, "no draft is left behind");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_permissions_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, "old").expect("written");
        fs::set_permissions(&real, PermissionsExt::from_mode(0o640)).expect("set");
        std::os::unix::fs::symlink(&real, &link).expect("linked");
        replace(&link, "new").expect("saved");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        assert_eq!(fs::read_to_string(&real).expect("there"), "new");
        assert_eq!(fs::metadata(&real).expect("there").permissions().mode() & 0o777, 0o640);
    }
}
