//! Parts of a list of cases, for job arrays.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One of several parts of about the same size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    /// From 1.
    pub number: usize,
    /// Number of parts.
    pub of: usize,
}

/// More parts than any cluster runs.
const MAX_SHARDS: usize = 1_000_000;

impl Shard {
    /// The name of the option.
    pub const OPTION: &'static str = "--shard";

    /// The part that a command line names, if it names one.
    pub fn of_command(words: &[String]) -> Option<Self> {
        let mut words = words.iter();
        let value = words.find_map(|word| {
            word.strip_prefix(Self::OPTION).map(|rest| rest.strip_prefix('=').map(str::to_owned))
        })?;
        value.or_else(|| words.next().cloned())?.parse().ok()
    }

    /// Its places among `items`: parts are contiguous, and in the order of the items.
    pub const fn places(self, items: usize) -> Range<usize> {
        (self.number - 1) * items / self.of..self.number * items / self.of
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!("expected a part and the number of parts, such as `3/8`, up to {MAX_SHARDS}")
        };
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let [number, of] = [number, of].map(str::parse::<usize>);
        match (number, of) {
            (Ok(number @ 1..), Ok(of @ ..=MAX_SHARDS)) if number <= of => Ok(Self { number, of }),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_all_items_once_and_are_of_about_the_same_size() {
        for items in [1, 7, 8, 100] {
            for of in [1, 2, 3, 8] {
                let parts = (1..=of).map(|number| Shard { number, of }.places(items));
                let sizes: Vec<usize> = parts.clone().map(|part| part.len()).collect();
                assert_eq!(parts.flatten().collect::<Vec<_>>(), (0..items).collect::<Vec<_>>());
                assert!(sizes.iter().all(|size| size.abs_diff(items / of) <= 1), "{sizes:?}");
            }
        }
    }

    #[test]
    fn a_part_is_read_from_text_and_from_a_command_line() {
        assert_eq!("3/8".parse(), Ok(Shard { number: 3, of: 8 }));
        for text in ["0/2", "3/2", "1", "1/0", "a/b", "-1/2", "1/2000000"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        for (command, found) in [
            (&["analyze", "--shard", "2/3", "cases"][..], Some(Shard { number: 2, of: 3 })),
            (&["analyze", "--shard=2/3"], Some(Shard { number: 2, of: 3 })),
            (&["analyze", "cases"], None),
        ] {
            let words: Vec<String> = command.iter().map(|&word| word.to_owned()).collect();
            assert_eq!(Shard::of_command(&words), found);
        }
    }
}
