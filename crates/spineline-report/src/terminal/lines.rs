//! The last step before text reaches a terminal.

use std::borrow::Cow;
use std::fmt::Display;

/// A longer line is shown without its middle.
const MAX_LINE_CHARS: usize = 2000;
/// Characters that are shown of its beginning and of its end.
const KEPT_CHARS: [usize; 2] = [1200, 600];

/// Text for a terminal, line by line. Quoted text cannot end its line, control the terminal, or hide anything ([`shown`]).
///
/// ```
/// use spineline_report::terminal::Lines;
///
/// let mut lines = Lines::of("error: a\nb\u{1b}[2J");
/// lines.line("  help: c");
/// assert_eq!(lines.as_str(), "error: a\\nb\\u{1b}[2J\n  help: c\n");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Lines(String);

impl Lines {
    /// One line.
    #[must_use]
    pub fn of(line: impl Display) -> Self {
        let mut lines = Self::default();
        lines.line(line);
        lines
    }

    /// Text that this program laid out: its line feeds stay.
    #[must_use]
    pub fn of_text(text: &str) -> Self {
        let mut lines = Self::default();
        lines.text(text);
        lines
    }

    /// Adds one line.
    pub fn line(&mut self, line: impl Display) -> &mut Self {
        self.0.push_str(&shown(&line.to_string()));
        self.0.push('\n');
        self
    }

    /// Adds text that this program laid out: its line feeds and tabs stay.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.0.push_str(&escaped(text, |c| is_hidden(c) && c != '\n' && c != '\t'));
        self
    }

    /// The text for the terminal.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Lines {
    fn from(line: &str) -> Self {
        Self::of(line)
    }
}

impl From<String> for Lines {
    fn from(line: String) -> Self {
        Self::of(line)
    }
}

/// Text from elsewhere as one line: control characters and invisible characters are written as their codes, and a very long text
/// loses its middle.
///
/// ```
/// use spineline_report::terminal::shown;
///
/// assert_eq!(shown("P07\u{1b}[31m\u{202e}\n"), "P07\\u{1b}[31m\\u{202e}\\n");
/// ```
#[must_use]
pub fn shown(text: &str) -> String {
    // Most texts are short enough by their bytes.
    let chars = if text.len() <= MAX_LINE_CHARS { 0 } else { text.chars().count() };
    if chars <= MAX_LINE_CHARS {
        return escaped(text, is_hidden).into_owned();
    }
    let [first, last] = KEPT_CHARS;
    let place = |chars: usize| text.char_indices().nth(chars).map_or(text.len(), |(at, _)| at);
    let (head, tail) = (&text[..place(first)], &text[place(chars - last)..]);
    let (head, tail) = (escaped(head, is_hidden), escaped(tail, is_hidden));
    format!("{head} … ({} characters left out) … {tail}", chars - first - last)
}

fn escaped(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_escaped(c) { escaped.extend(c.escape_default()) } else { escaped.push(c) }
    }
    Cow::Owned(escaped)
}

/// Whether a character controls the terminal, changes the direction of writing, breaks a line, or is invisible. Characters that
/// join letters (U+200C, U+200D) are allowed: several languages need them.
pub(super) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(c, '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quoted_value_cannot_end_its_line() {
        for end in ["\n", "\r\n", "\r", "\u{85}", "\u{2028}", "\u{2029}", "\u{b}", "\u{c}"] {
            let lines = Lines::of(format!("error: `a{end}error: nothing is wrong`"));
            assert_eq!(lines.as_str().lines().count(), 1, "{lines:?}");
            assert!(!lines.as_str().trim_end().chars().any(is_hidden), "{lines:?}");
        }
    }

    #[test]
    fn letters_of_all_languages_stay() {
        for text in ["Ångström µ ± °", "مريض", "病例", "ن\u{200c}م", "👩\u{200d}⚕\u{fe0f}"]
        {
            assert_eq!(shown(text), text);
        }
    }

    #[test]
    fn a_line_of_60_mb_is_shown_by_its_ends() {
        let text = format!("error: `{}`: help", "é".repeat(30_000_000));
        let line = shown(&text);
        assert!(line.starts_with("error: `éé") && line.ends_with("é`: help"), "{line}");
        assert!(line.contains("characters left out") && line.chars().count() < MAX_LINE_CHARS);
        let hidden = shown(&"\u{1b}".repeat(60_000_000));
        assert!(hidden.len() < 10 * MAX_LINE_CHARS && !hidden.contains('\u{1b}'));
        let whole = "é".repeat(MAX_LINE_CHARS);
        assert_eq!(shown(&whole), whole);
    }

    #[test]
    fn a_text_keeps_its_lines_and_nothing_else_that_is_hidden() {
        let text = Lines::of_text("a\n  b\tc\u{1b}[2J\u{202e}\u{9b}\n");
        assert_eq!(text.as_str(), "a\n  b\tc\\u{1b}[2J\\u{202e}\\u{9b}\n");
    }
}
