//! Requests, with their limits.

use std::time::Duration;

use ureq::http::Response;
use ureq::{Agent, Body};

use crate::answer::entries;
use crate::archive::Archive;
use crate::encryption;
use crate::error::DicomwebError;
use crate::multipart::only_part;
use crate::query::{
    FilmFound, FilmUid, Found, MAX_FOUND, OF_FILM, OF_SERIES, Search, SeriesFound, SeriesUid, film,
};

/// Limits of time and size for answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Time for a connection.
    pub connect: Duration,
    /// Time for the whole answer to a search.
    pub search: Duration,
    /// Bytes of it.
    pub search_bytes: u64,
    /// Time for a whole film.
    pub film: Duration,
    /// Bytes of it.
    pub film_bytes: u64,
}

/// Client for archives. It blocks, so call it on a thread that may wait.
#[derive(Debug, Clone)]
pub struct Client {
    agent: Agent,
    limits: Limits,
}

const JSON: &str = "application/dicom+json";
/// In the film's own transfer syntax.
const DICOM: &str = r#"multipart/related; type="application/dicom"; transfer-syntax=*"#;

impl Client {
    /// A client that follows no redirect, uses no proxy of the environment, and trusts the certificates of the system.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        let config = encryption::trusting_the_system(Agent::config_builder())
            .proxy(None)
            .max_redirects(0)
            .max_redirects_will_error(false)
            .http_status_as_error(false)
            .timeout_connect(Some(limits.connect))
            .user_agent("spineline")
            .build();
        Self { agent: config.into(), limits }
    }

    /// Searches for series (QIDO-RS).
    pub fn search(
        &self,
        archive: &Archive,
        search: &Search,
    ) -> Result<Found<SeriesFound>, DicomwebError> {
        let mut fields: Vec<&str> = OF_SERIES.into_iter().chain([search.tag()]).collect();
        fields.dedup();
        let found = self.found(archive, "series", &search.parameters(), &fields, |entry| {
            if search.holds(entry) {
                search.series(entry)
            } else {
                Err("an entry differs from the search")
            }
        });
        // A service has the list of all series, so its address is wrong.
        found.map_err(|error| match error {
            DicomwebError::NotFound { archive } => DicomwebError::Refused { archive, status: 404 },
            other => other,
        })
    }

    /// The films of a series (QIDO-RS).
    pub fn films(
        &self,
        archive: &Archive,
        of: &SeriesUid,
    ) -> Result<Found<FilmFound>, DicomwebError> {
        let path = format!("studies/{}/series/{}/instances", of.study(), of.series());
        self.found(archive, &path, &[], &OF_FILM, |entry| film(of, entry))
    }

    /// The DICOM file of a film (WADO-RS), in its own transfer syntax. After reading it, call [`FilmUid::check`].
    pub fn retrieve(&self, archive: &Archive, of: &FilmUid) -> Result<Vec<u8>, DicomwebError> {
        let (study, series) = (of.series.study(), of.series.series());
        let path = format!("studies/{study}/series/{series}/instances/{}", of.instance());
        let Answer { kind, body, .. } = self.get(archive, &path, &[], Wanted::Film)?;
        let bytes = only_part(&kind, body).map_err(|what| bad(archive, what))?;
        if bytes.len() as u64 > self.limits.film_bytes {
            return Err(too_large(archive, self.limits.film_bytes));
        }
        Ok(bytes)
    }

    fn found<T>(
        &self,
        archive: &Archive,
        path: &str,
        asked: &[(&str, &str)],
        fields: &[&str],
        read: impl Fn(&serde_json::Value) -> Result<T, &'static str>,
    ) -> Result<Found<T>, DicomwebError> {
        // One more than is shown, to detect further entries.
        let most = (MAX_FOUND + 1).to_string();
        let fields = fields.iter().map(|field| ("includefield", *field));
        let query: Vec<(&str, &str)> =
            asked.iter().copied().chain(fields).chain([("limit", most.as_str())]).collect();
        let answer = self.get(archive, path, &query, Wanted::Entries)?;
        let entries = entries(&answer.body).map_err(|what| bad(archive, what))?;
        let all = entries.iter().take(MAX_FOUND).map(read).collect::<Result<_, _>>();
        Ok(Found {
            all: all.map_err(|what| bad(archive, what))?,
            has_more: answer.has_more || entries.len() > MAX_FOUND,
        })
    }

    /// An answer within its limits.
    fn get(
        &self,
        archive: &Archive,
        path: &str,
        query: &[(&str, &str)],
        wanted: Wanted,
    ) -> Result<Answer, DicomwebError> {
        let Limits { search, search_bytes, film, film_bytes, .. } = self.limits;
        let (accept, limit, limit_bytes) = match wanted {
            Wanted::Entries => (JSON, search, search_bytes),
            // The head of the part comes in addition to the film.
            Wanted::Film => (DICOM, film, film_bytes + (1 << 16)),
        };
        let fail = |error: ureq::Error| failed(archive, &error, limit, limit_bytes);
        let mut request = self.agent.get(archive.address(path)).header("accept", accept);
        // Escaped: the user's input can only be a value.
        request = request.query_pairs(query.iter().copied());
        if let Some(login) = archive.login() {
            request = request.header("authorization", login);
        }
        let request = request.config().timeout_global(Some(limit)).build();
        let mut answer = request.call().map_err(fail)?;
        check(archive, &answer)?;
        let kind = answer.headers().get("content-type").and_then(|kind| kind.to_str().ok());
        let kind = kind.unwrap_or_default().to_owned();
        let has_more = has_more(&answer);
        let body = answer.body_mut().with_config().limit(limit_bytes).read_to_vec();
        Ok(Answer { kind, has_more, body: body.map_err(fail)? })
    }
}

