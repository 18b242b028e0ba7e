//! Films from image archives that speak DICOMweb: search by QIDO-RS, one film by WADO-RS.
//!
//! An [`Archive`] comes from the command line of an administrator. Users only enter values to search for and choose
//! UIDs from answers, never addresses: their input reaches an archive as an escaped value, or as digits and dots.
//! Answers have limits of size and time ([`Limits`]); redirects, proxies of the environment and addresses within
//! answers are not followed. A search answers without names and dates of birth, even if the archive sends them.
//! Encrypted connections need the feature `https`.
//!
//! ```
//! use spineline_dicomweb::{Archive, ArchiveFault};
//! let archive = Archive::parse("archive=http://localhost:8042/dicom-web")?;
//! assert_eq!(archive.name(), "archive");
//! assert!(Archive::parse("archive=file:///etc/passwd").is_err());
//! # Ok::<(), ArchiveFault>(())
//! ```

mod answer;
mod archive;
mod client;
mod encryption;
mod error;
mod multipart;
mod query;

pub use archive::{Archive, ArchiveFault};
pub use client::{Client, Limits};
pub use error::DicomwebError;
pub use query::{
    BadQuery, FilmFound, FilmUid, Found, PatientId, Search, SearchKey, SeriesFound, SeriesUid,
    StatedUids,
};
