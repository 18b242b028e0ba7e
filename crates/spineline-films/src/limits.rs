use serde::{Deserialize, Serialize};

/// Limits of a film. Every limit is checked before memory of that size is allocated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmLimits {
    /// Bytes of the file.
    pub file_bytes: u64,
    /// Bytes of a data set after its file-wide compression is undone.
    pub inflated_bytes: u64,
    /// Pixels of the picture: rows by columns.
    pub pixels: u64,
    /// Depth of sequences within sequences.
    pub depth: usize,
    /// Elements of the data set, including nested ones.
    pub elements: usize,
}

impl Default for FilmLimits {
    /// A film of the whole spine has up to 47 million pixels (17 by 43 inches at 0.1 mm).
    fn default() -> Self {
        Self {
            file_bytes: 256 << 20,
            inflated_bytes: 512 << 20,
            pixels: 100_000_000,
            depth: 16,
            elements: 100_000,
        }
    }
}
