//! Ctrl-C (SIGINT) and SIGTERM, by one rule for all commands.
//!
//! The first one ends the program with code 130, before any result is written. Two kinds of work are completed instead: work whose
//! parts count by themselves, such as replicates, stops after its present step ([`defer`]), and results that are being written
//! are written to the end ([`begin_writing`]). The second one ends the program at once.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fs, io};

use tempfile::{NamedTempFile, TempPath};
use tokio::sync::Notify;

use super::failure::{Failure, INTERRUPTED};
use super::messages::say;

struct State {
    /// Whether a signal has come.
    requested: bool,
    /// Parts of the program that look at it themselves.
    deferred: usize,
    /// Whether the first result is on its way.
    is_writing: bool,
    /// Unfinished files, to be removed with the program.
    parts: Vec<PathBuf>,
    /// Folders that were made for them, the outer one first.
    folders: Vec<PathBuf>,
}

static STATE: Mutex<State> = Mutex::new(State {
    requested: false,
    deferred: 0,
    is_writing: false,
    parts: Vec::new(),
    folders: Vec::new(),
});
static REQUEST: Notify = Notify::const_new();

fn state() -> MutexGuard<'static, State> {
    // Numbers and flags stay valid after a panic.
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Catches both signals from now on; to be called once, before a command begins.
pub fn catch() -> Result<(), Failure> {
    let failed = |error| Failure::internal(format!("signals cannot be caught: {error}"));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(failed)?;
    let watch = {
        let _inside = runtime.enter();
        watch().map_err(failed)?
    };
    let thread = std::thread::Builder::new().name("signals".to_owned());
    thread.spawn(move || runtime.block_on(watch)).map(|_| ()).map_err(failed)
}

#[cfg(unix)]
fn watch() -> std::io::Result<impl Future<Output = ()>> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    Ok(async move {
        tokio::spawn(async move {
            while terminate.recv().await.is_some() {
                on_signal();
            }
        });
        while interrupt.recv().await.is_some() {
            on_signal();
        }
    })
}

#[cfg(not(unix))]
fn watch() -> std::io::Result<impl Future<Output = ()>> {
    Ok(async {
        while tokio::signal::ctrl_c().await.is_ok() {
            on_signal();
        }
    })
}

fn on_signal() {
    let mut state = state();
    let is_first = !std::mem::replace(&mut state.requested, true);
    if is_first && (state.deferred > 0 || state.is_writing) {
        let what = if state.is_writing {
            "the results are being written, and will be complete"
        } else {
            "stopping after the present step"
        };
        drop(state);
        REQUEST.notify_one();
        say(format!("{what}; Ctrl-C again ends the program at once"));
        return;
    }
    if is_first {
        say(&Failure::interrupted());
    }
    for part in &state.parts {
        let _ = fs::remove_file(part);
    }
    for folder in state.folders.iter().rev() {
        // A folder that holds results stays.
        let _ = fs::remove_dir(folder);
    }
    // The state stays locked, so that nothing begins to be written now.
    std::process::exit(INTERRUPTED.into());
}

/// Work that looks at [`is_requested`] itself, as long as this lives.
#[must_use]
pub struct Deferred(());

impl Drop for Deferred {
    fn drop(&mut self) {
        state().deferred -= 1;
    }
}

/// Leaves it to the caller to stop, where the results so far count.
pub fn defer() -> Deferred {
    state().deferred += 1;
    Deferred(())
}

/// From now on, the first signal lets the program write all of its results.
pub fn begin_writing() {
    state().is_writing = true;
}

/// An unfinished file. It is removed if it is dropped without a name, or if a signal ends the program before it has its name.
pub struct Part<F = NamedTempFile> {
    pub file: F,
    /// Dropped after the file.
    listed: Listed,
}

/// A path in the list of unfinished files.
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        state().parts.retain(|other| *other != self.0);
    }
}

impl Part {
    /// Makes a file and lists it; a signal waits until both are done.
    pub fn make(make: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<Self> {
        let mut state = state();
        let file = make()?;
        let path = file.path().to_owned();
        state.parts.push(path.clone());
        Ok(Self { file, listed: Listed(path) })
    }

    /// Closes the file; a signal still removes it.
    pub fn close(self) -> Part<TempPath> {
        Part { file: self.file.into_temp_path(), listed: self.listed }
    }
}

impl Part<TempPath> {
    /// Gives the file its name.
    ///
    /// # Errors
    /// If it cannot have this name; it is removed then.
    pub fn persist(self, file: &Path) -> io::Result<()> {
        self.file.persist(file).map_err(|error| error.error)
    }
}

/// Makes a folder and those around it, which are removed if a signal ends the program while they are empty; returns those that were
/// missing, the outer one first.
pub fn make_folder(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut state = state();
    let around = folder.ancestors().take_while(|one| !one.as_os_str().is_empty() && !one.exists());
    let mut missing: Vec<PathBuf> = around.map(Path::to_owned).collect();
    missing.reverse();
    state.folders.extend_from_slice(&missing);
    if !missing.is_empty() {
        fs::create_dir_all(folder)?;
    }
    Ok(missing)
}

/// Whether a signal has come.
pub fn is_requested() -> bool {
    state().requested
}

/// Waits for a signal; for one waiting part of the program.
pub async fn requested() {
    REQUEST.notified().await;
}
