//! Plain text for a terminal: headings between rules, wrapped paragraphs, and tables with aligned columns.
//!
//! No control character and no change of the writing direction reaches the terminal, whatever a case file holds.

mod lines;
mod table;

use unicode_width::UnicodeWidthStr;

use spineline::number::NO_BREAK;

use crate::document::{Block, Document, Notice, Section};

pub use lines::{Lines, shown};
pub use table::table;
pub(crate) use table::{Parts, parts};

use lines::is_hidden;

/// Columns of text outside of a terminal.
pub const WIDTH: usize = 100;
/// Lines after the first one of a paragraph begin with it.
const HANGING: &str = "  ";

/// The document as text of at most `width` columns, unless a single word, or the names of rows with one column, are wider. A figure is named
/// in one line; the embedded analysis is left out.
#[must_use]
pub fn terminal(document: &Document, width: usize) -> String {
    let mut text = hanging(&format!("{}: {}", document.title, document.subject), width);
    for banner in &document.banners {
        text.push_str(&notice(banner, width));
    }
    for (place, part) in document.sections.iter().enumerate() {
        // A first section without a heading belongs to the head of the document.
        if place > 0 || !part.title.is_empty() {
            text.push('\n');
        }
        text.push_str(&section(part, width));
    }
    text
}

/// One section with its heading, if it has a title.
#[must_use]
pub fn section(section: &Section, width: usize) -> String {
    let title = plain(&section.title);
    let mut text =
        if title.is_empty() { String::new() } else { format!("═══ {title} ═══\n") };
    let mut after_table = false;
    for (place, block) in section.blocks.iter().enumerate() {
        let apart = matches!(block, Block::Heading(_) | Block::Table(_));
        if place > 0 && (apart || after_table) {
            text.push('\n');
        }
        after_table = matches!(block, Block::Table(_));
        match block {
            Block::Heading(words) | Block::Paragraph(words) => {
                text.push_str(&hanging(words, width));
            }
            Block::Notice(one) => text.push_str(&notice(one, width)),
            Block::Table(one) => text.push_str(&table(one, width)),
            Block::Figure(figure) => {
                let words = format!("[Figure {}: {}]", figure.name, figure.caption);
                text.push_str(&hanging(&words, width));
            }
        }
    }
    text
}

/// One notice, such as `Warning: left bending film, T9: … [code]`.
#[must_use]
pub fn notice(notice: &Notice, width: usize) -> String {
    let mut words = format!("{}: ", notice.kind.word());
    if !notice.place.is_empty() {
        words.push_str(&format!("{}: ", notice.place));
    }
    words.push_str(&notice.text);
    if !notice.code.is_empty() {
        words.push_str(&format!(" [{}]", notice.code));
    }
    hanging(&words, width)
}

/// Running text in lines of at most `width` columns, each of which begins with the indent.
#[must_use]
pub fn paragraph(text: &str, width: usize, indent: &str) -> String {
    let lines = wrapped(&plain(text), width.saturating_sub(indent.len()), false);
    lines.iter().map(|line| format!("{indent}{line}\n")).collect()
}

/// Running text whose lines after the first one are indented.
fn hanging(text: &str, width: usize) -> String {
    let lines = wrapped(&plain(text), width.saturating_sub(HANGING.len()), false);
    lines.join(&format!("\n{HANGING}")) + "\n"
}

/// Lines of at most `width` columns, unless a single word is wider. The parts of a broken line keep its indent, and have single blanks.
#[must_use]
pub fn within(lines: &Lines, width: usize) -> String {
    let broken = |line: &str| -> String {
        if line.width() <= width {
            return format!("{line}\n");
        }
        let indent = &line[..line.len() - line.trim_start_matches(' ').len()];
        let parts = hanging(line, width.saturating_sub(indent.len()));
        parts.lines().map(|part| format!("{indent}{part}\n")).collect()
    };
    lines.as_str().lines().map(broken).collect()
}

