//! Results from the films: landmarks, curve, movement, and line of action.

use spineline::analysis::{Analysis, FilmMovement, LineComparison, Movement};
use spineline::anatomy::Posture;
use spineline::clinical::{Balance, ClinicalCurve, CobbEnds};
use spineline::measure::{Interpolation, MeasuredVertebra, Outline};
use spineline::motion::SegmentEstimate;
use spineline::number::{fixed, probability};
use spineline::warning::counted;

use super::Patient;
use crate::document::{Figure, Section, Table};
use crate::figures::{self, InflectionSample};
use crate::phrases::{GIVE_SCALE, films_without_scale, none};

/// Films with everything on them, the curve, and clinical angles.
pub fn films(patient: &Patient<'_>) -> Section {
    let analysis = patient.analysis;
    let mut section = Section::new("films", "Films");
    let svg = figures::films(patient.case, analysis, patient.pictures);
    let pictures = match patient.pictures.len() {
        0 => "No image of a film was available: landmarks alone are shown.".to_owned(),
        n => format!("{n} of {} with images.", counted(analysis.movement.films.len(), "film")),
    };
    let caption = format!(
        "Films with landmarks, fitted curve, inflections and candidate lines of action. {pictures}"
    );
    section.figure(Figure::new("films", caption, svg).on_whole_page());
    for sentence in curve_sentences(analysis) {
        section.paragraph(sentence);
    }
    section.table(clinical(analysis));
    section.paragraph(format!("{}. {}.", analysis.balance_words(), analysis.lenke_words()));
    if analysis.movement.balance.is_some() {
        section.paragraph(format!("{}.", Balance::MISSING));
    }
    section.table(curves(analysis));
    section
}

/// How the erect curve turns, where it inflects, the chain, and the scales of the films.
pub fn curve_sentences(analysis: &Analysis) -> Vec<String> {
    let scale = analysis.movement.scale();
    let segment_mm = analysis.movement.chain.segment_mm;
    let segment = scale
        .px(segment_mm)
        .map_or_else(|| scale.text(segment_mm, 4), |px| format!("{} px", fixed(px, 3)));
    let curve = analysis.inflection_words();
    let chain = format!("Chain of {} segments of {segment}.", analysis.movement.chain.segments);
    let scales = analysis.film_scale_words().map(|words| format!("{words}."));
    curve.lines().map(|line| format!("{line}.")).chain([chain]).chain(scales).collect()
}

/// How well the vertebrae of the erect film are measured.
pub fn noise_words(analysis: &Analysis) -> String {
    let outline = &analysis.movement.erect().outline;
    let noise = outline.noise;
    let from = match noise.tilt_degrees_of_freedom {
        Some(_) => format!("erect film, {}", counted(outline.readings, "reading")),
        None => "assumed, since one reading does not show it".to_owned(),
    };
    format!(
        "Noise of a vertebra: {} and {}° (SD; {from}).",
        outline.scale.residual_text(noise.location_mm),
        fixed(noise.tilt.deg(), 1)
    )
}

/// Clinical angles of every curve on every film.
pub fn clinical(analysis: &Analysis) -> Table {
    let curves = &analysis.movement.clinical;
    let cobb = curves.iter().all(ClinicalCurve::has_cobb);
    let name = if cobb { "Cobb" } else { "Tilt range" };
    let caption = if cobb { "Cobb angles" } else { "Tilt ranges" };
    let mut table = Table::of(caption, curves, |add| {
        add.words("Curve", |curve| curve.region.to_string());
        add.words("Convex", |curve| curve.convex.map_or_else(none, |side| side.to_string()));
        add.words("Ends", |curve| format!("{}–{}", curve.ends.superior, curve.ends.inferior));
        add.words("Apex", |curve| curve.apex.to_string());
        for posture in analysis.movement.films.iter().map(|p| p.outline.posture) {
            add.numbers(format!("{name} {posture} (°)"), |curve| {
                let sign = curve.erect_size().rad().signum();
                let hidden = ends_interpolated(analysis, posture, curve.ends);
                let mark = if hidden { " ~" } else { "" };
                let size = curve.size_in(posture);
                size.map_or_else(none, |angle| format!("{}{mark}", fixed(angle.deg() * sign, 1)))
            });
        }
        add.numbers("Flexibility (%)", |curve| {
            curve.flexibility.map_or_else(none, |f| fixed(100.0 * f, 0))
        });
    });
    let what = if cobb {
        "Superior endplate of the upper against inferior endplate of the lower end vertebra."
    } else {
        "Cobb angles need the corners of the vertebrae, which are not known: a tilt range is the difference of the tilts of the end vertebrae."
    };
    table.note = format!(
        "{what} Positive in the direction of the erect curve: a negative angle is convex to the other side."
    );
    if let Some(whole) = &analysis.movement.whole_curve {
        table.note.push_str(&format!(
            " The limits of these curves are usual vertebrae and not inflections: a curve may continue in the next row. The two vertebrae that turn most against each other are {} and {}: {}.",
            whole.ends.superior,
            whole.ends.inferior,
            whole.erect_size().abs()
        ));
    }
    if table.rows.iter().flatten().any(|cell| cell.ends_with(" ~")) {
        table.note.push_str(" ~: ends at an interpolated vertebra.");
    }
    table
}

