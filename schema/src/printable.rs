//! Text out of anyone's files → text that a terminal shows instead of obeying.

use std::borrow::Cow;

/// The text with a visible character in place of each that would steer a terminal or turn the direction of writing; line
/// breaks and tabs stay. As many characters as before.
pub fn printable(text: &str) -> Cow<'_, str> {
    let obeyed = |c: char| steers(c) && c != '\n' && c != '\t';
    if !text.contains(obeyed) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.chars().map(|c| if obeyed(c) { picture(c) } else { c }).collect())
}

/// Whether a character is for the terminal and not for the eye.
pub(crate) fn steers(c: char) -> bool {
    c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn picture(c: char) -> char {
    match u32::from(c) {
        code @ ..0x20 => char::from_u32(0x2400 + code).unwrap_or('\u{fffd}'),
        0x7f => '\u{2421}',
        _ => '\u{fffd}',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_becomes_visible() {
        assert_eq!(
            printable("a\tb\n\u{1b}[31m\u{7}\u{0}\r\u{7f}\u{9b}\u{202e}é𝕏"),
            "a\tb\n␛[31m␇␀␍␡\u{fffd}\u{fffd}é𝕏"
        );
        assert!(matches!(printable("as it was …\n"), Cow::Borrowed(_)));
    }
}
