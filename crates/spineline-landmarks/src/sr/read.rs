use std::collections::BTreeMap;

use dicom_core::Tag;
use dicom_dictionary_std::{tags, uids};
use dicom_object::InMemDicomObject;
use spineline::anatomy::{Level, Posture};
use spineline::measure::{
    CornerName, Corners, IliacCrests, Origin, Reading, ReadingId, VertebraLandmarks,
};
use spineline::spatial::{Angle, Pixel};
use spineline_films::read_data_set;

use super::codes::{self, Code};
use crate::film::{HALF_PIXEL, degrees, origin, pixel};
use crate::names::observer;
use crate::{LandmarkError, LandmarkReadings, MarkedFilm};

/// Reads a report that [`write_sr`](super::write_sr) wrote: corners to 1e-4 of a pixel.
///
/// # Errors
/// [`LandmarkError::Report`] for anything else; other [`LandmarkError`]s for its values.
pub fn read_sr(bytes: &[u8]) -> Result<MarkedFilm, LandmarkError> {
    if bytes.get(128..132) != Some(b"DICM") {
        return Err(foreign("it is not a DICOM file"));
    }
    let document = &read_data_set(bytes).map_err(|error| foreign(&error.to_string()))?;
    if text(document, tags::SOP_CLASS_UID).as_deref() != Some(uids::COMPREHENSIVE_SR_STORAGE)
        || !is_named(document, codes::REPORT)
    {
        return Err(foreign("it is not a Comprehensive SR with a measurement report"));
    }
    let content = children(document);
    let device = content.iter().find(|item| is_named(item, codes::DEVICE_NAME));
    if device.and_then(|item| text(item, tags::TEXT_VALUE)).as_deref() != Some(codes::SCHEME_NAME) {
        return Err(foreign("another program wrote it"));
    }
    let person = content.iter().find(|item| is_named(item, codes::PERSON_NAME));
    let name = person.and_then(|item| text(item, tags::PERSON_NAME)).unwrap_or_default();
    let name = observer(name.strip_suffix('^').unwrap_or(&name), "Person Observer Name")?;
    let groups = content
        .iter()
        .find(|item| is_named(item, codes::MEASUREMENTS))
        .map(children)
        .unwrap_or_default();
    let film = Report::default().read(groups, name)?;
    Ok(MarkedFilm { picture: film_uid(document), ..film })
}

/// The SOP Instance UID of the film, from the list of evidence.
fn film_uid(document: &InMemDicomObject) -> Option<String> {
    let first = |object: &InMemDicomObject, tag: Tag| -> Option<InMemDicomObject> {
        object.get(tag)?.items()?.first().cloned()
    };
    let study = first(document, tags::CURRENT_REQUESTED_PROCEDURE_EVIDENCE_SEQUENCE)?;
    let series = first(&study, tags::REFERENCED_SERIES_SEQUENCE)?;
    let film = first(&series, tags::REFERENCED_SOP_SEQUENCE)?;
    text(&film, tags::REFERENCED_SOP_INSTANCE_UID)
}

#[derive(Default)]
struct Report {
    posture: Option<Posture>,
    repeat: Option<u32>,
    crests: Option<IliacCrests>,
    vertebrae: BTreeMap<Level, VertebraLandmarks>,
}

impl Report {
    fn read(
        mut self,
        groups: &[InMemDicomObject],
        observer: String,
    ) -> Result<MarkedFilm, LandmarkError> {
        for (place, group) in groups.iter().enumerate() {
            let items = children(group);
            let at = format!("measurement group {}", place + 1);
            self.common(items, &at)?;
            match coded(items, codes::FINDING) {
                Some((value, scheme)) if is(codes::VERTEBRA, &value, &scheme) => {
                    self.vertebra(items, &at)?;
                }
                Some((value, scheme)) if is(codes::ILIAC_LINE, &value, &scheme) => {
                    let [left, right] = corners(items, codes::ILIAC_TILT, &at)?;
                    if self.crests.replace(IliacCrests { left, right }).is_some() {
                        return Err(twice(&at, "the iliac line"));
                    }
                }
                // Curves follow from vertebrae.
                _ => {}
            }
        }
        let (Some(posture), Some(repeat)) = (self.posture, self.repeat) else {
            return Err(foreign("it holds no measurement group"));
        };
        let id = ReadingId::new(observer, repeat);
        Ok(MarkedFilm {
            posture: Some(posture),
            picture: None,
            size: None,
            iliac_crests: self.crests,
            landmarks: LandmarkReadings::Corners(vec![Reading { id, vertebrae: self.vertebrae }]),
        })
    }

    /// Posture and repeat, common to all groups.
    fn common(&mut self, items: &[InMemDicomObject], at: &str) -> Result<(), LandmarkError> {
        let key = coded(items, codes::POSTURE).map(|(value, _)| value);
        let posture: Option<Posture> = key.as_deref().and_then(|key| key.parse().ok());
        let session = items.iter().find(|item| is_named(item, codes::SESSION));
        let repeat = session
            .and_then(|item| text(item, tags::TEXT_VALUE))
            .and_then(|text| text.parse::<u32>().ok())
            .filter(|&repeat| repeat > 0);
        let missing = |what: &str| LandmarkError::missing(at, what);
        let posture = posture.ok_or_else(|| missing("the posture"))?;
        let repeat = repeat.ok_or_else(|| missing("the repeat, as a session,"))?;
        if self.posture.replace(posture).is_some_and(|first| first != posture)
            || self.repeat.replace(repeat).is_some_and(|first| first != repeat)
        {
            let reason = "its groups are of different postures or repeats".to_owned();
            let help = "give a report that `spineline export --to dicom-sr` wrote";
            return Err(LandmarkError::Ambiguous { at: at.to_owned(), reason, help });
        }
        Ok(())
    }

