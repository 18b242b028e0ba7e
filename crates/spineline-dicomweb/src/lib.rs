//! Films from DICOMweb servers: search by QIDO-RS, one film by WADO-RS.
//!
//! A [`Server`] comes from the command line of an administrator. What a user types is a value to search for or a UID of an
//! answer, never an address: it reaches a server as an escaped value or as digits and dots alone. Answers have limits of size
//! and time ([`Limits`]); redirects, proxies of the environment and addresses within answers are not followed. A search answers
//! without names and dates of birth, even where the server sends them.
//!
//! ```
//! use spineline_dicomweb::{Server, ServerFault};
//! let server = Server::parse("archive=https://pacs.clinic.example/dicom-web")?;
//! assert_eq!(server.name(), "archive");
//! assert!(Server::parse("archive=file:///etc/passwd").is_err());
//! # Ok::<(), ServerFault>(())
//! ```

mod answer;
mod client;
mod error;
mod multipart;
mod query;
mod server;

pub use client::{Client, Limits};
pub use error::DicomwebError;
pub use query::{BadQuery, FilmFound, FilmUid, Found, Search, SearchKey, SeriesFound, SeriesUid};
pub use server::{Server, ServerFault};
