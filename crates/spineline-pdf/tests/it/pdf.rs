//! Typeset reports, read by another program: pages, attachment, and letters that the fonts lack.

use chrono::{DateTime, Datelike, TimeDelta, Utc};
use hayro_syntax::Pdf;
use spineline_pdf::{PdfError, embedded, pdf};
use spineline_report::Document;
use spineline_report::document::{Column, Figure, Notice, NoticeKind, Section, Table};

/// 2026-01-02T03:04:05Z.
const MADE: DateTime<Utc> = DateTime::from_timestamp(1_767_323_045, 0).expect("a date");
const HOSTILE: &str = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef #let x = $y$ *z* <w> [病例一] مريض \\u{1}";

/// Every kind of block, with a given subject.
fn document(subject: &str) -> Document {
    let mut section = Section::new("all", "Every kind of block");
    section.heading("A heading with #emph[no markup]");
    section.paragraph(format!("About {subject}."));
    let kinds =
        [NoticeKind::Banner, NoticeKind::Contradiction, NoticeKind::Warning, NoticeKind::Note];
    for kind in kinds {
        let (place, code) = ("left bending film, T9".to_owned(), "some_code".to_owned());
        section.notice(Notice { kind, place, text: subject.to_owned(), code });
    }
    section.table(wide());
    section.figure(Figure::new("flat", "A flat figure", svg(720, 200, subject)));
    section.figure(Figure::new("tall", "A tall figure", svg(200, 900, "synthetic")));
    let mut long = Section::new("long", "A table over pages");
    long.table(tall(200));
    Document {
        title: "Report of one patient".to_owned(),
        subject: subject.to_owned(),
        generator: "spineline 0.1.0".to_owned(),
        banners: vec![Notice::new(NoticeKind::Banner, "Synthetic data: made up.")],
        sections: vec![section, long],
        analysis: format!("{{\"case_id\":{}}}", serde_json::Value::from(subject)),
    }
}

fn wide() -> Table {
    let columns = (0..14).map(|i| match i {
        0 => Column::words("Film"),
        _ => Column::numbers(format!("mean of column {i} (mm)")),
    });
    let mut table = Table::new("Fourteen columns", columns.collect());
    for film in ["erect", "left bending", "right_bending", HOSTILE] {
        let numbers = (1..14).map(|i| format!("-{i}.25 ± 0.125"));
        table.row([film.to_owned()].into_iter().chain(numbers).collect());
    }
    table.note = "How to read it.".to_owned();
    table
}

fn tall(rows: usize) -> Table {
    let columns = vec![Column::words("Patient"), Column::numbers("error (mm)")];
    let mut table = Table::new("Many rows", columns);
    for row in 0..rows {
        table.row(vec![format!("P{row:03}"), format!("{}.5", row % 7)]);
    }
    table
}

fn svg(width: u32, height: u32, text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}"><rect width="{width}" height="{height}" fill="#eee" opacity="0.5"/><text x="10" y="40" font-family="DejaVu Sans, sans-serif" font-size="12">{text}</text></svg>"##
    )
}

fn pages(bytes: &[u8]) -> usize {
    let pdf = Pdf::new(bytes.to_vec()).expect("another program reads it");
    pdf.pages().len()
}

#[test]
fn a_report_of_hostile_texts_is_typeset_with_its_analysis() {
    let document = document(HOSTILE);
    let bytes = pdf(&document, MADE).expect("it can be typeset");
    assert!(bytes.starts_with(b"%PDF-"));
    assert_eq!(embedded(&bytes).as_deref(), Some(document.analysis.as_str()));
    // A tall figure on a separate page, and a table of 200 rows.
    let pages = pages(&bytes);
    assert!((4..=10).contains(&pages), "{pages} pages");
}

#[test]
fn equal_reports_give_equal_bytes() {
    let document = document("P07");
    let [a, b] = [(); 2].map(|()| pdf(&document, MADE).expect("it can be typeset"));
    assert!(a == b, "two runs differ");
    let later = pdf(&document, MADE + TimeDelta::seconds(1)).expect("it can be typeset");
    assert!(a != later, "the date is in it");
}

