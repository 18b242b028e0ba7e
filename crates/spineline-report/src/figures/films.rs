//! The films of one patient as they were taken, with all landmarks and results on them.

use kuva::render::render::Primitive;
use spineline::action::{LineKind, LineOfAction};
use spineline::analysis::{Analysis, Case, FilmMovement};
use spineline::anatomy::{Level, Posture};
use spineline::measure::{Film, FilmFrame, FilmLandmarks, Outline, VertebraLandmarks};
use spineline::spatial::{Frontal, Pixel};

use super::frontal::{
    Extent, VIEW, axes_of_row, drawn, film_panel, fitted_curve, frame_px, scale_note,
};
use super::page::Page;
use super::panel::{Panel, Picture};
use super::style::{
    BLACK, GREY, Ink, Marker, ORANGE, PAGE_WIDTH_PX, Shape, VERMILLION, action_ink,
};

/// Room around the landmarks, as a part of their height.
const ROOM: f64 = 0.06;

pub(super) const BODY: Ink = Ink::new(GREY, "", 1.0);
const CURVE: Ink = Ink::new(BLACK, "", 2.0);
const CREST: Ink = Ink::new(VERMILLION, "", 1.4);
const MIDPOINT: Marker = Marker { radius_px: 2.6, ..Marker::new(Shape::Circle, BLACK, false) };
const INFLECTION: Marker = Marker { radius_px: 4.6, ..Marker::new(Shape::Diamond, ORANGE, true) };

/// The picture of a film.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilmPicture {
    /// Its posture.
    pub posture: Posture,
    /// The whole film as a PNG file, of any size.
    pub png: Vec<u8>,
}

/// How the films of a case share a page, so that any number of them fills it.
#[derive(Debug, Clone, Copy)]
struct Arrangement {
    per_row: usize,
    page_px: f64,
    tall_px: f64,
}

impl Arrangement {
    const fn of(films: usize) -> Self {
        let (per_row, page_px, tall_px) = match films {
            0 | 1 => (1, 640.0, 760.0),
            2 => (2, PAGE_WIDTH_PX, 590.0),
            4 => (2, PAGE_WIDTH_PX, 470.0),
            _ => (3, PAGE_WIDTH_PX, 400.0),
        };
        Self { per_row, page_px, tall_px }
    }
}

/// Coordinates on a film that is displayed upright: `-y` and `z` from L4's midpoint.
pub(super) struct Displayed<'a> {
    pub film: &'a Film,
    pub outline: &'a Outline,
    pub frame: Option<FilmFrame>,
}

impl<'a> Displayed<'a> {
    pub fn of(film: &'a Film, outline: &'a Outline) -> Self {
        Self { film, outline, frame: FilmFrame::of(film, outline) }
    }

    /// A point of the analysis.
    pub fn place(&self, point: Frontal) -> Frontal {
        point.rotated(self.outline.l4_on_film)
    }

    fn pixel(&self, frame: &FilmFrame, place: Pixel) -> Frontal {
        self.place(frame.point(place))
    }

    fn line(&self, line: &LineOfAction) -> LineOfAction {
        let [from, to] = [line.point, line.point + line.direction].map(|p| self.place(p));
        let along = to - from;
        let direction = along * (1.0 / along.norm_mm());
        LineOfAction { point: from, direction, application: line.application }
    }

    pub fn marks(&self) -> impl Iterator<Item = (&'a Level, &'a VertebraLandmarks)> {
        let readings = self.film.landmarks.corner_readings();
        readings.iter().flat_map(|reading| &reading.vertebrae)
    }

    pub fn corners(&self, mark: &VertebraLandmarks) -> Option<[Frontal; 4]> {
        let frame = self.frame.as_ref()?;
        let c = mark.corners.map(|corner| self.pixel(frame, corner));
        Some([c.superior_left, c.superior_right, c.inferior_right, c.inferior_left])
    }

