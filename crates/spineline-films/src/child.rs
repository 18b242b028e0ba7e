//! Decoding in another process with limits of memory, time and files. Every failure of a decoder is a [`FilmError`] for the
//! parent.
//!
//! The parent gives the film as the standard input and its [`ChildLimits`] in one environment variable, the only one that
//! the child has. The child answers on the standard output: `SPLNFILM`, a version (16 bits), the length of a header (32
//! bits), the header as JSON, and the pixels as 16-bit words, all little-endian. What the child writes to its standard
//! error is never shown: a decoder may quote the file there.

use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::error::{FilmError, Measure, system_words};
use super::pixels::little_endian;
use super::{FilmFile, FilmKind, FilmLimits, FilmRemark, FilmTags, Look, StoredPixels, read_film};

/// Limits of a decoder.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChildLimits {
    /// Of the film itself.
    pub film: FilmLimits,
    /// Address space of the child.
    pub memory_bytes: u64,
    /// Time of the processor.
    pub cpu_s: u64,
    /// Time on the clock, from start to end.
    pub wall_s: f64,
}

impl Default for ChildLimits {
    fn default() -> Self {
        Self { film: FilmLimits::default(), memory_bytes: 3 << 30, cpu_s: 30, wall_s: 60.0 }
    }
}

const VARIABLE: &str = "SPINELINE_DECODER_LIMITS";
const MAGIC: &[u8; 8] = b"SPLNFILM";
const VERSION: u16 = 1;
/// Two tables of 65536 entries are less than one MiB of JSON.
const MAX_HEADER_BYTES: u32 = 4 << 20;
/// Interval of checks whether the child has ended.
const POLL: Duration = Duration::from_millis(2);
/// Time that a child may run after its answer.
const GRACE: Duration = Duration::from_secs(2);

#[derive(Serialize, Deserialize)]
enum Header {
    Film(Box<FilmHeader>),
    Error(FilmError),
}

#[derive(Serialize, Deserialize)]
struct FilmHeader {
    kind: FilmKind,
    columns: u32,
    rows: u32,
    signed: bool,
    tags: FilmTags,
    look: Look,
    remarks: Vec<FilmRemark>,
}

/// Decodes a film in a process of `program`, which must call [`serve_child`].
///
/// # Errors
/// Errors of reading the film, and `FilmError::Decoder…` for failures of the process.
pub fn decode_in_child(
    program: &Path,
    arguments: &[&str],
    bytes: Vec<u8>,
    limits: &ChildLimits,
) -> Result<FilmFile, FilmError> {
    Measure::FileBytes.within(bytes.len() as u64, limits.film.file_bytes)?;
    let stated = serde_json::to_string(limits).expect("numbers only");
    let start = Instant::now();
    let mut child = Command::new(program)
        .args(arguments)
        .env_clear()
        .env(VARIABLE, stated)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| FilmError::DecoderStart { kind: system_words(error.kind()) })?;
    let pipe = child.stdin.take();
    // In a separate thread: a child that does not read must not block its parent.
    thread::spawn(move || {
        // A child that has ended closes the pipe; its answer gives the reason.
        pipe.map(|mut pipe| pipe.write_all(&bytes))
    });
    await_answer(child, start, limits)
}

fn await_answer(
    mut child: Child,
    start: Instant,
    limits: &ChildLimits,
) -> Result<FilmFile, FilmError> {
    let limit =
        limits.film.pixels.saturating_mul(2).saturating_add(u64::from(MAX_HEADER_BYTES) + 64);
    let answer = drain(child.stdout.take(), limit.saturating_add(1));
    let complaint = drain(child.stderr.take(), 1 << 16);
    let wall = Duration::try_from_secs_f64(limits.wall_s).unwrap_or(Duration::MAX);
    let received = answer.recv_timeout(wall.saturating_sub(start.elapsed()));
    let Ok(bytes) = received else {
        end(&mut child);
        return Err(FilmError::DecoderTimeout { limit_s: limits.wall_s });
    };
    if let Err(error) = Measure::AnswerBytes.within(bytes.len() as u64, limit) {
        end(&mut child);
        return Err(error);
    }
    let status = wait(&mut child);
    match status {
        Some(status) if status.success() => parse(&bytes),
        Some(status) => {
            let complaint = complaint.recv_timeout(GRACE).unwrap_or_default();
            Err(death(status, &complaint, limits))
        }
        None => Err(FilmError::DecoderTimeout { limit_s: limits.wall_s }),
    }
}

/// Reads a pipe to its end, or to a limit, in a separate thread.
fn drain(pipe: Option<impl Read + Send + 'static>, limit: u64) -> mpsc::Receiver<Vec<u8>> {
    let (send, receive) = mpsc::channel();
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(pipe) = pipe {
            // A broken pipe ends like a closed one: the answer is too short.
            let _ = pipe.take(limit).read_to_end(&mut bytes);
        }
        // After a time-out the result is not used.
        let _ = send.send(bytes);
    });
    receive
}

