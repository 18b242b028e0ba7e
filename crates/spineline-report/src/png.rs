//! Figures as PNG.

use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::fonts::Fonts;

/// Pixels of a PNG per unit of the figure that are sharp in print at 16 cm.
pub const PRINT_SCALE: f32 = 2.0;

/// A figure that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The text is not an SVG.
    #[error("the figure is not a valid SVG: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// More pixels than fit in memory.
    #[error("a picture of {columns} × {rows} pixels is too large")]
    Size {
        /// Width.
        columns: u32,
        /// Height.
        rows: u32,
    },
    /// The pixels could not be written.
    #[error("the picture could not be written as PNG: {0}")]
    Encode(String),
}

/// A figure as PNG on white, with `pixels_per_unit` of the SVG, such as [`PRINT_SCALE`].
pub fn png(svg: &str, pixels_per_unit: f32) -> Result<Vec<u8>, PngError> {
    let fonts = Fonts::for_texts([svg]);
    let options = Options {
        fontdb: Arc::new(fonts.database()),
        font_family: "DejaVu Sans".to_owned(),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options)?;
    let size = tree.size();
    let pixels = |length: f32| (length * pixels_per_unit).ceil().max(1.0) as u32;
    let (columns, rows) = (pixels(size.width()), pixels(size.height()));
    let mut picture = Pixmap::new(columns, rows).ok_or(PngError::Size { columns, rows })?;
    picture.fill(Color::WHITE);
    let scale = Transform::from_scale(pixels_per_unit, pixels_per_unit);
    resvg::render(&tree, scale, &mut picture.as_mut());
    picture.encode_png().map_err(|error| PngError::Encode(error.to_string()))
}
