//! The analysis inside a PDF: its place, and how it is extracted.

use hayro_syntax::Pdf;
use hayro_syntax::object::{Array, Dict, Object, Stream, String as PdfString};

/// The attachment, which PDF programs list under this name without the slash.
pub(crate) const PATH: &str = "/spineline-analysis.json";

/// The analysis in the PDF of a report, unchanged; `None` without one.
#[must_use]
pub fn embedded(pdf: &[u8]) -> Option<String> {
    // The reader may panic on a damaged file.
    std::panic::catch_unwind(|| attachment(pdf)).ok().flatten()
}

fn attachment(pdf: &[u8]) -> Option<String> {
    // Without this check, the reader would search any file for lost objects.
    if !pdf.starts_with(b"%PDF-") {
        return None;
    }
    let pdf = Pdf::new(pdf.to_vec()).ok()?;
    let catalog = pdf.xref().get::<Dict<'_>>(pdf.xref().root_id())?;
    let names = catalog.get::<Dict<'_>>("Names");
    let named = names.and_then(|names| names.get::<Dict<'_>>("EmbeddedFiles"));
    let named = named.and_then(|files| files.get::<Array<'_>>("Names"));
    let lists = [catalog.get::<Array<'_>>("AF"), named];
    let files = lists.into_iter().flatten().flat_map(|list| list.iter::<Object<'_>>());
    let found = files.filter_map(Object::into_dict).find(is_ours)?;
    let stream = found.get::<Dict<'_>>("EF")?.get::<Stream<'_>>("F")?;
    String::from_utf8(stream.decoded().ok()?.into_owned()).ok()
}

fn is_ours(file: &Dict<'_>) -> bool {
    let name = PATH.trim_start_matches('/').as_bytes();
    let is = |key: &str| file.get::<PdfString<'_>>(key).is_some_and(|text| text.as_bytes() == name);
    is("F") || is("UF")
}
