//! One HTML file that needs nothing beside it: no network, no other file.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::document::{Block, Document, Figure, Notice, Section, Table};
use crate::embedded::{ELEMENT_ID, for_html};

const STYLE: &str = include_str!("report.css");
/// Rules for a part of another page.
const FRAGMENT_STYLE: &str = include_str!("fragment.css");
const SCRIPT: &str = include_str!("report.js");
/// The file may load only its own content.
const POLICY: &str =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// A table of at most this number of rows stays on one printed page.
const SHORT_ROWS: usize = 16;
/// A table of more columns is printed in smaller letters.
const MANY_COLUMNS: usize = 8;

/// The report as one HTML file. Its script sorts tables, hides and shows layers of figures and turns views in space; without
/// it, everything can be read as well.
#[must_use]
pub fn html(document: &Document) -> String {
    let title = format!("{}: {}", document.title, document.subject);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="generator" content=(document.generator);
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    p.kind { (document.title) }
                    h1 { bdi { (document.subject) } }
                    @for banner in &document.banners { (notice(banner)) }
                }
                nav aria-label="Sections" {
                    @for section in &document.sections {
                        a href={ "#" (section.id) } { (section.title) }
                    }
                }
                main { @for part in &document.sections { (section(part)) } }
                footer { "Made by " (document.generator) ". This file contains the analysis behind this report." }
                script type="application/json" id=(ELEMENT_ID) {
                    (PreEscaped(for_html(&document.analysis)))
                }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    }
    .into_string()
}

/// The same as a part of another page, such as a notebook: it loads nothing, runs nothing, and changes nothing outside of it.
/// Views in space are left out.
#[must_use]
pub fn html_fragment(document: &Document) -> String {
    html! {
        div.spineline {
            style { (PreEscaped(FRAGMENT_STYLE)) }
            p { strong { bdi { (document.subject) } } " · " (document.title) }
            @for banner in &document.banners { (notice(banner)) }
            @for part in &document.sections {
                @if !part.title.is_empty() { h4 { (part.title) } }
                (blocks(part, |figure| html! {
                    figure.picture { (PreEscaped(&figure.svg)) figcaption { (figure.caption) } }
                }))
            }
        }
    }
    .into_string()
}

fn section(section: &Section) -> Markup {
    html! {
        section id=(section.id) {
            h2 { (section.title) }
            (blocks(section, figure))
        }
    }
}

fn blocks(section: &Section, picture: impl Fn(&Figure) -> Markup) -> Markup {
    html! {
        @for block in &section.blocks {
            @match block {
                Block::Heading(text) => h3 { (text) },
                Block::Paragraph(text) => p dir="auto" { (text) },
                Block::Notice(one) => (notice(one)),
                Block::Table(one) => (table(one)),
                Block::Figure(one) => (picture(one)),
            }
        }
    }
}

fn notice(notice: &Notice) -> Markup {
    html! {
        div class={ "notice " (notice.kind.key()) } role="note" {
            strong { (notice.kind.word()) }
            span.text dir="auto" {
                @if !notice.place.is_empty() { em { (notice.place) ": " } }
                (notice.text)
            }
            @if !notice.code.is_empty() { code { (notice.code) } }
        }
    }
}

fn table(table: &Table) -> Markup {
    let class = |column: usize| if table.columns[column].numeric { "number" } else { "words" };
    html! {
        figure.table.short[table.rows.len() <= SHORT_ROWS].many-columns[table.columns.len() > MANY_COLUMNS] {
            figcaption { (table.caption) }
            div.wide {
                table {
                    thead {
                        tr {
                            @for column in &table.columns {
                                th scope="col" class=(if column.numeric { "number" } else { "words" }) {
                                    (column.head)
                                }
                            }
                        }
                    }
                    tbody {
                        @for row in &table.rows {
                            tr {
                                @for (i, cell) in row.iter().enumerate() {
                                    td class=(class(i)) dir="auto" { (cell) }
                                }
                            }
                        }
                    }
                }
            }
            @if !table.note.is_empty() { p.note { (table.note) } }
        }
    }
}

fn figure(figure: &Figure) -> Markup {
    html! {
        figure.picture.whole-page[figure.whole_page] id={ "figure-" (figure.name) } {
            (PreEscaped(&figure.svg))
            @if let Some(space) = &figure.space {
                div.space {
                    p.hint { "Drag to turn; the buttons show and hide." }
                    script type="application/json" {
                        (PreEscaped(for_html(&serde_json::to_string(space).expect("numbers and text"))))
                    }
                }
            }
            figcaption { (figure.caption) }
        }
    }
}
