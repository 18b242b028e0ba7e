use std::collections::BTreeMap;

use serde::Deserialize;
use spineline::measure::{CornerName, Origin, Reading, ReadingId};
use spineline::spatial::Pixel;

use super::origin_key;
use crate::film::{Points, merge_crests, origin, pixel};
use crate::identity::Identity;
use crate::json::parse_foreign;
use crate::names::{PointName, parse_corner, parse_level, shown};
use crate::number::{Id, Loose, Whole};
use crate::{
    LandmarkError, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings, MarkedFilm,
};

/// Names that one category may have: four corners of 17 vertebrae and two crests.
const MAX_KEYPOINTS: usize = 70;

#[derive(Deserialize)]
struct Dataset {
    images: Vec<Image>,
    categories: Vec<Category>,
    annotations: Vec<Annotation>,
}

#[derive(Deserialize)]
struct Image {
    id: Id,
    file_name: Option<String>,
    width: Option<Whole>,
    height: Option<Whole>,
    #[serde(default, rename = "spineline")]
    identity: Identity,
}

#[derive(Deserialize)]
struct Category {
    id: Id,
    name: String,
    #[serde(default)]
    keypoints: Vec<String>,
}

#[derive(Deserialize)]
struct Annotation {
    image_id: Id,
    category_id: Id,
    /// Absent or empty without placed keypoints.
    keypoints: Option<Vec<Loose>>,
    /// Confidence of every keypoint.
    keypoint_scores: Option<Vec<Loose>>,
    /// Confidence of all of them.
    #[serde(default)]
    score: Loose,
    attributes: Option<serde_json::Value>,
    #[serde(default, rename = "spineline")]
    identity: Identity,
}

/// A picture and its points by reading.
struct Marked<'a> {
    image: &'a Image,
    readings: BTreeMap<ReadingId, Points<Pixel>>,
}

/// Reads keypoints of COCO; one film per picture.
///
/// # Errors
/// [`LandmarkError`], which names the annotation.
pub fn parse_coco(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    let dataset: Dataset = parse_foreign(bytes)?;
    let mut categories: BTreeMap<&Id, Vec<PointName>> = BTreeMap::new();
    for (place, category) in dataset.categories.iter().enumerate() {
        let at = format!("categories[{place}] `{}`", shown(&category.name));
        let names = names(category, &at)?;
        once(&mut categories, &category.id, names, &at)?;
    }
    let mut images: BTreeMap<&Id, Marked<'_>> = BTreeMap::new();
    for (place, image) in dataset.images.iter().enumerate() {
        let marked = Marked { image, readings: BTreeMap::new() };
        once(&mut images, &image.id, marked, &format!("images[{place}]"))?;
    }
    for (place, annotation) in dataset.annotations.iter().enumerate() {
        let at = format!("annotations[{place}]");
        let missing = |what: String| LandmarkError::missing(at.clone(), what);
        let names = categories
            .get(&annotation.category_id)
            .ok_or_else(|| missing(format!("category {}", annotation.category_id)))?;
        let marked = images
            .get_mut(&annotation.image_id)
            .ok_or_else(|| missing(format!("image {}", annotation.image_id)))?;
        let id = annotation.identity.reading(hint, &at)?;
        let points = marked.readings.entry(id).or_default();
        annotation.add(names, points, &at)?;
    }
    let (mut films, mut remarks) = (Vec::new(), Vec::new());
    for marked in images.into_values() {
        for remark in marked.readings.values().flat_map(Points::remarks) {
            if !remarks.contains(&remark) {
                remarks.push(remark);
            }
        }
        films.extend(marked.film(hint)?);
    }
    if films.is_empty() {
        return Err(LandmarkError::missing("annotations", "a marked keypoint"));
    }
    Ok(LandmarkFile { format: LandmarkFormat::Coco, films, remarks })
}

