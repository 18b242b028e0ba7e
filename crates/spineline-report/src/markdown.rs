//! Markdown, with every figure as a picture file beside it.

use std::fmt::Write;

use crate::document::{Block, Document, Figure, Notice, Section, Table};
use crate::embedded::{ELEMENT_ID, FENCE};

/// The report as Markdown with GitHub's tables. Figures are named `folder/NAME.svg`, and the caller writes
/// them there; `folder` is a relative path of plain letters.
#[must_use]
pub fn markdown(document: &Document, folder: &str) -> String {
    let mut text = format!("# {}: {}\n", plain(&document.title), plain(&document.subject));
    for banner in &document.banners {
        write_notice(&mut text, banner);
    }
    for section in &document.sections {
        write_section(&mut text, section, folder);
    }
    let _ = write!(
        text,
        "\n## Analysis as JSON\n\nMade by {}. The analysis behind this report:\n\n{FENCE}json {ELEMENT_ID}\n{}\n{FENCE}\n",
        plain(&document.generator),
        document.analysis
    );
    text
}

fn write_section(text: &mut String, section: &Section, folder: &str) {
    let _ = writeln!(text, "\n## {}", plain(&section.title));
    for block in &section.blocks {
        match block {
            Block::Heading(words) => {
                let _ = writeln!(text, "\n### {}", plain(words));
            }
            Block::Paragraph(words) => {
                let _ = writeln!(text, "\n{}", plain(words));
            }
            Block::Notice(notice) => write_notice(text, notice),
            Block::Table(table) => write_table(text, table),
            Block::Figure(figure) => write_figure(text, figure, folder),
        }
    }
}

fn write_notice(text: &mut String, notice: &Notice) {
    let place = if notice.place.is_empty() { "" } else { ": " };
    let code =
        if notice.code.is_empty() { String::new() } else { format!(" ({})", plain(&notice.code)) };
    let _ = writeln!(
        text,
        "\n> **{}.** {}{place}{}{code}",
        notice.kind.word(),
        plain(&notice.place),
        plain(&notice.text)
    );
}

fn write_table(text: &mut String, table: &Table) {
    let line = |cells: &mut dyn Iterator<Item = String>| {
        cells.fold("|".to_owned(), |line, cell| format!("{line} {cell} |"))
    };
    let heads = line(&mut table.columns.iter().map(|column| plain(&column.head)));
    let rule = |numeric: bool| if numeric { "---:" } else { "---" }.to_owned();
    let rules = line(&mut table.columns.iter().map(|column| rule(column.numeric)));
    let _ = writeln!(text, "\n**{}**\n\n{heads}\n{rules}", plain(&table.caption));
    for row in &table.rows {
        let _ = writeln!(text, "{}", line(&mut row.iter().map(|cell| plain(cell))));
    }
    if !table.note.is_empty() {
        let _ = writeln!(text, "\n{}", plain(&table.note));
    }
}

fn write_figure(text: &mut String, figure: &Figure, folder: &str) {
    let caption = plain(&figure.caption);
    let _ = writeln!(text, "\n![{caption}]({folder}/{}.svg)\n\n{caption}", figure.name);
}

/// Escapes every character that Markdown or HTML could read, and joins lines.
fn plain(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    let mut words = text.split_whitespace().peekable();
    let mut first = true;
    while let Some(word) = words.next() {
        for (i, c) in word.chars().enumerate() {
            match c {
                '<' => escaped.push_str("&lt;"),
                '>' => escaped.push_str("&gt;"),
                '&' => escaped.push_str("&amp;"),
                '\\' | '`' | '*' | '_' | '{' | '}' | '[' | ']' | '#' | '|' | '~' | '$' | '^' => {
                    escaped.extend(['\\', c]);
                }
                // A colon makes links of addresses and pictures of words between two.
                ':' if word.chars().nth(i + 1).is_some() => escaped.push_str("&#58;"),
                '@' => escaped.push_str("&#64;"),
                // At the start of a line these make lists, rules and headings.
                '-' | '+' | '=' if first && i == 0 => escaped.extend(['\\', c]),
                '.' | ')' if first && word[..].chars().take(i).all(|d| d.is_ascii_digit()) => {
                    escaped.extend(['\\', c]);
                }
                c if c.is_control() => {}
                c => escaped.push(c),
            }
        }
        first = false;
        if words.peek().is_some() {
            escaped.push(' ');
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn text_is_escaped_in_markdown() {
        assert_eq!(plain("<b>|*x*|</b>"), "&lt;b&gt;\\|\\*x\\*\\|&lt;/b&gt;");
        assert_eq!(plain("- a\n# b"), "\\- a \\# b");
        assert_eq!(plain("1. a 1.5 - 2.5"), "1\\. a 1.5 - 2.5");
        assert_eq!(plain("http://a :b: note: c"), "http&#58;//a &#58;b: note: c");
        assert_eq!(plain("病例 $x$ `y`"), "病例 \\$x\\$ \\`y\\`");
    }
}
