//! Names → bytes in a folder. A name is a relative path with `/` between its parts.
//!
//! A file is written as `staged/file-RANDOM` and renamed, so it is whole or absent. A writer that is killed leaves its
//! staged file, which nothing reads and `gc` sweeps.
//!
//! Only regular files count. What else stands under one of our names (a folder, a link, a pipe, a file in place of a
//! folder) is somebody's: it is neither followed nor opened nor removed, but moved aside when its place is needed.

use std::fs::{self, File, FileTimes, Metadata};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use crate::notice::Notices;
use crate::{Bytes, Error, Fault, Result};

/// Where files are written before they are renamed, and how their names begin.
const STAGED: &str = "staged/file-";
/// Characters that `tempfile` appends.
const RANDOM: usize = 6;

#[derive(Clone, Debug)]
pub(crate) struct Store {
    pub root: PathBuf,
    /// What was found wrong.
    pub notices: Arc<Notices>,
}

/// What stands in the store, but for folders.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub name: String,
    pub bytes: u64,
    pub modified: SystemTime,
    /// Neither a link nor a pipe or the like.
    pub is_file: bool,
}

impl Store {
    pub fn open(root: &Path) -> Result<Self> {
        fs::create_dir_all(root).map_err(|error| Error::at("make the folder", root, error))?;
        Ok(Self { root: root.to_path_buf(), notices: Arc::default() })
    }

    pub fn path_of(&self, name: &str) -> PathBuf {
        self.root.join(name)
    }

    /// What is known of the file `name`, if there is one: one system call, which an unchanged bake makes for every
    /// blob.
    pub fn file(&self, name: &str) -> Option<Metadata> {
        fs::symlink_metadata(self.path_of(name)).ok().filter(Metadata::is_file)
    }

    /// A file's bytes and when it was last changed; `None` if there is no such file. One that may not be read is as
    /// good as damaged: it is given without its bytes.
    pub fn get(&self, name: &str) -> Result<Option<(Bytes, SystemTime)>> {
        let Some(meta) = self.file(name) else { return Ok(None) };
        let path = self.path_of(name);
        let read = || -> io::Result<_> {
            let mut bytes = Vec::with_capacity(meta.len() as usize);
            match File::open(&path) {
                Ok(mut file) => file.read_to_end(&mut bytes)?,
                Err(error) if error.kind() == ErrorKind::PermissionDenied => 0,
                Err(error) => return Err(error),
            };
            Ok(Some((Arc::new(bytes), meta.modified()?)))
        };
        match read() {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            found => found.map_err(|error| Error::at("read", &path, error)),
        }
    }

    /// Publishes `bytes` under `name`, replacing what was there; `modified`, if given, as the time of its last change.
    pub fn put(&self, name: &str, bytes: &[u8], modified: Option<SystemTime>) -> Result<()> {
        self.make_way(name)?;
        self.make_way(STAGED)?;
        let path = self.path_of(name);
        let write = || -> io::Result<()> {
            let mut staged = self.staged_file()?;
            staged.as_file_mut().write_all(bytes)?;
            if let Some(modified) = modified {
                // Without the mark it counts as touched, and is read once more.
                let _ = staged.as_file().set_modified(modified);
            }
            // Closed before it is renamed: some network folders say only then that they are full.
            let staged = staged.into_temp_path();
            staged.persist(&path).or_else(|failed| {
                if failed.error.kind() != ErrorKind::NotFound {
                    return Err(failed.error);
                }
                fs::create_dir_all(path.parent().unwrap_or(&self.root))?;
                Ok(failed.path.persist(&path)?)
            })
        };
        write().map_err(|error| Error::at("write", &path, error))
    }

    fn staged_file(&self) -> io::Result<tempfile::NamedTempFile> {
        let staged = self.path_of(STAGED);
        let mut builder = tempfile::Builder::new();
        // A temporary file is private by default; what is renamed into place is for everyone to read.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder.prefix(staged.file_name().unwrap_or_default()).rand_bytes(RANDOM);
        let folder = staged.parent().unwrap_or(&self.root);
        builder.tempfile_in(folder).or_else(|error| {
            if error.kind() != ErrorKind::NotFound {
                return Err(error);
            }
            fs::create_dir_all(folder)?;
            builder.tempfile_in(folder)
        })
    }

    /// Removes a file, if it is there.
    pub fn remove(&self, name: &str) -> Result<()> {
        let path = self.path_of(name);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::at("remove", &path, error)),
            _ => Ok(()),
        }
    }

    /// Everything under a folder by name, but for folders; a link to a folder is not followed.
    pub fn list(&self, folder: &str) -> Result<Vec<Entry>> {
        let (mut entries, mut folders) = (Vec::new(), vec![folder.to_owned()]);
        while let Some(folder) = folders.pop() {
            let path = self.path_of(&folder);
            if !fs::symlink_metadata(&path).is_ok_and(|meta| meta.is_dir()) {
                continue;
            }
            let listed = match fs::read_dir(&path) {
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                listed => listed.map_err(|error| Error::at("list", &path, error))?,
            };
            for entry in listed.flatten() {
                let name = format!("{folder}/{}", entry.file_name().to_string_lossy());
                // What has vanished since it was listed is not there.
                let Ok(meta) = entry.metadata() else { continue };
                if meta.is_dir() {
                    folders.push(name);
                } else if let Ok(modified) = meta.modified() {
                    entries.push(Entry { name, bytes: meta.len(), modified, is_file: meta.is_file() });
                }
            }
        }
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(entries)
    }

    /// Sets the time of a file's last change, if that is allowed.
    pub fn set_modified(&self, name: &str, modified: SystemTime) {
        let times = FileTimes::new().set_modified(modified);
        let _ = File::options().append(true).open(self.path_of(name)).and_then(|file| file.set_times(times));
    }

    /// Moves aside whatever is in the way of a file `name`: what is no folder where one of its folders must be, what is
    /// no file in its own place.
    pub fn make_way(&self, name: &str) -> Result<()> {
        let parts = name.match_indices('/').map(|(end, _)| &name[..end]);
        for (part, is_folder) in parts.map(|part| (part, true)).chain([(name, false)]) {
            let Ok(meta) = fs::symlink_metadata(self.path_of(part)) else { return Ok(()) };
            if if is_folder { !meta.is_dir() } else { !meta.is_file() } {
                return self.move_aside(part);
            }
        }
        Ok(())
    }

    /// An empty folder just goes.
    fn move_aside(&self, name: &str) -> Result<()> {
        let path = self.path_of(name);
        if fs::remove_dir(&path).is_ok() {
            return Ok(());
        }
        let mut asides = (1..).map(|n| self.path_of(&format!("{name}.aside-{n}")));
        let free = asides.find(|aside| fs::symlink_metadata(aside).is_err()).expect("numbers do not end");
        match fs::rename(&path, &free) {
            // Another process was faster.
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            moved => moved.map_err(|error| Error::at("move aside", &path, error))?,
        }
        self.notices.add(free, Fault::MovedAside);
        Ok(())
    }
}

/// Whether that is the name of a file being written, or of one whose writer was killed.
pub(crate) fn is_staged(name: &str) -> bool {
    let random = name.strip_prefix(STAGED).unwrap_or_default();
    random.len() == RANDOM && random.bytes().all(|b| b.is_ascii_alphanumeric())
}
