//! Tables with aligned columns: numbers right, words left.
//! Not comfy-table: it gives a narrow column of numbers the same share as a column of words and breaks numbers.

use unicode_width::UnicodeWidthStr;

use super::{HANGING, filled, plain, words, wrapped};
use crate::document::Table;

/// Between two columns.
const GAP: &str = "  ";
/// Characters of a name without marks that stay together: more than in the longest word of a report.
const LONGEST_PIECE: usize = 24;

/// One table: its caption, heads, rule, rows and note. Heads and columns of words are wrapped where the table is wider than
/// the width; numbers never are. A long name is broken only where whole words do not fit, and columns that do not fit all the same
/// follow below, beside the names of their rows. Blanks at the start of a cell stay, and so does its row's place in the order.
#[must_use]
pub fn table(table: &Table, width: usize) -> String {
    let laid_out = |one: &Table| {
        let Parts { head, rows, note } = parts(one, width);
        [head, rows.concat(), note].concat()
    };
    match &blocks(table, width)[..] {
        [] => laid_out(table),
        blocks => blocks.iter().map(laid_out).collect::<Vec<_>>().join("\n"),
    }
}

/// A table that is too wide as several tables: each has the columns of words before the first number, which name the rows, and
/// the next columns that fit, at least one. Empty for a table that fits.
fn blocks(table: &Table, width: usize) -> Vec<Table> {
    let least = Cells::of(table).least(longest_piece);
    let needed = |columns: &[usize]| columns.iter().map(|&i| least[i] + GAP.len()).sum::<usize>();
    let all: Vec<usize> = (0..least.len()).collect();
    let limit = width.saturating_add(GAP.len());
    let names = table.columns.iter().position(|column| column.numeric).unwrap_or(1).max(1);
    if needed(&all) <= limit || names >= all.len() {
        return Vec::new();
    }
    let (names, others) = all.split_at(names);
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    for &column in others {
        match blocks.last_mut() {
            Some(block) if needed(block) + needed(&[column]) <= limit => block.push(column),
            _ => blocks.push([names, &[column]].concat()),
        }
    }
    let last = blocks.len() - 1;
    let text = |is_here: bool, text: &String| if is_here { text.clone() } else { String::new() };
    let block = |(place, columns): (usize, &Vec<usize>)| Table {
        caption: text(place == 0, &table.caption),
        columns: columns.iter().map(|&i| table.columns[i].clone()).collect(),
        rows: table
            .rows
            .iter()
            .map(|row| columns.iter().map(|&i| row[i].clone()).collect())
            .collect(),
        note: text(place == last, &table.note),
    };
    blocks.iter().enumerate().map(block).collect()
}

/// The lines of a table.
pub(crate) struct Parts {
    /// Caption, heads and rule.
    pub(crate) head: String,
    /// The lines of each row.
    pub(crate) rows: Vec<String>,
    pub(crate) note: String,
}

/// The lines of a table, between which other lines may stand.
pub(crate) fn parts(table: &Table, width: usize) -> Parts {
    let cells = Cells::of(table);
    let gaps = GAP.len() * cells.heads.len().saturating_sub(1);
    let widths = cells.widths(width.saturating_sub(gaps));
    let Cells { heads, rows, numeric } = cells;
    let mut head = String::new();
    if !table.caption.is_empty() {
        head.push_str(&super::hanging(&table.caption, width));
    }
    head.push_str(&head_lines(&heads, &widths, &numeric));
    head.push_str(&"─".repeat(widths.iter().sum::<usize>() + gaps));
    head.push('\n');
    let row = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, &width)| cell_lines(cell, width)).collect();
        lines(cells, &widths, &numeric)
    };
    let mut note = String::new();
    if !table.note.is_empty() {
        note = super::paragraph(&table.note, width.saturating_sub(HANGING.len()), HANGING);
    }
    Parts { head, rows: rows.iter().map(row).collect(), note }
}

