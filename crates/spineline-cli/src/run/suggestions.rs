//! What the command line suggests in place of a mistyped word.

use clap::Error;
use clap::error::{ContextKind, ContextValue};
use spineline_files::nearest;

/// Keeps the suggestion of an option or a command that differs by a letter or two, and no other: a similar value may mean another film, and a
/// similar option another side. The possible values are listed anyway.
pub fn near_only(mut words: Error) -> Error {
    words.remove(ContextKind::SuggestedValue);
    for (kind, of) in [
        (ContextKind::SuggestedArg, ContextKind::InvalidArg),
        (ContextKind::SuggestedSubcommand, ContextKind::InvalidSubcommand),
    ] {
        let Some(ContextValue::String(typed)) = words.get(of).cloned() else { continue };
        let suggested: Vec<String> = match words.remove(kind) {
            Some(ContextValue::String(one)) => vec![one],
            Some(ContextValue::Strings(some)) => some,
            _ => continue,
        };
        let known: Vec<&str> = suggested.iter().map(String::as_str).collect();
        if let Some(near) = nearest(&typed, &known) {
            let value = match kind {
                ContextKind::SuggestedArg => ContextValue::String(near),
                _ => ContextValue::Strings(vec![near]),
            };
            words.insert(kind, value);
        }
    }
    words
}
