//! Options whose values are the library's named values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
pub use spineline_files::method_text::{Choice, of_spelling};

/// Reads a value by its spelling. Help and completion list all of them.
pub fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    let possible = |value: &T| {
        let possible = PossibleValue::new(value.spelling());
        match Choice::help(*value) {
            "" => possible,
            help => possible.help(help),
        }
    };
    PossibleValuesParser::new(T::ALL.iter().map(possible))
        .try_map(|text| of_spelling(&text).ok_or("expected one of the possible values"))
}
