//! The hash of its content that a file carries, and the cases that it names.
//!
//! [`Provenance`](crate::Provenance) has a place for the hash, and JSON files, reports and figures hold a provenance; models for other
//! engines have the same keys in their first comment. The writer of the whole file fills the place in ([`with_hash`]) with the hash
//! of the file with 64 zeros there. The place may be anywhere in the file, and several times, in any format.

use std::borrow::Cow;
use std::collections::BTreeSet;

use memchr::memmem::find_iter;
use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::digest::RunningDigest;

const HASH: &[u8] = b"content_sha256";
const CASES: &[u8] = b"\"case_ids\"";
const FILM: &[u8] = b"\"file\"";
/// Hexadecimal digits of a hash.
const DIGITS: usize = 64;
/// The place of a hash that is not filled in.
const OPEN: &[u8; DIGITS] = &[b'0'; DIGITS];
/// Between the key and the digits are `": "`, or fewer of these.
const BETWEEN: usize = 4;

/// The place of the hash of a file in its JSON. It is written open, and a hash that is read is not kept: it belongs to that file alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema)]
#[schemars(with = "String")]
pub(crate) struct ContentHash;

impl Serialize for ContentHash {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&OPEN.escape_ascii())
    }
}

impl<'de> Deserialize<'de> for ContentHash {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = Cow::<str>::deserialize(deserializer)?;
        if text.len() == DIGITS && is_hash(text.as_bytes()) {
            return Ok(Self);
        }
        Err(D::Error::custom(format!("expected {DIGITS} hexadecimal digits, found `{text}`")))
    }
}

/// The case and the place of the hash, as JSON in the comment of a format without provenance.
#[derive(Serialize)]
pub(crate) struct ContentMark<'a> {
    pub(crate) case_ids: [&'a str; 1],
    pub(crate) content_sha256: ContentHash,
}

/// The same two keys as words of a format that has neither.
#[must_use]
pub fn content_words(case_ids: &BTreeSet<String>) -> [String; 2] {
    let cases = format!("\"case_ids\": {}", crate::to_line(case_ids));
    [cases, format!("content_sha256: {}", OPEN.escape_ascii())]
}

/// Whether a file is as it was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// It has no hash.
    NoHash,
    /// Its hash differs from the hash in it.
    Changed,
    /// Its hash equals the hash in it.
    AsWritten,
}

impl Content {
    /// Compares a file with the hash in it.
    #[must_use]
    pub fn of(file: &[u8]) -> Self {
        let Some(first) = places(file).next() else { return Self::NoHash };
        let stated = &file[first..first + DIGITS];
        if stated == OPEN {
            return Self::NoHash;
        }
        let (mut digest, mut from) = (RunningDigest::default(), 0);
        for place in places(file).filter(|&place| &file[place..place + DIGITS] == stated) {
            digest.update(&file[from..place]);
            digest.update(OPEN);
            from = place + DIGITS;
        }
        digest.update(&file[from..]);
        if digest.hex().as_bytes() == stated { Self::AsWritten } else { Self::Changed }
    }
}

/// A file with its hash, wherever it has a place for one; other files as they are.
///
/// ```
/// use spineline_files::{Content, with_hash};
///
/// let open = format!(r#"{{"content_sha256": "{:064}"}}"#, 0);
/// let mut file = with_hash(open.into_bytes());
/// assert_eq!(Content::of(&file), Content::AsWritten);
/// file.push(b'\n');
/// assert_eq!(Content::of(&file), Content::Changed);
/// ```
#[must_use]
pub fn with_hash(mut file: Vec<u8>) -> Vec<u8> {
    let mut content = RunningContent::default();
    content.update(&file);
    let (hash, places) = content.finish();
    // The file is in memory, so that every place fits.
    for place in places.into_iter().filter_map(|place| usize::try_from(place).ok()) {
        file[place..place + DIGITS].copy_from_slice(hash.as_bytes());
    }
    file
}

/// [`with_hash`] of a text.
///
/// # Panics
/// Never: digits replace digits.
#[must_use]
pub fn text_with_hash(text: String) -> String {
    String::from_utf8(with_hash(text.into_bytes())).expect("digits for digits")
}

/// [`with_hash`] of a file that comes piece by piece; no place of the hash is in two pieces.
#[derive(Debug, Default)]
pub struct RunningContent {
    digest: RunningDigest,
    bytes: u64,
    places: Vec<u64>,
}

impl RunningContent {
    /// Adds the next piece.
    pub fn update(&mut self, piece: &[u8]) {
        self.digest.update(piece);
        let open = places(piece).filter(|&place| &piece[place..place + DIGITS] == OPEN);
        self.places.extend(open.map(|place| self.bytes + place as u64));
        self.bytes += piece.len() as u64;
    }

