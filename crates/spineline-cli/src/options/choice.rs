//! Options whose values are the library's named values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use spineline::anatomy::Named;
use spineline_files::method_text::{NamedValue, named, named_values};

/// Reads one of these values as its spelling. Help and completion list all of them.
pub fn spelling(values: Vec<NamedValue>) -> PossibleValuesParser {
    let possible = |value: NamedValue| PossibleValue::new(value.spelling).help(value.help);
    PossibleValuesParser::new(values.into_iter().map(possible))
}

/// Reads a named value by its spelling.
pub fn choice<T: Named + Send + Sync>() -> impl TypedValueParser<Value = T> {
    spelling(named_values::<T>()).try_map(|text| named(&text))
}

#[cfg(test)]
mod tests {
    use spineline_phantom::Scenario;

    use super::named;

    #[test]
    fn every_name_is_read_in_both_spellings() {
        for scenario in Scenario::ALL {
            assert_eq!(named(scenario.key()), Ok(scenario));
            assert_eq!(named(&scenario.key().replace('-', "_")), Ok(scenario));
        }
    }
}
