//! Parts of the report as the browser shows them: the same texts, tables and pictures.

use axum::extract::State;
use spineline_report::document::{Block, Section, Table};
use spineline_report::patient::parts;

use crate::access::open_result;
use crate::api::{BlockView, ColumnView, Problem, SectionView};
use crate::extract::{Json, Path};
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;
use crate::user::User;

/// The lines of action beside predictions without mechanics, the automatic choice, and the line of best fit of every film.
#[utoipa::path(get, path = "/api/studies/{study}/lines", params(("study" = String, Path)),
    responses((status = 200, body = Vec<SectionView>), Problem))]
pub async fn lines(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<Vec<SectionView>>> {
    of_analysis(&state, &user, &study, |result| {
        let analysis = result.analysed()?;
        Ok(parts::lines(analysis))
    })
    .await
}

/// The erect and the lateral film together, with every number in 2-D and 3-D, and axial rotations from pedicles; empty without both.
#[utoipa::path(get, path = "/api/studies/{study}/space", params(("study" = String, Path)),
    responses((status = 200, body = Vec<SectionView>), Problem))]
pub async fn space(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<Vec<SectionView>>> {
    of_analysis(&state, &user, &study, |result| Ok(parts::space(result.analysed()?))).await
}

/// Parts of the report of a study that has an analysis.
async fn of_analysis(
    state: &AppState,
    user: &User,
    study: &str,
    parts: fn(&StudyResult) -> Answer<Vec<Section>>,
) -> Answer<Json<Vec<SectionView>>> {
    let result = open_result(state, user, study).await?;
    result.analysed()?;
    let made = computed(move || Ok(parts(&result)?.into_iter().map(section_view).collect()));
    made.await?.map(Json)
}

/// A part of a report.
pub fn section_view(section: Section) -> SectionView {
    SectionView {
        id: section.id.to_owned(),
        title: section.title,
        blocks: section.blocks.into_iter().map(block_view).collect(),
    }
}

fn block_view(block: Block) -> BlockView {
    match block {
        Block::Heading(text) => BlockView::Heading { text },
        Block::Paragraph(text) => BlockView::Paragraph { text },
        Block::Notice(notice) => BlockView::Notice {
            word: notice.kind.word().to_owned(),
            text: match notice.place.as_str() {
                "" => notice.text,
                place => format!("{place}: {}", notice.text),
            },
        },
        Block::Table(table) => table_view(table),
        Block::Figure(figure) => {
            BlockView::Figure { name: figure.name, caption: figure.caption, svg: figure.svg }
        }
    }
}

fn table_view(table: Table) -> BlockView {
    let columns = table.columns.into_iter();
    BlockView::Table {
        caption: table.caption,
        columns: columns.map(|one| ColumnView { head: one.head, numeric: one.numeric }).collect(),
        rows: table.rows,
        note: table.note,
    }
}