/// A cell as plain text with the blanks at its start, which indent names of rows.
fn indented(cell: &str) -> String {
    let blanks = cell.chars().take_while(|c| *c == ' ').count();
    format!("{}{}", " ".repeat(blanks), plain(cell))
}

/// The heads and cells of a table as plain text.
struct Cells {
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
    numeric: Vec<bool>,
}

impl Cells {
    fn of(table: &Table) -> Self {
        let cells = |row: &Vec<String>| row.iter().map(|cell| indented(cell)).collect();
        Self {
            heads: table.columns.iter().map(|column| plain(&column.head)).collect(),
            rows: table.rows.iter().map(cells).collect(),
            numeric: table.columns.iter().map(|column| column.numeric).collect(),
        }
    }

    /// The width of every column that holds its head in any number of lines, its numbers, and this part of its words.
    fn least(&self, of_words: fn(&str) -> usize) -> Vec<usize> {
        let of = |i: usize| {
            let part: fn(&str) -> usize = if self.numeric[i] { str::width } else { of_words };
            self.rows.iter().map(|row| part(&row[i])).fold(narrowest(&self.heads[i]), usize::max)
        };
        (0..self.heads.len()).map(of).collect()
    }

    /// The width of every column. Cells have one line where there is room; then heads have as few lines as possible. Where
    /// cells need more room than there is, the widest columns of words are narrowed, first to whole words and then to the pieces of
    /// long names ([`pieces`]).
    fn widths(&self, room: usize) -> Vec<usize> {
        let full = self.least(str::width);
        let fits = |widths: &Vec<usize>| widths.iter().sum::<usize>() <= room;
        if fits(&full) {
            let longest = self.heads.iter().map(|head| head.width()).max().unwrap_or(0);
            let in_lines = |lines: usize| -> Vec<usize> {
                let with_head = |(head, &full): (&String, &usize)| full.max(width_in(head, lines));
                self.heads.iter().zip(&full).map(with_head).collect()
            };
            return (1..=longest).map(in_lines).find(fits).unwrap_or(full);
        }
        let narrowed = |least: &[usize]| -> Option<Vec<usize>> {
            let to = |limit: usize| -> Vec<usize> {
                full.iter().zip(least).map(|(&full, &least)| full.min(limit).max(least)).collect()
            };
            (1..=room).rev().map(to).find(fits)
        };
        let in_pieces = self.least(longest_piece);
        narrowed(&self.least(longest_word)).or_else(|| narrowed(&in_pieces)).unwrap_or(in_pieces)
    }
}

/// The least width in which a head has at most `lines` lines.
fn width_in(head: &str, lines: usize) -> usize {
    (narrowest(head)..=head.width())
        .find(|&width| wrapped(head, width, true).len() <= lines)
        .unwrap_or(head.width())
}

fn narrowest(head: &str) -> usize {
    wrapped(head, 1, true).iter().map(|line| line.width()).max().unwrap_or(0)
}

fn longest_word(cell: &str) -> usize {
    let blanks = cell.len() - cell.trim_start().len();
    blanks + words(cell).into_iter().map(str::width).max().unwrap_or(0)
}

fn longest_piece(cell: &str) -> usize {
    let blanks = cell.len() - cell.trim_start().len();
    blanks + words(cell).into_iter().flat_map(pieces).map(str::width).max().unwrap_or(0)
}

/// The pieces of a name, each with the hyphen, point or low line at its end; a long piece is cut. A number is one piece.
fn pieces(word: &str) -> Vec<&str> {
    let mut pieces = Vec::new();
    let mut start = 0;
    for (place, mark) in word.match_indices(['-', '_', '.']) {
        let end = place + mark.len();
        let beside = [word[..place].chars().next_back(), word[end..].chars().next()];
        let in_name = mark == "_" || beside.iter().flatten().any(|c| c.is_alphabetic());
        if in_name && end < word.len() {
            pieces.push(&word[start..end]);
            start = end;
        }
    }
    pieces.push(&word[start..]);
    pieces.into_iter().flat_map(cut).collect()
}

