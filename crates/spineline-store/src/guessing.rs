//! How much of a password must be guessed. Measures of entropy by large word lists know more words; this module finds the
//! runs, repetitions and names that are tried first.

use std::collections::BTreeSet;

use spineline::warning::counted;

use crate::names::Name;

/// Minimum number of characters of a password.
const MIN_CHARACTERS: usize = 12;
/// Maximum number of bytes of a password.
pub const MAX_BYTES: usize = 1024;
/// Minimum number of different characters, without blanks.
const MIN_DIFFERENT: usize = 5;
/// Minimum number of characters that cannot be predicted from those before them.
const MIN_UNFORESEEN: usize = 8;
/// Rows of keyboards of several countries, along which passwords run.
const ROWS: [&str; 12] = [
    "1234567890",
    "qwertyuiop",
    "qwertzuiop",
    "azertyuiop",
    "asdfghjkl",
    "qsdfghjklm",
    "zxcvbnm",
    "yxcvbnm",
    "wxcvbn",
    "1q2w3e4r5t6y7u8i9o0p",
    "1q2w3e4r5t6z7u8i9o0p",
    "1a2z3e4r5t6y7u8i9o0p",
];

/// Words of the lists of common passwords, and of this program.
const WORDS: [&str; 27] = [
    "password",
    "passwort",
    "motdepasse",
    "contrasena",
    "kennwort",
    "letmein",
    "welcome",
    "willkommen",
    "iloveyou",
    "princess",
    "dragon",
    "monkey",
    "football",
    "baseball",
    "sunshine",
    "superman",
    "secret",
    "geheim",
    "changeme",
    "default",
    "admin",
    "login",
    "master",
    "hospital",
    "spineline",
    "scoliosis",
    "radiograph",
];

/// A shorter part of a name is contained in too many words.
const SHORTEST_PART: usize = 3;

/// Why a password is refused. It does not repeat the password.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PasswordFault {
    /// Too few characters.
    #[error("the password has {found} characters; it needs at least {MIN_CHARACTERS} characters")]
    Short {
        /// Its characters.
        found: usize,
    },
    /// Too many bytes.
    #[error("the password has {found} bytes; the limit is {MAX_BYTES} bytes")]
    Long {
        /// Its bytes.
        found: usize,
    },
    /// Few different characters.
    #[error(
        "the password has {}, not counting blanks; it needs at least {MIN_DIFFERENT}", counted(*.found as u64, "different character")
    )]
    Uniform {
        /// Its different characters.
        found: usize,
    },
    /// Runs, repetitions, common words or the account's name.
    #[error(
        "the password has {found} characters outside of runs (such as abcd or qwertz), repetitions, common words and the account's name; it needs at least {MIN_UNFORESEEN}"
    )]
    Foreseen {
        /// Its other characters.
        found: usize,
    },
}

impl PasswordFault {
    pub(crate) fn of(password: &str, account: &Name) -> Option<Self> {
        let characters = password.chars().count();
        if characters < MIN_CHARACTERS {
            return Some(Self::Short { found: characters });
        }
        if password.len() > MAX_BYTES {
            return Some(Self::Long { found: password.len() });
        }
        let different = different_characters(password);
        if different < MIN_DIFFERENT {
            return Some(Self::Uniform { found: different });
        }
        let unforeseen = unforeseen_characters(password, account);
        (unforeseen < MIN_UNFORESEEN).then_some(Self::Foreseen { found: unforeseen })
    }
}

/// Number of different characters that can be seen; upper and lower case are one.
fn different_characters(password: &str) -> usize {
    folded(password).into_iter().filter(|&one| is_seen(one)).collect::<BTreeSet<_>>().len()
}

/// Number of characters outside runs, repetitions, common words and parts of the account's name, without blanks.
fn unforeseen_characters(password: &str, account: &Name) -> usize {
    let text = folded(password);
    let seen: Vec<char> = text.into_iter().filter(|&one| is_seen(one)).collect();
    let mut foreseen = vec![false; seen.len()];
    for word in words_of(account) {
        mark(&seen, &word, &mut foreseen);
    }
    let rows: Vec<Vec<char>> = ROWS.iter().map(|row| row.chars().collect()).collect();
    let mut known = BTreeSet::new();
    for (at, two) in seen.windows(2).enumerate() {
        foreseen[at + 1] |= two[0] == two[1];
    }
    for (at, three) in seen.windows(3).enumerate() {
        if !known.insert(three) {
            foreseen[at..at + 3].fill(true);
        }
        foreseen[at + 2] |= is_run(three, &rows);
    }
    foreseen.iter().filter(|&&is| !is).count()
}

fn folded(password: &str) -> Vec<char> {
    password.chars().flat_map(char::to_lowercase).collect()
}

