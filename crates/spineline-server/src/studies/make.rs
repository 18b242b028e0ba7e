//! New studies, of uploaded films or of a case file with its films, and more films of a study.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use axum::extract::State;
use axum::http::StatusCode;
use spineline::anatomy::FilmView;
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane, SpacingSource};
use spineline_files::{FilmSource, image_value, sha256_hex};
use spineline_films::{
    DeidOptions, FilmKind, FilmLimits, Stated, deidentify, film_doubts, shape_contradiction,
    side_contradiction, view_contradictions,
};
use spineline_marking::{View, judge_view};
use spineline_store::{
    AddedCase, Name, NewCase, Role, Signature, Store, StoreError, Study, system_random,
};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::detail::{detail, of_study};
use crate::access::study_name;
use crate::api::{CaseImport, MoreFilms, NewFilm, NewStudy, Problem, ScaleChoice, StudyDetail};
use crate::decoded::picture_sha256;
use crate::extract::{Json, Path};
use crate::film_cache::Upload;
use crate::problem::{Answer, Failure};
use crate::result_cache::computed;
use crate::state::AppState;
use crate::user::User;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(new_study))
        .routes(routes!(more_films))
        .routes(routes!(import_case))
}

/// Creates a study from uploaded films, which are de-identified.
#[utoipa::path(post, path = "/api/studies", request_body = NewStudy,
    responses((status = 200, body = StudyDetail), Problem))]
async fn new_study(
    State(state): State<AppState>,
    user: User,
    Json(new): Json<NewStudy>,
) -> Answer<Json<StudyDetail>> {
    user.need(Role::Editor)?;
    let id = Name::new(&new.id)?;
    let films = uploaded(&state, &user, &new.films)?;
    let synthetic = films.iter().all(|(_, upload)| upload.is_synthetic);
    let study = Study::new(id, new.label, synthetic);
    let case = prepared(study, films, Pictures::default(), new.accept_doubtful_films).await?;
    let used = new.films.into_iter().map(|film| film.upload).collect();
    add(&state, user, case, used, Store::add_own_case).await
}

/// Adds uploaded films to a study, which are de-identified.
#[utoipa::path(post, path = "/api/studies/{study}/films", params(("study" = String, Path)), request_body = MoreFilms,
    responses((status = 200, body = StudyDetail), Problem))]
async fn more_films(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
    Json(more): Json<MoreFilms>,
) -> Answer<Json<StudyDetail>> {
    let (id, asker) = (study_name(&study)?, user.clone());
    let known = state.ask(move |store| {
        asker.need_on_study(store, &id, Role::Editor)?;
        let study = store.study(&id)?;
        if study.archived {
            return Err(StoreError::Archived { study: id }.into());
        }
        // A refusal of a film would reveal the films of the plan.
        if store.has_plan(&id)? {
            return Err(StoreError::PlanGoverns { study: id }.into());
        }
        Ok((store.films(&id)?, study))
    });
    let (known, study) = known.await?;
    let films = uploaded(&state, &user, &more.films)?;
    if !study.synthetic && films.iter().any(|(_, upload)| upload.is_synthetic) {
        let text = format!("the films of {} are not synthetic, and a new one is", study.id);
        return Err(Failure::refused(text).help("make a new study of the synthetic films"));
    }
    let mut pictures = Pictures::default();
    for film in known {
        pictures.0.insert(picture_sha256(&state, &film.content).await?, film.view);
    }
    let case = prepared(study, films, pictures, more.accept_doubtful_films).await?;
    let used = more.films.into_iter().map(|film| film.upload).collect();
    add(&state, user, case, used, Store::add_films).await
}

/// The films with their uploads.
fn uploaded(
    state: &AppState,
    user: &User,
    films: &[NewFilm],
) -> Answer<Vec<(NewFilm, Arc<Upload>)>> {
    let now = state.now();
    let uploads = films
        .iter()
        .map(|film| Ok((film.clone(), state.films.uploads.get(&user.name, &film.upload, now)?)));
    uploads.collect()
}

/// The films of a study, checked beside its present films and de-identified.
async fn prepared(
    study: Study,
    films: Vec<(NewFilm, Arc<Upload>)>,
    pictures: Pictures,
    accept_doubtful_films: bool,
) -> Answer<NewCase> {
    check(&films, pictures)?;
    if !accept_doubtful_films {
        let stated = |(film, upload): &(NewFilm, Arc<Upload>)| {
            (format!("{} film", film.posture.0), upload.stated.clone())
        };
        let mut texts = doubts(&films.iter().map(stated).collect::<Vec<_>>());
        for (film, upload) in &films {
            texts.extend(contradictions(film, upload)?);
        }
        need_no_doubt(&texts)?;
    }
    let prepared = computed(move || {
        let salt = salt();
        let mut case = NewCase::of(study);
        for (film, upload) in &films {
            let (bytes, image) = prepared_film(&case.study.id, film, upload, salt)?;
            case = case.film(film.posture.0, bytes, image);
            if film.posture.0 == FilmView::Lateral {
                case = case.simultaneous(film.simultaneous);
            }
        }
        Ok(case)
    });
    prepared.await?
}

