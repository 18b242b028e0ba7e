use super::Level;

/// The vertebrae that a model is made of: neighbours, from a base that is fixed to the top that carries the force.
///
/// A complete model has L4 to T2. Films that do not show all of these give a part of it, the same on all films of a patient.
///
/// ```
/// use spineline::anatomy::{Level, Levels};
/// let levels = Levels::between(Level::L4, Level::T4).unwrap();
/// assert_eq!((levels.len(), levels.joints()), (13, 12));
/// assert_eq!(levels.index_of(Level::L3), Some(1));
/// assert_eq!(levels.index_of(Level::T2), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Levels(&'static [Level]);

impl Levels {
    /// L4 to T2.
    pub const COMPLETE: Self = Self(&Level::MODEL);

    /// The highest base: the search for the least-rotating segment begins at L2, and the usual lowest region needs three
    /// vertebrae up to T12.
    pub const HIGHEST_BASE: Level = Level::L2;

    /// The lowest top: the upper window of that search begins at T7, and must hold a joint.
    pub const LOWEST_TOP: Level = Level::T6;

    /// From one vertebra of the complete model to another one above it; `None` for any other two.
    #[must_use]
    pub fn between(base: Level, top: Level) -> Option<Self> {
        let (first, last) = (base.model_index()?, top.model_index()?);
        (first < last).then(|| Self(&Level::MODEL[first..=last]))
    }

    /// All of them, caudal first.
    #[must_use]
    pub const fn as_slice(self) -> &'static [Level] {
        self.0
    }

    /// All of them, caudal first.
    pub fn iter(self) -> impl ExactSizeIterator<Item = Level> + DoubleEndedIterator + Clone {
        self.0.iter().copied()
    }

    /// The pairs of neighbours with a joint between them, caudal first.
    pub fn joint_pairs(self) -> impl ExactSizeIterator<Item = [Level; 2]> + Clone {
        self.0.windows(2).map(|pair| [pair[0], pair[1]])
    }

    /// Number of vertebrae.
    #[must_use]
    #[allow(clippy::len_without_is_empty)]
    pub const fn len(self) -> usize {
        self.0.len()
    }

    /// Number of joints.
    #[must_use]
    pub const fn joints(self) -> usize {
        self.0.len() - 1
    }

    /// The fixed vertebra, whose frame is `G`.
    #[must_use]
    pub const fn base(self) -> Level {
        self.0[0]
    }

    /// The vertebra that carries the force.
    #[must_use]
    pub const fn top(self) -> Level {
        self.0[self.0.len() - 1]
    }

    /// Whether these are L4 to T2.
    #[must_use]
    pub const fn is_complete(self) -> bool {
        self.0.len() == Level::MODEL.len()
    }

    /// The place of a level among them, caudal first.
    #[must_use]
    pub fn index_of(self, level: Level) -> Option<usize> {
        self.0.iter().position(|&own| own == level)
    }

    /// The place of a level among them, or of the nearest end.
    #[must_use]
    pub fn nearest_index(self, level: Level) -> usize {
        self.0.iter().filter(|&&own| own < level).count().min(self.joints())
    }

    /// The place of the lowest joint among the joints of the complete model.
    #[must_use]
    pub fn first_joint(self) -> usize {
        Level::MODEL.len() - Level::MODEL.iter().skip_while(|&&level| level != self.base()).count()
    }
}
