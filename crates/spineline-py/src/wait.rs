//! Long work beside the Python interpreter.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Interval of looks for Ctrl-C.
const POLL: Duration = Duration::from_millis(100);

/// Does long work while other Python threads run. At Ctrl-C it sets the flag, at which the work may stop, waits for it, and
/// raises `KeyboardInterrupt`.
///
/// # Errors
/// What a signal handler raises, or that a thread could not be started.
pub fn beside<T: Send>(py: Python<'_>, work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let (ended, end) = channel::<()>();
        let stop = &stop;
        let worker =
            thread::Builder::new().name("spineline".to_owned()).spawn_scoped(scope, move || {
                // Dropped at the end of the work, also where it panics.
                let _ended = ended;
                work(stop)
            });
        let worker = worker.map_err(|error| {
            PyRuntimeError::new_err(format!("a thread could not be started: {error}"))
        })?;
        let mut end = end;
        loop {
            let (state, back) = py.detach(move || (end.recv_timeout(POLL), end));
            end = back;
            if state == Err(RecvTimeoutError::Disconnected) {
                break;
            }
            if let Err(signal) = py.check_signals() {
                stop.store(true, Ordering::Relaxed);
                py.detach(|| worker.join()).ok();
                return Err(signal);
            }
        }
        let result = py.detach(|| worker.join());
        result.map_err(|_| {
            PyRuntimeError::new_err("a fault of the program: the computation panicked")
        })
    })
}
