//! Samples of a cohort: distances, rotations and location errors.

use spineline::action::LineKind;
use spineline::cohort::{Cohort, EstimateStatistics};

use super::boxes::{Column, RULE, box_panel, paper_entry};
use super::page::{Page, Sample};
use super::panel::{Axis, HeadingKind, Panel};
use super::style::{FILLS, Ink, VERMILLION, action_fill, outlined};
use crate::paper::{INFLECTION_ROTATION_DEG, NEAR_SHARES_PERCENT, PaperMean};

/// Inflection segments of one group of cases against the least-rotating ones.
#[derive(Debug, Clone, PartialEq)]
pub struct InflectionSample {
    /// Name of the group, such as the loading scenario of its phantoms.
    pub name: String,
    /// Distances between inflection and least-rotating segment, in segments: one per posture and window.
    pub distances_segments: Vec<f64>,
    /// Rotations of the inflection segments, in degrees.
    pub rotations_deg: Vec<f64>,
}

/// One estimate of the least-rotating segment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EstimateSample {
    /// Distances to the least-rotating segment, in segments.
    pub distances_segments: Vec<f64>,
    /// Rotations of the chosen segment, in degrees.
    pub rotations_deg: Vec<f64>,
}

/// Both choices over one group of postures.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateGroup {
    /// Name of the group, such as `left and right bending` or `neutral and traction`.
    pub name: String,
    /// The inflection segments (the paper's INF).
    pub inflection: EstimateSample,
    /// The mean of the least-rotating segments of both bends (the paper's MMS_Mean).
    pub mean_least: EstimateSample,
}

impl EstimateGroup {
    /// Bends, and the other films, of a cohort.
    #[must_use]
    pub fn of(cohort: &Cohort) -> [Self; 2] {
        let sample = |found: &EstimateStatistics| EstimateSample {
            distances_segments: found.all_distances_segments.clone(),
            rotations_deg: found.all_rotations_deg.clone(),
        };
        let group = |name: &str, films: usize| Self {
            name: name.to_owned(),
            inflection: sample(&cohort.inflection[films + 1]),
            mean_least: sample(&cohort.mean_least[films]),
        };
        [group("bends", 0), group("neutral and traction", 1)]
    }
}

/// Location errors of one model over one group of cases.
#[derive(Debug, Clone, PartialEq)]
pub struct LocationErrorSample {
    /// Name of the group, such as the loading scenario of its phantoms.
    pub group: String,
    /// The line of action of the model.
    pub line: LineKind,
    /// Errors, in millimetres: one per vertebra and film.
    pub errors_mm: Vec<f64>,
    /// The paper's mean over the same kind of films.
    pub paper: Option<PaperMean>,
}

/// Bins of the distance in segments: name, greatest distance.
const BINS: [(&str, f64); 7] = [
    ("0", 0.5),
    ("1", 1.5),
    ("2", 2.5),
    ("3–5", 5.5),
    ("6–10", 10.5),
    ("11–20", 20.5),
    (">20", f64::INFINITY),
];

/// A share of the paper.
const SHARE: Ink = Ink::new(VERMILLION, "", 2.2);

/// Whether a sample has something to draw.
fn has_values(values: &[f64]) -> bool {
    values.iter().any(|value| value.is_finite())
}

