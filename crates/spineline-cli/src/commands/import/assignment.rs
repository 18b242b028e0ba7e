//! Assigns the films of a file of landmarks to films of the case.

use std::path::PathBuf;

use spineline::anatomy::Posture;
use spineline_landmarks::MarkedFilm;

use super::args::{ImportArgs, OfFilm};
use super::pictures::Pictures;
use crate::run::failure::Failure;
use crate::run::messages::say;

/// A file of landmarks, the option that names it, and the films that are there.
pub struct Assignment<'a> {
    pub args: &'a ImportArgs,
    pub of: &'a OfFilm<PathBuf>,
    pub pictures: &'a Pictures,
    /// The only frontal film of the case.
    pub only: Option<Posture>,
}

impl Assignment<'_> {
    /// The films with their postures: as the file states, as the option says, as their pictures are named, or the only one.
    pub fn films(&self, films: Vec<MarkedFilm>) -> Result<Vec<(Posture, MarkedFilm)>, Failure> {
        let count = films.len();
        let (mut found, mut others) = (Vec::new(), Vec::new());
        for film in films {
            let named = film.picture.as_deref().and_then(|name| self.pictures.film(name));
            // With several pictures, an option for one film means the picture with its name.
            let said = match self.of.posture {
                Some(given) if count > 1 => named.filter(|named| *named == given),
                Some(given) => Some(given),
                None => named.or(self.only.filter(|_| count == 1)),
            };
            match film.posture.or(said) {
                Some(posture) => {
                    self.check_picture(posture, named, &film)?;
                    found.push((posture, film));
                }
                None => others.extend(film.picture),
            }
        }
        if found.is_empty() {
            return Err(self.unmatched(&others));
        }
        if !others.is_empty() {
            let (file, names) = (self.of.value.display(), listed(&others));
            say(format!(
                "note: {file}: pictures of no film of this case were passed over: {names}"
            ));
        }
        Ok(found)
    }

    /// Checks a picture with the name of another film, or of no film.
    fn check_picture(
        &self,
        posture: Posture,
        named: Option<Posture>,
        film: &MarkedFilm,
    ) -> Result<(), Failure> {
        let file = self.of.value.display();
        let Some(name) = film.picture.as_deref().map(shortened) else { return Ok(()) };
        match (named, self.pictures.name_of(posture)) {
            (Some(other), _) if other != posture => {
                let what = format!(
                    "its landmarks of the {posture} film name the picture {name}, which belongs to the {other} film"
                );
                if self.args.accept {
                    say(format!("note: {file}: {what}; accepted by --accept"));
                    return Ok(());
                }
                let help = "give the file for the film that it names, or --accept if you are sure";
                Err(Failure::input(file, what, help))
            }
            (None, Some(own)) => {
                say(format!(
                    "note: {file}: its landmarks of the {posture} film name the picture {name}, and the film is {own}: check that they are of this film"
                ));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The error for pictures without a film of the case.
    fn unmatched(&self, names: &[String]) -> Failure {
        if names.is_empty() {
            let what = "it does not state of which film it is";
            let help = "name the film, as in --landmarks erect=FILE";
            return Failure::input(self.of.value.display(), what, help);
        }
        let what = format!(
            "its pictures ({}) have other names than the films of this case ({})",
            listed(names),
            self.pictures.words()
        );
        let help = "give one file of landmarks per film, as in --landmarks erect=FILE; of several pictures in one file, name each as its film is named";
        Failure::input(self.of.value.display(), what, help)
    }
}

/// At most the last 60 letters of a name from a file.
fn shortened(name: &str) -> String {
    match name.char_indices().rev().nth(60) {
        Some((before, c)) => format!("…{}", &name[before + c.len_utf8()..]),
        None => name.to_owned(),
    }
}

/// The first names of a list.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 5;
    let mut text =
        names.iter().take(SHOWN).map(|name| shortened(name)).collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN {
        text.push_str(&format!(" and {} more", names.len() - SHOWN));
    }
    text
}
