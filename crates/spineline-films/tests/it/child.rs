//! Faulty decoders: every failure of the other process is an error for the parent.

use std::path::Path;
use std::time::Instant;

use spineline_films::{ChildLimits, FilmError, Measure, decode_in_child};

use crate::maker::{EXPLICIT, Maker, ramp};

#[cfg(unix)]
#[test]
fn f62_a_child_that_hangs_crashes_or_writes_too_much_is_an_error() {
    let film = Maker::new(6, 4, &ramp(6, 4)).file(EXPLICIT);
    let mut limits = ChildLimits { wall_s: 5.0, ..ChildLimits::default() };
    limits.film.pixels = 1000;
    let run = |script: &str| {
        decode_in_child(Path::new("/bin/sh"), &["-c", script], film.clone(), &limits).unwrap_err()
    };
    let asked = Instant::now();
    assert_eq!(run("exec sleep 600"), FilmError::DecoderTimeout { limit_s: 5.0 });
    // On a slow machine too: the parent does not wait for the program's end.
    assert!(asked.elapsed().as_secs() < 120, "{:?}", asked.elapsed());
    assert_eq!(run("kill -SEGV $$"), FilmError::DecoderDied { signal: Some(11) });
    assert_eq!(run("kill -ABRT $$"), FilmError::DecoderDied { signal: Some(6) });
    assert_eq!(run("exit 101"), FilmError::DecoderDied { signal: None });
    assert_eq!(run("echo hello"), FilmError::DecoderAnswer);
    assert_eq!(run("exec cat"), FilmError::DecoderAnswer);
    assert_eq!(run("printf 'SPLNFILM\\1\\0\\377\\377\\377\\377'"), FilmError::DecoderAnswer);
    let endless = run("exec yes");
    assert!(matches!(endless, FilmError::TooLarge { what: Measure::AnswerBytes, .. }), "{endless}");
    let out_of_memory = run("echo 'memory allocation of 99 bytes failed' >&2; kill -ABRT $$");
    assert_eq!(out_of_memory, FilmError::DecoderMemory { limit_bytes: 3 << 30 });
    assert_eq!(
        run("test -z \"$HOME$PATH_TO\" || exit 0; kill -KILL $$"),
        FilmError::DecoderDied { signal: Some(9) }
    );
    let start = decode_in_child(Path::new("/nonexistent/program"), &[], film.clone(), &limits);
    assert!(matches!(start, Err(FilmError::DecoderStart { .. })));
}