fn is_seen(one: char) -> bool {
    let draws_nothing =
        matches!(one, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    !(one.is_whitespace() || one.is_control() || draws_nothing)
}

/// Whether the third character continues the step from the first to the second one, by its number or along a keyboard.
fn is_run(three: &[char], rows: &[Vec<char>]) -> bool {
    let [first, second, third] = [0, 1, 2].map(|at| i64::from(u32::from(three[at])));
    let along =
        |row: &Vec<char>| row.windows(3).any(|keys| keys == three || keys.iter().rev().eq(three));
    second - first == third - second || rows.iter().any(along)
}

/// Common words and the parts of a name, forwards and backwards.
fn words_of(account: &Name) -> Vec<Vec<char>> {
    let name = account.as_str().to_ascii_lowercase();
    let parts = name.split(|one: char| !one.is_ascii_alphabetic());
    let own = parts.chain([name.as_str()]).filter(|part| part.len() >= SHORTEST_PART);
    let words = own.chain(WORDS).map(|word| word.chars().collect::<Vec<_>>());
    words.flat_map(|word| [word.iter().rev().copied().collect(), word]).collect()
}

/// Marks all occurrences of a word, also with signs in place of letters.
fn mark(seen: &[char], word: &[char], foreseen: &mut [bool]) {
    let is_same =
        |(one, letter): (&char, &char)| one == letter || stands_for(*one) == Some(*letter);
    for (at, part) in seen.windows(word.len()).enumerate() {
        if part.iter().zip(word).all(is_same) {
            foreseen[at..at + word.len()].fill(true);
        }
    }
}

fn stands_for(sign: char) -> Option<char> {
    let pairs = [
        ('@', 'a'),
        ('4', 'a'),
        ('3', 'e'),
        ('1', 'i'),
        ('!', 'i'),
        ('0', 'o'),
        ('$', 's'),
        ('5', 's'),
        ('7', 't'),
    ];
    pairs.into_iter().find(|(one, _)| *one == sign).map(|(_, letter)| letter)
}

#[cfg(test)]
mod tests {
    use super::PasswordFault;
    use crate::names::Name;

    fn fault(password: &str, account: &str) -> Option<PasswordFault> {
        PasswordFault::of(password, &Name::new(account).expect("a name"))
    }

    #[test]
    fn short_and_long_passwords_are_refused() {
        assert_eq!(fault("elevenchars", "lead"), Some(PasswordFault::Short { found: 11 }));
        let long = "a long sentence ".repeat(65);
        assert_eq!(fault(&long, "lead"), Some(PasswordFault::Long { found: 1040 }));
    }

    #[test]
    fn passwords_of_few_different_characters_are_refused() {
        for (password, found) in [
            ("aaaaaaaaaaaa", 1),
            ("AaAaAaAaAaAa", 1),
            ("            ", 0),
            ("\u{a0}\u{2003}\u{3000}\t\u{a0}\u{2003}\u{3000}\t\u{a0}\u{2003}\u{3000}\t", 0),
            (
                "\u{200b}\u{200c}\u{200d}\u{2060}\u{feff}\u{200b}\u{200c}\u{200d}\u{2060}\u{feff}\u{200b}\u{200c}",
                0,
            ),
            ("ab ab  ab ab ab", 2),
            ("112211221122", 2),
            ("........,,,,;", 3),
            ("éeéeéeéeéeéeé", 2),
        ] {
            assert_eq!(
                fault(password, "lead"),
                Some(PasswordFault::Uniform { found }),
                "{password}"
            );
        }
    }

    #[test]
    fn runs_repetitions_common_words_and_the_accounts_name_are_refused() {
        for password in [
            "abcdefghijkl",
            "ABCDEFGHIJKLM",
            "lkjihgfedcba",
            "123456789012",
            "098765432109",
            "acegikmoqsuwy",
            "qwertyuiopasdf",
            "qwertzuiopasd",
            "azertyuiop123",
            "poiuytrewq123",
            "1q2w3e4r5t6z7u",
            "abcabcdabcde1",
            "xk4!zxk4!zxk4!z",
            "a1b2c3a1b2c3",
            "password1234",
            "PassWord 2024",
            "passwordpassword",
            "P@ssw0rd!1234",
            "passwort12345",
            "Spineline2026",
            "leadleadlead1",
            "Anna.Meier.12",
            "anna meier 1234",
            "1234 reiem anna",
            "aaaabbbbccccddddeeee",
            "a b c d e f g h",
        ] {
            let found = fault(password, "anna.meier");
            let found = if password.starts_with("lead") { fault(password, "lead") } else { found };
            assert!(matches!(found, Some(PasswordFault::Foreseen { .. })), "{password}: {found:?}");
        }
    }

    #[test]
    fn sentences_and_random_characters_are_accepted() {
        for password in [
            "a long pass phrase",
            "another pass phrase",
            "a long enough sentence",
            "correct horse battery staple",
            "lead singers drink tea",
            "k7#Qv9!mZ2xT",
            "839201746552",
            "Wirbelsäule im Stehen",
            "脊柱側彎症患者的放射影像檢查",
        ] {
            assert_eq!(fault(password, "lead"), None, "{password}");
        }
    }
}