    fn vertebra(&mut self, items: &[InMemDicomObject], at: &str) -> Result<(), LandmarkError> {
        let site = coded(items, codes::SITE);
        let level = site.as_ref().and_then(|(value, scheme)| {
            Level::ALL.into_iter().find(|&level| is(codes::vertebra(level), value, scheme))
        });
        let level = level
            .ok_or_else(|| LandmarkError::missing(at, "a site that is a vertebra from T1 to L5"))?;
        let clicked =
            VertebraLandmarks::clicked(Corners::from(corners::<4>(items, codes::TILT, at)?));
        let axis_clockwise = axis(items, at)?;
        let landmarks =
            VertebraLandmarks { axis_clockwise, origins: origins(items, at)?, ..clicked };
        match self.vertebrae.insert(level, landmarks) {
            None => Ok(()),
            Some(_) => Err(twice(at, level.name())),
        }
    }
}

/// The axis that was set by hand: angle to the image's vertical.
fn axis(items: &[InMemDicomObject], at: &str) -> Result<Option<Angle>, LandmarkError> {
    let Some(turned) = items.iter().find(|item| is_named(item, codes::AXIS)) else {
        return Ok(None);
    };
    let value = turned
        .get(tags::MEASURED_VALUE_SEQUENCE)
        .and_then(|element| element.items()?.first()?.get(tags::FLOATING_POINT_VALUE))
        .and_then(|element| element.to_float64().ok());
    let deg = value.ok_or_else(|| LandmarkError::missing(at, "the axis in degrees"))?;
    degrees(deg, at).map(Some)
}

/// The origins of the corners of a vertebra; a missing one means clicked.
fn origins(items: &[InMemDicomObject], at: &str) -> Result<Corners<Origin>, LandmarkError> {
    let mut origins = Corners::all(Origin::Clicked);
    for corner in CornerName::ALL {
        if let Some((value, _)) = coded(items, codes::origin_of(corner)) {
            *corner.of_mut(&mut origins) = origin(&value, at)?;
        }
    }
    Ok(origins)
}

/// The places from which a number was derived.
fn corners<const N: usize>(
    items: &[InMemDicomObject],
    name: Code,
    at: &str,
) -> Result<[Pixel; N], LandmarkError> {
    let number = items.iter().find(|item| is_named(item, name));
    let data = number
        .and_then(|item| children(item).iter().find(|item| is_named(item, codes::SOURCE)))
        .and_then(|item| item.get(tags::GRAPHIC_DATA))
        .and_then(|element| element.to_multi_float32().ok())
        .filter(|data| data.len() == 2 * N);
    let data = data
        .ok_or_else(|| LandmarkError::missing(at, format!("spatial coordinates of {N} points")))?;
    let mut places = [Pixel::new(0.0, 0.0); N];
    for (place, pair) in places.iter_mut().zip(data.chunks_exact(2)) {
        *place = pixel(f64::from(pair[0]) - HALF_PIXEL, f64::from(pair[1]) - HALF_PIXEL, at)?;
    }
    Ok(places)
}

fn children(item: &InMemDicomObject) -> &[InMemDicomObject] {
    item.get(tags::CONTENT_SEQUENCE).and_then(|element| element.items()).unwrap_or_default()
}

fn text(item: &InMemDicomObject, tag: Tag) -> Option<String> {
    let text = item.get(tag)?.to_str().ok()?;
    Some(text.trim_matches(['\0', ' ']).to_owned())
}

/// Value and scheme of a coded attribute.
fn code_in(item: &InMemDicomObject, tag: Tag) -> Option<(String, String)> {
    let code = item.get(tag)?.items()?.first()?;
    Some((text(code, tags::CODE_VALUE)?, text(code, tags::CODING_SCHEME_DESIGNATOR)?))
}

/// The coded value of the first item of a name.
fn coded(items: &[InMemDicomObject], name: Code) -> Option<(String, String)> {
    let item = items.iter().find(|item| is_named(item, name))?;
    code_in(item, tags::CONCEPT_CODE_SEQUENCE)
}

fn is_named(item: &InMemDicomObject, name: Code) -> bool {
    code_in(item, tags::CONCEPT_NAME_CODE_SEQUENCE)
        .is_some_and(|(value, scheme)| is(name, &value, &scheme))
}

fn is(Code(value, scheme, _): Code, found_value: &str, found_scheme: &str) -> bool {
    value == found_value && scheme == found_scheme
}

fn foreign(reason: &str) -> LandmarkError {
    LandmarkError::Report { reason: reason.to_owned() }
}

fn twice(at: &str, what: &str) -> LandmarkError {
    LandmarkError::Duplicate { at: at.to_owned(), what: what.to_owned(), first: None }
}
