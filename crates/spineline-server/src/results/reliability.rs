//! Agreement of observers.

use spineline::measure::{FilmReadings, TiltRule};
use spineline::reliability::{DesignReliability, QuantityReliability, assess, film_quantities};

use crate::access::OpenResult;
use crate::api::{BlandAltmanView, NamedText, Problem, ReliabilityView};
use crate::extract::Json;
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};

/// Repeatability of the readings of a study.
#[utoipa::path(get, path = "/api/studies/{study}/reliability", params(("study" = String, Path)),
    responses((status = 200, body = Vec<ReliabilityView>), Problem))]
pub async fn reliability(OpenResult(result): OpenResult) -> Answer<Json<Vec<ReliabilityView>>> {
    computed(move || Json(of_studies(&[&result], result.study.as_str()))).await
}

/// Agreement on every quantity over some studies; empty if no film was read twice.
pub fn of_studies(results: &[&StudyResult], scope: &str) -> Vec<ReliabilityView> {
    let read = |result: &&StudyResult| {
        let films = result.current.case.films.iter();
        // Other parts report films that cannot be measured.
        let readings: Vec<FilmReadings> = films
            .filter_map(|film| FilmReadings::measure(film, TiltRule::default()).ok())
            .collect();
        (result.study.to_string(), readings)
    };
    let cases: Vec<(String, Vec<FilmReadings>)> = results.iter().map(read).collect();
    if cases.iter().flat_map(|(_, films)| films).all(|film| film.readings.len() < 2) {
        return Vec::new();
    }
    let borrowed: Vec<(&str, &[FilmReadings])> =
        cases.iter().map(|(id, films)| (id.as_str(), films.as_slice())).collect();
    let quantities = film_quantities(&borrowed);
    quantities.iter().map(assess).flat_map(|quantity| views(&quantity, scope)).collect()
}

fn views(quantity: &QuantityReliability, scope: &str) -> Vec<ReliabilityView> {
    quantity.designs.iter().map(|design| view(quantity, design, scope)).collect()
}

fn view(
    quantity: &QuantityReliability,
    design: &DesignReliability,
    scope: &str,
) -> ReliabilityView {
    let unit = &quantity.unit;
    let statistics = design.statistics.iter().map(|statistic| NamedText {
        name: statistic.kind.to_string(),
        text: statistic.words(unit),
    });
    let subjects = NamedText {
        name: "subjects".to_owned(),
        text: format!("{}, read by {}", design.subjects, design.raters.join(" and ")),
    };
    let remarks = design
        .remarks
        .iter()
        .map(|remark| NamedText { name: "remark".to_owned(), text: remark.to_string() });
    ReliabilityView {
        quantity: format!("{} ({unit}), {}: {}", quantity.key, design.design, quantity.meaning),
        scope: scope.to_owned(),
        statistics: statistics.chain([subjects]).chain(remarks).collect(),
        bland_altman: design.bland_altman.first().map(|pair| BlandAltmanView {
            means: pair.points.iter().map(|point| point[0]).collect(),
            differences: pair.points.iter().map(|point| point[1]).collect(),
            bias: pair.bias,
            limits: pair.limits,
            unit: unit.clone(),
        }),
    }
}