/// Whether a film does not show one of a curve's end vertebrae, which may lie outside of the model.
fn ends_interpolated(analysis: &Analysis, posture: Posture, ends: CobbEnds) -> bool {
    let film = analysis.movement.readings.iter().find(|film| film.posture == posture);
    let is_marked = |level| film.is_some_and(|film| film.marks(level));
    !is_marked(ends.inferior) || !is_marked(ends.superior)
}

/// The amplitude of a film, with the vertebrae between which it is measured if these are not the ends of the model, and with its
/// reference if this is not the iliac line.
pub fn amplitude(film: &Outline) -> String {
    let [lower, upper] = film.amplitude_levels();
    let base = film.levels().base();
    let ends = ([lower, upper] != [base, film.levels().top()]).then(|| format!("{lower}–{upper}"));
    let axis = film.iliac_normal.is_none().then(|| format!("against {base}'s axis"));
    let remarks: Vec<String> = ends.into_iter().chain(axis).collect();
    let leaning = film.amplitude().leaning();
    if remarks.is_empty() { leaning } else { format!("{leaning} ({})", remarks.join(" ")) }
}

/// The curve of every film, and its movement.
pub fn curves(analysis: &Analysis) -> Table {
    let levels = analysis.movement.levels();
    let caption = "Fitted curves and their movement from the erect film";
    let mut table = Table::of(caption, &analysis.movement.films, |add| {
        add.words("Film", |p| p.outline.posture.to_string());
        let [base, top] = [levels.base(), levels.top()];
        add.words(format!("Lateral tilt of {base}–{top} against the iliac normal"), |p| {
            amplitude(&p.outline)
        });
        add.numbers("Order of the curve", |p| p.fit.order.to_string());
        add.words("Residual of locations", |p| p.outline.scale.residual_text(p.fit.rmse_mm));
        add.numbers("Residual of tilts (°)", |p| fixed(p.fit.rmse_tilt.deg(), 2));
        add.numbers("Readings", |p| p.outline.readings.to_string());
        add.numbers("Mean rotation (°)", |p| {
            p.mean_rotation().map_or_else(none, |rotation| fixed(rotation.deg(), 4))
        });
        add.words("Inflections to the least-rotating segments (segments)", |p| {
            p.inflection_estimates.map_or_else(none, |[caudal, cranial]| {
                format!("{}, {}", caudal.distance_segments, cranial.distance_segments)
            })
        });
    });
    table.note = interpolated_words(analysis);
    table
}

/// The interpolated vertebrae of every film; empty without any.
fn interpolated_words(analysis: &Analysis) -> String {
    let on_film = |p: &FilmMovement| {
        let scale = &p.outline.scale;
        let words = |(vertebra, found): (&MeasuredVertebra, &Interpolation)| {
            let sd = scale.text(found.location_sd_mm, 1);
            format!("{} (sd {sd}, {})", vertebra.level, found.tilt_sd)
        };
        let names: Vec<String> = p.outline.interpolated().map(words).collect();
        (!names.is_empty()).then(|| format!("{}: {}", p.outline.posture, names.join(", ")))
    };
    let films: Vec<String> = analysis.movement.films.iter().filter_map(on_film).collect();
    if films.is_empty() {
        return String::new();
    }
    format!("Interpolated, not marked: {}.", films.join("; "))
}

