use crate::anatomy::{Level, Levels, Region};
use crate::curve::{CurveFit, Inflections};
use crate::spatial::{Angle, Frontal};
use crate::warning::{WarningCode, Warnings};

/// A region of the spine, as places among the vertebrae of the model ([`Levels`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RegionBounds {
    /// Which region.
    pub region: Region,
    /// Lower end vertebra.
    pub inferior: usize,
    /// Vertebra farthest from the line between the ends, on the erect film.
    pub apex: usize,
    /// Upper end vertebra.
    pub superior: usize,
}

/// The three regions, chosen on the erect film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Regions {
    /// Caudal first, in the order of [`Region::ALL`].
    pub bounds: [RegionBounds; 3],
    /// Whether they end at inflections, and so each has one curve; else they end at usual vertebrae.
    pub are_curves: bool,
}

/// Without two inflections the regions end at these vertebrae.
const USUAL_ENDS: [Level; 2] = [Level::T12, Level::T6];

impl Regions {
    /// Regions that end at T12 and T6, for a spine whose inflections are not known; below a low top as near to T6 as leaves a
    /// vertebra between it and the top.
    ///
    /// `locations` belong to the levels on the erect spine.
    #[must_use]
    pub fn usual(levels: Levels, locations: &[Frontal]) -> Self {
        let [low, high] = USUAL_ENDS.map(|level| levels.nearest_index(level));
        Self::between([low.max(2), high.min(levels.joints() - 2)], locations, false)
    }

    /// Number of joints of the model.
    #[must_use]
    pub const fn joints(&self) -> usize {
        self.bounds[2].superior
    }

    /// Regions that end at the vertebrae nearest to the two inflections, or at T12 and T6 without such a pair.
    #[must_use]
    pub fn from_inflections(
        fit: &CurveFit,
        inflections: &Inflections,
        locations: &[Frontal],
        warnings: &mut Warnings,
    ) -> Self {
        let last = fit.levels.joints();
        let ends =
            inflections.pair.map(|pair| pair.map(|inflection| nearest(fit, inflection.t_mm)));
        // An apex needs a vertebra between the ends.
        match ends {
            Some([low, high]) if low >= 2 && high >= low + 2 && high + 2 <= last => {
                Self::between([low, high], locations, true)
            }
            _ => {
                let usual = Self::usual(fit.levels, locations);
                let [low, high] = [0, 1].map(|i| fit.levels.as_slice()[usual.bounds[i].superior]);
                let text = format!(
                    "the erect curve does not give three regions of three vertebrae; the limits {low} and {high} are used instead"
                );
                warnings.push(WarningCode::UsualRegions, text);
                usual
            }
        }
    }

    fn between(ends: [usize; 2], locations: &[Frontal], are_curves: bool) -> Self {
        let limits = [0, ends[0], ends[1], locations.len() - 1];
        let bounds = std::array::from_fn(|i| {
            let (inferior, superior) = (limits[i], limits[i + 1]);
            let apex = apex_between(locations, inferior, superior);
            RegionBounds { region: Region::ALL[i], inferior, apex, superior }
        });
        Self { bounds, are_curves }
    }

    /// The region of a joint: the one of its upper vertebra; an end vertebra belongs to the region below.
    #[must_use]
    pub fn of_joint(&self, joint: usize) -> Region {
        let upper = joint + 1;
        let found = self.bounds.iter().find(|bounds| upper <= bounds.superior);
        found.map_or(Region::ProximalThoracic, |bounds| bounds.region)
    }
}

impl RegionBounds {
    /// A curve between two vertebrae of an erect spine, in the region of its apex: thoracolumbar or lumbar up to T12, main thoracic up to
    /// T6.
    pub(super) fn of_curve(
        [inferior, superior]: [usize; 2],
        levels: Levels,
        locations: &[Frontal],
    ) -> Self {
        let apex = apex_between(locations, inferior, superior);
        let region = match levels.as_slice()[apex] {
            level if level <= USUAL_ENDS[0] => Region::ThoracolumbarLumbar,
            level if level <= USUAL_ENDS[1] => Region::MainThoracic,
            _ => Region::ProximalThoracic,
        };
        Self { region, inferior, apex, superior }
    }

    /// The lines from the lower end to the apex and from the apex to the upper end.
    pub(crate) fn ferguson_lines(&self, location: impl Fn(usize) -> Frontal) -> [Frontal; 2] {
        let apex = location(self.apex);
        [apex - location(self.inferior), location(self.superior) - apex]
    }

    /// Ferguson angle of vertebrae at these locations: lateral tilt of the line apex → upper end minus the tilt of the line
    /// lower end → apex.
    ///
    /// Positive where the curve turns to the patient's right from below to above, so where it is convex to the left.
    ///
    /// ```
    /// use spineline::{anatomy::Region, clinical::RegionBounds, spatial::Frontal};
    /// let spine = [Frontal::new(0.0, 0.0), Frontal::new(10.0, 10.0), Frontal::new(0.0, 20.0)];
    /// let bounds = RegionBounds { region: Region::MainThoracic, inferior: 0, apex: 1, superior: 2 };
    /// assert!((bounds.ferguson_angle(|i| spine[i]).deg() - 90.0).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn ferguson_angle(&self, location: impl Fn(usize) -> Frontal) -> Angle {
        let [lower, upper] = self.ferguson_lines(location).map(Frontal::lateral_tilt);
        (upper - lower).wrapped()
    }
}

fn nearest(fit: &CurveFit, t_mm: f64) -> usize {
    let off = |i: &usize| (fit.vertebra_t_mm[*i] - t_mm).abs();
    (0..fit.vertebra_t_mm.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

fn apex_between(locations: &[Frontal], inferior: usize, superior: usize) -> usize {
    let chord = locations[superior] - locations[inferior];
    let off = |i: &usize| chord.cross(locations[*i] - locations[inferior]).abs();
    (inferior + 1..superior).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(inferior + 1)
}
