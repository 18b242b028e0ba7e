//! A report as data for the template: texts with available letters, in their order, with the widths of tables.

use serde_json::{Value, json};
use spineline_files::{case_ids, content_words};
use spineline_report::Document;
use spineline_report::document::{Block, Notice, NoticeKind, Table};

use crate::columns::{EDGES_PT, fit};
use crate::text::Letters;

/// Maximum length of the subject in the footer, in letters.
const FOOTER: usize = 48;

/// The file of a figure for the template, by its number in the report.
pub(crate) fn figure_path(place: usize) -> String {
    format!("/figures/{place}.svg")
}

pub(crate) fn texts(document: &Document) -> Vec<&str> {
    let mut texts =
        vec![document.title.as_str(), document.subject.as_str(), document.generator.as_str()];
    document.banners.iter().for_each(|banner| add_notice(&mut texts, banner));
    for section in &document.sections {
        texts.push(&section.title);
        section.blocks.iter().for_each(|block| add_block(&mut texts, block));
    }
    texts
}

fn add_block<'a>(texts: &mut Vec<&'a str>, block: &'a Block) {
    match block {
        Block::Heading(text) | Block::Paragraph(text) => texts.push(text),
        Block::Notice(notice) => add_notice(texts, notice),
        Block::Table(table) => {
            texts.extend([table.caption.as_str(), table.note.as_str()]);
            texts.extend(table.columns.iter().map(|column| column.head.as_str()));
            texts.extend(table.rows.iter().flatten().map(String::as_str));
        }
        Block::Figure(figure) => texts.extend([figure.caption.as_str(), figure.svg.as_str()]),
    }
}

fn add_notice<'a>(texts: &mut Vec<&'a str>, notice: &'a Notice) {
    texts.extend([notice.place.as_str(), notice.text.as_str(), notice.code.as_str()]);
}

/// The report for the template; `missing` names the letters that are boxes.
pub(crate) fn page(document: &Document, letters: &Letters, missing: Option<&str>) -> Value {
    let missing = missing.map(|text| Notice::new(NoticeKind::Note, text));
    let banners = document.banners.iter().chain(&missing);
    let mut figures = 0;
    let sections: Vec<Value> = document
        .sections
        .iter()
        .map(|section| {
            let blocks = section.blocks.iter();
            let blocks = blocks.map(|block| block_value(block, letters, &mut figures));
            json!({ "title": letters.words(&section.title), "blocks": blocks.collect::<Vec<_>>() })
        })
        .collect();
    json!({
        "title": letters.words(&document.title),
        "subject": letters.words(&document.subject),
        "heading": letters.plain(&format!("{}: {}", document.title, document.subject)),
        "footer": letters.words(&shortened(&document.subject)),
        "generator": letters.plain(&document.generator),
        // Programs show them; the writer of the file fills in the hash.
        "keywords": content_words(&case_ids(document.analysis.as_bytes())),
        "banners": banners.map(|banner| notice_value(banner, letters)).collect::<Vec<_>>(),
        "sections": sections,
    })
}

fn shortened(text: &str) -> String {
    if text.chars().count() <= FOOTER {
        return text.to_owned();
    }
    text.chars().take(FOOTER - 1).chain(['…']).collect()
}

fn block_value(block: &Block, letters: &Letters, figures: &mut usize) -> Value {
    match block {
        Block::Heading(text) => json!({ "kind": "heading", "of": letters.words(text) }),
        Block::Paragraph(text) => json!({ "kind": "paragraph", "of": letters.words(text) }),
        Block::Notice(notice) => json!({ "kind": "notice", "of": notice_value(notice, letters) }),
        Block::Table(table) => json!({ "kind": "table", "of": table_value(table, letters) }),
        Block::Figure(figure) => {
            let path = figure_path(*figures);
            *figures += 1;
            json!({ "kind": "figure", "of": {
                "path": path,
                "caption": letters.words(&figure.caption),
                "alternative": letters.plain(&figure.caption),
                "whole_page": figure.whole_page,
            } })
        }
    }
}

fn notice_value(notice: &Notice, letters: &Letters) -> Value {
    json!({
        "kind": notice.kind.key(),
        "word": notice.kind.word(),
        "place": letters.words(&notice.place),
        "text": letters.words(&notice.text),
        "code": letters.words(&notice.code),
    })
}

fn table_value(table: &Table, letters: &Letters) -> Value {
    let heads: Vec<String> =
        table.columns.iter().map(|column| letters.words(&column.head)).collect();
    let words = |row: &Vec<String>| row.iter().map(|cell| letters.words(cell)).collect();
    let rows: Vec<Vec<String>> = table.rows.iter().map(words).collect();
    let fit = fit(&heads, &rows);
    json!({
        "caption": letters.words(&table.caption),
        "note": letters.words(&table.note),
        "heads": heads,
        "numeric": table.columns.iter().map(|column| column.numeric).collect::<Vec<_>>(),
        "rows": rows,
        "size_pt": fit.size_pt,
        "widths_pt": fit.widths_pt,
        "edge_pt": EDGES_PT / 2.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_letters_are_reported_after_the_banners() {
        let document = Document {
            title: "Report".to_owned(),
            subject: "a_b".to_owned(),
            generator: "a program".to_owned(),
            banners: vec![Notice::new(NoticeKind::Banner, "Synthetic data.")],
            sections: Vec::new(),
            analysis: "{}".to_owned(),
        };
        let letters = Letters::of(texts(&document), &[]);
        assert!(letters.lacking().contains(&'S'), "fonts without letters lack all");
        let page = page(&document, &letters, Some("No font has these."));
        assert_eq!(page["banners"].as_array().map(Vec::len), Some(2));
        assert_eq!(page["banners"][1]["kind"], "note");
        assert_eq!(page["subject"], "□□□");
    }

    #[test]
    fn a_footer_has_room_for_its_text() {
        assert_eq!(shortened("P07"), "P07");
        assert_eq!(shortened(&"病".repeat(200)).chars().count(), FOOTER);
    }
}
