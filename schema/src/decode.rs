//! Bytes of a person's file → its text.

use crate::report::{Diagnostic, Report};

/// The text of a file, whose name is for messages.
///
/// # Errors
/// Where it is no UTF-8, and what to do about it.
pub fn decode(file: &str, bytes: Vec<u8>) -> Result<String, Report> {
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes());
        let message = match is_utf16(error.as_bytes()) {
            true => "the file is in UTF-16, as some editors on Windows save; save it as UTF-8",
            false => "this is no UTF-8 text; save the file in the encoding UTF-8",
        };
        Report { diagnostics: vec![Diagnostic::at(file, &text, at..at + 1, message)], more: 0 }
    })
}

/// By the mark at its beginning.
fn is_utf16(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(bytes: &[u8]) -> String {
        decode("p.ron", bytes.to_vec()).expect_err("no text").to_string()
    }

    #[test]
    fn what_is_no_text_is_told_with_its_place_and_a_remedy() {
        assert_eq!(decode("p.ron", b"(a: \"\xc3\xa4\")".to_vec()).expect("text"), "(a: \"ä\")");
        let latin = told(b"(\n  name: \"\xe4\"\n)");
        assert!(
            latin.starts_with("p.ron:2:10: ") && latin.contains("save the file in the encoding UTF-8"),
            "{latin}"
        );
        for bytes in [&b"\xff\xfe(\0a\0"[..], b"\xfe\xff\0(\0a"] {
            assert!(told(bytes).starts_with("p.ron:1:1: the file is in UTF-16"), "{}", told(bytes));
        }
    }
}
