use super::places::{EndAngles, end_angles};
use super::{CobbEnds, CurvePlaces, RegionBounds, Regions, convex_side};
use crate::anatomy::{Level, Posture, Region, Side, named};
use crate::measure::{EndplateTilts, Outline};
use crate::spatial::{Angle, Frontal};

named! {
    /// On which films end vertebrae are chosen.
    #[default(Erect)]
    pub enum EndRule {
        /// On the erect film; every other film is measured between the same vertebrae, as surgeons do.
        Erect = "erect",
        /// On every film anew.
        EachFilm = "each_film",
    }
}

/// How the end vertebrae of curves are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EndChoice {
    /// Where they are the most tilted ones.
    pub rule: EndRule,
    /// Picked by the user, by region in the order of [`Region::ALL`]; they hold on every film.
    pub given: [Option<CobbEnds>; 3],
}

/// One curve of the spine as clinicians describe it.
#[derive(Debug, Clone, PartialEq)]
pub struct ClinicalCurve {
    /// Region.
    pub region: Region,
    /// End vertebrae on the erect film.
    pub ends: CobbEnds,
    /// Vertebra farthest from the line between the region's ends.
    pub apex: Level,
    /// The side to which the erect curve is convex; `None` where it does not turn.
    pub convex: Option<Side>,
    /// Angles between the end vertebrae in every posture that shows both, the erect one first.
    pub angles: Vec<(Posture, EndAngles)>,
    /// Ferguson angle in every posture that shows the region.
    pub ferguson: Vec<(Posture, Angle)>,
    /// Part of the erect angle that the bend to the convex side corrects; `None` without that film, and for curves of less
    /// than [`ClinicalCurve::MIN_FLEXIBLE`].
    pub flexibility: Option<f64>,
}

impl ClinicalCurve {
    /// Flexibility is a ratio to the erect angle; below this angle noise decides it.
    pub const MIN_FLEXIBLE: Angle = Angle::from_deg(10.0);

    /// Angles of a posture.
    #[must_use]
    pub fn angles_in(&self, posture: Posture) -> Option<EndAngles> {
        self.angles.iter().find(|(p, _)| *p == posture).map(|(_, angles)| *angles)
    }

    /// Cobb angle of a posture; `None` where its endplates are not known.
    #[must_use]
    pub fn cobb_in(&self, posture: Posture) -> Option<Angle> {
        self.angles_in(posture)?.cobb
    }

    /// Cobb angle of a posture, or its tilt range in a case whose erect film has no endplates: the same measure in all postures.
    #[must_use]
    pub fn size_in(&self, posture: Posture) -> Option<Angle> {
        let angles = self.angles_in(posture)?;
        if self.has_cobb() { angles.cobb } else { Some(angles.tilt_range) }
    }

    /// Size of the erect curve.
    #[must_use]
    pub fn erect_size(&self) -> Angle {
        self.angles.first().map_or(Angle::ZERO, |(_, angles)| angles.size())
    }

    /// Whether its size is a Cobb angle; else it is a tilt range.
    #[must_use]
    pub fn has_cobb(&self) -> bool {
        self.angles.first().is_some_and(|(_, angles)| angles.cobb.is_some())
    }

    /// What its size is called: `Cobb angle` or `tilt range`.
    #[must_use]
    pub fn size_name(&self) -> &'static str {
        if self.has_cobb() { "Cobb angle" } else { "tilt range" }
    }

    /// Size on the film that bends to the convex side, in the direction of the erect curve.
    fn size_when_straightened(&self) -> Option<Angle> {
        let posture = match self.convex? {
            Side::Left => Posture::LeftBending,
            Side::Right => Posture::RightBending,
        };
        self.size_in(posture).map(|angle| angle * self.erect_size().rad().signum())
    }
}

/// Measures the curve of every region in every posture that shows its vertebrae; the first outline is the erect one.
#[must_use]
pub fn measure_curves(
    regions: &Regions,
    outlines: &[&Outline],
    choice: &EndChoice,
) -> Vec<ClinicalCurve> {
    regions.bounds.iter().map(|bounds| measure_curve(*bounds, outlines, choice)).collect()
}

/// Measures the curve between the two vertebrae of the erect film, the first outline, that make the largest angle, wherever regions end.
#[must_use]
pub fn measure_largest_curve(outlines: &[&Outline], rule: EndRule) -> Option<ClinicalCurve> {
    let erect = film_tilts(outlines[0]);
    let any_known = erect.iter().any(|(_, endplates)| endplates.is_some());
    let size = |ends: &[usize; 2]| {
        let EndAngles { cobb, tilt_range } = end_angles(*ends, &erect);
        if any_known { cobb } else { Some(tilt_range) }.map_or(0.0, |angle| angle.abs().rad())
    };
    // An apex needs a vertebra between the ends.
    let pairs = (2..erect.len()).flat_map(|upper| (0..upper - 1).map(move |lower| [lower, upper]));
    let ends = pairs.max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let locations: Vec<Frontal> = outlines[0].locations().collect();
    let bounds = RegionBounds::of_curve(ends, outlines[0].levels(), &locations);
    Some(measure_curve(bounds, outlines, &EndChoice { rule, ..EndChoice::default() }))
}