/// Creates a study from a case file with its readings and films.
#[utoipa::path(post, path = "/api/studies/case", request_body = CaseImport,
    responses((status = 200, body = StudyDetail), Problem))]
async fn import_case(
    State(state): State<AppState>,
    user: User,
    Json(import): Json<CaseImport>,
) -> Answer<Json<StudyDetail>> {
    user.need(Role::Editor)?;
    let now = state.now();
    let mut uploads = BTreeMap::new();
    for film in &import.films {
        let upload = state.films.uploads.get(&user.name, &film.upload, now)?;
        uploads.insert(film.name.clone(), upload);
    }
    if !import.accept_doubtful_films {
        let stated =
            |(name, upload): (&String, &Arc<Upload>)| (name.clone(), upload.stated.clone());
        need_no_doubt(&doubts(&uploads.iter().map(stated).collect::<Vec<_>>()))?;
    }
    let used = import.films.iter().map(|film| film.upload.clone()).collect();
    let read = computed(move || {
        let missing = "a film that the case names was not uploaded";
        let bytes_of =
            |file: &str| uploads.get(file).map(|upload| upload.bytes.clone()).ok_or(missing);
        let case = NewCase::read(&import.text, bytes_of).map_err(|error| Failure::of(&error))?;
        let mut pictures = Pictures::default();
        for (view, file, size) in case.pictures() {
            let upload = uploads.get(file).ok_or_else(|| Failure::refused(missing))?;
            check_picture(view, size, upload)?;
            pictures.add(view, upload)?;
        }
        let (id, salt) = (case.study.id.clone(), salt());
        case.rewritten(|bytes| clean(&id, bytes, salt))
    });
    let case = read.await??;
    add(&state, user, case, used, Store::add_own_case).await
}

async fn add(
    state: &AppState,
    user: User,
    case: NewCase,
    used: Vec<String>,
    keep: fn(&mut Store, &NewCase, &Signature) -> Result<AddedCase, StoreError>,
) -> Answer<Json<StudyDetail>> {
    let asker = state.clone();
    let detail = state.ask(move |store| {
        let added = keep(store, &case, &user.sign())?;
        asker.films.uploads.forget(used.iter().map(String::as_str));
        asker.changes.send(&added.study, of_study(&user));
        detail(&asker, store, &user, &added.study)
    });
    detail.await.map(Json)
}

/// Checks before any film is processed, beside the pictures that the study has already.
fn check(films: &[(NewFilm, Arc<Upload>)], mut pictures: Pictures) -> Answer<()> {
    if films.is_empty() {
        return Err(Failure::refused("the request has no film").help("choose at least one film"));
    }
    let mut views: BTreeSet<FilmView> = pictures.0.values().copied().collect();
    for (film, upload) in films {
        let view = film.posture.0;
        check_view(view, upload)?;
        if !views.insert(view) {
            return Err(Failure::refused(format!("the study has two {view} films"))
                .help("choose one film per posture, and one lateral film"));
        }
        pictures.add(view, upload)?;
    }
    Ok(())
}

/// Refuses a lateral view for a frontal film.
fn check_view(view: FilmView, upload: &Upload) -> Answer<()> {
    let is_lateral = judge_view(&upload.view, None).view == Some(View::Lateral);
    if is_lateral && view != FilmView::Lateral {
        let text = format!("{view}: the file contains a lateral view");
        return Err(Failure::refused(text).help("choose the frontal film"));
    }
    Ok(())
}

/// The pictures of a study by SHA-256, each for one posture or the lateral one.
#[derive(Default)]
struct Pictures(BTreeMap<String, FilmView>);

impl Pictures {
    fn add(&mut self, view: FilmView, upload: &Upload) -> Answer<()> {
        match self.0.insert(upload.picture.clone(), view) {
            None => Ok(()),
            Some(other) => {
                let text = format!("the {other} film and the {view} film are the same picture");
                Err(Failure::refused(text).help("choose a different film for each posture"))
            }
        }
    }
}

/// Films whose files state another part of the body, or two patients.
fn doubts(films: &[(String, Stated)]) -> Vec<String> {
    let named = films.iter().zip(film_doubts(films));
    named
        .flat_map(|((name, _), doubts)| {
            doubts.into_iter().map(move |doubt| format!("{name}: {}", doubt.text))
        })
        .collect()
}

