//! Texts for typesetting: only letters of the available fonts, and long words with places to break.

use std::collections::BTreeSet;

use typst::text::Font;

/// Replaces a letter that the fonts lack.
const BOX: char = '\u{25a1}';
/// A place where a line may break without a sign.
const BREAK: char = '\u{200b}';
/// A longer word may be broken anywhere.
const MAX_WORD: usize = 20;
/// Letters between two such places.
const PIECE: usize = 12;

/// The letters of a report that can be drawn.
pub(crate) struct Letters {
    lacking: BTreeSet<char>,
}

impl Letters {
    /// For these texts in these fonts.
    pub(crate) fn of<'a>(texts: impl IntoIterator<Item = &'a str>, fonts: &[Font]) -> Self {
        let letters: BTreeSet<char> = texts.into_iter().flat_map(str::chars).collect();
        let is_had = |c: char| fonts.iter().any(|font| font.info().coverage.contains(u32::from(c)));
        let lacking = letters.into_iter().filter(|&c| is_drawn(c) && !is_had(c)).collect();
        Self { lacking }
    }

    /// The letters that the fonts lack.
    pub(crate) fn lacking(&self) -> Vec<char> {
        self.lacking.iter().copied().collect()
    }

    /// The text without letters that the fonts lack: PDF/A forbids letters without a shape.
    pub(crate) fn plain(&self, text: &str) -> String {
        text.chars().filter_map(|c| self.shown(c)).collect()
    }

    /// The same with places to break in long words.
    pub(crate) fn words(&self, text: &str) -> String {
        breakable(&self.plain(text))
    }

    fn shown(&self, c: char) -> Option<char> {
        match c {
            c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') => Some(' '),
            c if is_mark_of_order(c) || is_mark_of_shape(c) => None,
            c if self.lacking.contains(&c) => Some(BOX),
            c => Some(c),
        }
    }
}

/// Changes the order of neighbouring letters; identifiers must not do this to the text around them.
fn is_mark_of_order(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Chooses among shapes of the letter before it; fonts rarely have it, and it may be left out.
fn is_mark_of_shape(c: char) -> bool {
    matches!(c, '\u{fe00}'..='\u{fe0f}' | '\u{feff}')
}

/// Spaces, controls and marks need no shape.
fn is_drawn(c: char) -> bool {
    let is_joiner = matches!(c, '\u{200b}'..='\u{200f}' | '\u{2060}'..='\u{2065}');
    let is_mark = is_mark_of_order(c) || is_mark_of_shape(c);
    !c.is_whitespace() && !c.is_control() && !is_joiner && !is_mark
}

/// A break is allowed after every `/` and `_` within a word, and in long words after every few letters.
fn breakable(text: &str) -> String {
    let mut broken = String::with_capacity(text.len() + text.len() / 8);
    for word in text.split_inclusive(char::is_whitespace) {
        let is_long = word.trim_end().chars().count() > MAX_WORD;
        let mut since = 0;
        let mut letters = word.chars().peekable();
        while let Some(letter) = letters.next() {
            broken.push(letter);
            since += 1;
            let Some(&next) = letters.peek() else { break };
            let is_place = matches!(letter, '/' | '_') || (is_long && since >= PIECE);
            if is_place && !next.is_whitespace() && begins(next) && !joins(letter) {
                broken.push(BREAK);
                since = 0;
            }
        }
    }
    broken
}

/// Whether a line may begin with it: a mark that belongs to the letter before may not.
fn begins(c: char) -> bool {
    let is_mark = matches!(c,
        '\u{300}'..='\u{36f}' | '\u{483}'..='\u{489}' | '\u{591}'..='\u{5c7}' | '\u{610}'..='\u{61a}'
        | '\u{64b}'..='\u{65f}' | '\u{670}' | '\u{6d6}'..='\u{6ed}' | '\u{900}'..='\u{dff}'
        | '\u{e31}'..='\u{e3a}' | '\u{e47}'..='\u{e4e}' | '\u{1ab0}'..='\u{1aff}'
        | '\u{1dc0}'..='\u{1dff}' | '\u{20d0}'..='\u{20ff}' | '\u{3099}' | '\u{309a}');
    !is_mark && !joins(c) && c != BREAK
}

/// Holds the letters on both sides of it together.
fn joins(c: char) -> bool {
    matches!(c, '\u{200c}' | '\u{200d}' | '\u{2060}')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lacking(letters: &str) -> Letters {
        Letters { lacking: letters.chars().collect() }
    }

    #[test]
    fn long_words_may_break_and_short_ones_not() {
        assert_eq!(breakable("mean 12.5 mm"), "mean 12.5 mm");
        assert_eq!(breakable("left_bending a/b"), "left_\u{200b}bending a/\u{200b}b");
        assert_eq!(breakable("a_ b/"), "a_ b/");
        assert_eq!(breakable(&"x".repeat(20)), "x".repeat(20));
        let long = breakable(&"x".repeat(64));
        assert_eq!(long.split(BREAK).map(str::len).collect::<Vec<_>>(), [12, 12, 12, 12, 12, 4]);
    }

    #[test]
    fn a_combining_mark_stays_with_its_letter() {
        let word = "a".repeat(12) + "\u{301}" + &"b".repeat(12);
        assert_eq!(breakable(&word), "a".repeat(12) + "\u{301}\u{200b}" + &"b".repeat(12));
        let joined = "\u{645}".repeat(12) + "\u{200d}" + &"\u{645}".repeat(12);
        assert!(!breakable(&joined).contains("\u{200d}\u{200b}"));
        assert!(!breakable(&joined).contains("\u{200b}\u{200d}"));
    }

    #[test]
    fn characters_that_cannot_be_set_are_removed() {
        let letters = lacking("\u{10fffd}病");
        assert_eq!(letters.plain("a\u{10fffd}病\n\u{0}b"), "a□□  b");
        assert_eq!(letters.plain("\u{202e}abc\u{2066}\u{feff}\u{fe0f}"), "abc");
        assert_eq!(letters.lacking(), ['病', '\u{10fffd}']);
    }
}
