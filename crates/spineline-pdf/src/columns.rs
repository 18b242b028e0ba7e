//! Layout of a table on the page: size of type, and width of each column.

/// Between the margins of the page.
const PAGE_PT: f64 = 481.0;
/// Left and right of a cell's text, together.
pub(crate) const EDGES_PT: f64 = 5.0;
/// Sizes of letters, the preferred one first.
const SIZES_PT: [f64; 4] = [7.5, 6.5, 5.5, 4.5];
/// Tables with more columns begin with the second size.
const COMMON_COLUMNS: usize = 9;
/// Heads are bold.
const BOLD: f64 = 1.15;
/// Widths of letters are estimates.
const SLACK: f64 = 1.03;

/// A table's measures.
#[derive(Debug, PartialEq)]
pub(crate) struct Fit {
    pub(crate) size_pt: f64,
    pub(crate) widths_pt: Vec<f64>,
}

/// Required width of a column, in em.
#[derive(Debug, Clone, Copy, Default)]
struct Required {
    /// For words without breaks.
    word: f64,
    /// For cells of one line.
    line: f64,
}

impl Required {
    fn and(self, text: &str, factor: f64) -> Self {
        Self {
            word: self.word.max(factor * longest_piece_em(text)),
            line: self.line.max(factor * text.chars().map(width_em).sum::<f64>()),
        }
    }
}

/// The largest letters for which words are not cut; free room goes to columns whose cells have more than one line.
pub(crate) fn fit(heads: &[String], rows: &[Vec<String>]) -> Fit {
    let mut required: Vec<Required> =
        heads.iter().map(|head| Required::default().and(head, BOLD)).collect();
    // A head may have two lines, so the cells below decide.
    required.iter_mut().for_each(|required| required.line = required.word.max(0.5 * required.line));
    for row in rows {
        for (required, cell) in required.iter_mut().zip(row) {
            *required = required.and(cell, 1.0);
        }
    }
    let room = PAGE_PT - EDGES_PT * heads.len() as f64;
    let words: f64 = required.iter().map(|required| SLACK * required.word).sum();
    let sizes = &SIZES_PT[usize::from(heads.len() > COMMON_COLUMNS)..];
    let size_pt = sizes.iter().copied().find(|size| size * words <= room);
    let size_pt = size_pt.unwrap_or(SIZES_PT[SIZES_PT.len() - 1]);
    let in_pt = |em: f64| SLACK * size_pt * em;
    let least: Vec<f64> = required.iter().map(|required| in_pt(required.word)).collect();
    let more: Vec<f64> =
        required.iter().map(|required| in_pt(required.line - required.word)).collect();
    let given = shared(room - least.iter().sum::<f64>(), &more);
    let mut widths: Vec<f64> =
        least.iter().zip(given).map(|(least, given)| least + given).collect();
    // Words that are too long even in the smallest letters run into the next column, and not off the page.
    let scale = (room / widths.iter().sum::<f64>()).min(1.0);
    widths.iter_mut().for_each(|width| *width = (*width * scale + EDGES_PT).max(EDGES_PT));
    Fit { size_pt, widths_pt: widths }
}

/// Distributes room equally, but gives a column at most what it needs.
fn shared(room: f64, wanted: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    let mut given = vec![0.0; wanted.len()];
    let mut left = room.max(0.0);
    for (i, &column) in order.iter().enumerate() {
        given[column] = wanted[column].min(left / (order.len() - i) as f64);
        left -= given[column];
    }
    given
}

/// The longest part of a text without a place to break.
fn longest_piece_em(text: &str) -> f64 {
    let (mut longest, mut piece) = (0.0_f64, 0.0);
    for c in text.chars() {
        let is_break = c == '\u{200b}' || (c.is_whitespace() && c != '\u{a0}');
        // Every Chinese character may end a line.
        let begins = is_break || is_wide(c);
        piece = if begins { 0.0 } else { piece };
        piece += if is_break { 0.0 } else { width_em(c) };
        longest = longest.max(piece);
    }
    longest
}

/// Approximate width of a letter of DejaVu Sans.
fn width_em(c: char) -> f64 {
    match c {
        '\u{200b}'..='\u{200f}' | '\u{2060}' | '\u{300}'..='\u{36f}' => 0.0,
        'f' | 'i' | 'j' | 'l' | 'r' | 't' | 'I' | 'J' | '.' | ',' | ':' | ';' | '\'' | '|'
        | '!' | '(' | ')' | '[' | ']' | '-' | '/' | ' ' | '\u{a0}' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '…' | '—' => 1.0,
        '+' | '<' | '>' | '=' | '±' | '×' | '≤' | '≥' | '→' | '−' | 'ω' | '□' => 0.95,
        c if is_wide(c) => 1.05,
        c if c.is_uppercase() => 0.78,
        _ => 0.64,
    }
}

fn is_wide(c: char) -> bool {
    c >= '\u{2e80}'
        && !('\u{fb00}'..='\u{fdff}').contains(&c)
        && !('\u{fe70}'..='\u{feff}').contains(&c)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(texts: &[&str]) -> Vec<String> {
        texts.iter().map(|text| (*text).to_owned()).collect()
    }

    #[test]
    fn a_small_table_is_as_wide_as_its_text() {
        let found = fit(&texts(&["Film", "mean (mm)"]), &[texts(&["left bending", "1.25"])]);
        assert_eq!(found.size_pt, SIZES_PT[0]);
        assert!(found.widths_pt.iter().sum::<f64>() < 0.5 * PAGE_PT, "{found:?}");
        assert!(found.widths_pt[0] > 40.0, "{found:?}");
    }

    #[test]
    fn many_columns_have_smaller_type_and_fit_the_page() {
        let heads: Vec<String> = (0..14).map(|i| format!("column {i} of many")).collect();
        let row: Vec<String> = (0..14).map(|i| format!("-12.3456 ± 0.12{i}")).collect();
        let found = fit(&heads, &[row]);
        assert!(found.size_pt < SIZES_PT[0]);
        let width: f64 = found.widths_pt.iter().sum();
        assert!(width > 0.9 * PAGE_PT && width < PAGE_PT + 1e-9, "{width}");
        let long: Vec<String> = (0..20).map(|i| format!("Donaudampfschifffahrt{i}")).collect();
        let monstrous = fit(&long, &[]);
        assert!(monstrous.widths_pt.iter().sum::<f64>() < PAGE_PT + 1e-9);
        assert_eq!(fit(&[], &[]).widths_pt, Vec::<f64>::new());
    }

    #[test]
    fn no_column_is_wider_than_it_needs() {
        assert_eq!(shared(10.0, &[1.0, 20.0, 2.0]), [1.0, 7.0, 2.0]);
        assert_eq!(shared(-1.0, &[1.0, 2.0]), [0.0, 0.0]);
        assert_eq!(shared(9.0, &[]), Vec::<f64>::new());
    }

    #[test]
    fn pieces_end_at_possible_line_breaks() {
        assert!((longest_piece_em("ab cde") - 3.0 * 0.64).abs() < 1e-12);
        assert!((longest_piece_em("ab\u{200b}cde") - 3.0 * 0.64).abs() < 1e-12);
        assert!((longest_piece_em("病例一") - 1.05).abs() < 1e-12);
    }
}
