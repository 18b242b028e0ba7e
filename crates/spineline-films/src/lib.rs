//! Radiographs: DICOM, PNG, JPEG and TIFF files in, exact pixels and the evidence for spacing and view out.
//!
//! [`read_film`] does not trust a file: each length is checked against the bytes of the file, and each size against
//! [`FilmLimits`] and the header of the compressed picture, before allocation. It runs in the caller's process;
//! [`decode_in_child`] runs it in another process with limits of memory and time, which may crash. A [`FilmFile`]
//! contains no name, number or date of a patient, and no error or remark quotes the file.
//!
//! Grey values go through the pipeline of DICOM PS3.4, annex N: modality table or rescale, then table or window of
//! interest, then polarity ([`FilmFile::display`]). [`spineline_marking::judge_spacing`] judges a spacing, and
//! [`spineline_marking::judge_view`] finds open questions about a view.
//!
//! [`intake`] finds films in folders and archives.
//!
//! ```
//! use spineline_films::{FilmError, FilmLimits, Lookalike, read_film};
//! let error = read_film(b"%PDF-1.7", &FilmLimits::default()).expect_err("a document");
//! assert_eq!(error, FilmError::NotAFilm { looks_like: Lookalike::Pdf });
//! ```

mod attribute;
mod child;
mod codec;
mod container;
mod deid;
mod display;
mod element;
mod error;
mod exposure;
mod film;
pub mod intake;
mod kind;
mod limits;
mod lookup;
mod pair;
mod patient;
mod pixels;
mod png_file;
mod raster;
mod read;
mod remark;
mod resolution;
mod rle;
mod scan;
mod spacing_question;
mod tags;
mod uid;
mod view_doubts;
mod write;
mod wrong_film;

pub use attribute::Attribute;
pub use child::{ChildLimits, decode_in_child, serve_child};
pub use container::sniff;
pub use deid::{DeidAction, DeidEntry, DeidOptions, DeidReport, Deidentified, deidentify};
pub use display::{Display, ScreenValues};
pub use error::{
    Codec, CodecFault, ElementFault, FilmError, Lookalike, Measure, Place, UnsupportedPhotometric,
};
pub use exposure::{ExposureMarks, Exposures};
pub use film::{FilmFile, FilmTags, FilmUids, Photometric, StoredPixels};
pub use kind::FilmKind;
pub use limits::FilmLimits;
pub use lookup::{Look, Lut, ModalityTransform, Voi, Window, WindowFunction};
pub use patient::PatientMarks;
pub use read::{is_own_dicom, read_data_set, read_film};
pub use remark::FilmRemark;
pub use resolution::{Resolution, ResolutionUnit};
pub use spacing_question::spacing_question;
pub use tags::is_uid;
pub use uid::from_bytes as uid_of_bytes;
pub use view_doubts::{shape_contradiction, side_contradiction, view_contradictions};
pub use write::{DicomFilm, Encoding, FilmPolarity, WriteFilmError, pixels_sha256, write_dicom};
pub use wrong_film::{FilmDoubt, Stated, film_doubts};