/// A piece in parts of at most [`LONGEST_PIECE`] characters.
fn cut(mut piece: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    while let Some((place, _)) = piece.char_indices().nth(LONGEST_PIECE) {
        let (part, rest) = piece.split_at(place);
        parts.push(part);
        piece = rest;
    }
    parts.push(piece);
    parts
}

/// A cell in lines; those after the first one begin below its first word.
fn cell_lines(cell: &str, width: usize) -> Vec<String> {
    let blanks = &cell[..cell.len() - cell.trim_start().len()];
    let room = width.saturating_sub(blanks.len());
    let lines =
        filled(cell, room, |word| if word.width() > room { pieces(word) } else { vec![word] });
    lines.iter().map(|line| format!("{blanks}{line}")).collect()
}

/// The heads, whose last lines stand on the rule.
fn head_lines(heads: &[String], widths: &[usize], numeric: &[bool]) -> String {
    let mut cells: Vec<Vec<String>> =
        heads.iter().zip(widths).map(|(head, &width)| wrapped(head, width, true)).collect();
    let most = cells.iter().map(Vec::len).max().unwrap_or(0);
    for cell in &mut cells {
        let missing = most - cell.len();
        cell.splice(0..0, vec![String::new(); missing]);
    }
    lines(cells, widths, numeric)
}

