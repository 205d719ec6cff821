//! Lines for a person, on standard output and standard error, in which no name out of a file steers the terminal; and how
//! sizes are written there.

use std::fmt::Arguments;
use std::io::Write;

use bytesize::ByteSize;
use genescape_schema::printable;

/// `println!` that does not panic when its reader has gone (`bake | head`).
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => { $crate::say::line(format_args!($($words)*)) };
}

/// One line, or more, on standard output.
pub fn line(words: Arguments<'_>) {
    let _ = writeln!(std::io::stdout().lock(), "{}", printable(&words.to_string()));
}

/// The same on standard error.
pub fn warn(words: Arguments<'_>) {
    let _ = writeln!(std::io::stderr().lock(), "{}", printable(&words.to_string()));
}

/// A number for programs, to four digits behind the point.
pub fn rounded(number: f32) -> f64 {
    (f64::from(number) * 1e4).round() / 1e4
}

/// "12.3 MB".
pub fn size(bytes: u64) -> bytesize::Display {
    ByteSize(bytes).display().si()
}