/// The content of an answer that is asked for.
#[derive(Clone, Copy)]
enum Wanted {
    /// Entries of a search.
    Entries,
    /// The file of a film.
    Film,
}

struct Answer {
    /// Its Content-Type.
    kind: String,
    /// Whether the archive has more entries than in its answer.
    has_more: bool,
    body: Vec<u8>,
}

/// Whether an answer is incomplete: `Warning: 299` (PS3.18, 8.3.4.4), or a partial answer (206).
fn has_more(answer: &Response<Body>) -> bool {
    let warnings = answer.headers().get_all("warning").into_iter();
    let is_of_more = |value: &str| value.trim_start().starts_with("299");
    answer.status().as_u16() == 206
        || warnings.filter_map(|value| value.to_str().ok()).any(is_of_more)
}

fn check(archive: &Archive, answer: &Response<Body>) -> Result<(), DicomwebError> {
    let name = || archive.name().to_owned();
    match answer.status().as_u16() {
        200..=299 => Ok(()),
        status @ (401 | 403) => Err(DicomwebError::Login { archive: name(), status }),
        404 | 410 => Err(DicomwebError::NotFound { archive: name() }),
        status @ 300..=399 => Err(DicomwebError::Redirect { archive: name(), status }),
        status => Err(DicomwebError::Refused { archive: name(), status }),
    }
}

fn failed(
    archive: &Archive,
    error: &ureq::Error,
    limit: Duration,
    limit_bytes: u64,
) -> DicomwebError {
    let name = archive.name().to_owned();
    match error {
        ureq::Error::Timeout(_) => DicomwebError::TooSlow { archive: name, limit },
        ureq::Error::BodyExceedsLimit(_) => too_large(archive, limit_bytes),
        ureq::Error::HostNotFound => {
            DicomwebError::Unreachable { archive: name, reason: "its name is unknown".to_owned() }
        }
        ureq::Error::ConnectionFailed => {
            DicomwebError::Unreachable { archive: name, reason: "no connection".to_owned() }
        }
        error if encryption::is_fault(error) => DicomwebError::Unreachable {
            archive: name,
            reason: "its certificate is not trusted, or it does not speak TLS".to_owned(),
        },
        ureq::Error::Io(error) => {
            DicomwebError::Unreachable { archive: name, reason: error.kind().to_string() }
        }
        _ => bad(archive, "it is not an HTTP answer"),
    }
}

fn bad(archive: &Archive, what: &'static str) -> DicomwebError {
    DicomwebError::BadAnswer { archive: archive.name().to_owned(), what }
}

fn too_large(archive: &Archive, limit_bytes: u64) -> DicomwebError {
    DicomwebError::TooLarge { archive: archive.name().to_owned(), limit_bytes }
}
