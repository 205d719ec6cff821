//! Names → bytes in a folder. A name is a relative path with `/` between its parts.
//!
//! A file is written as `NAME#RANDOM` beside its target and renamed, so it is whole or absent. A writer that is killed
//! leaves its `NAME#RANDOM`, which nothing reads and `gc` sweeps.

use std::fs::{self, File, FileTimes, Metadata};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use crate::{Bytes, Error, Result};

#[derive(Debug)]
pub(crate) struct Store {
    pub root: PathBuf,
}

/// A file in the store.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub name: String,
    pub bytes: u64,
    pub modified: SystemTime,
}

impl Store {
    pub fn open(root: &Path) -> Result<Self> {
        fs::create_dir_all(root).map_err(|source| Error::at("make the folder", root, source))?;
        Ok(Self { root: root.to_path_buf() })
    }

    pub fn path_of(&self, name: &str) -> PathBuf {
        self.root.join(name)
    }

    /// A file's bytes and when it was last changed; `None` if there is no such file.
    pub fn get(&self, name: &str) -> Result<Option<(Bytes, SystemTime)>> {
        let path = self.path_of(name);
        let read = || -> io::Result<_> {
            let mut file = File::open(&path)?;
            let meta = file.metadata()?;
            if meta.is_dir() {
                return Ok(None);
            }
            let mut bytes = Vec::with_capacity(meta.len() as usize);
            file.read_to_end(&mut bytes)?;
            Ok(Some((Arc::new(bytes), meta.modified()?)))
        };
        match read() {
            // A file where a folder should be hides what should lie in the folder.
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Ok(None),
            found => found.map_err(|source| Error::at("read", &path, source)),
        }
    }

    /// Publishes `bytes` under `name`, replacing what was there.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.path_of(name);
        let write = || -> io::Result<()> {
            let folder = path.parent().unwrap_or(&self.root);
            let mut prefix = path.file_name().unwrap_or_default().to_owned();
            prefix.push("#");
            let mut builder = tempfile::Builder::new();
            // A temporary file is private by default; what is renamed into place is for everyone to read.
            #[cfg(unix)]
            builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
            builder.prefix(&prefix);
            let mut staged = builder.tempfile_in(folder).or_else(|error| {
                if error.kind() != ErrorKind::NotFound {
                    return Err(error);
                }
                fs::create_dir_all(folder)?;
                builder.tempfile_in(folder)
            })?;
            staged.as_file_mut().write_all(bytes)?;
            // Closed before it is renamed: some network folders say only then that they are full.
            Ok(staged.into_temp_path().persist(&path)?)
        };
        write().map_err(|source| Error::at("write", &path, source))
    }

    /// Removes a file, if it is there.
    pub fn remove(&self, name: &str) -> Result<()> {
        let path = self.path_of(name);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::at("remove", &path, error)),
            _ => Ok(()),
        }
    }

    /// All files under a folder by name, without those that are being written.
    pub fn list(&self, folder: &str) -> Result<Vec<Entry>> {
        Ok(self.walk(folder)?.into_iter().filter(|entry| !entry.is_staged()).collect())
    }

    /// Files under a folder that are being written, or were when their writer was killed.
    pub fn staged(&self, folder: &str) -> Result<Vec<Entry>> {
        Ok(self.walk(folder)?.into_iter().filter(Entry::is_staged).collect())
    }

    fn walk(&self, folder: &str) -> Result<Vec<Entry>> {
        let (mut entries, mut folders) = (Vec::new(), vec![folder.to_owned()]);
        while let Some(folder) = folders.pop() {
            let path = self.path_of(&folder);
            let listed = match fs::read_dir(&path) {
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                listed => listed.map_err(|source| Error::at("list", &path, source))?,
            };
            for entry in listed.flatten() {
                let name = format!("{folder}/{}", entry.file_name().to_string_lossy());
                // What has vanished since it was listed is not there.
                let Ok(meta) = entry.metadata() else { continue };
                if meta.is_dir() {
                    folders.push(name);
                } else if let (true, Ok(modified)) = (meta.is_file(), meta.modified()) {
                    entries.push(Entry { name, bytes: meta.len(), modified });
                }
            }
        }
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(entries)
    }

    /// What stands at `name`, if anything does: one system call, which an unchanged bake makes for every blob.
    pub fn metadata(&self, name: &str) -> Option<Metadata> {
        fs::metadata(self.path_of(name)).ok()
    }

    /// Marks a file as used now. In a folder that cannot be written to, nothing is evicted: it needs no mark.
    pub fn touch(&self, name: &str) {
        let now = FileTimes::new().set_modified(SystemTime::now());
        let _ = File::options().append(true).open(self.path_of(name)).and_then(|file| file.set_times(now));
    }

    /// Moves a folder out of the way of the file `name`; where to, unless it was empty or none.
    pub fn move_aside(&self, name: &str) -> Result<Option<PathBuf>> {
        let path = self.path_of(name);
        if !fs::symlink_metadata(&path).is_ok_and(|meta| meta.is_dir()) || fs::remove_dir(&path).is_ok() {
            return Ok(None);
        }
        let mut asides = (1..).map(|n| self.path_of(&format!("{name}.aside-{n}")));
        let free = asides.find(|aside| fs::symlink_metadata(aside).is_err()).expect("numbers do not end");
        fs::rename(&path, &free).map_err(|source| Error::at("move aside", &path, source))?;
        Ok(Some(free))
    }
}

impl Entry {
    /// Whether the name is `NAME#RANDOM`; versions before this one wrote `NAME#1`.
    fn is_staged(&self) -> bool {
        let suffix = self.name.rsplit_once('#').map_or("", |(_, suffix)| suffix);
        !suffix.is_empty() && suffix.bytes().all(|b| b.is_ascii_alphanumeric())
    }
}