impl Marked<'_> {
    /// The film of a picture with points.
    fn film(self, hint: &LandmarkHint) -> Result<Option<MarkedFilm>, LandmarkError> {
        if self.readings.values().all(Points::is_empty) {
            return Ok(None);
        }
        let what = format!("image {}", self.image.id);
        let (mut iliac_crests, mut readings) = (None, Vec::new());
        for (id, points) in self.readings {
            merge_crests(&mut iliac_crests, points.iliac_crests(&what)?, &what)?;
            let vertebrae = points.landmarks(&what)?;
            if !vertebrae.is_empty() {
                readings.push(Reading { id, vertebrae });
            }
        }
        Ok(Some(MarkedFilm {
            posture: self.image.identity.posture(&what)?.or(hint.posture),
            picture: self.image.file_name.clone().filter(|name| !name.is_empty()),
            size: self
                .image
                .width
                .zip(self.image.height)
                .map(|(width, height)| (width.0, height.0)),
            iliac_crests,
            landmarks: LandmarkReadings::Corners(readings),
        }))
    }
}

impl Annotation {
    /// Adds its placed keypoints.
    fn add(
        &self,
        names: &[PointName],
        points: &mut Points<Pixel>,
        at: &str,
    ) -> Result<(), LandmarkError> {
        let count = |found: usize, what: &str| LandmarkError::Syntax {
            at: at.to_owned(),
            reason: format!("{found} {what}, and its category has {} keypoints", names.len()),
        };
        let keypoints = self.keypoints.as_deref().unwrap_or_default();
        if keypoints.is_empty() {
            return Ok(());
        }
        if keypoints.len() != 3 * names.len() {
            return Err(count(keypoints.len(), "numbers of keypoints, three for each"));
        }
        if let Some(scores) = self.keypoint_scores.as_ref().filter(|s| s.len() != names.len()) {
            return Err(count(scores.len(), "keypoint_scores"));
        }
        for (place, (name, values)) in names.iter().zip(keypoints.chunks_exact(3)).enumerate() {
            let at = format!("{at}, `{name}`");
            let Loose(visibility) = values[2];
            if let Some(other) = visibility.filter(|visible| ![0.0, 1.0, 2.0].contains(visible)) {
                return Err(LandmarkError::Value {
                    at,
                    value: other.to_string(),
                    expected: "a visibility of 0, 1 or 2; confidences go into `keypoint_scores`",
                });
            }
            // Without coordinates it was not placed, whatever its visibility.
            let (Loose(Some(column)), Loose(Some(row))) = (values[0], values[1]) else { continue };
            if visibility.is_none_or(|visible| visible == 0.0) {
                continue;
            }
            points.insert(*name, pixel(column, row, &at)?, &at)?;
            let score = self.keypoint_scores.as_ref().and_then(|scores| scores[place].0);
            points.set_confidence(*name, score.or(self.score.0), &at)?;
            points.set_origin(*name, self.origin_of(*name, &at)?);
        }
        Ok(())
    }

    /// The origin of a keypoint, if stated; attributes of other programs are ignored.
    fn origin_of(&self, name: PointName, at: &str) -> Result<Option<Origin>, LandmarkError> {
        let PointName::Corner(_, corner) = name else { return Ok(None) };
        let found = self.attributes.as_ref().and_then(|all| all.get(origin_key(corner)));
        let text = |value: &serde_json::Value| {
            value.as_str().map_or_else(|| value.to_string(), str::to_owned)
        };
        found.filter(|value| !value.is_null()).map(|value| origin(&text(value), at)).transpose()
    }
}

fn names(category: &Category, at: &str) -> Result<Vec<PointName>, LandmarkError> {
    let count = category.keypoints.len();
    if count > MAX_KEYPOINTS {
        return Err(LandmarkError::TooLarge {
            what: "keypoints of a category",
            found: count as u64,
            limit: MAX_KEYPOINTS as u64,
        });
    }
    let corners: Vec<CornerName> =
        category.keypoints.iter().filter_map(|name| parse_corner(name)).collect();
    if corners.len() == count && count > 0 {
        let level = parse_level(&category.name, at)?;
        return Ok(corners.into_iter().map(|corner| PointName::Corner(level, corner)).collect());
    }
    let name = |name: &String| PointName::parse(name, &format!("{at}, keypoints"));
    category.keypoints.iter().map(name).collect()
}

fn once<'a, T>(
    map: &mut BTreeMap<&'a Id, T>,
    id: &'a Id,
    value: T,
    at: &str,
) -> Result<(), LandmarkError> {
    match map.insert(id, value) {
        None => Ok(()),
        Some(_) => Err(LandmarkError::Duplicate {
            at: at.to_owned(),
            what: format!("id {id}"),
            first: None,
        }),
    }
}
