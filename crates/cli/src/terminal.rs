//! Text from elsewhere on its way to a terminal.

/// Replaces what could move the cursor, change colours or hide text: names in projects, pictures and films are chosen by
/// whoever made them.
pub fn printable(text: &str) -> String {
    let is_harmless = |c: char| !c.is_control() && !is_direction(c) || matches!(c, '\n' | '\t');
    text.chars().map(|c| if is_harmless(c) { c } else { char::REPLACEMENT_CHARACTER }).collect()
}

/// Marks that turn the direction of writing, so that a name looks like another one.
fn is_direction(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_text_is_left() {
        assert_eq!(printable("ä 木\n\t1"), "ä 木\n\t1");
        assert_eq!(
            printable("a\u{1b}[2Jb\r\u{7}\u{9b}c\u{202e}d"),
            "a\u{fffd}[2Jb\u{fffd}\u{fffd}\u{fffd}c\u{fffd}d"
        );
    }
}
