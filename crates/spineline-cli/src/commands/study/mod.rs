//! `spineline study`: the study store, from the command line.

mod args;
mod edits;

pub use args::{EXAMPLES, StudyArgs};

use std::io::{IsTerminal, stdout};
use std::path::Path;
use std::time::SystemTime;

use spineline::warning::counted;
use spineline_report::document::{Column, Table};
use spineline_report::terminal::{self, Lines};
use spineline_store::{
    FilmRecord, Head, Name, Next, PlanDesign, ReadingRecord, Signature, Store, StoreError,
    StudyEdit, Timestamp, Verification, system_random,
};

use args::StudyCommand;

use crate::analysis::study::{add_case, alike_observers};
use crate::options::values::author;
use crate::run::failure::{Ending, Failure};
use crate::run::interrupt;
use crate::run::messages::say;
use crate::run::outputs::{Outputs, entry_width, print, width};

pub fn run(args: &StudyArgs) -> Result<Ending, Failure> {
    let path = args.command.store();
    let fail = |error: StoreError| Failure::file(path, &error);
    let author = author(args.by.as_ref(), args.command.has_author())?;
    let by = || Signature::now(author.clone());
    match &args.command {
        StudyCommand::Create { .. } => {
            interrupt::begin_writing();
            Store::create(path, &by()).map_err(fail)?;
            print(format!("{} was created as an empty store.", path.display()))
        }
        StudyCommand::Add { cases, accept, .. } => {
            let mut store = Store::open(path).map_err(fail)?;
            for case in cases {
                print(add_case(&mut store, fail, case, *accept, &by())?)?;
            }
            Ok(Ending::Done)
        }
        StudyCommand::List { study: None, .. } => {
            print(Lines::of_text(&list(&view(path)?).map_err(fail)?))
        }
        StudyCommand::List { study: Some(study), .. } => edits::list_readings(path, study),
        StudyCommand::Plan { study, observers, repeats, washout_days, proposals, .. } => {
            let (repeats, washout_days) = (*repeats, *washout_days);
            let design = PlanDesign { repeats, washout_days, proposals: *proposals };
            plan(path, study, observers, design, &by())
        }
        StudyCommand::Next { study, observer, .. } => next(path, study, observer),
        StudyCommand::Release { study, .. } => release(path, study, &by()),
        StudyCommand::Withdraw { reading, reason, .. } => {
            edits::withdraw(path, *reading, reason, &by())
        }
        StudyCommand::Correct { reading, .. } => edits::correct(path, *reading, &by()),
        StudyCommand::Rename { study, label, .. } => {
            edits::edit(path, study, &StudyEdit::Label { label: Some(label.clone()) }, &by())
        }
        StudyCommand::Archive { study, undo, .. } => {
            edits::edit(path, study, &StudyEdit::Archived { archived: !undo }, &by())
        }
        StudyCommand::Export { study, out, overwrite, .. } => {
            export(path, study, out, Outputs::new(*overwrite, [path]))
        }
        StudyCommand::Log { .. } => print(Lines::of_text(&log(&view(path)?).map_err(fail)?)),
        StudyCommand::Verify { head, .. } => verify(path, head.as_ref()),
        StudyCommand::Backup { out, .. } => {
            let store = view(path)?;
            interrupt::begin_writing();
            let verification = store.backup_to(out).map_err(fail)?;
            report(out, &verification)
        }
        StudyCommand::Restore { backup, .. } => restore(backup, path),
    }
}

fn plan(
    path: &Path,
    study: &Name,
    observers: &[Name],
    design: PlanDesign,
    by: &Signature,
) -> Result<Ending, Failure> {
    let fail = |error: StoreError| Failure::file(path, &error);
    let mut store = Store::open(path).map_err(fail)?;
    let earlier = store.open_plan(study).map_err(fail)?;
    let readings = match &earlier {
        Some(plan) => store.change_plan(study, plan.id, observers, design, &mut system_random, by),
        None => store.reading_plan(study, observers, design, &mut system_random, by),
    };
    let readings = readings.map_err(fail)?;
    let mut text = Lines::of(format!(
        "Planned {}: every observer reads every film {}, {} apart, each time in a random order{}.",
        counted(readings, "reading"),
        counted(design.repeats, "time"),
        counted(design.washout_days, "day"),
        if design.proposals { ", with proposed vertebrae" } else { "" }
    ));
    if earlier.is_some() {
        text.line("This plan replaces the earlier plan, whose codes are invalid now.");
    }
    let names = observers.iter().map(Name::to_string).collect();
    for remark in alike_observers(&store, &names).map_err(fail)? {
        text.line(format!("  ! {remark}"));
    }
    print(text)
}

fn next(path: &Path, study: &Name, observer: &Name) -> Result<Ending, Failure> {
    let fail = |error: StoreError| Failure::file(path, &error);
    let store = view(path)?;
    if store.study(study).map_err(fail)?.archived {
        return Err(fail(StoreError::Archived { study: study.clone() }));
    }
    let next =
        store.observer(observer).next_film_for(study, SystemTime::now().into()).map_err(fail)?;
    let planned = store.planned_observers(study).map_err(fail)?;
    if !planned.contains(observer) {
        return Err(unknown_observer(path, study, observer, &planned));
    }
    print(next_text(&next))
}

fn release(path: &Path, study: &Name, by: &Signature) -> Result<Ending, Failure> {
    let fail = |error: StoreError| Failure::file(path, &error);
    let readings = Store::open(path).and_then(|mut store| store.release_washout(study, by));
    let readings = readings.map_err(fail)?;
    print(format!(
        "{study}: the washout of {} with a time ahead of the clock is over.",
        counted(readings, "reading")
    ))
}

