//! What is said on standard output, and how sizes are written there.

use bytesize::ByteSize;

/// `println!` that does not panic when its reader has gone (`bake | head`).
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout().lock(), $($words)*);
    }};
}

/// "12.3 MB".
pub fn size(bytes: u64) -> bytesize::Display {
    ByteSize(bytes).display().si()
}
