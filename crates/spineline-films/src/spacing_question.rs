//! What a film states of its pixels and a person has to decide.

use spineline_marking::judge_spacing;

use super::{FilmRemark, FilmTags};

/// Why the spacing of a film has to be asked for: its file states the shape of a pixel in a way that cannot be read, that cannot be
/// meant, or that contradicts itself, and all angles depend on it. `None` where the file states a spacing or a shape that can be
/// used, or states nothing.
#[must_use]
pub fn spacing_question(tags: &FilmTags, remarks: &[FilmRemark]) -> Option<String> {
    let judged = judge_spacing(&tags.spacing);
    let unreadable = remarks.iter().find(|remark| {
        judged.spacing.is_none() && matches!(remark, FilmRemark::PairUnreadable { .. })
    });
    judged.question().map(ToString::to_string).or_else(|| unreadable.map(ToString::to_string))
}
