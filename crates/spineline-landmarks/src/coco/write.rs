use serde::Serialize;
use spineline::anatomy::{Level, Posture};
use spineline::measure::{CornerName, IliacCrests, ImageGeometry, Reading, VertebraLandmarks};
use spineline::spatial::Pixel;

use super::origin_key;
use crate::film::stated_origins;
use crate::identity::Identity;
use crate::names::{CREST_LEFT, CREST_RIGHT};

/// The category of the iliac crests; categories of vertebrae count from 1, T1 first.
const CRESTS_ID: usize = Level::ALL.len() + 1;

#[derive(Serialize)]
struct Dataset {
    images: Vec<Image>,
    categories: Vec<Category>,
    annotations: Vec<Annotation>,
}

#[derive(Serialize)]
struct Image {
    id: usize,
    file_name: String,
    width: u32,
    height: u32,
    spineline: Identity,
}

#[derive(Serialize)]
struct Category {
    id: usize,
    name: &'static str,
    supercategory: &'static str,
    keypoints: Vec<&'static str>,
    /// Pairs of keypoints to join, counted from 1.
    skeleton: Vec<[usize; 2]>,
}

#[derive(Serialize)]
struct Annotation {
    id: usize,
    image_id: usize,
    category_id: usize,
    keypoints: Vec<f64>,
    num_keypoints: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    keypoint_scores: Option<[f64; 4]>,
    /// Column, row, width and height of the box around the points.
    bbox: [f64; 4],
    area: f64,
    iscrowd: u8,
    #[serde(skip_serializing_if = "Option::is_none")]
    attributes: Option<serde_json::Map<String, serde_json::Value>>,
    spineline: Identity,
}

/// A film as its dataset has it.
pub struct CocoFilm<'a> {
    pub posture: Posture,
    pub image: &'a ImageGeometry,
    pub picture: String,
    pub iliac_crests: Option<IliacCrests>,
    pub readings: &'a [Reading<VertebraLandmarks>],
}

/// All films as one dataset of keypoints.
pub fn write(films: Vec<CocoFilm<'_>>) -> String {
    let (mut images, mut annotations) = (Vec::new(), Vec::new());
    for (place, film) in films.into_iter().enumerate() {
        let image_id = place + 1;
        for reading in film.readings {
            for (&level, landmark) in &reading.vertebrae {
                let identity = Identity::default().with_reading(&reading.id);
                let points = landmark.corners.points();
                let id = annotations.len() + 1;
                annotations.push(Annotation {
                    keypoint_scores: landmark.confidence.map(|corners| corners.points()),
                    attributes: stated_origins(landmark).map(|origins| {
                        let keys = origins.map(|origin| serde_json::Value::from(origin.key()));
                        CornerName::ALL.map(origin_key).into_iter().zip(keys).collect()
                    }),
                    ..Annotation::new(id, image_id, category(level), &points, identity)
                });
            }
        }
        if let Some(crests) = film.iliac_crests {
            let points = [crests.left, crests.right];
            let (id, identity) = (annotations.len() + 1, Identity::default());
            annotations.push(Annotation::new(id, image_id, CRESTS_ID, &points, identity));
        }
        images.push(Image {
            id: image_id,
            file_name: film.picture,
            width: film.image.columns,
            height: film.image.rows,
            spineline: Identity::of_film(film.posture),
        });
    }
    let dataset = Dataset { images, categories: categories(), annotations };
    spineline_files::to_text(&dataset)
}

fn category(level: Level) -> usize {
    Level::ALL.len() - level as usize
}

fn categories() -> Vec<Category> {
    let vertebrae = Level::ALL.into_iter().rev().map(|level| Category {
        id: category(level),
        name: level.name(),
        supercategory: "vertebra",
        keypoints: CornerName::ALL.map(CornerName::key).to_vec(),
        skeleton: vec![[1, 2], [2, 4], [4, 3], [3, 1]],
    });
    let crests = Category {
        id: CRESTS_ID,
        name: "iliac_crests",
        supercategory: "pelvis",
        keypoints: vec![CREST_LEFT, CREST_RIGHT],
        skeleton: vec![[1, 2]],
    };
    vertebrae.chain([crests]).collect()
}

impl Annotation {
    /// Points without scores and origins.
    fn new(
        id: usize,
        image_id: usize,
        category_id: usize,
        points: &[Pixel],
        spineline: Identity,
    ) -> Self {
        let range = |value: fn(&Pixel) -> f64| {
            let values = points.iter().map(value);
            let low = values.clone().fold(f64::INFINITY, f64::min);
            (low, values.fold(f64::NEG_INFINITY, f64::max) - low)
        };
        let (column, width) = range(|point| point.column_px);
        let (row, height) = range(|point| point.row_px);
        /// Placed and visible.
        const VISIBLE: f64 = 2.0;
        let keypoints = points.iter().flat_map(|p| [p.column_px, p.row_px, VISIBLE]);
        Self {
            id,
            image_id,
            category_id,
            keypoints: keypoints.collect(),
            num_keypoints: points.len(),
            keypoint_scores: None,
            bbox: [column, row, width, height],
            area: width * height,
            iscrowd: 0,
            attributes: None,
            spineline,
        }
    }
}
