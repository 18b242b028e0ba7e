//! Statistics over many studies.

use std::sync::Arc;

use axum::extract::State;
use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmRole};
use spineline::anatomy::Posture;
use spineline::cohort::{Cohort, CohortPatient, KnownPatients, PatientMarks, SamePatient};
use spineline::evaluate::statistics::{Summary, box_summary};
use spineline::number::{fixed, none};
use spineline::warning::WarningCode;
use spineline_files::method_text::ChosenOptions;
use spineline_store::StoreError;

use super::summary::{known, of_result, summary};
use super::{notices, reliability};
use crate::access::{prepared, sees_results};
use crate::api::{
    BoxChart, BoxView, CohortCell, CohortRow, CohortView, ComparisonView, Notice, ResultSummary,
    Severity,
};
use crate::extract::Json;
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;
use crate::user::User;

const BOOTSTRAP_SEED: u64 = 1;
const LINES: [LineKind; 3] = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated];
const WHISKERS: &str = "box: quartiles and median; whiskers: last value within 1.5 interquartile ranges; circles: values beyond";

/// A study as the cohort sees it.
struct Member {
    study: String,
    synthetic: bool,
    /// Whether it is synthetic beside real studies, which the statistics are about.
    apart: bool,
    summary: ResultSummary,
    result: Option<Arc<StudyResult>>,
    /// The same patient in another study.
    same: Option<SamePatient>,
}

/// All studies that the requester may see, without the archived ones. Statistics leave out synthetic studies beside real ones.
#[utoipa::path(get, path = "/api/cohort", responses((status = 200, body = CohortView)))]
pub async fn cohort(State(state): State<AppState>, user: User) -> Answer<Json<CohortView>> {
    of_studies(state, user, false).await
}

/// The same with statistics over synthetic and real studies together.
#[utoipa::path(get, path = "/api/cohort/pooled", responses((status = 200, body = CohortView)))]
pub async fn pooled(State(state): State<AppState>, user: User) -> Answer<Json<CohortView>> {
    of_studies(state, user, true).await
}

async fn of_studies(state: AppState, user: User, pools: bool) -> Answer<Json<CohortView>> {
    let mut studies = prepared(&state, &user).await?;
    studies.retain(|(study, _)| !study.archived);
    let is_mixed = studies.iter().any(|(study, _)| study.synthetic)
        && studies.iter().any(|(study, _)| !study.synthetic);
    let shared = state.clone();
    let members = state.store(move |store| {
        let members = studies.into_iter().map(|(study, _)| {
            let cache = &shared.results;
            let hidden = !sees_results(store, &user, &study.id)?;
            let result = if hidden { None } else { known(cache, store, &study.id)?.ok() };
            let line = match &result {
                Some(result) => of_result(result),
                None => summary(cache, store, &user, &study.id)?,
            };
            let (id, synthetic) = (study.id.to_string(), study.synthetic);
            let apart = synthetic && is_mixed && !pools;
            Ok(Member { study: id, synthetic, apart, summary: line, result, same: None })
        });
        members.collect::<Result<Vec<Member>, StoreError>>()
    });
    let mut members = members.await?;
    computed(move || {
        find_same(&mut members);
        Json(view(&members, is_mixed))
    })
    .await
}

/// Finds second studies of a patient; a study that is counted comes before one that is not.
fn find_same(members: &mut [Member]) {
    let mut ordered: Vec<&mut Member> = members.iter_mut().collect();
    // No member has `same` yet, so each answers for itself.
    ordered.sort_by_cached_key(|member| !is_counted(member));
    let mut known = KnownPatients::default();
    for member in ordered {
        let case = member.result.as_ref().filter(|_| !member.apart).map(|one| &one.current.case);
        member.same = case.and_then(|case| known.add(PatientMarks::of(case)).err());
    }
}

fn view(members: &[Member], is_mixed: bool) -> CohortView {
    let together = members.iter().filter(|member| !member.apart && member.same.is_none());
    let results: Vec<&StudyResult> = together.filter_map(|m| m.result.as_deref()).collect();
    let counted = members.iter().filter(|member| is_counted(member));
    let counted = counted.filter_map(|member| member.result.as_ref());
    let analyses: Vec<&Analysis> = counted.filter_map(|result| result.analysis()).collect();
    let patients: Vec<CohortPatient> = analyses.iter().map(|one| CohortPatient::of(one)).collect();
    let mut found = CohortView {
        synthetic: members.iter().any(|member| member.synthetic),
        mixed: is_mixed,
        rows: members.iter().map(row).collect(),
        charts: Vec::new(),
        comparisons: Vec::new(),
        reliability: reliability::of_studies(&results, "all studies"),
        verdict: Vec::new(),
        notices: cohort_notices(members),
    };
    for result in members.iter().filter_map(|member| member.result.as_deref()) {
        found.reliability.extend(reliability::of_studies(&[result], result.study.as_str()));
    }
    if !patients.is_empty() {
        let cohort = Cohort::of(&patients, BOOTSTRAP_SEED);
        found.charts = charts(&analyses, &cohort);
        found.comparisons = comparisons(&cohort);
        found.verdict = cohort.sentences();
    }
    found
}

