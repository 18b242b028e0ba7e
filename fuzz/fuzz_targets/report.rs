//! DICOM reports of landmarks.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = spineline_landmarks::read_sr(bytes);
});
