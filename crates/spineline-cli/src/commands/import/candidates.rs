//! The films that were found, each decoded once in its own process, with their metadata.

use spineline::anatomy::FilmView;
use spineline_files::sha256_hex;
use spineline_films::intake::{Found, IntakeLimits, Place, Survey, read, survey};
use spineline_films::{FilmRemark, FilmTags};
use spineline_marking::{SpacingJudgement, ViewJudgement, judge_spacing, judge_view};

use super::args::{FilmChoice, ImportArgs};
use crate::run::failure::Failure;
use crate::run::film_decoder::Decoder;
use crate::run::outputs::is_same_file;
use crate::run::progress::spinner;

/// A film that was found.
pub struct Candidate {
    pub found: Found,
    /// Its metadata, or why a case cannot use it.
    pub seen: Result<Seen, String>,
}

/// The data of a film that an import needs, without its pixels.
pub struct Seen {
    pub columns: u32,
    pub rows: u32,
    pub tags: FilmTags,
    pub remarks: Vec<FilmRemark>,
    /// Hash of the file's bytes, to notice a file that changes while it is imported.
    pub source: String,
    /// Hash of the decoded pixels, equal for the same film in two files.
    pub picture: String,
}

impl Seen {
    pub fn spacing(&self) -> SpacingJudgement {
        judge_spacing(&self.tags.spacing)
    }

    pub fn view(&self) -> ViewJudgement {
        judge_view(&self.tags.view, None)
    }
}

/// A film that is chosen for a view of the case.
pub struct ChosenFilm<'a> {
    pub view: FilmView,
    /// Place in the list of films.
    pub index: usize,
    pub seen: &'a Seen,
}

/// Everything that lies at the given paths.
pub struct Candidates {
    pub films: Vec<Candidate>,
    pub survey: Survey,
}

impl Candidates {
    /// Looks at the given paths and decodes every film there.
    pub fn find(args: &ImportArgs) -> Result<Self, Failure> {
        let limits = IntakeLimits::default();
        let bar = spinner("looking for films");
        let survey = survey(&args.paths, &limits, |count| bar.set_position(count as u64));
        bar.finish_and_clear();
        let survey = survey?;
        let decoder = Decoder::new()?;
        let bar = crate::run::progress::bar("decoding films", survey.films.len());
        let films = survey
            .films
            .iter()
            .map(|found| {
                bar.inc(1);
                let seen = see(found, &decoder, &limits);
                Candidate { found: found.clone(), seen }
            })
            .collect();
        bar.finish_and_clear();
        Ok(Self { films, survey })
    }

    /// The place in the list of a film that was chosen.
    pub fn index(&self, choice: &FilmChoice) -> Result<usize, Failure> {
        let index = match choice {
            FilmChoice::Number(number) => Some(number - 1).filter(|&i| i < self.films.len()),
            FilmChoice::File(path) => self.films.iter().position(
                |film| matches!(&film.found.place, Place::File(of) if is_same_file(of, path)),
            ),
        };
        index.ok_or_else(|| {
            let what = match choice {
                FilmChoice::Number(number) => format!("film {number}"),
                FilmChoice::File(path) => path.display().to_string(),
            };
            Failure::usage(format!(
                "{what} is not among the films that were found ({}); `--list` prints them with their numbers",
                self.films.len()
            ))
        })
    }

    /// What was seen in a film.
    pub fn seen(&self, index: usize) -> Result<&Seen, Failure> {
        let film = &self.films[index];
        film.seen.as_ref().map_err(|why| {
            Failure::input(
                format!("film {} ({})", index + 1, film.found.place),
                why,
                "choose another film; `--list` prints what can be used",
            )
        })
    }
}

fn see(found: &Found, decoder: &Decoder, limits: &IntakeLimits) -> Result<Seen, String> {
    let bytes = read(&found.place, limits).map_err(|error| error.to_string())?;
    let source = sha256_hex(&bytes);
    let film = decoder.decode(bytes).map_err(|error| error.to_string())?;
    let picture = film.picture_sha256();
    Ok(Seen {
        columns: film.columns,
        rows: film.rows,
        tags: film.tags,
        remarks: film.remarks,
        source,
        picture,
    })
}
