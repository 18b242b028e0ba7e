//! Open questions about a film's pixels that a person must decide.

use spineline_marking::judge_spacing;

use super::{FilmRemark, FilmTags};

/// Why the program must ask for the spacing of a film: its file states the shape of a pixel in a way that is
/// unreadable, implausible or contradictory, and all angles depend on it. `None` where the file states a usable spacing
/// or shape, or neither.
#[must_use]
pub fn spacing_question(tags: &FilmTags, remarks: &[FilmRemark]) -> Option<String> {
    let judged = judge_spacing(&tags.spacing);
    let unreadable = remarks.iter().find(|remark| {
        judged.spacing.is_none() && matches!(remark, FilmRemark::PairUnreadable { .. })
    });
    judged.question().map(ToString::to_string).or_else(|| unreadable.map(ToString::to_string))
}
