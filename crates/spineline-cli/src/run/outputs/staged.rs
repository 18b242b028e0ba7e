//! Results of one command: their targets are checked before any work, and they appear together at its end.

use std::collections::{BTreeSet, HashSet};
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use clap::Args;
use indexmap::IndexMap;
use spineline_files::{
    InputFile, MAX_ANALYSES_BYTES, Provenance, ProvenanceFile, case_ids, film_names, read_bytes,
    to_text, with_hash,
};
use tempfile::TempPath;

use super::parts::Parts;
use super::print_data;
use super::target::{Identity, Target, is_stdout, refuse_film};
use super::there::There;
use crate::run::failure::Failure;
use crate::run::interrupt::{self, Part};
use crate::run::messages::say;

/// The permission to replace files.
#[derive(Args, Debug, Clone, Copy)]
pub struct OverwriteArgs {
    /// Replace output files that this program did not write, that were changed since, or that are of other patients; inputs, their
    /// films, other DICOM films and study stores are never replaced
    #[arg(long)]
    pub overwrite: bool,
}

/// The outputs of one command.
///
/// Files are written beside their targets under temporary names, and get their own names in [`Outputs::commit`]. Without that,
/// such as after a failure, every target is as it was and nothing is left behind. Of several results, one that cannot be made does not
/// stop the others ([`Outputs::attempt`]).
pub struct Outputs {
    overwrite: bool,
    inputs: Vec<(PathBuf, Identity)>,
    named: OnceLock<Named>,
    state: Mutex<State>,
}

/// What the inputs name.
struct Named {
    /// Their cases; `None` if they are not known before they are read: without an input, and with an input that allows one reading only.
    cases: Option<BTreeSet<String>>,
    /// Their films, which lie beside them.
    films: Vec<Identity>,
}

#[derive(Default)]
struct State {
    declared: Vec<Identity>,
    /// Names of what was written, with upper and lower case as one.
    written: HashSet<String>,
    /// The cases that this command has read.
    cases: BTreeSet<String>,
    parts: Vec<Parts>,
    staged: Vec<Staged>,
    /// Folders that were made, the outer one first.
    folders: Vec<PathBuf>,
    /// Results that could not be made, beside others that can.
    failures: Vec<Failure>,
    /// Two results have one name, so that nothing is written.
    conflict: Option<Failure>,
}

enum Staged {
    Printed(String),
    Into(PathBuf, Vec<u8>),
    File { part: Part<TempPath>, file: PathBuf, shown: PathBuf },
}