/// The text as one line, without hidden characters.
fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for word in words(text) {
        let end = plain.len();
        plain.extend(word.chars().filter(|&c| !is_hidden(c)));
        if end > 0 && plain.len() > end {
            plain.insert(end, ' ');
        }
    }
    plain
}

/// Units that stay on the line of their number.
const UNITS: [&str; 8] = ["mm", "px", "deg", "%", "N", "N·m", "N·mm", "×"];

/// The words of a text. A number and its unit are one word.
fn words(text: &str) -> Vec<&str> {
    let ends = |c: char| c.is_whitespace() && c != NO_BREAK;
    let mut words: Vec<&str> = Vec::new();
    let mut end = 0;
    for word in text.split(ends).filter(|word| !word.is_empty()) {
        // Places in the text, of which a word is a part.
        let start = word.as_ptr() as usize - text.as_ptr() as usize;
        let is_unit = UNITS.contains(&word.trim_end_matches([',', '.', ';', ':', ')']));
        let follows = &text[end..start] == " ";
        match words.last_mut() {
            Some(last) if is_unit && follows && last.ends_with(|c: char| c.is_ascii_digit()) => {
                *last = &text[end - last.len()..start + word.len()];
            }
            _ => words.push(word),
        }
        end = start + word.len();
    }
    words
}

/// Breaks plain text into one or more lines of at most `width` columns. A longer word stands alone on a line. The heads of narrow
/// columns may break after hyphens too. A no-break space becomes a space.
fn wrapped(text: &str, width: usize, at_hyphens: bool) -> Vec<String> {
    if at_hyphens {
        filled(text, width, |word| word.split_inclusive('-').collect())
    } else {
        filled(text, width, |word| vec![word])
    }
}