    /// The hash, and the places in the file where it goes.
    #[must_use]
    pub fn finish(self) -> (String, Vec<u64>) {
        (self.digest.hex(), self.places)
    }
}

/// Where the digits of hashes are.
fn places(file: &[u8]) -> impl Iterator<Item = usize> {
    find_iter(file, HASH).filter_map(move |key| {
        let after = key + HASH.len();
        let between = file[after..].iter().take(BETWEEN);
        let place = after + between.take_while(|byte| b"\": ".contains(byte)).count();
        file.get(place..place + DIGITS).filter(|digits| is_hash(digits)).map(|_| place)
    })
}

fn is_hash(digits: &[u8]) -> bool {
    digits.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// The cases that a file names: its own, the cases of a list of analyses, or in its provenance.
#[must_use]
pub fn case_ids(file: &[u8]) -> BTreeSet<String> {
    #[derive(Deserialize)]
    struct OfCase {
        case_id: Option<String>,
    }
    let text = file.strip_prefix("\u{feff}".as_bytes()).unwrap_or(file);
    let one = || serde_json::from_slice::<OfCase>(text).map(|one| vec![one]);
    let files = one().or_else(|_| serde_json::from_slice(text)).unwrap_or_default();
    let mut ids: BTreeSet<String> = files.into_iter().filter_map(|file| file.case_id).collect();
    for key in find_iter(file, CASES) {
        let after = file[key + CASES.len()..].trim_ascii_start();
        let Some(list) = after.strip_prefix(b":") else { continue };
        let mut lists = serde_json::Deserializer::from_slice(list).into_iter::<Vec<String>>();
        ids.extend(lists.next().and_then(Result::ok).unwrap_or_default());
    }
    ids
}

/// The films that a file names: as a case, or within its analyses.
#[must_use]
pub fn film_names(file: &[u8]) -> BTreeSet<String> {
    let name = |key: usize| {
        let value = file[key + FILM.len()..].trim_ascii_start().strip_prefix(b":")?;
        serde_json::Deserializer::from_slice(value).into_iter::<String>().next()?.ok()
    };
    find_iter(file, FILM).filter_map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(text: &str) -> Vec<u8> {
        text.replace('?', std::str::from_utf8(OPEN).expect("digits")).into_bytes()
    }

    #[test]
    fn a_hash_is_found_in_every_format_and_any_change_is_too() {
        for text in [
            "{\n  \"case_id\": \"a\",\n  \"content_sha256\": \"?\"\n}\n",
            "<svg><metadata>{\"content_sha256\":\"?\"}</metadata></svg>",
            "# Report\n\n```json\n[{\"content_sha256\":\"?\"},{\"content_sha256\":\"?\"}]\n```\n",
            "/Keywords (content_sha256: ?)",
        ] {
            let file = open(text);
            assert_eq!(Content::of(&file), Content::NoHash, "{text}");
            let written = with_hash(file);
            assert_eq!(Content::of(&written), Content::AsWritten, "{text}");
            assert_eq!(with_hash(written.clone()), written, "it is filled in once");
            for at in 0..written.len() {
                let mut changed = written.clone();
                changed[at] ^= 1;
                assert_ne!(Content::of(&changed), Content::AsWritten, "{text} at {at}");
            }
            for more in [[&written[..], &b" "[..]].concat(), [&b" "[..], &written[..]].concat()] {
                assert_eq!(Content::of(&more), Content::Changed, "{text}");
            }
        }
        assert_eq!(with_hash(b"content_sha256: 0".to_vec()), b"content_sha256: 0");
    }

    #[test]
    fn pieces_have_the_hash_of_the_whole() {
        let pieces = [open("[{\"content_sha256\": \"?\"}"), open(",{\"content_sha256\": \"?\"}]")];
        let mut running = RunningContent::default();
        pieces.iter().for_each(|piece| running.update(piece));
        let (hash, places) = running.finish();
        let whole = with_hash(pieces.concat());
        assert_eq!(places.len(), 2);
        for place in places {
            let place = usize::try_from(place).expect("a short text");
            assert_eq!(&whole[place..place + DIGITS], hash.as_bytes());
        }
    }

    #[test]
    fn cases_are_found_in_every_format() {
        for (text, expected) in [
            (r#"{"format": "spineline-case", "case_id": "a"}"#, &["a"][..]),
            ("\u{feff}[{\"case_id\": \"a\"}, {\"case_id\": \"b\"}]", &["a", "b"]),
            ("<!-- {\"case_ids\":[\"a-\\u002db\"]} -->", &["a--b"]),
            ("<metadata>{\"case_ids\": [\n \"a\",\n \"b\"\n]}</metadata>", &["a", "b"]),
            ("\"case_ids\": [1] and \"case_ids\"", &[]),
            ("quantity,unit\n", &[]),
        ] {
            assert!(case_ids(text.as_bytes()).iter().eq(expected), "{text}");
        }
    }
}