/// Figures 5 and 6 of the paper.
pub fn movement(analysis: &Analysis) -> Section {
    let mut section = Section::new("movement", "Movement of the spine");
    let Some(svg) = figures::rotations(analysis) else {
        section.paragraph("Only the erect film is available: it shows no movement.");
        return section;
    };
    let caption = "Rotation of every segment of the chain from the erect to every other posture (figure 5 of the paper).";
    section.figure(Figure::new("rotations", caption, svg));
    let estimates: Vec<(String, usize, &SegmentEstimate)> = analysis
        .movement
        .films
        .iter()
        .filter_map(|p| Some((p, p.inflection_estimates.as_ref()?)))
        .flat_map(|(p, pair)| {
            let names = pair.iter().enumerate();
            names.map(move |(i, estimate)| (p.outline.posture.to_string(), i, estimate))
        })
        .collect();
    if estimates.is_empty() {
        section.paragraph(
            "The erect curve has no pair of inflections to compare with the least-rotating segments.",
        );
        return section;
    }
    let of_pairs = |p: &&FilmMovement| p.inflection_estimates.is_some();
    let films = analysis.movement.films.iter().filter(of_pairs).count();
    let sample = InflectionSample {
        name: format!("both inflections on {}", counted(films, "film")),
        distances_segments: estimates.iter().map(|(.., e)| e.distance_segments as f64).collect(),
        rotations_deg: estimates.iter().map(|(.., e)| e.rotation.deg()).collect(),
    };
    let id = Some(analysis.case_id.as_str());
    if let Some(svg) = figures::inflection_distances(&[sample], id, false, analysis.synthetic) {
        let caption =
            "Inflection segments against the least-rotating segments (figure 6 of the paper).";
        section.figure(Figure::new("inflections", caption, svg));
    }
    let caption = "Inflection segments and least-rotating segments";
    section.table(Table::of(caption, estimates, |add| {
        add.words("Film", |(posture, ..)| posture.clone());
        add.words("Inflection", |(_, i, _)| ["caudal", "cranial"][*i]);
        add.numbers("Inflection segment", |(.., e)| e.segment.to_string());
        add.numbers("Least-rotating segment", |(.., e)| e.least.to_string());
        add.numbers("Distance (segments)", |(.., e)| e.distance_segments.to_string());
        add.words("Distance", |(.., e)| analysis.movement.scale().text(e.distance_mm, 2));
        add.numbers("Rotation (°)", |(.., e)| fixed(e.rotation.deg(), 4));
    }));
    section
}

/// Figure 7 of the paper, with the line of best fit to the rotations of every film.
pub fn line(analysis: &Analysis) -> Section {
    let mut section = Section::new("line", "Identification of the line of action");
    let Some(svg) = figures::line_identification(analysis) else {
        section.paragraph(if analysis.movement.films.iter().all(|p| p.motion.is_none()) {
            "Only the erect film is available: no line can be identified."
        } else {
            "No line can be identified: the erect curve has no pair of inflections, and no film has a line of best fit to the rotations."
        });
        return section;
    };
    let best_fits = analysis.movement.films.iter().any(|p| p.best_fit_line.is_some());
    let lines = if best_fits {
        "The line through the inflections, and the line of best fit to the joints' rotations on each film"
    } else {
        "The line through the inflections on each film"
    };
    section.figure(Figure::new("line", format!("{lines} (after figure 7 of the paper)."), svg));
    if let (false, Some(films)) = (best_fits, films_without_scale(analysis)) {
        section.paragraph(format!("The line of best fit to the rotations is not computed: without a scale ({films}) its place in millimetres is not known. {GIVE_SCALE}"));
    }
    let mut table = best_fit(analysis);
    table.note = format!(
        "In brackets the 95 % confidence interval of each place alone; negative is right. {}",
        table.note
    );
    section.table(table);
    section
}

/// The line of best fit to the rotations of every film, and its tests against the candidate lines.
pub fn best_fit(analysis: &Analysis) -> Table {
    let films = analysis.movement.films.iter();
    let found = films.filter_map(|p| Some((p.outline.posture, p.best_fit_line.as_ref()?)));
    let mut table = Table::of("Line of best fit to the rotations of each film", found, |add| {
        add.words("Film", |(posture, _)| posture.to_string());
        add.words("Lateral tilt of the line", |(_, one)| one.line.lateral_tilt().leaning());
        for (place, height) in heights_of_lines(&analysis.movement).into_iter().enumerate() {
            add.words(format!("At {height} (mm left)"), move |(_, one)| {
                one.crossings[place].to_string()
            });
        }
        add.words("p: through both inflections", |(_, one)| p_value(one.inflection));
        add.words("p: parallel to the iliac line", |(_, one)| p_value(one.iliac));
        if !analysis.options.given_lines.is_empty() {
            add.words("p: the given line", |(_, one)| p_value(one.given));
        }
    });
    if let Some(found) = analysis.movement.films.iter().find_map(|p| p.best_fit_line.as_ref()) {
        table.note = format!(
            "p below 0.05 rejects the line. Joints of a region differ in stiffness by {} % on these films.",
            fixed(100.0 * found.joint_log_sd, 0)
        );
    }
    table
}

/// At which heights the places of lines of best fit are given: of the inflections, or of the ends of the model on a spine without two.
fn heights_of_lines(movement: &Movement) -> [String; 2] {
    if movement.inflection_segments.is_some() {
        return ["caudal", "cranial"].map(|end| format!("the {end} inflection"));
    }
    let levels = movement.levels();
    [levels.base(), levels.top()].map(|level| level.to_string())
}

fn p_value(found: Option<LineComparison>) -> String {
    found.map_or_else(none, |found| probability(found.test.p_value))
}