impl Outputs {
    /// For a command that reads these files, if they exist.
    pub fn new<'a>(args: OverwriteArgs, inputs: impl IntoIterator<Item = &'a Path>) -> Self {
        let inputs = inputs.into_iter().map(|path| (path.to_owned(), Identity::of(path))).collect();
        let (named, state) = (OnceLock::new(), Mutex::default());
        Self { overwrite: args.overwrite, inputs, named, state }
    }

    /// Adds a case of the results: they may replace earlier results of this case.
    pub fn of_case(&self, id: &str) {
        self.state().cases.insert(id.to_owned());
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // Lists stay valid after a panic.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Checks a file before any work.
    ///
    /// # Errors
    /// If it is an input or a film of one, a store or another output, cannot be written, or would replace what this program did not write.
    pub fn file(&self, path: &Path) -> Result<(), Failure> {
        self.declare(path)?;
        if let Target::File(file) = Target::of(path)? {
            self.check_replaceable(path, &file, None)?;
        }
        Ok(())
    }

    /// Checks a file that may have the new content already, which is compared when it is written.
    ///
    /// # Errors
    /// As [`Outputs::file`], except for refusals to replace a file.
    pub fn declare(&self, path: &Path) -> Result<(), Failure> {
        let Target::File(file) = Target::of(path)? else { return Ok(()) };
        let identity = self.check_own(path, &file)?;
        if self.state().declared.iter().any(|other| other.is_alike(&identity)) {
            return Err(named_twice(path));
        }
        check_folder(path, file.parent().unwrap_or(Path::new("")))?;
        self.state().declared.push(identity);
        Ok(())
    }

    /// Checks a table, which has its provenance beside it.
    pub fn table(&self, path: &Path) -> Result<(), Failure> {
        self.file(path)?;
        match Target::of(path)? {
            Target::File(_) => self.file(&beside(path)),
            Target::StandardOutput | Target::Into(_) => Ok(()),
        }
    }

    /// Checks a folder of results, which may be there already.
    ///
    /// # Errors
    /// If it is the standard output or a file, or cannot be made or written.
    pub fn folder(&self, path: &Path) -> Result<(), Failure> {
        if is_stdout(path) {
            let path = path.display();
            return Err(Failure::usage(format!(
                "several files cannot go to {path}: name a folder"
            )));
        }
        check_folder(path, path)
    }

    /// Keeps a result for its path; a file beside its target, so that there is room for it.
    ///
    /// # Errors
    /// As [`Outputs::file`], unless the same content is there; or if it cannot be written.
    pub fn write(&self, path: &Path, content: impl Into<Vec<u8>>) -> Result<(), Failure> {
        let content = with_hash(content.into());
        let staged = match Target::of(path)? {
            Target::StandardOutput => {
                Staged::Printed(String::from_utf8(content).map_err(|_| {
                    Failure::usage("this result is not text; name a file and not `-`")
                })?)
            }
            Target::Into(stream) => Staged::Into(stream, content),
            Target::File(file) => {
                let mut part = self.begin_file(path, &file)?;
                let is_same = || fs::read(&file).is_ok_and(|there| there == content);
                self.check_replaceable(path, &file, Some(&case_ids(&content)))
                    .or_else(|failure| if is_same() { Ok(()) } else { Err(failure) })?;
                part.file.write_all(&content).map_err(failed(path))?;
                part.file.flush().map_err(failed(path))?;
                Staged::File { part: part.close(), file, shown: path.to_owned() }
            }
        };
        self.state().staged.push(staged);
        Ok(())
    }

    /// An empty file in the folder of a target that no other result has.
    pub(super) fn begin_file(&self, path: &Path, file: &Path) -> Result<Part, Failure> {
        let identity = self.check_own(path, file)?;
        let mut state = self.state();
        if !state.written.insert(identity.name()) {
            state.conflict.get_or_insert_with(|| named_twice(path));
            return Err(named_twice(path));
        }
        let folder = folder_or_here(file.parent().unwrap_or(Path::new("")));
        let made = interrupt::make_folder(folder).map_err(failed(path))?;
        state.folders.extend(made);
        if let Some(known) = state.parts.iter().find(|parts| parts.folder == *folder) {
            return known.add().map_err(failed(path));
        }
        let parts = Parts::begin(folder).map_err(failed(path))?;
        let part = parts.add().map_err(failed(path));
        state.parts.push(parts);
        part
    }

    /// Keeps a result of [`Outputs::begin`].
    pub(super) fn keep(&self, part: Part<TempPath>, file: PathBuf, shown: PathBuf) {
        self.state().staged.push(Staged::File { part, file, shown });
    }

    /// A table, and in a file beside it its provenance, so that other programs read the table unchanged. The standard output and
    /// pipes get the table alone.
    pub fn write_table(
        &self,
        path: &Path,
        content: impl Into<Vec<u8>>,
        provenance: &Provenance,
    ) -> Result<(), Failure> {
        let content = content.into();
        let table = InputFile::of(name_of(path), &content);
        self.write(path, content)?;
        self.write_provenance(path, table, provenance)
    }

    /// The provenance of a table, in a file beside it.
    pub fn write_provenance(
        &self,
        path: &Path,
        table: InputFile,
        provenance: &Provenance,
    ) -> Result<(), Failure> {
        if !matches!(Target::of(path)?, Target::File(_)) {
            return Ok(());
        }
        let file = ProvenanceFile::new(vec![table], provenance.clone());
        self.write(&beside(path), to_text(&file))
    }

    /// Makes one of several results. If that fails, it is removed and the others are made; [`Outputs::commit`] returns the failure.
    /// Returns whether it was made.
    pub fn attempt(&self, result: &Path, make: impl FnOnce() -> Result<(), Failure>) -> bool {
        let before = self.state().staged.len();
        let Err(failure) = make() else { return true };
        let mut state = self.state();
        state.staged.truncate(before);
        state.failures.push(failure.naming(result));
        false
    }

    /// Gives all results their names, and prints what goes to the standard output.
    ///
    /// # Errors
    /// Of every result that could not be made or written; the others are. If two results have one name, nothing is written.
    pub fn commit(self) -> Result<(), Failure> {
        self.name_all(&mut Vec::new())
    }

    /// As [`Outputs::commit`], and says on the standard error which files were written.
    pub fn commit_and_say(self) -> Result<(), Failure> {
        let mut files = Vec::new();
        let kept = self.name_all(&mut files);
        for line in written_words(&files) {
            say(line);
        }
        kept
    }

    fn name_all(self, files: &mut Vec<PathBuf>) -> Result<(), Failure> {
        interrupt::begin_writing();
        let (staged, mut failures) = {
            let mut state = self.state();
            if let Some(conflict) = state.conflict.take() {
                return Err(conflict);
            }
            (std::mem::take(&mut state.staged), std::mem::take(&mut state.failures))
        };
        let mut printed = String::new();
        for one in staged {
            let written = match one {
                Staged::Printed(text) => {
                    printed.push_str(&text);
                    Ok(())
                }
                Staged::Into(stream, content) => write_into(&stream, &content),
                Staged::File { part, file, shown } => {
                    let named = part.persist(&file).map_err(failed(&shown));
                    named.map(|()| files.push(shown))
                }
            };
            failures.extend(written.err());
        }
        if !printed.is_empty() {
            failures.extend(print_data(&printed).err());
        }
        Failure::together(failures).map_or(Ok(()), Err)
    }

    /// Refuses an input of this command, and a film that an input names.
    fn check_own(&self, path: &Path, file: &Path) -> Result<Identity, Failure> {
        let identity = Identity::of(file);
        let is_film = || self.named().films.iter().any(|film| film.is(&identity));
        let what = if self.inputs.iter().any(|(_, input)| input.is(&identity)) {
            "an input"
        } else if file.exists() && is_film() {
            "a film of an input"
        } else {
            return Ok(identity);
        };
        let why = format!("it is {what} of this command, which would be destroyed");
        Err(Failure::target(path, &why, "name another file"))
    }

    /// Refuses to replace files of other programs, changed files, and results of cases that the inputs, the cases that were read and
    /// the content do not have; `None` before the content is known.
    pub(super) fn check_replaceable(
        &self,
        path: &Path,
        file: &Path,
        content: Option<&BTreeSet<String>>,
    ) -> Result<(), Failure> {
        if !file.exists() {
            return Ok(());
        }
        if self.overwrite {
            return refuse_film(path, file);
        }
        let why = match There::of(path, file) {
            There::Result(cases) => {
                let Some(other) = self.other_case(&cases, content) else { return Ok(()) };
                format!("it is a result of the case {other}, which is not a case of this command")
            }
            There::Changed => "it was changed after this program wrote it".to_owned(),
            There::Other => {
                "it exists, and is not a result that this program can make again".to_owned()
            }
        };
        let help = "name another file, or add `--overwrite` to replace it";
        Err(Failure::target(path, &why, help))
    }

    /// A case of a result that is not a case of this command.
    fn other_case<'a>(
        &self,
        cases: &'a BTreeSet<String>,
        content: Option<&BTreeSet<String>>,
    ) -> Option<&'a String> {
        let of_inputs = self.named().cases.as_ref();
        if cases.is_empty() || (of_inputs.is_none() && content.is_none()) {
            return None;
        }
        let state = self.state();
        let known = [Some(&state.cases), content, of_inputs];
        cases.iter().find(|case| !known.iter().flatten().any(|all| all.contains(*case)))
    }

    /// Reads the inputs when this is asked for the first time.
    fn named(&self) -> &Named {
        self.named.get_or_init(|| {
            let cases = (!self.inputs.is_empty()).then(BTreeSet::new);
            let mut named = Named { cases, films: Vec::new() };
            for (path, _) in &self.inputs {
                let bytes = path.is_file().then(|| read_bytes(path, MAX_ANALYSES_BYTES).ok());
                let Some(bytes) = bytes.flatten() else {
                    named.cases = None;
                    continue;
                };
                named.cases.iter_mut().for_each(|cases| cases.extend(case_ids(&bytes)));
                let beside = |name: String| Identity::of(&path.with_file_name(name));
                named.films.extend(film_names(&bytes).into_iter().map(beside));
            }
            named
        })
    }
}

