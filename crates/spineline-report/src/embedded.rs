//! Embedding of the analysis in a report, and its extraction.

/// The mark of the embedded analysis in HTML and Markdown.
pub(crate) const ELEMENT_ID: &str = "spineline-analysis";
/// Its opening tag in HTML.
pub(crate) const HTML_OPEN: &str = r#"<script type="application/json" id="spineline-analysis">"#;
pub(crate) const HTML_CLOSE: &str = "</script>";
/// Its fence in Markdown: longer than any in a report's text, and never a line of JSON.
pub(crate) const FENCE: &str = "``````";

/// JSON for an HTML element: `<`, which only strings contain, is written as its code.
pub(crate) fn for_html(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// The inverse of [`for_html`].
fn from_html(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    let mut rest = json;
    while let Some(at) = rest.find('\\') {
        text.push_str(&rest[..at]);
        rest = &rest[at..];
        match rest.strip_prefix("\\u003c") {
            Some(after) => {
                text.push('<');
                rest = after;
            }
            // An escape of JSON itself, such as `\\`, which may stand before `u003c`.
            None => {
                let end = rest.char_indices().nth(2).map_or(rest.len(), |(end, _)| end);
                text.push_str(&rest[..end]);
                rest = &rest[end..];
            }
        }
    }
    text.push_str(rest);
    text
}

/// The analysis that an HTML or Markdown report holds, unchanged; `None` without one.
#[must_use]
pub fn embedded(report: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(report).ok()?;
    if let Some((_, after)) = text.split_once(HTML_OPEN) {
        return Some(from_html(after.split_once(HTML_CLOSE)?.0));
    }
    let (_, after) = text.rsplit_once(&format!("\n{FENCE}json {ELEMENT_ID}\n"))?;
    Some(after.split_once(&format!("\n{FENCE}\n"))?.0.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_json_round_trips_through_html() {
        for json in [r#"{"a":"</script><!--"}"#, r#"["\\u003c","\\<","\"<\""]"#, "[]", r#""\\""#] {
            let safe = for_html(json);
            assert!(!safe.contains('<'));
            assert_eq!(from_html(&safe), json);
        }
    }
}
