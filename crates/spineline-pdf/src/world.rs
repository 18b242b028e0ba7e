//! The typesetter's input: one template, texts and figures in memory, and fonts.

use std::collections::HashMap;
use std::sync::Arc;

use typst::diag::{FileError, FileResult, SourceDiagnostic};
use typst::foundations::{Bytes, Datetime, Duration};
use typst::syntax::{FileId, RootedPath, Source, VirtualPath, VirtualRoot};
use typst::text::{Font, FontBook};
use typst::utils::LazyHash;
use typst::{Library, LibraryExt, World, WorldExt};

const TEMPLATE: &str = include_str!("report.typ");

/// Files by their names, without a disk.
pub(crate) struct Paper {
    library: LazyHash<Library>,
    book: LazyHash<FontBook>,
    fonts: Vec<Font>,
    template: Source,
    files: HashMap<FileId, Bytes>,
}

/// The file of a font, shared and not copied.
struct FontFile(Arc<dyn AsRef<[u8]> + Send + Sync>);

impl AsRef<[u8]> for FontFile {
    fn as_ref(&self) -> &[u8] {
        (*self.0).as_ref()
    }
}

impl Paper {
    /// With the template only.
    pub(crate) fn new(fonts: &[spineline_report::fonts::Font]) -> Self {
        let loaded = |font: &spineline_report::fonts::Font| {
            Font::new(Bytes::new(FontFile(font.data.clone())), font.index)
        };
        let fonts: Vec<Font> = fonts.iter().filter_map(loaded).collect();
        Self {
            library: LazyHash::new(Library::default()),
            book: LazyHash::new(FontBook::from_fonts(&fonts)),
            fonts,
            template: Source::new(id("/report.typ"), TEMPLATE.to_owned()),
            files: HashMap::new(),
        }
    }

    /// The fonts that could be read.
    pub(crate) fn fonts(&self) -> &[Font] {
        &self.fonts
    }

    /// Adds a file. The typesetter keeps names forever, so they must be few.
    pub(crate) fn put(&mut self, path: &str, text: String) {
        self.files.insert(id(path), Bytes::from_string(text));
    }

    /// Errors of the template, with their places.
    pub(crate) fn words(&self, faults: &[SourceDiagnostic]) -> String {
        let messages: Vec<String> = faults.iter().map(|fault| self.fault_words(fault)).collect();
        messages.join("; ")
    }

    fn fault_words(&self, fault: &SourceDiagnostic) -> String {
        let hints = fault.hints.iter().map(|hint| hint.v.as_str());
        let text: Vec<&str> = std::iter::once(fault.message.as_str()).chain(hints).collect();
        let text = text.join(", ");
        match (fault.span.id(), self.range(fault.span)) {
            (Some(id), Some(range)) if id == self.template.id() => {
                let before = self.template.text().get(..range.start).unwrap_or_default();
                format!("{text} (line {} of the template)", 1 + before.matches('\n').count())
            }
            (Some(id), _) => format!("{text} (in {})", id.vpath().get_without_slash()),
            (None, _) => text,
        }
    }
}

fn id(path: &str) -> FileId {
    let path = VirtualPath::new(path).expect("names of our own stay below the root");
    RootedPath::new(VirtualRoot::Project, path).intern()
}

impl World for Paper {
    fn library(&self) -> &LazyHash<Library> {
        &self.library
    }

    fn book(&self) -> &LazyHash<FontBook> {
        &self.book
    }

    fn main(&self) -> FileId {
        self.template.id()
    }

    fn source(&self, id: FileId) -> FileResult<Source> {
        if id == self.template.id() { Ok(self.template.clone()) } else { Err(FileError::NotSource) }
    }

    fn file(&self, id: FileId) -> FileResult<Bytes> {
        let missing = || FileError::NotFound(id.vpath().get_with_slash().into());
        self.files.get(&id).cloned().ok_or_else(missing)
    }

    fn font(&self, index: usize) -> Option<Font> {
        self.fonts.get(index).cloned()
    }

    fn today(&self, _: Option<Duration>) -> Option<Datetime> {
        None
    }
}
