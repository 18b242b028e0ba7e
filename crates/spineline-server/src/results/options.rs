//! Model options of a study, which apply to all its results.

use axum::extract::State;
use axum::http::StatusCode;
use spineline_files::method_text::{
    ChosenOption, ChosenOptions, MethodOption, OptionError, OptionValues, study_options,
};
use spineline_store::{Name, Role, Store, StudyOptions};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::OpenStudy;
use crate::api::{Change, OptionValueView, OptionView, OptionsChange, OptionsView, Problem};
use crate::extract::{Json, WithBody};
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::User;

/// Maximum length of a stored file name, in characters.
const MAX_FILE_NAME: usize = 100;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(options, change))
}

/// The model options of a study.
#[utoipa::path(get, path = "/api/studies/{study}/options", params(("study" = String, Path)),
    responses((status = 200, body = OptionsView), Problem))]
async fn options(
    State(state): State<AppState>,
    user: User,
    OpenStudy(study): OpenStudy,
) -> Answer<Json<OptionsView>> {
    state.ask(move |store| view(store, &user, &study)).await.map(Json)
}

/// Changes the model options of a study. Results with other options are computed again.
#[utoipa::path(put, path = "/api/studies/{study}/options", params(("study" = String, Path)),
    request_body = OptionsChange,
    responses((status = 200, body = OptionsView), Problem))]
async fn change(
    State(state): State<AppState>,
    user: User,
    WithBody(Json(wanted), OpenStudy(study)): WithBody<Json<OptionsChange>, OpenStudy>,
) -> Answer<Json<OptionsView>> {
    let by = user.sign();
    let asker = state.clone();
    let changed = state.ask(move |store| {
        user.need_on_study(store, &study, Role::Editor)?;
        let chosen = changed(&store.study_options(&study)?.chosen, &wanted).map_err(refused)?;
        let edited = store.set_study_options(&study, &chosen, wanted.expected_revision, &by);
        // A refused change is reported too, because it is kept.
        let who = user.name.to_string();
        asker.changes.send(&study, Change { who, film: None, reading: None, revision: None });
        edited?;
        view(store, &user, &study)
    });
    changed.await.map(Json)
}

/// The options after a change.
fn changed(now: &ChosenOptions, wanted: &OptionsChange) -> Result<ChosenOptions, OptionError> {
    let names: Vec<String> = wanted.options.iter().map(|one| one.name.replace('-', "_")).collect();
    let kept = now.all().iter().filter(|one| !wanted.reset && !names.contains(&one.name)).cloned();
    let new = wanted.options.iter().filter(|one| !one.value.trim().is_empty());
    let new = new.map(|one| ChosenOption {
        name: one.name.clone(),
        value: one.value.clone(),
        file: one.file.as_deref().map(base_name),
    });
    ChosenOptions::new(&kept.chain(new).collect::<Vec<_>>())
}

/// A file's name for display: without folders, and shortened.
fn base_name(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or_default();
    let shown = name.chars().filter(|one| !one.is_control()).take(MAX_FILE_NAME);
    shown.collect()
}

fn refused(error: OptionError) -> Failure {
    Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "option", error.to_string())
        .help("nothing was changed: choose another value, or leave it empty for the default")
}

fn view(store: &Store, user: &User, study: &Name) -> Answer<OptionsView> {
    let StudyOptions { chosen, revision } = store.study_options(study)?;
    Ok(OptionsView {
        revision,
        may_change: user.on_study(store, study)? >= Role::Editor && !store.study(study)?.archived,
        options: study_options().map(|option| option_view(option, &chosen)).collect(),
        changed_text: Some(chosen.words()).filter(|words| !words.is_empty()),
    })
}

fn value_view(value: &str, help: &str) -> OptionValueView {
    OptionValueView { value: value.to_owned(), help: help.to_owned() }
}

fn option_view(option: &MethodOption, chosen: &ChosenOptions) -> OptionView {
    let one = chosen.of(option.name);
    // If another version of the program chose the options, the results say so.
    let without = chosen.before(option).unwrap_or_default();
    let default = option.shown(&without);
    let named = option.named_values();
    let (is_closed, values) = match option.values {
        // Without a file, the option has no value.
        OptionValues::Named(_) if named.is_empty() => (true, vec![value_view("", "")]),
        OptionValues::Named(_) => {
            (true, named.iter().map(|one| value_view(&one.spelling, &one.help)).collect())
        }
        OptionValues::Text(some) => {
            (false, some.iter().map(|value| value_view(value, "")).collect())
        }
    };
    OptionView {
        name: option.name.to_owned(),
        title: option.title.to_owned(),
        help: option.help.to_owned(),
        value: one.map_or_else(|| default.clone(), ChosenOption::words),
        default,
        default_words: option.words(&without),
        is_changed: one.is_some(),
        is_closed,
        takes_file: option.takes_a_file(),
        values,
    }
}
