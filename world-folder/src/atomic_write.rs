//! Bytes → file by temporary file and rename, so that a crash, a full disk or a pulled plug leaves either the old file
//! or the new one, whole. A missing folder is made.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Result, Write};
use std::path::Path;
use std::time::Duration;

use tempfile::NamedTempFile;

/// How the name of a draft begins, and how many characters follow.
const DRAFT: &str = ".draft-";
const RANDOM: usize = 6;
/// A draft that was written to more recently is not swept.
const GRACE: Duration = Duration::from_secs(600);

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

/// Removes the drafts in a folder that killed programs left there; how many.
///
/// # Errors
/// A folder that cannot be read, or a draft that cannot be removed.
pub fn sweep(folder: &Path) -> Result<usize> {
    let mut swept = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if is_draft(&entry.file_name().to_string_lossy()) && is_abandoned(&entry)? {
            fs::remove_file(entry.path())?;
            swept += 1;
        }
    }
    Ok(swept)
}

fn is_draft(name: &str) -> bool {
    let random = name.strip_prefix(DRAFT).unwrap_or_default();
    random.len() == RANDOM && random.bytes().all(|b| b.is_ascii_alphanumeric())
}

/// A writer locks its draft, and the system takes the lock back when it dies. A new draft is spared: it may not be locked
/// yet.
fn is_abandoned(draft: &fs::DirEntry) -> Result<bool> {
    let meta = draft.metadata()?;
    let is_old = meta.modified()?.elapsed().is_ok_and(|age| age >= GRACE);
    Ok(meta.is_file() && is_old && File::options().append(true).open(draft.path())?.try_lock().is_ok())
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
    let made = builder.prefix(DRAFT).rand_bytes(RANDOM).tempfile_in(folder);
    // The message would name the draft, which nobody asked for; its number says the same.
    let mut draft = made.map_err(|error| Error::from(error.kind()))?;
    // Some network folders have no locks; there no draft is ever swept.
    let _ = draft.as_file().lock();
    draft.write_all(bytes)?;
    Ok(draft)
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

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
        let left = fs::read_dir(path.parent().expect("a folder")).expect("a folder").count();
        assert_eq!(left, 1, "no draft is left behind");
    }

    #[test]
    fn drafts_of_the_dead_are_swept_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = |name: &str| folder.path().join(name);
        let living = draft(&path("g0000.ron"), b"half").expect("written");
        for name in [".draft-Ab3xYz", ".draft-Young1", ".draft-notes of mine", "g0000.ron"] {
            fs::write(path(name), "half").expect("written");
        }
        fs::create_dir(path(".draft-folder")).expect("made");
        let age = |path: &Path| {
            let file = File::options().append(true).open(path).expect("there");
            file.set_modified(SystemTime::now() - 2 * GRACE).expect("set");
        };
        for name in [".draft-Ab3xYz", ".draft-notes of mine", "g0000.ron"] {
            age(&path(name));
        }
        age(living.path());
        assert_eq!(sweep(folder.path()).expect("swept"), 1);
        assert!(!path(".draft-Ab3xYz").exists() && path(".draft-Young1").exists() && living.path().exists());
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 5);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn an_error_names_no_draft() {
        let error = create(Path::new("/proc/a.glb"), "one").expect_err("no place for files").to_string();
        assert!(!error.contains("draft"), "{error}");
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
