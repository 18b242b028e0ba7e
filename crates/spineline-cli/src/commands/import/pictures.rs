//! Finds the film of a picture that a file of landmarks names.

use std::path::Path;

use spineline::anatomy::Posture;
use spineline_files::column_name;
use spineline_films::intake::Place;

use super::candidates::Candidates;
use super::resolve::ResolvedFilm;

/// The frontal films of a case by their names.
pub struct Pictures(Vec<NamedFilm>);

struct NamedFilm {
    posture: Posture,
    /// Folders and name of its file, the name last; the entry of an archive has none.
    path: Vec<String>,
    sop_instance: Option<String>,
}

/// How well a name fits a film: the same name goes before one with another ending, and equal folders decide between equal names.
type Fit = (bool, usize);

impl Pictures {
    pub fn of(films: &[ResolvedFilm], candidates: &Candidates) -> Self {
        let named = |film: &ResolvedFilm| {
            let candidate = &candidates.films[film.index];
            let path = match &candidate.found.place {
                Place::File(path) => parts(&path.to_string_lossy()),
                Place::Entry { .. } => Vec::new(),
            };
            let seen = candidate.seen.as_ref().ok();
            let sop_instance = seen.and_then(|seen| seen.tags.uids.sop_instance.clone());
            Some(NamedFilm { posture: film.view.posture()?, path, sop_instance })
        };
        Self(films.iter().filter_map(named).collect())
    }

    /// The film whose picture this is; `None` if no film or several match.
    pub fn film(&self, picture: &str) -> Option<Posture> {
        let by_identifier =
            self.0.iter().find(|film| film.sop_instance.as_deref() == Some(picture));
        if let Some(film) = by_identifier {
            return Some(film.posture);
        }
        let picture = parts(picture);
        let fits =
            self.0.iter().filter_map(|film| Some((fit(&film.path, &picture)?, film.posture)));
        let fits: Vec<(Fit, Posture)> = fits.collect();
        let best = fits.iter().map(|(fit, _)| *fit).max();
        let mut best = fits.iter().filter(|(fit, _)| Some(*fit) == best);
        match (best.next(), best.next()) {
            (Some((_, posture)), None) => Some(*posture),
            (Some(_), Some(_)) => None,
            _ => self.by_posture(picture.last()?),
        }
    }

    /// Exports of this program name the picture of a film after its posture.
    fn by_posture(&self, name: &str) -> Option<Posture> {
        let key = column_name(stem(name));
        self.0.iter().map(|film| film.posture).find(|posture| posture.key() == key)
    }

    /// The name of the file of a film.
    pub fn name_of(&self, posture: Posture) -> Option<&str> {
        let film = self.0.iter().find(|film| film.posture == posture)?;
        film.path.last().map(String::as_str)
    }

    /// The names of all files, with their postures.
    pub fn words(&self) -> String {
        let name = |film: &NamedFilm| {
            let file = film.path.last().map_or("an entry of an archive", String::as_str);
            format!("{file} ({})", film.posture)
        };
        self.0.iter().map(name).collect::<Vec<_>>().join(", ")
    }
}

/// Folders and name of a path of any system.
fn parts(path: &str) -> Vec<String> {
    path.split(['/', '\\']).filter(|part| !part.is_empty()).map(str::to_owned).collect()
}

/// A name without its ending.
fn stem(name: &str) -> &str {
    Path::new(name).file_stem().and_then(|stem| stem.to_str()).unwrap_or(name)
}

/// A name without the prefixes and suffixes of programs: Label Studio eight digits, Roboflow the old ending and a hash.
fn plain(name: &str) -> &str {
    let name = name.split_once(".rf.").map_or(name, |(first, _)| first);
    let name =
        ["_png", "_jpg", "_jpeg"].iter().find_map(|old| name.strip_suffix(old)).unwrap_or(name);
    match name.split_once('-') {
        Some((hash, rest)) if hash.len() == 8 && hash.bytes().all(|c| c.is_ascii_hexdigit()) => {
            rest
        }
        _ => name,
    }
}

fn fit(film: &[String], picture: &[String]) -> Option<Fit> {
    let ((file, folders), (name, others)) = (film.split_last()?, picture.split_last()?);
    let is_same = file.eq_ignore_ascii_case(name);
    let alike = |name: &str| stem(file).eq_ignore_ascii_case(name);
    if !(is_same || alike(stem(name)) || alike(plain(stem(name))) || alike(plain(name))) {
        return None;
    }
    let pairs = folders.iter().rev().zip(others.iter().rev());
    Some((is_same, pairs.take_while(|(a, b)| a.eq_ignore_ascii_case(b)).count()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pictures(files: &[(Posture, &str)]) -> Pictures {
        let film = |&(posture, path): &(Posture, &str)| NamedFilm {
            posture,
            path: parts(path),
            sop_instance: Some(format!("1.2.{}", posture as u8)),
        };
        Pictures(files.iter().map(film).collect())
    }

    #[test]
    fn a_picture_belongs_to_the_film_with_its_name() {
        use Posture::{Erect, LeftBending};
        let films = pictures(&[(Erect, "o02/P07_standing.dcm"), (LeftBending, "o02/P07_LB.dcm")]);
        for (name, posture) in [
            ("P07_standing.dcm", Some(Erect)),
            ("P07_LB.png", Some(LeftBending)),
            ("p07_lb.PNG", Some(LeftBending)),
            ("C:\\study\\pictures\\P07_LB.png", Some(LeftBending)),
            ("../images/P07_standing.png", Some(Erect)),
            ("/data/upload/1/624cb493-P07_LB.png", Some(LeftBending)),
            ("P07_LB_png.rf.0f1e2d.jpg", Some(LeftBending)),
            ("P07_LB_jpg.rf.0f1e2d.jpg", Some(LeftBending)),
            ("left_bending.png", Some(LeftBending)),
            ("erect.png", Some(Erect)),
            ("1.2.0", Some(Erect)),
            ("000001.png", None),
            ("P07_L.png", None),
            ("neutral.png", None),
            ("", None),
        ] {
            assert_eq!(films.film(name), posture, "{name}");
        }
    }

    #[test]
    fn equal_names_are_told_apart_by_their_folders() {
        use Posture::{Erect, LeftBending};
        let films = pictures(&[(Erect, "P07/erect/IM0001"), (LeftBending, "P07/left/IM0001")]);
        assert_eq!(films.film("left/IM0001.png"), Some(LeftBending));
        assert_eq!(films.film("P07\\erect\\IM0001"), Some(Erect));
        assert_eq!(films.film("IM0001.png"), None);
    }
}
