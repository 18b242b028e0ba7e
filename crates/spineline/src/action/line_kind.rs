use crate::anatomy::named;

named! {
    /// A candidate for the line of action.
    ///
    /// [`LineOfAction`](crate::action::LineOfAction) is the line itself.
    pub enum LineKind {
        /// Through the two inflections as they lie in the posture.
        Inflection = "inflection_line" as "inflection line",
        /// Parallel to the iliac line, through T2's midpoint and moving with it.
        Iliac = "iliac_line" as "iliac line",
        /// The line that fits measured rotations and positions best.
        Estimated = "estimated_line" as "estimated line",
        /// The user's.
        Given = "given_line" as "given line",
    }
}