/// One row, whose cells may have several lines.
fn lines(cells: Vec<Vec<String>>, widths: &[usize], numeric: &[bool]) -> String {
    let most = cells.iter().map(Vec::len).max().unwrap_or(0);
    let mut text = String::new();
    for line in 0..most {
        let padded: Vec<String> = cells
            .iter()
            .zip(widths.iter().zip(numeric))
            .map(|(cell, (&width, &numeric))| {
                let words = cell.get(line).map_or("", String::as_str);
                let blanks = " ".repeat(width.saturating_sub(words.width()));
                if numeric { format!("{blanks}{words}") } else { format!("{words}{blanks}") }
            })
            .collect();
        text.push_str(padded.join(GAP).trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Column;

    fn example(rows: &[[&str; 3]]) -> Table {
        let columns = vec![
            Column::words("Line of action"),
            Column::numbers("Mean location error (mm)"),
            Column::words("Verdict"),
        ];
        let mut table = Table::new("Errors", columns);
        for row in rows {
            table.row(row.map(str::to_owned).to_vec());
        }
        table
    }

    const ROWS: [[&str; 3]; 3] = [
        ["inflection line", "2.05", "identified"],
        ["iliac line", "12.1", "only an upper limit"],
        ["病例", "-3", "–"],
    ];

    #[test]
    fn numbers_are_aligned_right_and_words_left() {
        assert_eq!(
            table(&example(&ROWS), 80),
            "Errors\n\
             Line of action   Mean location error (mm)  Verdict\n\
             ──────────────────────────────────────────────────────────────\n\
             inflection line                      2.05  identified\n\
             iliac line                           12.1  only an upper limit\n\
             病例                                   -3  –\n"
        );
    }

    #[test]
    fn headings_are_wrapped_before_cells() {
        assert_eq!(
            table(&example(&ROWS[..1]), 39),
            format!(
                "Errors\n{:>27}\n{:>27}\n\
                 Line of action   error (mm)  Verdict\n\
                 ───────────────────────────────────────\n\
                 inflection line        2.05  identified\n",
                "Mean", "location"
            )
        );
    }

    #[test]
    fn text_columns_are_narrowed_and_no_number_or_word_is_cut() {
        for width in 36..90 {
            let text = table(&example(&ROWS), width);
            assert!(text.lines().all(|line| line.width() <= width), "{width}:\n{text}");
            let end = |number: &str| {
                let line = text.lines().find(|line| line.contains(number)).expect("it is whole");
                line[..line.find(number).expect("found")].width() + number.len()
            };
            assert!(end("2.05") == end("12.1") && end("-3") == end("2.05"), "{width}:\n{text}");
            for word in ROWS.iter().flatten().flat_map(|cell| cell.split(' ')) {
                assert!(text.contains(word), "{width}: {word}\n{text}");
            }
        }
        // Too narrow for any layout: the words stay whole all the same.
        assert!(table(&example(&ROWS), 5).contains("identified"));
    }

    #[test]
    fn long_names_break_after_their_marks_where_words_do_not_fit() {
        let columns =
            vec![Column::words("Patient"), Column::words("Verdict"), Column::numbers("mm")];
        let mut rows = Table::new("", columns);
        let name = "phantom-weight-and-couple-01-hinges";
        rows.row([name, "not_identified.yet 0.45 mm", "12.1"].map(str::to_owned).to_vec());
        let text = table(&rows, 40);
        assert_eq!(
            text.lines().skip(2).collect::<Vec<_>>(),
            ["phantom-weight-   not_identified.   12.1", "and-couple-01-    yet 0.45 mm", "hinges"]
        );
        assert!(table(&rows, 61).contains(name), "whole words fit");
    }

    #[test]
    fn a_long_name_without_marks_is_cut_where_it_does_not_fit() {
        let columns = vec![Column::words("Patient"), Column::numbers("mm")];
        let mut rows = Table::new("", columns);
        let name = "ABCDEF".repeat(10);
        rows.row(vec![name.clone(), "12.1".to_owned()]);
        let text = table(&rows, 40);
        assert!(text.lines().all(|line| line.width() <= 40), "{text}");
        let letters: String = text.lines().skip(2).collect::<String>().replace("12.1", "");
        assert_eq!(letters.replace(' ', ""), name);
        assert!(table(&rows, 66).contains(&name), "the whole name fits");
    }

    #[test]
    fn columns_that_do_not_fit_follow_below_beside_the_names_of_their_rows() {
        let heads = ["Fitted", "Left out", "BIC"].map(Column::numbers);
        let columns = [Column::words("Load")].into_iter().chain(heads).collect();
        let mut rows = Table::new("Errors", columns);
        rows.row(["couple", "10.25", "11.25", "-120"].map(str::to_owned).to_vec());
        rows.note = "In mm.".to_owned();
        let [wide, narrow] = [21, 12].map(|width| "─".repeat(width));
        assert_eq!(
            table(&rows, 21),
            format!(
                "Errors\n{:>21}\nLoad    Fitted    out\n{wide}\ncouple   10.25  11.25\n\n\
                 Load     BIC\n{narrow}\ncouple  -120\n  In mm.\n",
                "Left"
            )
        );
    }

    #[test]
    fn a_wide_table_without_limit_has_one_line_per_row() {
        let text = table(&example(&ROWS), usize::MAX);
        assert_eq!(text.lines().count(), 3 + ROWS.len());
    }

    #[test]
    fn leading_blanks_of_a_cell_indent_all_its_lines() {
        let mut rows = Table::new("", vec![Column::words("Quantity"), Column::numbers("n")]);
        rows.row(vec!["  resampled over patients".to_owned(), "4".to_owned()]);
        let text = table(&rows, 19);
        assert_eq!(
            text,
            "Quantity          n\n───────────────────\n  resampled over  4\n  patients\n"
        );
    }

    #[test]
    fn the_note_is_below_the_table_and_indented() {
        let mut rows = example(&ROWS[..1]);
        rows.note = "p below 0.05 rejects the line.".to_owned();
        let text = table(&rows, 64);
        assert!(text.ends_with("\n  p below 0.05 rejects the line.\n"), "{text}");
    }
}