fn measure_curve(bounds: RegionBounds, outlines: &[&Outline], choice: &EndChoice) -> ClinicalCurve {
    let erect = outlines[0];
    let level = |place: usize| erect.vertebrae[place].level;
    // A place of the erect film on another film.
    let on = |film: &Outline, place: usize| film.levels().index_of(level(place));
    let given = choice.given[bounds.region.index()].and_then(|ends| {
        let place = |level| erect.levels().index_of(level);
        Some([place(ends.inferior)?, place(ends.superior)?])
    });
    let bounds_on = |film: &Outline| {
        let [inferior, apex, superior] =
            [bounds.inferior, bounds.apex, bounds.superior].map(|place| on(film, place));
        Some(RegionBounds {
            inferior: inferior?,
            apex: apex?,
            superior: superior?,
            region: bounds.region,
        })
    };
    let held = given.unwrap_or_else(|| CurvePlaces::choose(bounds, &film_tilts(erect)).cobb_ends);
    let angles_on = |film: &&Outline| {
        let tilts = film_tilts(film);
        let ends = if choice.rule == EndRule::EachFilm && given.is_none() {
            CurvePlaces::choose(bounds_on(film)?, &tilts).cobb_ends
        } else {
            [on(film, held[0])?, on(film, held[1])?]
        };
        Some((film.posture, end_angles(ends, &tilts)))
    };
    let ferguson_on = |film: &&Outline| {
        let bounds = bounds_on(film)?;
        Some((film.posture, bounds.ferguson_angle(|i| film.vertebrae[i].location)))
    };
    let mut curve = ClinicalCurve {
        region: bounds.region,
        ends: CobbEnds { inferior: level(held[0]), superior: level(held[1]) },
        apex: level(bounds.apex),
        convex: None,
        angles: outlines.iter().filter_map(angles_on).collect(),
        ferguson: outlines.iter().filter_map(ferguson_on).collect(),
        flexibility: None,
    };
    curve.convex = convex_side(curve.erect_size());
    let size = curve.erect_size().abs();
    curve.flexibility = curve
        .size_when_straightened()
        .filter(|_| size >= ClinicalCurve::MIN_FLEXIBLE)
        .map(|bent| (size.rad() - bent.rad()) / size.rad());
    curve
}

/// Tilts of the vertebrae of a film and of their endplates, caudal first.
#[must_use]
pub fn film_tilts(outline: &Outline) -> Vec<(Angle, Option<EndplateTilts>)> {
    outline.vertebrae.iter().map(|vertebra| (vertebra.tilt, vertebra.endplates)).collect()
}

/// The Lenke curve type, as far as frontal films show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LenkeType {
    /// 1 to 6.
    pub number: u8,
}

/// Lenke's curve type from erect and bending Cobb angles.
///
/// A minor curve is structural when at least 25° remain on the bend to its convex side. Kyphosis, which may make a
/// curve structural too, the lumbar and the sagittal modifier need what these films do not show.
/// `None` where a bending film is missing, no curve reaches 10°, or the structural curves make no type.
///
/// # References
/// [lenke-2001].
#[must_use]
pub fn lenke_type(curves: &[ClinicalCurve]) -> Option<LenkeType> {
    const STRUCTURAL: Angle = Angle::from_deg(25.0);
    const SCOLIOSIS: Angle = Angle::from_deg(10.0);
    let [lumbar, main, proximal] = curves else { return None };
    let size = |curve: &ClinicalCurve| curve.cobb_in(Posture::Erect).map(Angle::abs);
    let stays = |curve: &ClinicalCurve| curve.size_when_straightened().map(|a| a >= STRUCTURAL);
    // The proximal thoracic curve is never the major one.
    let lumbar_is_major = size(lumbar)? > size(main)?;
    if size(lumbar)? < SCOLIOSIS && size(main)? < SCOLIOSIS {
        return None;
    }
    let lumbar_structural = lumbar_is_major || stays(lumbar)?;
    let main_structural = !lumbar_is_major || stays(main)?;
    let number = match (stays(proximal)?, main_structural, lumbar_structural) {
        (false, true, false) => 1,
        (true, true, false) => 2,
        (false, true, true) if !lumbar_is_major => 3,
        (true, true, true) => 4,
        (false, false, true) => 5,
        (false, true, true) => 6,
        _ => return None,
    };
    Some(LenkeType { number })
}