impl Drop for Outputs {
    /// Removes what was begun and not committed.
    fn drop(&mut self) {
        let state = self.state.get_mut().unwrap_or_else(PoisonError::into_inner);
        state.staged.clear();
        state.parts.clear();
        for folder in state.folders.iter().rev() {
            // A folder with a file in it stays.
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Files of one folder that are named one by one.
const MOST_NAMED: usize = 4;

/// Says which files were written: one by one, or the number of files of a folder.
fn written_words(files: &[PathBuf]) -> Vec<String> {
    let mut folders: IndexMap<&Path, Vec<&PathBuf>> = IndexMap::new();
    for file in files {
        folders.entry(file.parent().unwrap_or(Path::new(""))).or_default().push(file);
    }
    let of_folder = |(folder, files): (&Path, Vec<&PathBuf>)| match files.len() {
        0..=MOST_NAMED => files.iter().map(|file| format!("written: {}", file.display())).collect(),
        count => vec![format!("written: {count} files in {}", folder_or_here(folder).display())],
    };
    folders.into_iter().flat_map(of_folder).collect()
}

/// The name of a file without its folder.
pub(super) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

pub(super) fn failed(path: &Path) -> impl Fn(io::Error) -> Failure {
    let place = path.display().to_string();
    move |error| Failure::write(&place, &error)
}

fn folder_or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// Whether a file can be made in a folder, or in the nearest one around it that is there.
fn check_folder(path: &Path, folder: &Path) -> Result<(), Failure> {
    let there = folder.ancestors().find(|one| one.as_os_str().is_empty() || one.exists());
    let there = folder_or_here(there.unwrap_or(Path::new("")));
    tempfile::tempfile_in(there).map(|_| ()).map_err(failed(path))
}

fn named_twice(path: &Path) -> Failure {
    Failure::target(
        path,
        "it is named for two outputs of this command (upper and lower case count as one)",
        "give each output a file, and each case a `case_id`, that differs in more than upper and lower case",
    )
}

/// A pipe or device gets the content and stays what it is.
fn write_into(stream: &Path, content: &[u8]) -> Result<(), Failure> {
    let opened = OpenOptions::new().append(true).open(stream);
    let written = opened.and_then(|mut stream| stream.write_all(content));
    match written {
        // A closed pipe is not an error, as with the standard output.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(failed(stream)),
    }
}

/// `errors.csv` has `errors.csv.provenance.json` beside it.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".provenance.json");
    path.with_file_name(name)
}