/// Distances of inflection segments from least-rotating ones and their rotations, like figure 6 of the paper. Groups without
/// values are left out; `None` where no group has any. The title names the one case that the samples are of. `with_paper` draws
/// the paper's values beside them.
#[must_use]
pub fn inflection_distances(
    samples: &[InflectionSample],
    case: Option<&str>,
    with_paper: bool,
    synthetic: bool,
) -> Option<String> {
    let samples: Vec<&InflectionSample> = samples
        .iter()
        .filter(|sample| {
            has_values(&sample.distances_segments) && has_values(&sample.rotations_deg)
        })
        .collect();
    if samples.is_empty() {
        return None;
    }
    let case = case.map_or_else(String::new, |id| format!(", case {id}"));
    let title = format!("Inflection segments and least-rotating segments{case}");
    let mut page = Page::new(title, synthetic);
    let n = "n counts both inflections on every film.";
    page.notes.push(format!("From the erect to all other postures; {n} {RULE}"));
    for (sample, fill) in samples.iter().zip(FILLS.iter().cycle()) {
        let n = sample.distances_segments.iter().filter(|d| d.is_finite()).count();
        page.entry(Sample::Fill(fill), format!("{} (n = {n})", sample.name));
    }
    if with_paper {
        page.entry(SHARE, "the paper: share");
        paper_entry(&mut page);
    }
    let mut bars = distance_bars(&samples, with_paper, [0.56 * page.inner_px() - 84.0, 340.0]);
    bars.heading(HeadingKind::Title, "(a) distance between them");
    let columns: Vec<Column> = samples
        .iter()
        .zip(FILLS.iter().cycle())
        .map(|(sample, fill)| Column {
            group: sample.name.clone(),
            name: String::new(),
            values: sample.rotations_deg.clone(),
            fill,
            paper: with_paper.then_some(INFLECTION_ROTATION_DEG),
        })
        .collect();
    let frame_px = [0.44 * page.inner_px() - 84.0, 340.0];
    let mut boxes = box_panel(&columns, "rotation of a segment (deg)", frame_px);
    boxes.heading(HeadingKind::Title, "(b) rotation of inflection segments");
    page.rows.push(vec![bars, boxes]);
    Some(page.into_svg())
}

/// Share of the distances of every sample per bin; the paper's shares as strokes across the bins.
fn distance_bars(samples: &[&InflectionSample], with_paper: bool, frame_px: [f64; 2]) -> Panel {
    let shares: Vec<Vec<f64>> =
        samples.iter().map(|sample| bin_shares(&sample.distances_segments)).collect();
    let papers = if with_paper { &NEAR_SHARES_PERCENT[..] } else { &[] };
    let most = shares.iter().flatten().chain(papers).copied().fold(0.0, f64::max);
    let x = Axis::places("distance (segments)", BINS.len() as f64);
    let mut panel = Panel::new(x, Axis::from_zero("share (%)", most), frame_px);
    let width = 0.8 / samples.len().max(1) as f64;
    for (bin, (name, _)) in BINS.iter().enumerate() {
        panel.name_below(bin as f64 + 0.5, 0, vec![(*name).to_owned()], false);
        for (i, (shares, fill)) in shares.iter().zip(FILLS.iter().cycle()).enumerate() {
            let from = panel.px(bin as f64 + 0.1 + i as f64 * width, shares[bin]);
            let to = panel.px(bin as f64 + 0.1 + (i + 1) as f64 * width, 0.0);
            if shares[bin] > 0.0 {
                panel.marks.push(outlined(from.0, from.1, to.0 - from.0, to.1 - from.1, fill));
            }
        }
    }
    for (bin, &share) in papers.iter().enumerate() {
        let ends = [0.05, 0.95].map(|part| panel.px(bin as f64 + part, share));
        panel.marks.push(SHARE.stroke(ends[0], ends[1]));
    }
    panel
}

/// Percentages of the distances that fall into each of [`BINS`].
fn bin_shares(distances: &[f64]) -> Vec<f64> {
    let mut counts = [0_usize; BINS.len()];
    for distance in distances.iter().filter(|d| d.is_finite()) {
        let bin = BINS.iter().position(|(_, most)| distance <= most);
        counts[bin.expect("the last bin has no end")] += 1;
    }
    let total = counts.iter().sum::<usize>().max(1) as f64;
    counts.iter().map(|&count| 100.0 * count as f64 / total).collect()
}

