//! A file's bytes, if it is a regular file of bounded size: no pipe that never answers, no device that never ends.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The whole of a file of at most `max` bytes. Links are followed.
///
/// # Errors
/// What the system says; [`ErrorKind::InvalidInput`] for what is no regular file, [`ErrorKind::FileTooLarge`] for more
/// than `max` bytes.
pub fn read(path: &Path, max: u64) -> Result<Vec<u8>> {
    // Before it is opened: to open a pipe may wait for ever.
    if !fs::metadata(path)?.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "it is no regular file"));
    }
    let mut bytes = Vec::new();
    // It may grow while it is read.
    File::open(path)?.take(max.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max {
        let message = format!("it is larger than {}, the most that is read", in_words(max));
        return Err(Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

fn in_words(bytes: u64) -> String {
    match bytes {
        0x10_0000.. => format!("{} MiB", bytes >> 20),
        0x400.. => format!("{} KiB", bytes >> 10),
        _ => format!("{bytes} bytes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_files_up_to_a_size_are_read_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("file");
        fs::write(&path, "twelve bytes").expect("written");
        assert_eq!(read(&path, 12).expect("just fits"), b"twelve bytes");
        let error = read(&path, 11).expect_err("one too many");
        assert!(error.kind() == ErrorKind::FileTooLarge && error.to_string().contains("11 bytes"), "{error}");
        assert_eq!(read(folder.path(), 12).expect_err("a folder").kind(), ErrorKind::InvalidInput);
        assert_eq!(read(&folder.path().join("none"), 12).expect_err("none").kind(), ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_not_waited_for_and_a_device_not_read() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs");
        assert!(made.success());
        for endless in [&pipe, Path::new("/dev/zero")] {
            assert_eq!(read(endless, 12).expect_err("no file").kind(), ErrorKind::InvalidInput);
        }
    }
}
