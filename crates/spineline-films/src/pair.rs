//! Two values of one attribute: distances between pixels, or the sides of a pixel, vertical first. Devices also
//! separate them with commas, blanks and other marks; a text with only one meaning is read.

use dicom_core::Tag;
use dicom_object::InMemDicomObject;

use super::FilmRemark;
use super::element::{Attributes, decimal};

/// Longest text of a pair that a remark shows.
const MAX_SHOWN: usize = 48;

/// The two values of an attribute, with a remark if their notation differs from the standard.
pub(super) fn pair(
    data: &InMemDicomObject,
    tag: Tag,
    remarks: &mut Vec<FilmRemark>,
) -> Option<[f64; 2]> {
    if data.is_blank(tag) {
        return None;
    }
    let text = data.text(tag).unwrap_or_default();
    if let [Some(down), Some(across)] = text.split('\\').map(decimal).collect::<Vec<_>>()[..] {
        return Some([down, across]);
    }
    let values = only_meaning(&text);
    let (attribute, text) = (tag.into(), shown(&text).into());
    remarks.push(match values {
        Some(values) => FilmRemark::PairReadAs { attribute, text, values },
        None => FilmRemark::PairUnreadable { attribute, text },
    });
    values
}

/// Height of a pixel over its width, from the lengths of its sides.
pub(super) fn aspect(
    data: &InMemDicomObject,
    tag: Tag,
    remarks: &mut Vec<FilmRemark>,
) -> Option<f64> {
    let [down, across] = pair(data, tag, remarks)?;
    if down > 0.0 && across > 0.0 {
        return Some(down / across);
    }
    let text = shown(&data.text(tag).unwrap_or_default()).into();
    remarks.push(FilmRemark::PairUnreadable { attribute: tag.into(), text });
    None
}

/// The two numbers of a text with only one meaning.
fn only_meaning(text: &str) -> Option<[f64; 2]> {
    let two = |separator: char| {
        let parts: Vec<&str> =
            text.split(separator).map(str::trim).filter(|part| !part.is_empty()).collect();
        match parts[..] {
            [a, b] => Some([number(a)?, number(b)?]),
            _ => None,
        }
    };
    let by_mark = ['\\', ';', '/', ':', 'x', 'X', ' '].into_iter().find_map(two);
    by_mark.or_else(|| by_comma(text))
}

/// A number with a decimal point or a decimal comma.
fn number(text: &str) -> Option<f64> {
    let commas = text.matches(',').count();
    match (commas, text.contains('.')) {
        (0, _) => decimal(text),
        (1, false) => decimal(&text.replace(',', ".")),
        _ => None,
    }
}

/// Two numbers with a comma between them: each has a decimal point, or each has a decimal comma. `0,5` may be one number.
fn by_comma(text: &str) -> Option<[f64; 2]> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    match parts[..] {
        [a, b] if a.contains('.') && b.contains('.') => Some([decimal(a)?, decimal(b)?]),
        [a, b, c, d] if parts.iter().all(|part| part.bytes().all(|c| c.is_ascii_digit())) => {
            Some([decimal(&format!("{a}.{b}"))?, decimal(&format!("{c}.{d}"))?])
        }
        _ => None,
    }
}

/// The text of a pair if it has only usual characters: other text may be a name.
fn shown(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_digit() || "+-.,;:/\\ xXeEm".contains(c);
    if text.len() <= MAX_SHOWN && text.chars().all(is_plain) {
        text.to_owned()
    } else {
        "(other text)".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::only_meaning;

    #[test]
    fn a_pair_is_read_where_it_can_be_meant_in_one_way_alone() {
        for (text, wanted) in [
            ("0.500,0.250", Some([0.5, 0.25])),
            ("0,5\\0,25", Some([0.5, 0.25])),
            ("0,500;0,250", Some([0.5, 0.25])),
            ("0,500,0,250", Some([0.5, 0.25])),
            ("0.5 0.25", Some([0.5, 0.25])),
            ("0.5 / 0.25", Some([0.5, 0.25])),
            ("1:2", Some([1.0, 2.0])),
            ("0,500", None),
            ("1,2", None),
            ("0.5", None),
            ("0.5,", None),
            ("0.5\\0.25\\1", None),
            ("0.5,0.25,1.0", None),
            ("0.5,25", None),
            ("0.5mm", None),
            ("", None),
        ] {
            assert_eq!(only_meaning(text), wanted, "{text}");
        }
    }
}
