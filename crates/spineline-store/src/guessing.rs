//! How much of a password whoever guesses must guess. Measures of entropy by word lists of megabytes know more words; the
//! runs, repetitions and names here are what is tried first.

use std::collections::BTreeSet;

use crate::names::Name;

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

/// A shorter part of a name is a part of too many words.
const SHORTEST_PART: usize = 3;

/// Number of different characters that can be seen; upper and lower case are one.
pub fn different(password: &str) -> usize {
    folded(password).into_iter().filter(|&one| is_seen(one)).collect::<BTreeSet<_>>().len()
}

/// Number of characters that no run, repetition, common word or part of the account's name foretells. Blanks do not count.
pub fn unforeseen(password: &str, account: &Name) -> usize {
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

/// Marks every place of a word, also where signs stand for letters.
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
