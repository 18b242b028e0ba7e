//! Common parts of tables of other programs: encodings, separators, empty cells.

use std::borrow::Cow;

/// The text of a file in UTF-8 or UTF-16, without a mark of the byte order; `None` where it is neither.
///
/// Excel writes UTF-16 as "Unicode text", and so does the redirection of Windows. Without a mark, a zero beside every letter of the beginning
/// gives UTF-16 away.
#[must_use]
pub fn decode_text(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let wide = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = rest.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        String::from_utf16(&units).ok().map(Cow::Owned)
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        [first, 0, ..] if *first != 0 && is_utf_16(bytes) => wide(bytes, u16::from_le_bytes),
        _ if is_utf_16(bytes) => wide(bytes, u16::from_be_bytes),
        _ => {
            let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            std::str::from_utf8(bytes).ok().map(Cow::Borrowed)
        }
    }
}

/// Whether a file begins as text in UTF-16 does.
pub(crate) fn is_utf_16(bytes: &[u8]) -> bool {
    matches!(
        bytes,
        [0xff, 0xfe, ..]
            | [0xfe, 0xff, ..]
            | [1..=0x7f, 0, 1..=0x7f, 0, ..]
            | [0, 1..=0x7f, 0, 1..=0x7f, ..]
    )
}

/// The separator that the first line states as Excel does, `sep=;`; `None` where it is a heading.
#[must_use]
pub fn stated_separator(text: &str) -> Option<char> {
    let line = text.lines().next()?.trim_matches(['\r', '"', ' ']);
    let prefix = line.get(..4).filter(|prefix| prefix.eq_ignore_ascii_case("sep="))?;
    let mut rest = line[prefix.len()..].chars();
    // Nothing but more separators may follow, which some programs add to fill the row.
    let separator = rest.next().unwrap_or('\t');
    rest.all(|other| other == separator || matches!(other, ';' | ',' | '\t')).then_some(separator)
}

/// A name of a column as it is compared: small letters, with `_` for blanks and dashes, and without brackets.
#[must_use]
pub fn column_name(cell: &str) -> String {
    let cell = cell.trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
    cell.to_lowercase().replace([' ', '-', '\u{a0}'], "_").replace(['(', ')', '[', ']'], "")
}

/// Whether a spreadsheet takes a cell for a formula, and runs it; also in the wide letters of Chinese and Japanese, and behind blanks.
#[must_use]
pub fn starts_formula(cell: &str) -> bool {
    const BLANKS: [char; 3] = ['\t', '\r', '\n'];
    let unseen =
        |c: char| c.is_whitespace() || c.is_control() || matches!(c, '\u{200b}' | '\u{feff}');
    cell.starts_with(BLANKS)
        || cell.trim_start_matches(unseen).starts_with(['=', '+', '-', '@', '＝', '＋', '－', '＠'])
}

/// A text as a cell of CSV: a quote before what a spreadsheet would run, and before what [`unguarded`] would take for such a quote.
///
/// ```
/// use spineline_files::{guarded, unguarded};
///
/// assert_eq!(guarded("=1+1"), "'=1+1");
/// for text in ["P07", "=1+1", "'=1+1", "'P07", "-", ""] {
///     assert_eq!(unguarded(&guarded(text)), text);
/// }
/// ```
#[must_use]
pub fn guarded(text: &str) -> Cow<'_, str> {
    if needs_guard(text) { Cow::Owned(format!("'{text}")) } else { Cow::Borrowed(text) }
}

/// The text of a cell that [`guarded`] wrote.
#[must_use]
pub fn unguarded(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|text| needs_guard(text)).unwrap_or(cell)
}

fn needs_guard(text: &str) -> bool {
    text.starts_with('\'') || starts_formula(text)
}

/// Whether a cell or text means a missing number. An infinite number is not missing: it is an error of the program that wrote it.
#[must_use]
pub fn is_no_number(cell: &str) -> bool {
    const SPELLINGS: [&str; 15] = [
        "",
        "-",
        "–",
        "—",
        ".",
        "?",
        "na",
        "n/a",
        "#n/a",
        "#nv",
        "nan",
        "null",
        "none",
        "nil",
        "undefined",
    ];
    let word = cell.trim().to_lowercase();
    let word = word.strip_prefix(['+', '-']).filter(|rest| !rest.is_empty()).unwrap_or(&word);
    SPELLINGS.contains(&word.trim_matches(['<', '>']))
}

/// A whole number from 0, also written with decimals, as in `1.0` or `1,0`.
#[must_use]
pub fn whole_number(cell: &str) -> Option<u32> {
    let cell = cell.trim();
    let zeros = |decimals: &str| decimals.bytes().all(|digit| digit == b'0');
    let whole = match cell.split_once(['.', ',']) {
        Some((whole, decimals)) if zeros(decimals) => whole,
        Some(_) => return None,
        None => cell,
    };
    whole.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_read_in_both_encodings() {
        let text = "vertebra\tü\r\nL4\t1,5";
        let units: Vec<u16> = text.encode_utf16().collect();
        let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            [&[0xff, 0xfe], &little[..]].concat(),
            [&[0xfe, 0xff], &big[..]].concat(),
            little,
            big,
        ] {
            assert_eq!(decode_text(&bytes).as_deref(), Some(text), "{bytes:?}");
        }
        assert_eq!(decode_text(b"M\xfcller"), None, "Latin 1");
        assert_eq!(decode_text(b""), Some(Cow::Borrowed("")));
    }

    #[test]
    fn a_separator_is_stated_or_not() {
        for (text, separator) in [
            ("sep=;\r\nposture;vertebra", Some(';')),
            ("SEP=,\nposture", Some(',')),
            ("\"sep=;\"\nposture", Some(';')),
            ("sep=\t\nposture", Some('\t')),
            ("sep=;;;;\nposture", Some(';')),
            ("posture;vertebra", None),
            ("separator=;", None),
            ("", None),
        ] {
            assert_eq!(stated_separator(text), separator, "{text:?}");
        }
    }

    #[test]
    fn a_text_that_a_spreadsheet_would_run_has_a_quote_before_it() {
        for text in [
            "=cmd|' /C calc'!A0",
            "-A1",
            "+1",
            "@SUM(A1)",
            "\t=1",
            " =1",
            "\u{feff}=1",
            "＝1",
            "\r",
        ] {
            assert_eq!(guarded(text), format!("'{text}"));
            assert_eq!(unguarded(&guarded(text)), text);
        }
        for text in ["P07", "a=1", "", ".", "'"] {
            assert_eq!(unguarded(&guarded(text)), text);
            assert_eq!(unguarded(text), text);
        }
    }

    #[test]
    fn no_number_has_many_spellings() {
        for cell in ["", " ", "NaN", "-nan", "NA", "n/a", "#N/A", "null", "-", "<NA>"] {
            assert!(is_no_number(cell), "{cell:?}");
        }
        for cell in ["0", "-1", "1,5", "L4", "nano", "1e3", "Infinity", "-inf"] {
            assert!(!is_no_number(cell), "{cell:?}");
        }
    }

    #[test]
    fn whole_numbers_may_have_zeros_behind_their_mark() {
        for (cell, number) in [
            ("1", Some(1)),
            ("1.0", Some(1)),
            (" 2,00 ", Some(2)),
            ("1.5", None),
            ("x", None),
            ("-1", None),
            ("", None),
        ] {
            assert_eq!(whole_number(cell), number, "{cell:?}");
        }
        assert_eq!(column_name("\u{feff} Superior Left-Row_px "), "superior_left_row_px");
    }
}
