//! The key that was meant.

/// The known key from which a mistyped one differs by a letter or two, or by capitals alone; `None` where two are as near.
///
/// For keys, columns and options. A value, such as a posture, a side or a vertebra, is never guessed: its names are listed.
///
/// ```
/// use spineline_files::nearest;
/// assert_eq!(nearest("Suport", &["support", "prior"]).as_deref(), Some("support"));
/// assert_eq!(nearest("patient_right", &["patient_left"]), None);
/// ```
#[must_use]
pub fn nearest(word: &str, keys: &[&str]) -> Option<String> {
    let word = word.to_lowercase();
    // Short words are near to too many.
    let most = (word.chars().count() / 3).min(2);
    let mut near: Vec<(usize, &str)> = keys
        .iter()
        .map(|key| (strsim::osa_distance(&word, &key.to_lowercase()), *key))
        .filter(|(distance, _)| *distance <= most)
        .collect();
    near.sort_unstable();
    match near[..] {
        [(first, _), (second, _), ..] if first == second => None,
        [(_, key), ..] => Some(key.to_owned()),
        [] => None,
    }
}
