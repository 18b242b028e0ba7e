//! Input and output of a codec.

/// Checked values of the image pixel module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Format {
    pub columns: u16,
    pub rows: u16,
    /// 1, or 3 for colour.
    pub samples: u8,
    /// All samples of one kind, then all of the next.
    pub planar: bool,
    /// The first of three samples is the luminance.
    pub luminance_first: bool,
    /// 8 or 16.
    pub allocated: u8,
    pub stored: u8,
    pub high: u8,
    pub signed: bool,
}

impl Format {
    pub fn pixels(self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }
}

/// Output of a codec.
pub(crate) enum Coded {
    /// Words of one sample each, as many as there are pixels.
    Words(Vec<u16>),
    /// Red, green and blue.
    Colour(Vec<[u8; 3]>),
    /// Luminance and two colour differences.
    Luminance(Vec<[u8; 3]>),
}
