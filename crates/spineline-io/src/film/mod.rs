//! Radiographs as files.

mod rle;
mod uid;
mod write;

pub use write::{
    DicomFilm, Encoding, FilmPolarity, View, WriteFilmError, pixels_sha256, write_dicom,
};
