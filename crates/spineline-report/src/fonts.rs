//! Fonts for pictures and pages: a built-in family, and installed fonts for other letters.
//!
//! DejaVu Sans has the scripts of Europe and the Near East. A letter that it lacks, such as a Chinese one, is taken from the
//! first installed font that has it; letters without a font are reported. As long as DejaVu Sans is enough, pictures and pages
//! have the same bytes everywhere.

use std::collections::BTreeSet;
use std::sync::Arc;

use resvg::usvg::fontdb::{Database, Source};
use ttf_parser::Face;

/// One font: its file and its place in it.
#[derive(Clone)]
pub struct Font {
    /// The bytes of the file.
    pub data: Arc<dyn AsRef<[u8]> + Send + Sync>,
    /// Which of the fonts in the file.
    pub index: u32,
}

/// Fonts that draw a text.
pub struct Fonts {
    /// The built-in fonts first, then installed fonts for other letters.
    pub fonts: Vec<Font>,
    /// Letters that no font has, each once.
    pub missing: Vec<char>,
}

impl Font {
    fn within(bytes: &'static [u8]) -> Self {
        Self { data: Arc::new(bytes), index: 0 }
    }

    fn has(&self, letter: char) -> bool {
        covers((*self.data).as_ref(), self.index, letter)
    }
}

impl Fonts {
    /// The built-in fonts.
    #[must_use]
    pub fn within() -> Vec<Font> {
        [dejavu::sans::regular(), dejavu::sans::bold(), dejavu::sans::oblique()]
            .map(Font::within)
            .to_vec()
    }

    /// The fonts for texts, with installed fonts only where a letter is missing.
    pub fn for_texts<'a>(texts: impl IntoIterator<Item = &'a str>) -> Self {
        let letters: BTreeSet<char> =
            texts.into_iter().flat_map(str::chars).filter(|c| is_drawn(*c)).collect();
        let mut fonts = Self::within();
        let mut missing: Vec<char> =
            letters.into_iter().filter(|&letter| !fonts[0].has(letter)).collect();
        if !missing.is_empty() {
            fonts.extend(of_machine(&mut missing));
        }
        Self { fonts, missing }
    }

    /// The letters that no font has, in words with their codes; `None` where all are drawn.
    #[must_use]
    pub fn missing_words(&self) -> Option<String> {
        let codes: Vec<String> =
            self.missing.iter().map(|c| format!("U+{:04X}", u32::from(*c))).collect();
        (!codes.is_empty()).then(|| {
            format!(
                "No installed font has letters for {}: they are shown as empty boxes. The embedded analysis has them; install a font with these letters and make the report again.",
                codes.join(", ")
            )
        })
    }

    /// The database that SVG pictures are drawn with.
    pub(crate) fn database(&self) -> Database {
        let mut database = Database::new();
        for font in &self.fonts {
            database.load_font_source(Source::Binary(font.data.clone()));
        }
        database.set_sans_serif_family("DejaVu Sans");
        database
    }
}

/// The installed fonts that have a missing letter, in the order of their files; removes these letters from `missing`.
fn of_machine(missing: &mut Vec<char>) -> Vec<Font> {
    let mut database = Database::new();
    database.load_system_fonts();
    let mut places: Vec<(std::path::PathBuf, u32)> = database
        .faces()
        .filter_map(|face| match &face.source {
            Source::File(path) => Some((path.clone(), face.index)),
            _ => None,
        })
        .collect();
    places.sort();
    let mut found = Vec::new();
    for (path, index) in places {
        if missing.is_empty() {
            break;
        }
        let Ok(bytes) = std::fs::read(&path) else { continue };
        let before = missing.len();
        missing.retain(|&letter| !covers(&bytes, index, letter));
        if missing.len() < before {
            found.push(Font { data: Arc::new(bytes), index });
        }
    }
    found
}

fn covers(bytes: &[u8], index: u32, letter: char) -> bool {
    Face::parse(bytes, index).is_ok_and(|face| face.glyph_index(letter).is_some())
}

/// Spaces, controls and marks of direction or joining need no letter.
fn is_drawn(c: char) -> bool {
    !c.is_whitespace()
        && !c.is_control()
        && !matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fonts_cover_scripts_of_europe_and_the_near_east() {
        let fonts = Fonts::for_texts(["Größe ½ ≤ → ± °, αβγ, Жук, שלום, مرحبا, T9/T10"]);
        assert!(fonts.missing.is_empty() && fonts.fonts.len() == 3);
        assert_eq!(fonts.missing_words(), None);
    }

    #[test]
    fn a_letter_without_a_font_is_reported() {
        // A private letter that no font of a machine has.
        let fonts = Fonts::for_texts(["a\u{10fffd}b"]);
        assert_eq!(fonts.missing, ['\u{10fffd}']);
        assert!(fonts.missing_words().is_some_and(|words| words.contains("U+10FFFD")));
    }
}
