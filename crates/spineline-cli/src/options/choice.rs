//! Options whose values are the library's named values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use spineline::anatomy::Named;
use spineline_files::method_text::{NamedValue, option_named};

/// Sides of the patient.
pub const SIDES: &[NamedValue] = &[NamedValue::new("left", ""), NamedValue::new("right", "")];

/// Sides of a picture.
pub const IMAGE_SIDES: &[NamedValue] = &[
    NamedValue::new("image-left", "Left side of the picture as viewed"),
    NamedValue::new("image-right", "Right side of the picture as viewed"),
];

/// Reads one of these values as its spelling. Help and completion list all of them.
pub fn spelling(values: &'static [NamedValue]) -> PossibleValuesParser {
    let possible = |value: &NamedValue| {
        let possible = PossibleValue::new(value.spelling);
        if value.help.is_empty() { possible } else { possible.help(value.help) }
    };
    PossibleValuesParser::new(values.iter().map(possible))
}

/// Reads one of these values, whose spellings are their keys with `-`.
pub fn choice<T: Named + Send + Sync>(
    values: &'static [NamedValue],
) -> impl TypedValueParser<Value = T> {
    spelling(values).try_map(|text| {
        T::from_key(&text.replace('-', "_")).ok_or("expected one of the possible values")
    })
}

/// Reads a value of an option of the method.
pub fn choice_of<T: Named + Send + Sync>(
    option: &str,
) -> impl TypedValueParser<Value = T> + use<T> {
    choice(option_named(option).named_values())
}
