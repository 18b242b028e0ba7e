//! Long work while the Python interpreter runs.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::Builder;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Interval of checks for Ctrl-C.
const POLL: Duration = Duration::from_millis(100);

/// Runs long work while other Python threads run. At Ctrl-C it sets the flag and raises `KeyboardInterrupt` without
/// waiting. The work runs until it checks the flag, and its result is dropped.
///
/// # Errors
/// Exceptions of a signal handler, or if a thread could not be started.
pub fn apart<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    apart_with(py, |_| Ok(()), work)
}

/// As [`apart`], and calls a function at every check for Ctrl-C: it shows progress, or ends the call by an error, as in a worker, which
/// cannot receive Ctrl-C.
///
/// # Errors
/// As [`apart`], and errors of the function.
pub fn apart_with<T: Send + 'static>(
    py: Python<'_>,
    at_check: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, receiver) = channel();
    let seen = Arc::clone(&stop);
    let worker = Builder::new().name("spineline".to_owned());
    worker.spawn(move || sender.send(work(&seen)).ok()).map_err(|error| {
        PyRuntimeError::new_err(format!("a thread could not be started: {error}"))
    })?;
    let result = received(py, receiver, at_check);
    stop.store(result.is_err(), Ordering::Relaxed);
    result
}

/// Waits for a worker's message, or for an exception of a signal handler or of the function.
fn received<T: Send>(
    py: Python<'_>,
    mut receiver: Receiver<T>,
    mut at_check: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    loop {
        at_check(py)?;
        let (state, back) = py.detach(move || (receiver.recv_timeout(POLL), receiver));
        receiver = back;
        match state {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            // The sender is dropped if the work panics.
            Err(RecvTimeoutError::Disconnected) => {
                let text = "a fault of the program: the computation panicked";
                return Err(PyRuntimeError::new_err(text));
            }
        }
    }
}
