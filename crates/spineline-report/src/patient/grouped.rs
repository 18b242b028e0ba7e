//! Equal warnings of several films as one notice with the range of their numbers.

use spineline::anatomy::Posture;
use spineline::warning::{Warning, WarningCode};

use crate::document::Notice;

/// One notice per warning. Warnings that differ only in film and numbers become one notice, at the place of the first.
pub fn notices<'a>(warnings: impl IntoIterator<Item = &'a Warning>) -> Vec<Notice> {
    let mut groups: Vec<(Pattern, Vec<&'a Warning>)> = Vec::new();
    for warning in warnings {
        let pattern = Pattern::of(warning);
        match groups.iter_mut().find(|(known, _)| warning.posture.is_some() && *known == pattern) {
            Some((_, group)) => group.push(warning),
            None => groups.push((pattern, vec![warning])),
        }
    }
    groups.iter().flat_map(|(pattern, group)| pattern.notices(group)).collect()
}

/// The common part of a group of warnings.
#[derive(PartialEq)]
struct Pattern {
    code: WarningCode,
    /// Level and line.
    place: String,
    is_of_film: bool,
    /// Text between the numbers.
    words: Vec<String>,
}

impl Pattern {
    fn of(warning: &Warning) -> Self {
        Self {
            code: warning.code,
            place: format!("{:?} {:?}", warning.level, warning.line),
            is_of_film: warning.posture.is_some(),
            words: parts(&warning.text()).0,
        }
    }

    /// One notice of several films; if a film has the warning twice, every notice stays.
    fn notices(&self, group: &[&Warning]) -> Vec<Notice> {
        let mut films: Vec<Posture> = group.iter().filter_map(|warning| warning.posture).collect();
        films.sort();
        films.dedup();
        if films.len() < 2 || films.len() < group.len() {
            return group.iter().map(|&warning| warning.into()).collect();
        }
        let first = Notice::from(group[0]);
        let numbers: Vec<Vec<String>> =
            group.iter().map(|warning| parts(&warning.text()).1).collect();
        let mut text = String::new();
        for (i, words) in self.words.iter().enumerate() {
            text.push_str(words);
            let values: Vec<&String> = numbers.iter().filter_map(|own| own.get(i)).collect();
            text.push_str(&range(&values));
        }
        let names: Vec<String> = films.iter().map(Posture::to_string).collect();
        // After the films stands their common place.
        let shared = first.place.split_once(", ").map(|(_, level)| format!(", {level}"));
        let place = format!("{} films{}", names.join(", "), shared.unwrap_or_default());
        vec![Notice { place, text, ..first }]
    }
}

/// The least and the greatest number, as they were written.
fn range(values: &[&String]) -> String {
    let value = |text: &&&String| text.parse::<f64>().unwrap_or(f64::NAN);
    let least = values.iter().min_by(|a, b| value(a).total_cmp(&value(b)));
    let most = values.iter().max_by(|a, b| value(a).total_cmp(&value(b)));
    match least.zip(most) {
        None => String::new(),
        Some((least, most)) if least == most => least.to_string(),
        Some((least, most)) => format!("{least} to {most}"),
    }
}

/// Splits a text into words, one more than numbers, and numbers. Digits of a name, such as T12, are words.
fn parts(text: &str) -> (Vec<String>, Vec<String>) {
    let (mut words, mut numbers) = (Vec::new(), Vec::new());
    let mut current = String::new();
    let mut is_name = false;
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        if !character.is_ascii_digit() || is_name {
            current.push(character);
            is_name = character.is_alphanumeric();
            continue;
        }
        let mut number = String::from(character);
        while let Some(&next) = characters.peek() {
            if next.is_ascii_digit() {
                number.push(next);
            } else if next == '.' && !number.contains('.') {
                // A point at the end of a sentence is not a decimal point.
                let mut ahead = characters.clone();
                ahead.next();
                if !ahead.peek().is_some_and(char::is_ascii_digit) {
                    break;
                }
                number.push(next);
            } else {
                break;
            }
            characters.next();
        }
        numbers.push(number);
        words.push(std::mem::take(&mut current));
    }
    words.push(current);
    (words, numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spineline::warning::Warnings;

    #[test]
    fn numbers_are_found_beside_names() {
        let (words, numbers) = parts("T12 lies 3.5 mm above L1, in 2 of 14 films.");
        assert_eq!(numbers, ["3.5", "2", "14"]);
        assert_eq!(words, ["T12 lies ", " mm above L1, in ", " of ", " films."]);
    }

    #[test]
    fn films_that_say_the_same_are_one_notice() {
        let mut warnings = Warnings::default();
        for (posture, joints) in [(Posture::LeftBending, 6), (Posture::Traction, 11)] {
            let text = format!("{joints} of 14 joints turn against the force");
            warnings.film(WarningCode::JointsContradictLine, posture, text);
        }
        for readings in [2, 3] {
            let text = format!("{readings} readings");
            warnings.film(WarningCode::ReadingsIncomplete, Posture::Traction, text);
        }
        warnings.push(WarningCode::ObserversAlike, "2 readings");
        warnings.push(WarningCode::ObserversAlike, "3 readings");
        let found = notices(warnings.all());
        let texts: Vec<(&str, &str)> =
            found.iter().map(|notice| (notice.place.as_str(), notice.text.as_str())).collect();
        assert_eq!(
            texts,
            [
                ("left bending, traction films", "6 to 11 of 14 joints turn against the force"),
                ("traction film", "2 readings"),
                ("traction film", "3 readings"),
                ("", "2 readings"),
                ("", "3 readings"),
            ]
        );
    }
}