/// The same with words that may break between their pieces.
fn filled<'a>(
    text: &'a str,
    width: usize,
    pieces: impl Fn(&'a str) -> Vec<&'a str>,
) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut columns = 0;
    for word in words(text) {
        for (place, piece) in pieces(word).into_iter().enumerate() {
            let line = lines.last_mut().expect("never empty");
            let blank = if place == 0 && !line.is_empty() { " " } else { "" };
            let wider = columns + blank.len() + piece.width();
            if !line.is_empty() && wider > width {
                columns = piece.width();
                lines.push(piece.to_owned());
            } else {
                columns = wider;
                line.push_str(blank);
                line.push_str(piece);
            }
        }
    }
    lines.iter().map(|line| line.replace(NO_BREAK, " ")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Column, Figure, NoticeKind, Table};

    #[test]
    fn lines_are_filled_to_the_limit_and_keep_every_word() {
        let text =
            "Each bend left out of the fit in turn and then predicted by the inflection line";
        for width in [12, 20, 33, 200] {
            let lines = wrapped(text, width, false);
            assert!(lines.iter().all(|line| line.width() <= width), "{lines:?}");
            assert_eq!(lines.join(" "), text);
            for pair in lines.windows(2) {
                let next = pair[1].split(' ').next().expect("a word");
                assert!(pair[0].width() + 1 + next.width() > width, "{lines:?}");
            }
        }
        assert_eq!(wrapped("", 10, false), [""]);
        assert_eq!(wrapped("a verylongword b", 4, false), ["a", "verylongword", "b"]);
        assert_eq!(wrapped("Counter-rotating joints", 8, true), ["Counter-", "rotating", "joints"]);
    }

    #[test]
    fn a_unit_stays_on_the_line_of_its_number() {
        let text = format!("errors of {} on bends", spineline::number::with_unit("12.1", "mm"));
        assert_eq!(wrapped(&plain(&text), 16, false), ["errors of", "12.1 mm on bends"]);
        assert_eq!(
            wrapped("errors of 12.1 mm, 3 % more", 12, false),
            ["errors of", "12.1 mm, 3 %", "more"]
        );
        assert_eq!(wrapped("vertebra L4 mm", 11, false), ["vertebra", "L4 mm"]);
    }

    #[test]
    fn wide_characters_count_twice() {
        assert_eq!(wrapped("病例 病例 病例", 9, false), ["病例 病例", "病例"]);
    }

    #[test]
    fn control_characters_in_text_are_removed() {
        assert_eq!(plain("\u{7} a\u{1b}[31mb\u{7}\u{9b}\n\tc\u{202e}d\u{2066}"), "a[31mb cd");
        let hostile = "x\u{1b}]0;title\u{7}\u{202e}\r\ny";
        let mut part = Section::new("a", hostile);
        part.heading(hostile);
        part.paragraph(hostile);
        part.notice(Notice {
            kind: NoticeKind::Warning,
            place: hostile.to_owned(),
            text: hostile.to_owned(),
            code: hostile.to_owned(),
        });
        let mut rows = Table::new(hostile, vec![Column::words(hostile), Column::numbers(hostile)]);
        rows.row(vec![hostile.to_owned(), hostile.to_owned()]);
        rows.note = hostile.to_owned();
        part.table(rows);
        part.figure(Figure::new("name", hostile, String::new()));
        let document = Document {
            title: hostile.to_owned(),
            subject: hostile.to_owned(),
            generator: String::new(),
            banners: vec![Notice::new(NoticeKind::Banner, hostile)],
            sections: vec![part],
            analysis: hostile.to_owned(),
        };
        let text = terminal(&document, 40);
        assert!(text.chars().all(|c| c == '\n' || !is_hidden(c)), "{text:?}");
        assert!(text.contains("[Figure name: x]0;title y]"), "{text}");
    }

    #[test]
    fn notices_contain_severity_place_and_code() {
        let one = Notice {
            kind: NoticeKind::Warning,
            place: "left bending film, T9".to_owned(),
            text: "a tilt differs from its neighbours".to_owned(),
            code: "odd_tilt".to_owned(),
        };
        assert_eq!(
            notice(&one, 60),
            "Warning: left bending film, T9: a tilt differs from its\n  neighbours [odd_tilt]\n"
        );
        let plain = Notice::new(NoticeKind::Note, "a, b");
        assert_eq!(notice(&plain, 60), "Note: a, b\n");
    }

    #[test]
    fn the_indent_of_a_paragraph_counts_in_its_width() {
        assert_eq!(paragraph("left and right", 9, ""), "left and\nright\n");
        assert_eq!(paragraph("left and right", 9, "  "), "  left\n  and\n  right\n");
    }

    #[test]
    fn a_message_of_several_lines_is_wrapped_line_by_line() {
        let mut lines = Lines::of("error: a.json: the film has two readings");
        lines.line("  help: name another film").line("a   table");
        let expected = "error: a.json: the\n  film has two\n  readings\n  help: name\n    another film\na   table\n";
        assert_eq!(within(&lines, 20), expected);
        assert_eq!(within(&lines, usize::MAX), lines.as_str());
    }

    #[test]
    fn a_section_without_a_title_has_no_heading() {
        let mut part = Section::new("a", "");
        part.paragraph("One film.");
        assert_eq!(section(&part, 80), "One film.\n");
    }

    #[test]
    fn sections_have_a_heading_and_room_around_tables() {
        let mut part = Section::new("a", "Films");
        part.paragraph("One film.");
        let mut rows = Table::new("Angles", vec![Column::words("Film"), Column::numbers("(°)")]);
        rows.row(vec!["erect".to_owned(), "4.5".to_owned()]);
        part.table(rows);
        part.paragraph("Two words.");
        assert_eq!(
            section(&part, 80),
            "═══ Films ═══\nOne film.\n\nAngles\nFilm   (°)\n──────────\nerect  4.5\n\nTwo words.\n"
        );
    }
}
