//! Compressed answers: films and the files of the app.

use std::io::{Read, Write};

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;

/// Bytes in compressed form.
#[derive(Debug, Clone)]
pub struct Gzipped(Bytes);

impl Gzipped {
    /// # Panics
    /// Never: memory takes all bytes.
    pub fn new(bytes: &[u8], level: Compression) -> Self {
        let mut encoder = GzEncoder::new(Vec::new(), level);
        encoder.write_all(bytes).expect("memory takes all bytes");
        Self(encoder.finish().expect("memory takes all bytes").into())
    }

    /// Length of the compressed bytes.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The original bytes.
    ///
    /// # Panics
    /// Never: the bytes were compressed here.
    pub fn unpacked(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        GzDecoder::new(&*self.0).read_to_end(&mut bytes).expect("compressed here");
        bytes
    }

    /// An answer to a request with these headers: compressed if they accept it.
    pub fn answer(&self, asked: &HeaderMap) -> Response {
        let accepted = asked.get(header::ACCEPT_ENCODING).and_then(|value| value.to_str().ok());
        let mut response = if accepted.is_some_and(accepts_gzip) {
            let encoding = [(header::CONTENT_ENCODING, "gzip")];
            (encoding, self.0.clone()).into_response()
        } else {
            self.unpacked().into_response()
        };
        let vary = HeaderValue::from_static("accept-encoding");
        response.headers_mut().insert(header::VARY, vary);
        response
    }
}

/// Whether a list of codings accepts gzip: a weight of zero refuses it.
fn accepts_gzip(codings: &str) -> bool {
    codings.split(',').any(|one| {
        let (coding, parameters) = one.split_once(';').unwrap_or((one, ""));
        let weight = parameters.trim().strip_prefix("q=");
        let is_refused = weight.is_some_and(|weight| weight.trim().parse() == Ok(0.0));
        coding.trim().eq_ignore_ascii_case("gzip") && !is_refused
    })
}

#[cfg(test)]
mod tests {
    use super::accepts_gzip;

    #[test]
    fn gzip_is_accepted_by_name_and_refused_by_a_weight_of_zero() {
        for accepted in ["gzip", "br;q=1.0, GZIP;q=0.5", "deflate, gzip"] {
            assert!(accepts_gzip(accepted), "{accepted}");
        }
        for refused in ["", "identity", "gzip;q=0", "br, gzip; q=0.0", "x-gzipped"] {
            assert!(!accepts_gzip(refused), "{refused}");
        }
    }
}
