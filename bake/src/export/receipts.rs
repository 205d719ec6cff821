//! What exports wrote, so that a later one can tell its own files from a person's.
//!
//! Beside the blobs, `exported.b3` has a line for each file: the digest of its bytes, the landscape, the name. So a file
//! may be moved with its folder and is still known, and one that was changed by hand is not.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use genescape_cache::Digest;
use genescape_world::atomic_write;

use super::InTheWay;

const FILE: &str = "exported.b3";

pub struct Receipts {
    path: PathBuf,
    /// What exports are called: files of one landscape are not replaced by another's.
    landscape: String,
    lines: String,
}

impl Receipts {
    /// Those in the folder of what was baked.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn open(baked: &Path, landscape: &str) -> Result<Self> {
        let path = baked.join(FILE);
        let lines = match fs::read_to_string(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            read => read.with_context(|| format!("cannot read {}", path.display()))?,
        };
        Ok(Self { path, landscape: landscape.into(), lines })
    }

    /// That a file may be written there: none is, or an earlier export of this landscape wrote it.
    ///
    /// # Errors
    /// [`InTheWay`]; a file that cannot be read.
    pub fn allow(&self, path: &Path, name: &str) -> Result<()> {
        match fs::read(path) {
            Ok(there) if self.has(&self.line(&there, name)) => Ok(()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            Err(error) if !path.is_dir() => {
                Err(error).with_context(|| format!("cannot read {}", path.display()))
            }
            _ => Err(InTheWay(path.to_owned()).into()),
        }
    }

    /// Notes that these bytes are written under that name.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn note(&mut self, bytes: &[u8], name: &str) -> Result<()> {
        let line = self.line(bytes, name);
        if self.has(&line) {
            return Ok(());
        }
        self.lines += &format!("{line}\n");
        let written = atomic_write::replace(&self.path, &self.lines);
        written.with_context(|| format!("cannot write {}", self.path.display()))
    }

    fn line(&self, bytes: &[u8], name: &str) -> String {
        format!("{}  {}  {name}", Digest::of(bytes), self.landscape)
    }

    fn has(&self, line: &str) -> bool {
        self.lines.lines().any(|other| other == line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_an_export_of_the_landscape_wrote_is_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("oak.glb");
        let open = |landscape: &str| Receipts::open(folder.path(), landscape).expect("readable");
        let allowed = |landscape: &str| open(landscape).allow(&file, "oak.glb");
        allowed("valley").expect("nothing is there");
        fs::write(&file, "mine").expect("written");
        assert!(allowed("valley").expect_err("a person's").is::<InTheWay>());
        open("valley").note(b"ours", "oak.glb").expect("noted");
        allowed("valley").expect_err("still a person's");
        fs::write(&file, "ours").expect("written");
        allowed("valley").expect("ours");
        allowed("lake").expect_err("another landscape's");
        open("valley").note(b"ours too", "oak.glb").expect("noted");
        allowed("valley").expect("of the export before");
        assert!(open("valley").allow(folder.path(), "oak.glb").expect_err("a folder").is::<InTheWay>());
    }
}