fn cohort_notices(members: &[Member]) -> Vec<Notice> {
    let synthetic_studies = members.iter().filter(|member| member.synthetic).count();
    let synthetic = (synthetic_studies > 0).then(|| {
        let text = format!("{synthetic_studies} of {} studies are synthetic", members.len());
        Notice::new(Severity::Note, "synthetic", text)
    });
    let is_pooled = synthetic_studies > 0
        && synthetic_studies < members.len()
        && members.iter().all(|member| !member.apart);
    let mixed = is_pooled.then(|| {
        let text = "the statistics of this page pool synthetic and real studies";
        Notice::new(Severity::Warning, "synthetic_mixed", text)
    });
    notices::sorted(synthetic.into_iter().chain(mixed).chain(other_options(members)).collect())
}

/// Warns where the statistics pool studies with different model options, or notes common options that differ from the
/// defaults.
fn other_options(members: &[Member]) -> Option<Notice> {
    let counted: Vec<&ChosenOptions> = members
        .iter()
        .filter(|member| is_counted(member))
        .filter_map(|member| Some(&member.result.as_ref()?.current.options))
        .collect();
    let changed = counted.iter().filter(|options| !options.all().is_empty()).count();
    let (severity, text) = if counted.windows(2).any(|pair| pair[0] != pair[1]) {
        let text = format!(
            "{changed} of {} studies in the statistics have changed model options: the statistics pool results of different methods",
            counted.len()
        );
        (Severity::Warning, text)
    } else {
        (Severity::Note, format!("model options of all studies: {}", counted.first()?.words()))
    };
    (changed > 0).then(|| Notice::new(severity, "options_changed", text))
}

/// Whether the statistics count a study.
fn is_counted(member: &Member) -> bool {
    excluded(member).is_none()
}

/// Why the statistics leave a study out.
fn excluded(member: &Member) -> Option<String> {
    let analysis = member.result.as_ref().and_then(|result| result.analysis());
    match (analysis, &member.same) {
        (None, _) => Some(member.summary.status_text.clone()),
        (Some(_), _) if member.apart => Some("synthetic: not pooled with real studies".to_owned()),
        (Some(_), Some(same)) => {
            Some(format!("{same}; a patient counts once: archive one of the two studies"))
        }
        (Some(analysis), None) if analysis.warnings.has(WarningCode::NoSpacing) => {
            Some("a film has no spacing; its lengths are not comparable".to_owned())
        }
        (Some(_), None) => None,
    }
}

fn row(member: &Member) -> CohortRow {
    let analysis = member.result.as_ref().and_then(|result| result.analysis());
    CohortRow {
        study: member.study.clone(),
        synthetic: member.synthetic,
        status: member.summary.status,
        excluded: excluded(member),
        options_text: member.result.as_ref().and_then(|result| result.options_text()),
        cells: cells(analysis),
    }
}

fn cell(heading: &str, value: Option<f64>, places: usize) -> CohortCell {
    CohortCell {
        heading: heading.to_owned(),
        text: value.map_or_else(none, |value| fixed(value, places)),
        value,
    }
}

/// The same headings for every study.
fn cells(analysis: Option<&Analysis>) -> Vec<CohortCell> {
    let of = |value: &dyn Fn(&Analysis) -> Option<f64>| analysis.and_then(value);
    let cobb = of(&|a| Some(a.movement.main_curve()?.cobb_in(Posture::Erect)?.abs().deg()));
    let mut cells = vec![
        cell("Lenke type", of(&|a| a.movement.lenke.map(|lenke| f64::from(lenke.number))), 0),
        cell("main Cobb (°)", cobb, 1),
        cell("inflections", of(&|a| Some(a.movement.inflections.all.len() as f64)), 0),
        cell("segments", of(&|a| Some(a.movement.chain.segments as f64)), 0),
        cell("segment length (mm)", of(&|a| a.movement.scale().mm(a.movement.chain.segment_mm)), 4),
        cell("rotation at inflection (0.001°)", of(&inflection_rotation_mdeg), 1),
    ];
    for kind in LINES {
        for (films, fitted) in [("fitted", true), ("held out", false)] {
            let heading = format!("{kind}, {films} (mm)");
            let error = of(&|a| a.model(kind)?.mean_location_error_mm(fitted));
            cells.push(cell(&heading, error, 2));
        }
    }
    let warnings = of(&|a| Some(a.all_warnings().count() as f64));
    cells.push(cell("warnings", warnings, 0));
    cells
}

