//! Parts of the report as the browser shows them: the same texts, tables and pictures.

use std::sync::Arc;

use spineline::analysis::Analysis;
use spineline_report::document::Section;
use spineline_report::patient::parts;

use crate::access::OpenResult;
use crate::api::Problem;
use crate::extract::Json;
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};

/// The lines of action beside predictions without mechanics, the automatic choice, and the line of best fit of every film.
#[utoipa::path(get, path = "/api/studies/{study}/lines", params(("study" = String, Path)),
    responses((status = 200, body = Vec<Section>), Problem))]
pub async fn lines(OpenResult(result): OpenResult) -> Answer<Json<Vec<Section>>> {
    of_analysis(result, parts::lines).await
}

/// The erect and the lateral film together, with every number in 2-D and 3-D, and axial rotations from pedicles; empty without both.
#[utoipa::path(get, path = "/api/studies/{study}/space", params(("study" = String, Path)),
    responses((status = 200, body = Vec<Section>), Problem))]
pub async fn space(OpenResult(result): OpenResult) -> Answer<Json<Vec<Section>>> {
    of_analysis(result, parts::space).await
}

/// Parts of the report of a study that has an analysis.
async fn of_analysis(
    result: Arc<StudyResult>,
    parts: fn(&Analysis) -> Vec<Section>,
) -> Answer<Json<Vec<Section>>> {
    computed(move || result.analysed().map(parts)).await?.map(Json)
}
