use super::places::{EndAngles, end_angles};
use super::{CobbEnds, CurvePlaces, RegionBounds, Regions, convex_side};
use crate::anatomy::{Level, Posture, Region, Side, named};
use crate::measure::{EndplateTilts, MeasuredVertebra, Outline};
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
    /// Vertebrae beside ends that were chosen on a film which does not show these vertebrae: its angle may be too small.
    pub unmarked: Vec<UnmarkedNeighbour>,
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

    /// The bend to the convex side.
    fn straightened_by(&self) -> Option<Posture> {
        self.convex.map(|side| match side {
            Side::Left => Posture::LeftBending,
            Side::Right => Posture::RightBending,
        })
    }

    /// Size on the film that bends to the convex side, in the direction of the erect curve.
    fn size_when_straightened(&self) -> Option<Angle> {
        let angle = self.size_in(self.straightened_by()?)?;
        Some(angle * self.erect_size().rad().signum())
    }

    /// Whether an angle that Lenke's criteria take from it may be too small.
    fn may_be_larger(&self) -> bool {
        let films = [Some(Posture::Erect), self.straightened_by()];
        self.unmarked.iter().any(|beside| films.contains(&Some(beside.posture)))
    }
}

/// A vertebra of L4 to T2 that a film does not show, beside an end vertebra that was chosen on this film: it may be the end vertebra.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnmarkedNeighbour {
    /// The film.
    pub posture: Posture,
    /// The end vertebra.
    pub end: Level,
    /// The vertebra beside it.
    pub level: Level,
}

impl UnmarkedNeighbour {
    /// Beside ends that were chosen on a film, given as places on it; at most one for each end, the lower one first.
    fn of(film: &Outline, ends: [usize; 2]) -> impl Iterator<Item = Self> {
        let lacks = move |level: &Level| {
            let shown = film.vertebra(*level).is_some_and(MeasuredVertebra::is_measured);
            level.model_index().is_some() && !shown
        };
        ends.into_iter().filter_map(move |place| {
            let end = film.vertebrae[place].level;
            let level = [end.next_below(), end.next_above()].into_iter().flatten().find(lacks)?;
            Some(Self { posture: film.posture, end, level })
        })
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
    let each_film = choice.rule == EndRule::EachFilm && given.is_none();
    let ends_on = |film: &Outline| {
        Some(if each_film {
            CurvePlaces::choose(bounds_on(film)?, &film_tilts(film)).cobb_ends
        } else {
            [on(film, held[0])?, on(film, held[1])?]
        })
    };
    let angles_on =
        |film: &&Outline| Some((film.posture, end_angles(ends_on(film)?, &film_tilts(film))));
    let chosen_on = if each_film { outlines.len() } else { usize::from(given.is_none()) };
    let unmarked_on =
        |film| ends_on(film).into_iter().flat_map(move |ends| UnmarkedNeighbour::of(film, ends));
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
        unmarked: outlines[..chosen_on].iter().copied().flat_map(unmarked_on).collect(),
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
/// `None` where a bending film is missing, no curve reaches 10°, the structural curves make no type, or the type depends on
/// an angle that may be too small.
///
/// # References
/// [lenke-2001].
#[must_use]
pub fn lenke_type(curves: &[ClinicalCurve]) -> Option<LenkeType> {
    let number = lenke_number(curves, None)?;
    lenke_doubt(curves).is_none().then_some(LenkeType { number })
}

/// The first curve whose angle may be too small, where the type differs with this curve as the largest one; `None` also where the
/// measured angles make no type.
pub(crate) fn lenke_doubt(curves: &[ClinicalCurve]) -> Option<&ClinicalCurve> {
    let number = lenke_number(curves, None)?;
    let changes = |curve: &&ClinicalCurve| lenke_number(curves, Some(curve.region)) != Some(number);
    curves.iter().filter(|curve| curve.may_be_larger()).find(changes)
}

/// The number of the type, as measured or with one curve as the largest one, and structural.
fn lenke_number(curves: &[ClinicalCurve], largest: Option<Region>) -> Option<u8> {
    const STRUCTURAL: Angle = Angle::from_deg(25.0);
    const SCOLIOSIS: Angle = Angle::from_deg(10.0);
    const LARGEST: Angle = Angle::from_deg(f64::INFINITY);
    let [lumbar, main, proximal] = curves else { return None };
    let size = |curve: &ClinicalCurve| match largest {
        Some(region) if region == curve.region => Some(LARGEST),
        _ => curve.cobb_in(Posture::Erect).map(Angle::abs),
    };
    let stays = |curve: &ClinicalCurve| match largest {
        Some(region) if region == curve.region => Some(true),
        _ => curve.size_when_straightened().map(|angle| angle >= STRUCTURAL),
    };
    // The proximal thoracic curve is never the major one.
    let lumbar_is_major = size(lumbar)? > size(main)?;
    if size(lumbar)? < SCOLIOSIS && size(main)? < SCOLIOSIS {
        return None;
    }
    let lumbar_structural = lumbar_is_major || stays(lumbar)?;
    let main_structural = !lumbar_is_major || stays(main)?;
    match (stays(proximal)?, main_structural, lumbar_structural) {
        (false, true, false) => Some(1),
        (true, true, false) => Some(2),
        (false, true, true) if !lumbar_is_major => Some(3),
        (true, true, true) => Some(4),
        (false, false, true) => Some(5),
        (false, true, true) => Some(6),
        _ => None,
    }
}
