//! An analysis as lines and points over one of its films, in the film's pixels.

use spineline::analysis::{Analysis, FilmMovement};
use spineline::anatomy::{Level, Posture};
use spineline::clinical::endplate_line;
use spineline::curve::{CurveFit, Site, fit_curve};
use spineline::measure::{
    Film, FilmFrame, LengthScale, Outline, body_widths, endplate_centres, measure_film,
};
use spineline::number::fixed;
use spineline::spatial::{Frontal, Pixel};
use spineline::warning::Warnings;

use super::curves::{curve_text, size_of};
use crate::api::{CobbOverlay, FilmOverlay, LabelledPoint, LineOverlay, Residual, SitePoint, Wire};
use crate::result_cache::StudyResult;
use spineline_files::method_text::site_text;

/// Points of the drawn curve.
const CURVE_POINTS: u32 = 120;
/// Extension of an endplate's line to either side, in body widths.
const REACH_WIDTHS: f64 = 1.6;

/// Drawing over a complete film: all results of the study if it is analysed, else the film's curve.
pub fn of_film(result: &StudyResult, posture: Posture) -> Option<FilmOverlay> {
    let film = result.current.landmarks(posture)?;
    if let Some((analysis, measured)) =
        result.analysis().and_then(|a| a.movement.film(posture).map(|p| (a, p)))
    {
        let frame = FilmFrame::of(film, &measured.outline)?;
        let mut overlay = curve_alone(&frame, &measured.outline, &measured.fit);
        let drawing = Drawing { analysis, measured, film, frame };
        overlay.inflections = drawing.inflections();
        overlay.cobb = drawing.cobb();
        overlay.lines = drawing.lines();
        overlay.least_rotating = drawing.least_rotating();
        return Some(overlay);
    }
    let (options, _) = result.current.options.options().ok()?;
    let outline = measure_film(film, options.tilt, &mut Warnings::default()).ok()?;
    let fit = fit_curve(&outline, options.order_rule, &mut Warnings::default()).ok()?;
    Some(curve_alone(&FilmFrame::of(film, &outline)?, &outline, &fit))
}

fn px(place: Pixel) -> [f64; 2] {
    [place.column_px, place.row_px]
}

/// Where inflections can be picked on the erect curve: vertebrae and discs, caudal first; none on other films.
fn sites(frame: &FilmFrame, fit: &CurveFit, posture: Posture) -> Vec<SitePoint> {
    if posture != Posture::Erect {
        return Vec::new();
    }
    let point = |site: Site| SitePoint {
        site: site_text(site),
        px: px(frame.pixel(fit.curve.point(fit.site_mm(site)))),
    };
    fit.sites().map(point).collect()
}

fn curve_alone(frame: &FilmFrame, outline: &Outline, fit: &CurveFit) -> FilmOverlay {
    let at = |i: u32| fit.curve.end_mm() * f64::from(i) / f64::from(CURVE_POINTS - 1);
    let residuals = fit.residuals(outline);
    let residual = |residual: &spineline::curve::CurveResidual| Residual {
        level: residual.level.to_string(),
        from_px: px(frame.pixel(residual.measured)),
        to_px: px(frame.pixel(residual.on_curve)),
        text: format!(
            "{} is {} and {} from the curve",
            residual.level,
            outline.scale.residual_text(residual.distance_mm()),
            residual.tilt.abs()
        ),
        is_outlier: residual.is_outlier,
    };
    FilmOverlay {
        posture: Wire(outline.posture),
        curve_px: (0..CURVE_POINTS).map(|i| px(frame.pixel(fit.curve.point(at(i))))).collect(),
        curve_text: format!(
            "polynomial of order {}, RMSE {} and {}",
            fit.order,
            outline.scale.residual_text(fit.rmse_mm),
            fit.rmse_tilt
        ),
        inflections: Vec::new(),
        sites: sites(frame, fit, outline.posture),
        residuals: residuals.iter().map(residual).collect(),
        cobb: Vec::new(),
        lines: Vec::new(),
        least_rotating: Vec::new(),
    }
}

/// One film of an analysis.
struct Drawing<'a> {
    analysis: &'a Analysis,
    measured: &'a FilmMovement,
    film: &'a Film,
    frame: FilmFrame,
}

