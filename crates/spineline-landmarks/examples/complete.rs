//! Completes corners of films from clicks: JSON in, JSON out. `validation/landmarks` judges the output.
//!
//! In: `{"table": "text of a shape table, or null", "films": [{"columns", "rows", "clicks": [[level, mark, column, row], …],
//! "erect": clicks on the erect film of the same size, or null, "is_bend": true if the joints turned since}, …]}`; marks are corners (`superior_left`), `left_wall`, `right_wall`, `superior_endplate`, `inferior_endplate`, `centre`, and `midline` (of any
//! level). The patient's left is on the right of the picture. Out, per film: `{level: {"corners": [[column, row] × 4], "sd": px}}`.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};

use serde::Deserialize;
use spineline::anatomy::{ImageSide, Level, Posture, Side};
use spineline::measure::ImageGeometry;
use spineline::measure::completion::{
    Click, Clicks, Mark, ShapeModel, complete, complete_by, provide_shape,
};
use spineline::spatial::Pixel;

#[derive(Deserialize)]
struct Request {
    table: Option<String>,
    films: Vec<Film>,
}

#[derive(Deserialize)]
struct Film {
    columns: u32,
    rows: u32,
    clicks: Vec<JsonClick>,
    erect: Option<Vec<JsonClick>>,
    #[serde(default)]
    is_bend: bool,
}

/// Level, mark, column and row.
type JsonClick = (String, String, f64, f64);

fn main() -> io::Result<()> {
    provide_shape(spineline_weights::ERECT_SPINES);
    let mut text = String::new();
    io::stdin().read_to_string(&mut text)?;
    let request: Request = serde_json::from_str(&text)?;
    let model = match &request.table {
        Some(table) => Some(
            ShapeModel::of_erect(table)
                .ok_or_else(|| io::Error::other("this is not a shape table"))?,
        ),
        None => None,
    };
    let films: Vec<_> = request.films.iter().map(|film| completed(film, model.as_ref())).collect();
    io::stdout().write_all(&serde_json::to_vec(&films)?)
}

/// Corners and deviation of every level; `null` where the clicks are not enough.
fn completed(
    film: &Film,
    model: Option<&ShapeModel>,
) -> Option<BTreeMap<String, serde_json::Value>> {
    let &Film { columns, rows, .. } = film;
    let patient_left = ImageSide::Right;
    let image = ImageGeometry { columns, rows, spacing: None, patient_left };
    let clicks = clicks_of(&film.clicks)?;
    let found = match (&film.erect, model) {
        (Some(erect), _) => {
            let model = ShapeModel::of_patient(&image, &clicks_of(erect)?, &image).ok()?;
            complete_by(&model, &image, &clicks)
        }
        (None, Some(model)) => complete_by(model, &image, &clicks),
        (None, None) => complete(&image, (!film.is_bend).then_some(Posture::Erect), &clicks),
    };
    let found = found.ok()?;
    let of = |level: Level| {
        let corners = found.corners_px(&image, level).points();
        let corners = corners.map(|corner| [corner.column_px, corner.row_px]);
        (level.to_string(), serde_json::json!({ "corners": corners, "sd": found.sd_mm(level) }))
    };
    Some(Level::ALL.into_iter().map(of).collect())
}

fn clicks_of(given: &[JsonClick]) -> Option<Clicks> {
    let mut clicks = Clicks::default();
    for (level, mark, column, row) in given {
        let place = Pixel::new(*column, *row);
        let mark = match mark.as_str() {
            "midline" => {
                clicks.midline.push(place);
                continue;
            }
            "left_wall" => Mark::Wall(Side::Left),
            "right_wall" => Mark::Wall(Side::Right),
            "superior_endplate" => Mark::SuperiorEndplate,
            "inferior_endplate" => Mark::InferiorEndplate,
            "centre" => Mark::Centre,
            corner => Mark::Corner(corner.parse().ok()?),
        };
        let level = Level::ALL.into_iter().find(|one| one.name() == level)?;
        clicks.vertebrae.push(Click { level, mark, place });
    }
    Some(clicks)
}
