//! Files as text.

use std::io;

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::{CompactFormatter, Formatter, PrettyFormatter};
use spineline::number::significant;
use spineline::spatial::Angle;

/// Significant digits of a result: more than any reading has, and enough to compare two programs.
const DIGITS: usize = 10;

/// An angle in degrees with nine decimals, which drop the rounding of radians.
pub(crate) fn written_deg(angle: Angle) -> f64 {
    (angle.deg() * 1e9).round() / 1e9
}

/// The text of a file that a program reads back: JSON with two blanks of indent and a line feed at the end, every number with all its digits.
///
/// # Panics
/// Never: the types have string keys only.
#[must_use]
pub fn to_text<T: Serialize>(file: &T) -> String {
    let mut text = serde_json::to_string_pretty(file).expect("string keys only");
    text.push('\n');
    text
}

/// [`to_text`] on one line, as part of another file.
///
/// # Panics
/// Never, as [`to_text`].
#[must_use]
pub fn to_line<T: Serialize>(file: &T) -> String {
    serde_json::to_string(file).expect("string keys only")
}

/// A number as JSON can hold it.
pub(crate) fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

/// The text of a file of results: as [`to_text`], with ten significant digits. The case and the provenance in it keep all digits, because
/// they repeat the analysis.
///
/// # Panics
/// Never, as [`to_text`].
#[must_use]
pub fn results_text<T: Serialize>(file: &T) -> String {
    let mut text = rounded(file, PrettyFormatter::new());
    text.push('\n');
    text
}

/// [`results_text`] on one line, as part of another file.
///
/// # Panics
/// Never, as [`to_text`].
#[must_use]
pub fn results_line<T: Serialize>(file: &T) -> String {
    rounded(file, CompactFormatter)
}

/// A list of results as text, piece by piece: the same text as [`results_text`] of the list, without all of it in memory.
///
/// ```
/// use spineline_files::{ListText, results_text};
///
/// let mut list = ListText::default();
/// let mut text = String::new();
/// for item in ["a", "b"] {
///     text += list.before_item();
///     text += &ListText::item(&[item]);
/// }
/// text += list.end();
/// assert_eq!(text, results_text(&[["a"], ["b"]]));
/// ```
#[derive(Debug, Default)]
pub struct ListText {
    has_items: bool,
}

impl ListText {
    /// The text of one item, at its depth in the list.
    ///
    /// # Panics
    /// Never, as [`to_text`].
    #[must_use]
    pub fn item<T: Serialize>(item: &T) -> String {
        // Line ends within texts are escaped, so that every one here begins a line of the layout.
        results_text(item).trim_end().replace('\n', "\n  ")
    }

    /// The text before the next item.
    pub fn before_item(&mut self) -> &'static str {
        if std::mem::replace(&mut self.has_items, true) { ",\n  " } else { "[\n  " }
    }

    /// The text after the last item.
    #[must_use]
    pub fn end(self) -> &'static str {
        if self.has_items { "\n]\n" } else { "[]\n" }
    }
}

fn rounded<T: Serialize>(file: &T, layout: impl Formatter) -> String {
    let mut bytes = Vec::new();
    let layout = Rounded { layout, depth: 0, key: None, exact_since: None };
    let mut serializer = Serializer::with_formatter(&mut bytes, layout);
    file.serialize(&mut serializer).expect("string keys only");
    String::from_utf8(bytes).expect("JSON is UTF-8")
}

/// A layout whose numbers have [`DIGITS`] significant digits outside of the inputs.
struct Rounded<F> {
    layout: F,
    /// Objects that are open.
    depth: usize,
    /// The key that is being written.
    key: Option<String>,
    /// Depth of the object whose input is being written.
    exact_since: Option<usize>,
}

/// Methods of the layout as they are.
macro_rules! as_the_layout {
    ($($name:ident $(, $first:ident)?;)*) => {$(
        fn $name<W: ?Sized + io::Write>(&mut self, to: &mut W $(, $first: bool)?) -> io::Result<()> {
            self.layout.$name(to $(, $first)?)
        }
    )*};
}

impl<F: Formatter> Formatter for Rounded<F> {
    as_the_layout! {
        begin_array;
        end_array;
        begin_array_value, first;
        end_array_value;
        begin_object_value;
    }

    fn write_f64<W: ?Sized + io::Write>(&mut self, to: &mut W, value: f64) -> io::Result<()> {
        let value = if self.exact_since.is_some() { value } else { significant(value, DIGITS) };
        self.layout.write_f64(to, value)
    }

    fn begin_object<W: ?Sized + io::Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.depth += 1;
        self.layout.begin_object(to)
    }

    fn end_object<W: ?Sized + io::Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.depth -= 1;
        self.layout.end_object(to)
    }

    fn begin_object_key<W: ?Sized + io::Write>(
        &mut self,
        to: &mut W,
        first: bool,
    ) -> io::Result<()> {
        self.key = Some(String::new());
        self.layout.begin_object_key(to, first)
    }

    fn write_string_fragment<W: ?Sized + io::Write>(
        &mut self,
        to: &mut W,
        part: &str,
    ) -> io::Result<()> {
        if let Some(key) = &mut self.key {
            key.push_str(part);
        }
        self.layout.write_string_fragment(to, part)
    }

    fn end_object_key<W: ?Sized + io::Write>(&mut self, to: &mut W) -> io::Result<()> {
        let is_input = self.key.take().is_some_and(|key| matches!(&*key, "case" | "provenance"));
        if is_input && self.exact_since.is_none() {
            self.exact_since = Some(self.depth);
        }
        self.layout.end_object_key(to)
    }

    fn end_object_value<W: ?Sized + io::Write>(&mut self, to: &mut W) -> io::Result<()> {
        if self.exact_since == Some(self.depth) {
            self.exact_since = None;
        }
        self.layout.end_object_value(to)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_result_has_ten_digits_and_an_input_has_all() {
        let noisy = 100.0 * 0.033;
        let file = json!({
            "value": noisy,
            "case": {"films": [{"x": noisy}], "y": noisy},
            "after": [-0.0, noisy],
            "inner": {"provenance": {"case": {"x": noisy}, "y": noisy}, "after": noisy},
        });
        assert_eq!(
            results_line(&file),
            "{\"value\":3.3,\"case\":{\"films\":[{\"x\":3.3000000000000003}],\"y\":3.3000000000000003},\
             \"after\":[0.0,3.3],\"inner\":{\"provenance\":{\"case\":{\"x\":3.3000000000000003},\
             \"y\":3.3000000000000003},\"after\":3.3}}"
        );
    }

    #[test]
    fn the_layout_is_the_same() {
        let file = json!({"a": [1, {"b": "x\ny"}, []], "c": {}});
        assert_eq!(results_text(&file), to_text(&file));
        assert_eq!(results_line(&file), to_line(&file));
    }
}
