//! A limit on how large files may grow (`ulimit -f`) → an error of the write that meets it.

/// From now on such a write fails with [`std::io::ErrorKind::FileTooLarge`], instead of ending the process without a word.
pub fn is_an_error() {
    #[cfg(unix)]
    {
        // That it is handled is enough: the write tells.
        static MET: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);
        if let Err(error) = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, &MET) {
            // Only the words would be missing.
            eprintln!("note: a limit on the size of files would end the program: {error}");
        }
    }
}
