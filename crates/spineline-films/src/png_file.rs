//! A grey picture as a PNG file that states the shape of its pixels and whether its film is synthetic.

use png::{
    BitDepth, ColorType, Compression, Encoder, EncodingError, Filter, PixelDimensions, Unit,
};

/// Keyword and text of the `tEXt` chunk of a synthetic film.
pub(super) const SYNTHETIC: [&str; 2] = ["Description", "SYNTHETIC: drawn from a phantom"];

/// Pixels per unit of length, down, in a file that states the ratio alone.
const DOWN: u32 = 1_000_000;

/// A picture before it is written.
pub(super) struct PngFile<'a> {
    pub columns: u32,
    pub rows: u32,
    /// Row by row from the top left; 16 bits with the larger byte first.
    pub samples: &'a [u8],
    pub depth: BitDepth,
    /// Height of a pixel over its width, where it is known. Millimetres are left out: a PNG cannot state their plane.
    pub pixel_aspect: Option<f64>,
    pub is_phantom: bool,
}

impl PngFile<'_> {
    pub fn bytes(&self) -> Result<Vec<u8>, EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, self.columns, self.rows);
        encoder.set_color(ColorType::Grayscale);
        encoder.set_depth(self.depth);
        encoder.set_compression(Compression::Fast);
        encoder.set_filter(Filter::Adaptive);
        encoder.set_pixel_dims(self.pixel_aspect.map(|aspect| PixelDimensions {
            // The cast saturates.
            xppu: (aspect * f64::from(DOWN)).round() as u32,
            yppu: DOWN,
            unit: Unit::Unspecified,
        }));
        if self.is_phantom {
            let [keyword, text] = SYNTHETIC.map(str::to_owned);
            encoder.add_text_chunk(keyword, text)?;
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.samples)?;
        writer.finish()?;
        Ok(bytes)
    }
}