/// Contradictions between the answers for a film and its file: view, stance, side, and shape of a pixel.
fn contradictions(film: &NewFilm, upload: &Upload) -> Answer<Vec<String>> {
    let view = film.posture.0;
    let judged = judge_view(&upload.view, view.posture());
    let mut texts = view_contradictions(view, &judged);
    texts.extend(side_contradiction(view, &judged, film.patient_left.0, "your answer"));
    // Where the file leaves the shape open, the answer decides it.
    let by_file = upload.spacing.filter(|_| upload.spacing_question.is_none());
    if let (ScaleChoice::Stated { column_mm, row_mm, plane }, Some(by_file)) =
        (&film.scale, by_file)
    {
        let said = stated_spacing([*column_mm, *row_mm], plane.0)?;
        texts.extend(shape_contradiction(&by_file, &said, "your answer"));
    }
    Ok(texts.into_iter().map(|text| format!("{view} film: {text}")).collect())
}

/// Refuses films with doubts; the answer has a separate code, because the user may confirm them.
fn need_no_doubt(texts: &[String]) -> Answer<()> {
    if texts.is_empty() {
        return Ok(());
    }
    let failure = Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "doubtful_film", texts.join("; "));
    Err(failure.help("correct the answers, choose other films, or confirm them if you are sure"))
}

/// Whether an upload can be the film of a case.
fn check_picture(view: FilmView, [columns, rows]: [u64; 2], upload: &Upload) -> Answer<()> {
    if [u64::from(upload.columns), u64::from(upload.rows)] != [columns, rows] {
        let text = format!(
            "{view}: the case needs a picture of {columns} × {rows} pixels, and this one has {} × {}",
            upload.columns, upload.rows
        );
        return Err(Failure::refused(text).help("choose the original film"));
    }
    check_view(view, upload)
}

/// A film's de-identified bytes, and its description for the study.
fn prepared_film(
    id: &Name,
    film: &NewFilm,
    upload: &Upload,
    salt: [u8; 32],
) -> Answer<(Vec<u8>, serde_json::Value)> {
    let bytes = clean(id, &upload.bytes, salt)?;
    let spacing = match film.scale {
        ScaleChoice::File | ScaleChoice::Pixels if upload.spacing_question.is_some() => {
            let question = upload.spacing_question.as_deref().unwrap_or_default();
            let text = format!("{}: {question}", film.posture.0);
            return Err(
                Failure::refused(text).help("enter the distances between columns and rows in mm")
            );
        }
        ScaleChoice::File => upload.spacing,
        // The shape of the pixels is kept: all angles depend on it.
        ScaleChoice::Pixels => upload
            .spacing
            .filter(|spacing| !spacing.is_square())
            .map(|spacing| Spacing::of_aspect(spacing.aspect(), SpacingSource::PixelAspect)),
        ScaleChoice::Stated { column_mm, row_mm, plane } => {
            Some(stated_spacing([column_mm, row_mm], plane.0)?)
        }
    };
    let geometry = ImageGeometry {
        columns: upload.columns,
        rows: upload.rows,
        spacing,
        patient_left: film.patient_left.0,
    };
    geometry.check_size().map_err(|error| {
        let posture = film.posture.0;
        Failure::refused(format!("{posture}: {error}"))
            .help("enter another scale, or use the film without one")
    })?;
    let extension = if upload.kind == FilmKind::Dicom { "dcm" } else { "png" };
    let posture = film.posture.0.key();
    let source = FilmSource {
        file: Some(format!("{id}-{posture}.{extension}")),
        sha256: Some(sha256_hex(&bytes)),
        inverted: film.inverted,
    };
    Ok((bytes, image_value(film.posture.0, &geometry, source)))
}

/// The spacing that a person enters: between columns and between rows.
pub fn stated_spacing([column_mm, row_mm]: [f64; 2], plane: SpacingPlane) -> Answer<Spacing> {
    let is_shape = plane == SpacingPlane::Pixels;
    let stated = if is_shape {
        Spacing::of_aspect(row_mm / column_mm, SpacingSource::Stated)
    } else {
        Spacing::stated(column_mm, row_mm, plane)
    };
    if stated.is_plausible() {
        return Ok(stated);
    }
    Err(if is_shape {
        Failure::refused(format!("pixels of {column_mm} × {row_mm} are not plausible"))
            .help("enter the width and height of a pixel")
    } else {
        Failure::refused(format!("a spacing of {column_mm} mm × {row_mm} mm is not plausible"))
            .help("enter the distance between pixel centres in mm")
    })
}

/// De-identifies a film's file.
fn clean(id: &Name, bytes: &[u8], salt: [u8; 32]) -> Answer<Vec<u8>> {
    let options = DeidOptions { case_id: id.to_string(), salt, retain_sex_and_age: false };
    Ok(deidentify(bytes, &options, &FilmLimits::default())?.bytes)
}

/// Films of one study get a common new identifier that does not reveal the old one.
fn salt() -> [u8; 32] {
    let mut salt = [0; 32];
    system_random(&mut salt);
    salt
}