#[test]
fn long_tables_continue_over_pages() {
    let mut document = document("cohort");
    document.sections.truncate(1);
    let few = pages(&pdf(&document, MADE).expect("it can be typeset"));
    let mut section = Section::new("long", "Five hundred patients");
    section.table(tall(500));
    document.sections.push(section);
    let many = pages(&pdf(&document, MADE).expect("it can be typeset"));
    assert!((5..=14).contains(&(many - few)), "{few} pages, then {many}");
}

#[test]
fn a_figure_of_a_whole_page_is_as_wide_as_the_page() {
    // As tall as the films of five postures: with two on one page, letters would be a millimetre high.
    let tall = || Figure::new("films", "Films of five postures", svg(900, 1130, "synthetic"));
    let five = |figure: &dyn Fn() -> Figure| {
        let mut section = Section::new("films", "Films");
        (0..5).for_each(|_| section.figure(figure()));
        let document = Document { sections: vec![section], ..document("P07") };
        pages(&pdf(&document, MADE).expect("it can be typeset"))
    };
    assert_eq!(five(&tall), 3, "two on each page but the first");
    assert_eq!(five(&|| tall().on_whole_page()), 5, "one on each page");
}

#[test]
fn short_tables_are_not_divided_over_pages() {
    let mut section = Section::new("short", "Short tables");
    (0..30).for_each(|_| section.table(tall(15)));
    let document = Document { sections: vec![section], ..document("P07") };
    let found = pages(&pdf(&document, MADE).expect("it can be typeset"));
    // A page has room for three and a half: divided ones would take nine pages.
    assert_eq!(found, 10, "three on each page");
}

#[test]
fn f54_a_report_of_five_hundred_pages_is_typeset() {
    // Oracle: every section begins a new table; a page holds fewer than sixty rows.
    let mut document = document("cohort");
    document.sections = (0..10)
        .map(|number| {
            let mut section = Section::new("part", "A part of the cohort");
            section.paragraph(format!("Part {number}."));
            section.table(tall(3700));
            section
        })
        .collect();
    let bytes = pdf(&document, MADE).expect("it can be typeset");
    assert!(pages(&bytes) >= 500, "{} pages", pages(&bytes));
    assert_eq!(embedded(&bytes).as_deref(), Some(document.analysis.as_str()));
}

#[test]
fn f54_names_in_chinese_and_in_arabic_are_kept_whole_in_the_attached_analysis() {
    for subject in ["病例一", "مريض ٧", "רחל", "Łukasz Ñandú", "👩🏽‍⚕️"] {
        let document = document(subject);
        let bytes = pdf(&document, MADE).expect("it can be typeset");
        assert_eq!(embedded(&bytes).as_deref(), Some(document.analysis.as_str()));
    }
}

#[test]
fn letters_without_a_font_do_not_stop_the_report() {
    // One private letter in a text and in a figure; controls and marks of order beside it.
    let subject = "P\u{10fffd}07\u{202e}\u{7}\u{feff}";
    let document = document(subject);
    let bytes = pdf(&document, MADE).expect("it can be typeset");
    assert_eq!(embedded(&bytes).as_deref(), Some(document.analysis.as_str()));
}

#[test]
fn a_report_without_content_is_a_page() {
    let document = Document { banners: Vec::new(), sections: Vec::new(), ..document("") };
    assert_eq!(pages(&pdf(&document, MADE).expect("it can be typeset")), 1);
}

#[test]
fn impossible_input_is_reported() {
    let document = document("P07");
    for year in [12_026, -44] {
        let made = MADE.with_year(year).expect("a date");
        let error = pdf(&document, made).expect_err("a PDF cannot have this year");
        let words =
            format!("the time of the report, {year:04}-01-02T03:04:05Z, is not a valid date");
        assert!(matches!(error, PdfError::Date(_)) && error.to_string() == words, "{error}");
    }
    let mut broken = document;
    broken.sections[1].figure(Figure::new("broken", "No SVG", "<svg".to_owned()));
    let error = pdf(&broken, MADE).expect_err("no figure").to_string();
    assert!(error.contains("SVG"), "{error}");
}

#[test]
fn files_without_a_report_have_no_analysis() {
    for bytes in [&b"%PDF-1.7 and no analysis"[..], b"", b"<html>", b"{}", b"%PDF-"] {
        assert_eq!(embedded(bytes), None);
    }
}