/// Location errors by group of cases and line of action, like figure 8 of the paper.
///
/// `films` says over which films, such as `bending films, fitted` or `neutral and traction films, held out`: errors on
/// films that were fitted and on films that were not go into separate figures. Samples without values are left out;
/// `None` without values.
#[must_use]
pub fn location_errors(
    samples: &[LocationErrorSample],
    films: &str,
    synthetic: bool,
) -> Option<String> {
    let samples: Vec<&LocationErrorSample> =
        samples.iter().filter(|sample| has_values(&sample.errors_mm)).collect();
    if samples.is_empty() {
        return None;
    }
    let mut page = Page::new(format!("Location errors: {films}"), synthetic);
    page.notes.push(format!(
        "Distance between simulated and measured midpoints of the vertebrae above the base. {RULE}"
    ));
    let columns: Vec<Column> = samples
        .iter()
        .map(|sample| Column {
            group: sample.group.clone(),
            name: sample.line.to_string(),
            values: sample.errors_mm.clone(),
            fill: action_fill(sample.line),
            paper: sample.paper,
        })
        .collect();
    let mut kinds: Vec<LineKind> = samples.iter().map(|sample| sample.line).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        page.entry(Sample::Fill(action_fill(kind)), kind.to_string());
    }
    if samples.iter().any(|sample| sample.paper.is_some()) {
        paper_entry(&mut page);
    }
    let frame_px = [page.inner_px() - 84.0, 380.0];
    page.rows.push(vec![box_panel(&columns, "location error (mm)", frame_px)]);
    Some(page.into_svg())
}

/// Inflection segments against the mean of the least-rotating segments of both bends, like figure 10 of the paper. Groups
/// and estimates without values are left out; `None` where no group has any.
#[must_use]
pub fn least_rotating_estimates(groups: &[EstimateGroup], synthetic: bool) -> Option<String> {
    let samples = |group: &&EstimateGroup| {
        let samples = [&group.inflection, &group.mean_least];
        samples.iter().any(|s| has_values(&s.distances_segments) && has_values(&s.rotations_deg))
    };
    let groups: Vec<&EstimateGroup> = groups.iter().filter(samples).collect();
    if groups.is_empty() {
        return None;
    }
    let mut page = Page::new("Two estimates of the least-rotating segments", synthetic);
    page.notes.push(
        "Inflection: inflection segments of the erect curve (INF). Mean: segment midway between the least-rotating \
         ones of the left and right bend (MMS_Mean)."
            .to_owned(),
    );
    page.notes.push(RULE.to_owned());
    page.entry(Sample::Fill(FILLS[0]), "inflection");
    page.entry(Sample::Fill(FILLS[1]), "mean");
    let panel = |pick: fn(&EstimateSample) -> &Vec<f64>, label: &str, heading: &str, width_px| {
        let columns: Vec<Column> = groups
            .iter()
            .flat_map(|group| {
                let both = [("inflection", &group.inflection), ("mean", &group.mean_least)];
                let drawn = both.into_iter().zip(FILLS);
                let drawn = drawn.filter(|((_, sample), _)| has_values(pick(sample)));
                drawn.map(|((name, sample), fill)| Column {
                    group: group.name.clone(),
                    name: name.to_owned(),
                    values: pick(sample).clone(),
                    fill,
                    paper: None,
                })
            })
            .collect();
        let mut panel = box_panel(&columns, label, [width_px, 330.0]);
        panel.heading(HeadingKind::Title, heading);
        panel
    };
    // Beside one another as long as the names below the boxes have room.
    let beside = groups.len() <= 2;
    let width_px = page.inner_px() * if beside { 0.5 } else { 1.0 } - 84.0;
    let distance = "distance (segments)";
    let panels = [
        panel(|s| &s.distances_segments, distance, "(a) distance to the least-rotating", width_px),
        panel(|s| &s.rotations_deg, "rotation (deg)", "(b) rotation of the estimate", width_px),
    ];
    page.rows = if beside {
        vec![panels.into()]
    } else {
        panels.into_iter().map(|panel| vec![panel]).collect()
    };
    Some(page.into_svg())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_distance_is_in_exactly_one_bin() {
        let shares = bin_shares(&[0.0, 1.0, 1.0, 2.0, 4.0, 7.0, 20.0, 21.0, f64::NAN, 500.0]);
        let ninth = 100.0 / 9.0;
        let counts = [1.0, 2.0, 1.0, 1.0, 1.0, 1.0, 2.0];
        assert!(shares.iter().zip(counts).all(|(s, n)| (s - n * ninth).abs() < 1e-12));
    }
}