fn export(path: &Path, study: &Name, out: &Path, outputs: Outputs) -> Result<Ending, Failure> {
    outputs.declare(out)?;
    let exported = view(path)?.export_case(study);
    let exported = exported.map_err(|error| Failure::file(path, &error))?;
    for remark in &exported.remarks {
        say(format!("note: {remark}"));
    }
    outputs.write(out, exported.text)?;
    outputs.commit_and_say()?;
    Ok(Ending::Done)
}

/// Opens a store for reading.
fn view(path: &Path) -> Result<Store, Failure> {
    Store::view(path).map_err(|error| Failure::file(path, &error))
}

/// The error for an observer who is not in the plan.
fn unknown_observer(path: &Path, study: &Name, observer: &Name, planned: &[Name]) -> Failure {
    let known = planned.iter().map(Name::as_str).collect::<Vec<_>>().join(", ");
    let what = format!("unknown observer `{observer}`: the plan of {study} has {known}");
    let help = "give the code of an observer of this plan; `spineline study plan` makes plans";
    Failure::input(path.display(), what, help)
}

fn list(store: &Store) -> Result<String, StoreError> {
    let columns = vec![
        Column::words("Study"),
        Column::words("Film"),
        Column::numbers("Readings"),
        Column::numbers("Finished"),
        Column::words("Observers"),
    ];
    let mut table = Table::new("", columns);
    for study in store.studies()? {
        let films = store.films(&study.id)?;
        let readings = store.readings(&study.id)?;
        let notes = match (study.synthetic, study.archived) {
            (true, true) => " (synthetic, archived)",
            (true, false) => " (synthetic)",
            (false, true) => " (archived)",
            (false, false) => "",
        };
        for film in &films {
            table.row(row(&format!("{}{notes}", study.id), film, &readings));
        }
        if films.is_empty() {
            let nothing = || "-".to_owned();
            table.row(vec![study.id.to_string(), nothing(), nothing(), nothing(), nothing()]);
        }
    }
    Ok(terminal::table(&table, entry_width()))
}

fn row(study: &str, film: &FilmRecord, readings: &[ReadingRecord]) -> Vec<String> {
    let of_film: Vec<&ReadingRecord> = readings.iter().filter(|r| r.film == film.id).collect();
    let finished = of_film.iter().filter(|r| r.counts()).count();
    let mut observers: Vec<&str> = of_film.iter().map(|r| r.observer.as_str()).collect();
    observers.sort_unstable();
    observers.dedup();
    vec![
        study.to_owned(),
        film.view.to_string(),
        of_film.len().to_string(),
        finished.to_string(),
        observers.join(", "),
    ]
}

fn next_text(next: &Next) -> String {
    match next {
        Next::Begin(film) => format!("Next: film {}.", film.code),
        Next::Continue(film, _) => format!("Continue with film {}.", film.code),
        Next::Wait(until) => format!("Washout: no film before {until}."),
        Next::Done => "All films are read.".to_owned(),
    }
}

fn log(store: &Store) -> Result<String, StoreError> {
    let when = |ms| Timestamp::from_unix_ms(ms).map_or_else(String::new, |at| at.to_string());
    let table = Table::of("", store.audit_log()?, |add| {
        add.numbers("Entry", |entry| entry.sequence.to_string());
        add.words("When", |entry| when(entry.time_ms));
        add.words("Who", |entry| entry.actor.clone());
        add.words("What", |entry| entry.action.clone());
        add.words("Object", |entry| shown_object(&entry.object));
    });
    Ok(terminal::table(&table, entry_width()))
}

/// An object of the log. A terminal shows the start of a film's hash; a file or a pipe gets the whole hash.
fn shown_object(object: &str) -> String {
    const SHOWN: usize = 16;
    match object.strip_prefix("content/").filter(|_| stdout().is_terminal()) {
        Some(hash) => format!("content/{}…", hash.chars().take(SHOWN).collect::<String>()),
        None => object.to_owned(),
    }
}

fn verify(path: &Path, head: Option<&Head>) -> Result<Ending, Failure> {
    let verification = view(path)?.verify(head).map_err(|error| Failure::file(path, &error))?;
    report(path, &verification)
}

fn restore(backup: &Path, path: &Path) -> Result<Ending, Failure> {
    interrupt::begin_writing();
    let restored = Store::restore(backup, path).map_err(|error| match error {
        StoreError::Backup { .. } => Failure::file(backup, &error),
        _ => Failure::file(path, &error),
    })?;
    if !restored.verification.is_clean() {
        say(format!("{} was not changed: the backup is damaged.", path.display()));
        return report(backup, &restored.verification);
    }
    let mut said = Lines::of(format!("{} was restored from {}.", path.display(), backup.display()));
    if let Some(kept) = restored.replaced {
        said.line(format!("The earlier store is {}.", kept.display()));
    }
    print(said)
}

fn report(path: &Path, verification: &Verification) -> Result<Ending, Failure> {
    let mut text = Lines::default();
    if let Some(head) = &verification.head {
        text.line(format!("{}: entries in the log: {}", path.display(), head.entries));
        text.line(format!("  end of the log: {head}"));
    }
    for finding in &verification.findings {
        text.text(&terminal::paragraph(&format!("! {finding}"), width(), "  "));
    }
    if verification.is_clean() {
        let clean = "no damage found. Keep the end of the log elsewhere: with `--head`, `verify` also detects a store that was rewritten as a whole.";
        text.text(&terminal::paragraph(clean, width(), "  "));
        return print(text);
    }
    print(text)?;
    Ok(Ending::BadInput)
}