/// Mean rotation of the inflection segments over all films.
fn inflection_rotation_mdeg(analysis: &Analysis) -> Option<f64> {
    let estimates = analysis.movement.films.iter().filter_map(|p| p.inflection_estimates.as_ref());
    let rotations: Vec<f64> =
        estimates.flatten().map(|estimate| 1000.0 * estimate.rotation.deg()).collect();
    (!rotations.is_empty()).then(|| Summary::of(&rotations).mean)
}

fn charts(analyses: &[&Analysis], cohort: &Cohort) -> Vec<BoxChart> {
    let errors = |title: &str, role| {
        let lines = cohort.compared.of_role(role);
        let boxes = lines.filter_map(|line| box_of(&line.kind.to_string(), &line.all_location_mm));
        chart(title, "location error (mm)", boxes.collect())
    };
    let motions =
        analyses.iter().flat_map(|one| &one.movement.films).filter_map(|p| p.motion.as_ref());
    let all_segments = motions.flat_map(|motion| motion.rotations.iter().map(|r| 1000.0 * r.deg()));
    let millidegrees = |deg: &[f64]| -> Vec<f64> { deg.iter().map(|deg| 1000.0 * deg).collect() };
    let rotations = [
        ("all segments", all_segments.collect()),
        ("inflections", millidegrees(&cohort.inflection[0].all_rotations_deg)),
        ("least-rotating", millidegrees(&cohort.all_least_rotations_deg)),
    ];
    let [bends, others] = [1, 2].map(|i| &cohort.inflection[i].all_distances_segments);
    vec![
        errors("Location errors on fitted films", FilmRole::Fitted),
        errors("Location errors on held-out films", FilmRole::HeldOut),
        chart(
            "Rotation from the erect posture",
            "rotation (0.001°)",
            rotations.iter().filter_map(|(label, values)| box_of(label, values)).collect(),
        ),
        chart(
            "Inflections to the least-rotating segments",
            "distance (segments)",
            [("bends", bends), ("neutral and traction", others)]
                .iter()
                .filter_map(|(label, values)| box_of(label, values))
                .collect(),
        ),
    ]
}

fn chart(title: &str, axis: &str, boxes: Vec<BoxView>) -> BoxChart {
    BoxChart {
        title: title.to_owned(),
        axis: axis.to_owned(),
        whiskers_text: WHISKERS.to_owned(),
        boxes,
    }
}

/// None for an empty sample.
fn box_of(label: &str, values: &[f64]) -> Option<BoxView> {
    let summary = box_summary(values)?;
    let ([low, high], [lower, median, upper]) = (summary.whiskers, summary.quartiles);
    Some(BoxView {
        label: label.to_owned(),
        count: values.len(),
        five: [low, lower, median, upper, high],
        outliers: summary.outliers,
    })
}

fn comparisons(cohort: &Cohort) -> Vec<ComparisonView> {
    let [near_bends, near_others, turn_bends, turn_others] = &cohort.table_2;
    let distance = "distance to the least-rotating segments, inflections against MMS_Mean";
    let rotation = "rotation, inflections against MMS_Mean";
    let all = [
        (
            "location error on fitted films, inflection against iliac line".to_owned(),
            &cohort.location_test,
            "mm",
        ),
        (
            "Ferguson error on fitted films, inflection against iliac line".to_owned(),
            &cohort.ferguson_test,
            "°",
        ),
        (format!("{distance}, bends"), near_bends, "segments"),
        (format!("{distance}, neutral and traction"), near_others, "segments"),
        (format!("{rotation}, bends"), turn_bends, "°"),
        (format!("{rotation}, neutral and traction"), turn_others, "°"),
    ];
    all.into_iter()
        .map(|(label, comparison, unit)| ComparisonView {
            label,
            pooled_text: comparison.pooled_words(unit),
            by_patient_text: comparison.patient_words(unit),
        })
        .collect()
}
