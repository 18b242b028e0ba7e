//! A writer of XML: escapes, indents, and closes every element.

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use spineline::spatial::Vec3;

/// Attributes of one element.
pub(super) type Attributes<'a> = &'a [(&'a str, &'a str)];

/// A document being written.
pub(super) struct Document {
    writer: Writer<Vec<u8>>,
    open: Vec<String>,
}

impl Document {
    /// An empty document.
    pub(super) fn new() -> Self {
        let mut document =
            Self { writer: Writer::new_with_indent(Vec::new(), b' ', 2), open: Vec::new() };
        document.write(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
        document
    }

    /// Opens an element.
    pub(super) fn open(&mut self, name: &str, attributes: Attributes<'_>) {
        self.write(Event::Start(start(name, attributes)));
        self.open.push(name.to_owned());
    }

    /// Closes the element that was opened last.
    pub(super) fn close(&mut self) {
        let name = self.open.pop().expect("what is closed was opened");
        self.write(Event::End(BytesEnd::new(name)));
    }

    /// An element without content.
    pub(super) fn empty(&mut self, name: &str, attributes: Attributes<'_>) {
        self.write(Event::Empty(start(name, attributes)));
    }

    /// An element that holds a text.
    pub(super) fn text(&mut self, name: &str, text: &str) {
        self.text_of(name, &[], text);
    }

    /// An element with attributes that holds a text.
    pub(super) fn text_of(&mut self, name: &str, attributes: Attributes<'_>, text: &str) {
        self.write(Event::Start(start(name, attributes)));
        self.write(Event::Text(BytesText::new(text)));
        self.write(Event::End(BytesEnd::new(name)));
    }

    /// A comment. XML forbids two hyphens in a row in it, so a blank separates them.
    pub(super) fn comment(&mut self, text: &str) {
        let mut escaped = text.to_owned();
        while escaped.contains("--") {
            escaped = escaped.replace("--", "- -");
        }
        self.write(Event::Comment(BytesText::from_escaped(format!(" {escaped} "))));
    }

    /// The whole text, all elements closed.
    pub(super) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        let mut text =
            String::from_utf8(self.writer.into_inner()).expect("written from strings only");
        text.push('\n');
        text
    }

    fn write(&mut self, event: Event<'_>) {
        self.writer.write_event(event).expect("memory takes every byte");
    }
}

fn start<'a>(name: &'a str, attributes: Attributes<'a>) -> BytesStart<'a> {
    BytesStart::new(name).with_attributes(attributes.iter().copied())
}

/// Numbers with a blank between them, each the shortest decimal that reads back to the same bits.
pub(super) fn numbers(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|&value| number(value)).collect();
    texts.join(" ")
}

/// One number, without a negative zero.
pub(super) fn number(value: f64) -> String {
    format!("{:?}", value + 0.0)
}

/// The components of a vector.
pub(super) fn vector(v: &Vec3) -> String {
    numbers(v.as_slice())
}
