//! Keypoints in the format of COCO.
//!
//! A category is a vertebra with the keypoints `superior_left`, `superior_right`, `inferior_left` and `inferior_right`, or
//! one thing with keypoints named as in Slicer's lists, such as `T12_superior_left`. Sides are the patient's. Places count from
//! the centre of the first pixel, as in Spineline. Keypoints of visibility 0 were not placed.

use std::collections::BTreeMap;

use serde::Deserialize;
use spineline::measure::{CornerName, Reading};
use spineline::spatial::Pixel;

use super::film::{Points, pixel};
use super::json::parse_foreign;
use super::names::{PointName, parse_corner, parse_level, shown};
use super::{
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
    id: i64,
    file_name: Option<String>,
    width: Option<u32>,
    height: Option<u32>,
}

#[derive(Deserialize)]
struct Category {
    id: i64,
    name: String,
    #[serde(default)]
    keypoints: Vec<String>,
}

#[derive(Deserialize)]
struct Annotation {
    image_id: i64,
    category_id: i64,
    #[serde(default)]
    keypoints: Vec<f64>,
}

/// Reads keypoints of COCO; one film per picture.
///
/// # Errors
/// [`LandmarkError`], which names the annotation.
pub fn parse_coco(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    let dataset: Dataset = parse_foreign(bytes)?;
    let mut categories: BTreeMap<i64, Vec<PointName>> = BTreeMap::new();
    for (place, category) in dataset.categories.iter().enumerate() {
        let at = format!("categories[{place}] `{}`", shown(&category.name));
        let names = names(category, &at)?;
        once(&mut categories, category.id, names, &at)?;
    }
    let mut images: BTreeMap<i64, (&Image, Points<Pixel>)> = BTreeMap::new();
    for (place, image) in dataset.images.iter().enumerate() {
        once(&mut images, image.id, (image, Points::new()), &format!("images[{place}]"))?;
    }
    for (place, annotation) in dataset.annotations.iter().enumerate() {
        let at = format!("annotations[{place}]");
        let missing = |what: String| LandmarkError::Missing { at: at.clone(), what };
        let names = categories
            .get(&annotation.category_id)
            .ok_or_else(|| missing(format!("category {}", annotation.category_id)))?;
        let (_, points) = images
            .get_mut(&annotation.image_id)
            .ok_or_else(|| missing(format!("image {}", annotation.image_id)))?;
        if annotation.keypoints.len() != 3 * names.len() {
            return Err(LandmarkError::Syntax {
                at,
                reason: format!(
                    "{} numbers of keypoints, and its category has {} keypoints of three",
                    annotation.keypoints.len(),
                    names.len()
                ),
            });
        }
        for (name, values) in names.iter().zip(annotation.keypoints.chunks_exact(3)) {
            let at = format!("{at}, `{name}`");
            match values[2] {
                0.0 => {}
                1.0 | 2.0 => points.insert(*name, pixel(values[0], values[1], &at)?, &at)?,
                other => {
                    return Err(LandmarkError::Value {
                        at,
                        value: other.to_string(),
                        expected: "a visibility of 0, 1 or 2",
                    });
                }
            }
        }
    }
    let mut films = Vec::new();
    for (image, points) in images.into_values().filter(|(_, points)| !points.is_empty()) {
        let what = format!("image {}", image.id);
        let reading = Reading { id: hint.reading.clone(), vertebrae: points.landmarks(&what)? };
        films.push(MarkedFilm {
            posture: hint.posture,
            picture: image.file_name.as_deref().map(shown),
            size: image.width.zip(image.height),
            iliac_crests: points.iliac_crests(&what)?,
            landmarks: LandmarkReadings::Corners(vec![reading]),
        });
    }
    if films.is_empty() {
        let what = "a marked keypoint".to_owned();
        return Err(LandmarkError::Missing { at: "annotations".to_owned(), what });
    }
    Ok(LandmarkFile { format: LandmarkFormat::Coco, films, remarks: Vec::new() })
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
    category.keypoints.iter().map(|name| PointName::parse(name, at)).collect()
}

fn once<T>(map: &mut BTreeMap<i64, T>, id: i64, value: T, at: &str) -> Result<(), LandmarkError> {
    match map.insert(id, value) {
        None => Ok(()),
        Some(_) => Err(LandmarkError::Duplicate {
            at: at.to_owned(),
            what: format!("id {id}"),
            first: None,
        }),
    }
}