impl Drawing<'_> {
    fn point(&self, at: Frontal, label: &str, text: String) -> LabelledPoint {
        LabelledPoint { px: px(self.frame.nearest_pixel(at)), label: label.to_owned(), text }
    }

    /// The inflections of the erect curve at their places on this film.
    fn inflections(&self) -> Vec<LabelledPoint> {
        let pair = self.analysis.movement.inflections.pair.zip(self.measured.inflection_points);
        let Some((pair, places)) = pair else { return Vec::new() };
        let moved = self.measured.motion.is_some();
        let point = |(inflection, at): (&spineline::curve::Inflection, Frontal)| {
            let (below, above) = inflection.between;
            let between = || format!("between {below} and {above}");
            let place = inflection.vertebra.map_or_else(between, |level| format!("at {level}"));
            let when = if moved { " of the erect curve" } else { "" };
            self.point(at, "INF", format!("inflection{when} {place}"))
        };
        pair.iter().zip(places).map(point).collect()
    }

    fn least_rotating(&self) -> Vec<LabelledPoint> {
        let Some(motion) = &self.measured.motion else { return Vec::new() };
        let points = motion.least.iter().filter_map(|&segment| {
            let at = *self.measured.pose.joints.get(segment)?;
            let text = format!(
                "least-rotating segment of its window: {}°",
                fixed(motion.rotations.get(segment)?.deg(), 4)
            );
            Some(self.point(at, "MMS", text))
        });
        points.collect()
    }

    fn lines(&self) -> Vec<LineOverlay> {
        let lines = self.analysis.models.iter().filter_map(|model| {
            let simulation = model.simulation(self.measured.outline.posture)?;
            let line = &simulation.line;
            let [from, to] = self.frame.line(line.point, line.direction)?;
            let status = if simulation.is_usable() {
                let films = if simulation.fitted { "fitted" } else { "held out" };
                format!(
                    "{films}, {} mm mean location error",
                    fixed(simulation.shape.mean_location_error_mm(), 1)
                )
            } else {
                format!("{}: no result", simulation.status.key().replace('_', " "))
            };
            Some(LineOverlay {
                kind: Wire(model.kind),
                from_px: px(from),
                to_px: px(to),
                text: format!("{}: {status}", model.kind),
                converged: simulation.is_usable(),
            })
        });
        lines.collect()
    }

    /// Lines along the end vertebrae's endplates, with the angle between them.
    fn cobb(&self) -> Vec<CobbOverlay> {
        let outline = &self.measured.outline;
        let overlays = self.analysis.movement.clinical.iter().filter_map(|curve| {
            let angle = size_of(curve, outline.posture)?;
            let line = |level: Level, inferior: bool| {
                let [upper, lower] = endplate_centres(self.film, &self.frame, level)?;
                let centre = if inferior { lower } else { upper };
                let endplates = outline.vertebra(level)?.endplates?;
                let tilt = if inferior { endplates.inferior } else { endplates.superior };
                Some(endplate_line(centre, tilt, self.reach_mm()))
            };
            let upper = line(curve.ends.superior, false)?;
            let lower = line(curve.ends.inferior, true)?;
            // Beside the curve, on the side where the lines diverge.
            let left = curve.convex == Some(spineline::anatomy::Side::Left);
            let end = |line: &[Frontal; 2]| line[usize::from(left)];
            Some(CobbOverlay {
                region: curve.region.to_string(),
                upper_px: self.frame.stretch(upper)?.map(px),
                lower_px: self.frame.stretch(lower)?.map(px),
                label_px: px(self.frame.nearest_pixel((end(&upper) + end(&lower)) * 0.5)),
                label: angle.abs().to_string(),
                text: curve_text(curve, outline.posture, angle),
            })
        });
        overlays.collect()
    }

    fn reach_mm(&self) -> f64 {
        let scale: &LengthScale = &self.measured.outline.scale;
        let widths = body_widths(self.film, self.analysis.movement.levels());
        let widths: Vec<f64> = widths.into_iter().flatten().collect();
        let mean = widths.iter().sum::<f64>() / widths.len().max(1) as f64;
        REACH_WIDTHS * mean / scale.units_per_mm
    }
}
