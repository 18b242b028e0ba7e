//! The first part of an answer `multipart/related`.

use memchr::memmem;

/// The content of the first part, which must be the only one.
pub(crate) fn only_part(content_type: &str, body: Vec<u8>) -> Result<Vec<u8>, &'static str> {
    let kind = content_type.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    if kind == "application/dicom" {
        return Ok(body);
    }
    if kind != "multipart/related" {
        return Err("it is not a DICOM file and not a multipart answer");
    }
    let boundary = boundary(content_type).ok_or("its multipart header has no boundary")?;
    let opening = format!("--{boundary}");
    let closing = format!("\r\n--{boundary}");
    let start = memmem::find(&body, opening.as_bytes()).ok_or("its first part is missing")?;
    let head = start + opening.len();
    let blank = memmem::find(&body[head..], b"\r\n\r\n").ok_or("its first part has no content")?;
    let content = head + blank + 4;
    let length = memmem::find(&body[content..], closing.as_bytes()).ok_or("it is incomplete")?;
    let rest = &body[content + length + closing.len()..];
    if !rest.starts_with(b"--") {
        return Err("it has more than one film");
    }
    let mut body = body;
    body.truncate(content + length);
    body.drain(..content);
    Ok(body)
}

/// The parameter `boundary`, with or without quotation marks.
fn boundary(content_type: &str) -> Option<&str> {
    let parameters = content_type.split(';').skip(1);
    let value = parameters.filter_map(|parameter| parameter.trim().split_once('=')).find_map(
        |(name, value)| name.trim().eq_ignore_ascii_case("boundary").then_some(value.trim()),
    )?;
    let value = value.trim_matches('"');
    (!value.is_empty() && value.len() <= 70).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: &str = r#"multipart/related; type="application/dicom"; boundary="b-1""#;

    fn part(content: &[u8], end: &str) -> Vec<u8> {
        let head = b"--b-1\r\nContent-Type: application/dicom\r\nContent-Length: 3\r\n\r\n";
        [&head[..], content, end.as_bytes()].concat()
    }

    #[test]
    fn the_content_of_the_only_part_is_returned_byte_by_byte() {
        for content in [&b"\r\n\r\n--b\0"[..], b"", b"--b-1"] {
            assert_eq!(only_part(KIND, part(content, "\r\n--b-1--\r\n")).as_deref(), Ok(content));
        }
        let unquoted = KIND.replace('"', "");
        assert_eq!(only_part(&unquoted, part(b"x", "\r\n--b-1--")).as_deref(), Ok(&b"x"[..]));
        assert_eq!(only_part("application/dicom", b"y".to_vec()).as_deref(), Ok(&b"y"[..]));
    }

    #[test]
    fn broken_answers_are_refused() {
        for (kind, body) in [
            ("text/html", b"<p>".to_vec()),
            ("multipart/related", part(b"x", "\r\n--b-1--")),
            (KIND, Vec::new()),
            (KIND, b"--b-1".to_vec()),
            (KIND, part(b"x", "")),
            (KIND, part(b"x", "\r\n--b-1\r\n\r\ny\r\n--b-1--")),
        ] {
            assert!(only_part(kind, body.clone()).is_err(), "{kind} {body:?}");
        }
    }
}