/// Waits for a child that has closed its output; kills it after a time.
fn wait(child: &mut Child) -> Option<ExitStatus> {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Some(status),
            Ok(None) if start.elapsed() < GRACE => thread::sleep(POLL),
            _ => {
                end(child);
                return None;
            }
        }
    }
}

fn end(child: &mut Child) {
    // It may have ended already.
    let _ = child.kill();
    let _ = child.wait();
}

fn death(status: ExitStatus, complaint: &[u8], limits: &ChildLimits) -> FilmError {
    // Rust's allocator writes this before it aborts.
    let phrase = b"memory allocation of";
    if complaint.windows(phrase.len()).any(|window| window == phrase) {
        return FilmError::DecoderMemory { limit_bytes: limits.memory_bytes };
    }
    match signal(status) {
        Some(SIGXCPU) => FilmError::DecoderTimeout { limit_s: limits.cpu_s as f64 },
        signal => FilmError::DecoderDied { signal },
    }
}

/// "CPU time limit exceeded" on Linux and macOS.
const SIGXCPU: i32 = 24;

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_status: ExitStatus) -> Option<i32> {
    None
}

fn parse(bytes: &[u8]) -> Result<FilmFile, FilmError> {
    let split = || {
        let rest = bytes.strip_prefix(MAGIC)?;
        let (version, rest) = rest.split_first_chunk::<2>()?;
        let (length, rest) = rest.split_first_chunk::<4>()?;
        let length = u32::from_le_bytes(*length);
        let fits = u16::from_le_bytes(*version) == VERSION && length <= MAX_HEADER_BYTES;
        rest.split_at_checked(usize::try_from(length).ok().filter(|_| fits)?)
    };
    let (header, pixels) = split().ok_or(FilmError::DecoderAnswer)?;
    let header = serde_json::from_slice(header).map_err(|_| FilmError::DecoderAnswer)?;
    let header: FilmHeader = match header {
        Header::Film(header) => *header,
        Header::Error(error) => return Err(error),
    };
    let words = pixels.as_chunks::<2>().0;
    let wanted = u64::from(header.columns) * u64::from(header.rows);
    if wanted == 0 || pixels.len() as u64 != wanted * 2 {
        return Err(FilmError::DecoderAnswer);
    }
    let stored = if header.signed {
        StoredPixels::Signed(words.iter().map(|&pair| i16::from_le_bytes(pair)).collect())
    } else {
        StoredPixels::Unsigned(words.iter().map(|&pair| u16::from_le_bytes(pair)).collect())
    };
    let FilmHeader { kind, columns, rows, tags, look, remarks, .. } = header;
    Ok(FilmFile { kind, columns, rows, stored, tags, look, remarks })
}

/// The child's side: sets limits, reads a film, answers.
///
/// # Errors
/// If the caps cannot be set, or input or output fail. A film that cannot be read is an answer.
pub fn serve_child(input: &mut dyn Read, output: &mut dyn Write) -> io::Result<()> {
    let limits = match std::env::var(VARIABLE) {
        Ok(text) => serde_json::from_str(&text)?,
        Err(_) => ChildLimits::default(),
    };
    cap(&limits)?;
    let mut bytes = Vec::new();
    input.take(limits.film.file_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    answer(read_film(&bytes, &limits.film), output)
}

#[cfg(unix)]
fn cap(limits: &ChildLimits) -> io::Result<()> {
    use rlimit::Resource;
    let set = |resource: Resource, limit: u64| rlimit::setrlimit(resource, limit, limit);
    set(Resource::AS, limits.memory_bytes)?;
    // One second from the signal to the end that cannot be caught.
    rlimit::setrlimit(Resource::CPU, limits.cpu_s, limits.cpu_s.saturating_add(1))?;
    set(Resource::FSIZE, 0)?;
    set(Resource::CORE, 0)?;
    set(Resource::NOFILE, 16)
}

#[cfg(not(unix))]
fn cap(_limits: &ChildLimits) -> io::Result<()> {
    // Only the parent's clock and the limits of the film apply here.
    Ok(())
}

fn answer(film: Result<FilmFile, FilmError>, output: &mut dyn Write) -> io::Result<()> {
    let (header, stored) = match film {
        Ok(FilmFile { kind, columns, rows, stored, tags, look, remarks }) => {
            let signed = matches!(stored, StoredPixels::Signed(_));
            let header = FilmHeader { kind, columns, rows, signed, tags, look, remarks };
            (Header::Film(Box::new(header)), stored)
        }
        Err(error) => (Header::Error(error), StoredPixels::Unsigned(Vec::new())),
    };
    let header = serde_json::to_vec(&header)?;
    let length = u32::try_from(header.len()).map_err(io::Error::other)?;
    output.write_all(MAGIC)?;
    output.write_all(&VERSION.to_le_bytes())?;
    output.write_all(&length.to_le_bytes())?;
    output.write_all(&header)?;
    let bytes: Vec<u8> = match stored {
        StoredPixels::Unsigned(words) => little_endian(&words),
        StoredPixels::Signed(words) => words.into_iter().flat_map(i16::to_le_bytes).collect(),
    };
    output.write_all(&bytes)?;
    output.flush()
}