    fn crests(&self) -> Option<[Frontal; 2]> {
        let FilmLandmarks::Corners { iliac_crests, .. } = &self.film.landmarks else { return None };
        let crests = iliac_crests.as_ref()?;
        let frame = self.frame.as_ref()?;
        Some([crests.left, crests.right].map(|tip| self.pixel(frame, tip)))
    }

    fn extent(&self) -> Extent {
        let corners = self.marks().filter_map(|(_, mark)| self.corners(mark)).flatten();
        let locations = self.outline.locations().map(|p| self.place(p));
        let points: Vec<Frontal> = corners.chain(locations).collect();
        let bare = Extent::around(points);
        let room = ROOM * bare.height_mm();
        bare.grown([2.0 * room, room])
    }
}

/// The films of one patient: landmarks of all readings, fitted curve, inflections, iliac crests and lines of action, over the
/// available pictures.
#[must_use]
pub fn films(case: &Case, analysis: &Analysis, pictures: &[FilmPicture]) -> String {
    let title = format!("Films with landmarks, curve, inflections and lines, case {}", case.id);
    let mut page = Page::new(title, analysis.synthetic);
    let base = analysis.movement.levels().base();
    page.notes.push(format!(
        "{VIEW} Films are shown as they were taken; {base}'s midpoint is at the origin."
    ));
    if analysis.movement.films.iter().any(|posture| posture.outline.length.is_free()) {
        page.notes.push("Films are drawn at the length of the erect film.".to_owned());
    }
    page.notes.extend(scale_note(analysis));
    let displayed: Vec<(Displayed<'_>, &FilmMovement)> = analysis
        .movement
        .films
        .iter()
        .filter_map(|p| {
            let film = case.film(p.outline.posture)?;
            Some((Displayed::of(film, &p.outline), p))
        })
        .collect();
    legend(&mut page, analysis, &displayed);
    let arrangement = Arrangement::of(displayed.len());
    page.width_px = arrangement.page_px;
    let rows: Vec<_> = displayed.chunks(arrangement.per_row).collect();
    let axes: Vec<Vec<bool>> =
        rows.iter().map(|row| axes_of_row(row.iter().map(|(film, _)| film.outline))).collect();
    let widths = axes.iter().map(|axes| frame_px(page.inner_px(), axes, arrangement.per_row));
    let wide_px = widths.fold(f64::INFINITY, f64::min);
    let frames = Frames::of(&displayed, [wide_px, arrangement.tall_px]);
    for (row, axes) in rows.into_iter().zip(axes) {
        let panel = |(shown, written): (&(Displayed<'_>, &FilmMovement), bool)| {
            let (film, posture) = shown;
            let mut panel = frames.panel(film, written);
            let picture = pictures.iter().find(|p| p.posture == film.outline.posture);
            panel.picture = picture.and_then(|picture| placed(&panel, film, picture));
            fill(&mut panel, film, analysis, posture);
            panel
        };
        page.rows.push(row.iter().zip(axes).map(panel).collect());
    }
    page.into_svg()
}

fn legend(page: &mut Page, analysis: &Analysis, displayed: &[(Displayed<'_>, &FilmMovement)]) {
    if displayed.iter().any(|(film, _)| film.marks().next().is_some()) {
        page.entry(BODY, "marked corners, every reading");
    }
    page.entry(MIDPOINT, "midpoints, mean of readings");
    page.entry(CURVE, "fitted curve");
    if analysis.movement.inflection_segments.is_some() {
        page.entry(INFLECTION, "inflections of the erect curve");
    }
    if displayed.iter().any(|(film, _)| film.crests().is_some()) {
        page.entry(CREST, "iliac crests");
    }
    for model in &analysis.models {
        page.entry(action_ink(model.kind), model.kind.to_string());
    }
}

/// Frames of one size, at one scale and over the same heights, so that films can be compared and a row needs one axis. A
/// film without a scale is taken at the length of the erect one.
struct Frames {
    z_mm: [f64; 2],
    wide_mm: f64,
    px_per_mm: f64,
}

impl Frames {
    /// The largest scale at which all landmarks of every film lie in a frame of at most this width and height.
    fn of(displayed: &[(Displayed<'_>, &FilmMovement)], [wide_px, tall_px]: [f64; 2]) -> Self {
        let extents = || displayed.iter().map(|(film, _)| film.extent());
        let all = extents().reduce(Extent::union).unwrap_or_else(|| Extent::of([]));
        let widest = extents().map(|extent| extent.width_mm()).fold(0.0, f64::max);
        let px_per_mm = (tall_px / all.height_mm()).min(wide_px / widest.max(f64::MIN_POSITIVE));
        Self { z_mm: all.z_mm, wide_mm: wide_px / px_per_mm, px_per_mm }
    }

    fn panel(&self, film: &Displayed<'_>, y_written: bool) -> Panel {
        let mut extent = film.extent().at_least_wide(self.wide_mm);
        extent.z_mm = self.z_mm;
        film_panel(film.outline, extent, self.px_per_mm, y_written)
    }
}

fn placed(panel: &Panel, film: &Displayed<'_>, picture: &FilmPicture) -> Option<Picture> {
    let frame = film.frame.as_ref()?;
    let image = frame.image();
    let [columns, rows] = [image.columns, image.rows].map(f64::from);
    let ends = [Pixel::new(-0.5, -0.5), Pixel::new(columns - 0.5, rows - 0.5)];
    let corners_px = ends.map(|end| panel.place(film.pixel(frame, end)));
    Some(Picture { png: picture.png.clone(), corners_px })
}

fn fill(panel: &mut Panel, film: &Displayed<'_>, analysis: &Analysis, posture: &FilmMovement) {
    let at = |point: Frontal| drawn(film.place(point));
    let bodies: Vec<Primitive> = film
        .marks()
        .filter_map(|(_, mark)| film.corners(mark))
        .map(|[a, b, c, d]| panel.trace(BODY, [a, b, c, d, a].map(drawn)))
        .collect();
    if !bodies.is_empty() {
        panel.layer("marked corners", bodies);
    }
    if let Some(line) = film.crests().and_then(|tips| within(panel, tips.map(drawn))) {
        panel.curve_layer("iliac crests", CREST, line);
    }
    for model in &analysis.models {
        line_layer(panel, film, model.kind, posture, analysis);
    }
    panel.curve_layer("fitted curve", CURVE, fitted_curve(posture).map(at));
    let marker = |panel: &Panel, marker: Marker, place: (f64, f64)| {
        let (x, y) = panel.px(place.0, place.1);
        marker.at(x, y)
    };
    let midpoints: Vec<Primitive> =
        film.outline.locations().map(|p| marker(panel, MIDPOINT, at(p))).collect();
    panel.layer("midpoints", midpoints);
    if let Some(points) = posture.inflection_points {
        let marks = points.map(|p| marker(panel, INFLECTION, at(p)));
        panel.layer("inflections", marks);
    }
}

/// The part of a stretch between the left and right sides of the frame.
fn within(panel: &Panel, [a, b]: [(f64, f64); 2]) -> Option<[(f64, f64); 2]> {
    let (left, right) = if a.0 < b.0 { (a, b) } else { (b, a) };
    let [from, to] = [left.0.max(panel.x.range[0]), right.0.min(panel.x.range[1])];
    let height = |x: f64| left.1 + (right.1 - left.1) * (x - left.0) / (right.0 - left.0);
    let inside = |z: f64| (panel.y.range[0]..=panel.y.range[1]).contains(&z);
    let ends = [from, to].map(|x| (x, height(x)));
    (from < to && ends.iter().all(|end| inside(end.1))).then_some(ends)
}

fn line_layer(
    panel: &mut Panel,
    film: &Displayed<'_>,
    kind: LineKind,
    posture: &FilmMovement,
    analysis: &Analysis,
) {
    let model = analysis.model(kind);
    let simulation = model.and_then(|model| model.simulation(posture.outline.posture));
    let mark = simulation
        .and_then(|simulation| panel.action_mark(&film.line(&simulation.line), action_ink(kind)));
    if let Some(mark) = mark {
        panel.layer(&kind.to_string(), [mark]);
    }
}
