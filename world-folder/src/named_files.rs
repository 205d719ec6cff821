//! Files that a model names → their bytes. A model may come from a stranger and what is made of it may go back there, so
//! it gets regular files inside its own folder and no others, of bounded size in all. Blobs of a cache may lie elsewhere:
//! they are named by the digest of their bytes, which is checked, so whoever names one has it already.

use std::collections::BTreeSet;
use std::fs;
use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use percent_encoding::percent_decode_str;

use crate::regular_file;

/// What a model may hold, and what all files that it names may hold together, in bytes.
pub const MAX_MODEL_BYTES: u64 = 2 << 30;

/// The files that one model may name.
#[derive(Debug)]
pub struct NamedFiles {
    folder: PathBuf,
    /// How many bytes may still be read.
    left: AtomicU64,
    read: Mutex<BTreeSet<PathBuf>>,
}

impl NamedFiles {
    /// Those that the model in this file may name.
    pub fn of(model: &Path) -> Self {
        let folder = model.parent().filter(|folder| !folder.as_os_str().is_empty());
        Self {
            folder: folder.unwrap_or(Path::new(".")).to_owned(),
            left: AtomicU64::new(MAX_MODEL_BYTES),
            read: Mutex::default(),
        }
    }

    /// The bytes of a file named by a URI, in which characters may be given as percent codes.
    ///
    /// # Errors
    /// As [`NamedFiles::read`].
    pub fn read_uri(&self, uri: &str) -> Result<Vec<u8>> {
        self.read(&percent_decode_str(uri).decode_utf8_lossy())
    }

    /// The bytes of the file of that name, relative to the model's folder.
    ///
    /// # Errors
    /// [`ErrorKind::PermissionDenied`] for what lies outside the folder, [`ErrorKind::InvalidData`] for a blob that is
    /// damaged, and those of [`regular_file::read`].
    pub fn read(&self, name: &str) -> Result<Vec<u8>> {
        let digest = Path::new(name).file_stem().and_then(|stem| stem.to_str());
        let digest = digest.and_then(|stem| blake3::Hash::from_hex(stem).ok());
        let path = self.place(name, digest.is_some())?;
        let bytes = regular_file::read(&path, self.left.load(Ordering::Relaxed))?;
        if digest.is_some_and(|promised| promised != blake3::hash(&bytes)) {
            let message = "it is damaged: its bytes are not those that its name promises";
            return Err(Error::new(ErrorKind::InvalidData, message));
        }
        let less = |left: u64| left.checked_sub(bytes.len() as u64);
        if self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_err() {
            return Err(Error::new(ErrorKind::FileTooLarge, "the files of one model are too large together"));
        }
        self.seen().insert(path);
        Ok(bytes)
    }

    /// What has been read so far.
    pub fn files(&self) -> Vec<PathBuf> {
        self.seen().iter().cloned().collect()
    }

    fn seen(&self) -> MutexGuard<'_, BTreeSet<PathBuf>> {
        self.read.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Where a file of that name lies, with links resolved; it is there.
    fn place(&self, name: &str, is_blob: bool) -> Result<PathBuf> {
        let outside = || {
            Error::new(ErrorKind::PermissionDenied, "it lies outside the folder of the file that names it")
        };
        // Before the system is asked: on Windows even to look at `\\server\share` sends the person's name there.
        let mut depth = 0;
        for part in Path::new(name).components() {
            depth += match part {
                Component::Normal(_) => 1,
                Component::CurDir => 0,
                Component::ParentDir => -1,
                Component::RootDir | Component::Prefix(_) => return Err(outside()),
            };
            if depth < 0 && !is_blob {
                return Err(outside());
            }
        }
        let path = fs::canonicalize(self.folder.join(name))?;
        match is_blob || path.starts_with(fs::canonicalize(&self.folder)?) {
            true => Ok(path),
            false => Err(outside()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with `secret` and, inside, `model/` with `near`, `sub/deep`, and what `more` puts there.
    fn folder() -> (tempfile::TempDir, NamedFiles) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let model = folder.path().join("model");
        fs::create_dir_all(model.join("sub")).expect("made");
        for (file, text) in [("secret", "secret"), ("model/near one", "near"), ("model/sub/deep", "deep")] {
            fs::write(folder.path().join(file), text).expect("written");
        }
        let files = NamedFiles::of(&model.join("a.gltf"));
        (folder, files)
    }

    #[test]
    fn files_in_the_folder_are_read_and_remembered() {
        let (folder, files) = folder();
        assert_eq!(files.read_uri("near%20one").expect("near"), b"near");
        assert_eq!(files.read("sub/../sub/./deep").expect("deep"), b"deep");
        let real = fs::canonicalize(folder.path()).expect("there");
        assert_eq!(files.files(), [real.join("model/near one"), real.join("model/sub/deep")]);
    }

    #[test]
    fn what_lies_outside_is_refused() {
        let (folder, files) = folder();
        let absolute = folder.path().join("model/sub/deep");
        for uri in [
            "../secret",
            "..%2fsecret",
            "%2e%2e/secret",
            "sub/../../secret",
            "sub/../../model/sub/deep",
            "/etc/hostname",
            "/dev/zero",
            absolute.to_str().expect("text"),
        ] {
            let error = files.read_uri(uri).expect_err(uri);
            assert_eq!(error.kind(), ErrorKind::PermissionDenied, "{uri}: {error}");
        }
        for uri in ["", ".", "sub", "sub/", "\0", "none", &"a".repeat(5000)] {
            files.read_uri(uri).expect_err(uri);
        }
        assert!(files.files().is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn links_that_lead_outside_are_refused() {
        let (folder, files) = folder();
        let link = |to: &str, name: &str| {
            std::os::unix::fs::symlink(to, folder.path().join("model").join(name)).expect("linked");
        };
        link("../secret", "file");
        link("..", "up");
        link("/dev/zero", "endless");
        link("sub", "down");
        for name in ["file", "up/secret", "endless"] {
            assert_eq!(files.read(name).expect_err(name).kind(), ErrorKind::PermissionDenied, "{name}");
        }
        assert_eq!(files.read("down/deep").expect("it stays inside"), b"deep");
    }

    #[test]
    fn a_blob_may_lie_anywhere_if_it_is_what_its_name_promises() {
        let (folder, files) = folder();
        let name = format!("{}.bin", blake3::hash(b"secret").to_hex());
        fs::rename(folder.path().join("secret"), folder.path().join(&name)).expect("renamed");
        assert_eq!(files.read(&format!("../{name}")).expect("a blob"), b"secret");
        fs::write(folder.path().join(&name), "another secret").expect("written");
        assert_eq!(files.read(&format!("../{name}")).expect_err("damaged").kind(), ErrorKind::InvalidData);
    }

    #[test]
    fn all_files_together_are_bounded() {
        let (_folder, files) = folder();
        files.left.store(7, Ordering::Relaxed);
        files.read("sub/deep").expect("four bytes");
        let error = files.read("sub/deep").expect_err("four more");
        assert_eq!(error.kind(), ErrorKind::FileTooLarge, "{error}");
    }
}
