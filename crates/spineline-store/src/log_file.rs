//! SQLite's write-ahead log as a file (<https://www.sqlite.org/fileformat2.html#the_write_ahead_log>): whether it holds changes, and
//! whether some of them can no longer be read.
//!
//! SQLite reads a log up to the first frame whose checksum is wrong, and ignores the rest. A killed process or a loss of power
//! leaves such a frame in the last change, which was not acknowledged. Changes after it were acknowledged.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

const HEADER_BYTES: usize = 32;
const FRAME_HEADER_BYTES: usize = 24;
const MAGIC: u32 = 0x377f_0682;
/// A log that another program restarts during the reading looks damaged once.
const TRIES: usize = 3;

/// What a log holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LogContent {
    /// The log is missing or has no committed change.
    Nothing,
    /// Changes.
    Changes,
    /// Changes that can no longer be read.
    Torn,
}

impl LogContent {
    /// Reads a log file.
    pub fn of(log: &Path) -> io::Result<Self> {
        let mut content = Self::Nothing;
        for _ in 0..TRIES {
            content = match File::open(log) {
                Ok(file) => survey(&mut BufReader::new(file))?,
                Err(error) if error.kind() == io::ErrorKind::NotFound => Self::Nothing,
                Err(error) => return Err(error),
            };
            if content != Self::Torn {
                break;
            }
        }
        Ok(content)
    }
}

fn survey(log: &mut impl Read) -> io::Result<LogContent> {
    let mut header = [0; HEADER_BYTES];
    if !fill(log, &mut header)? {
        return Ok(LogContent::Nothing);
    }
    let mut chain = Chain { is_big_endian: word(&header, 0) & 1 == 1, sums: [0; 2] };
    chain.add(&header[..24]);
    let page_bytes = word(&header, 8) as usize;
    let is_sound = word(&header, 0) & !1 == MAGIC
        && page_bytes.is_power_of_two()
        && (512..=65_536).contains(&page_bytes)
        && chain.sums == [word(&header, 24), word(&header, 28)];
    let mut frame = vec![0; FRAME_HEADER_BYTES + if is_sound { page_bytes } else { 0 }];
    if !is_sound {
        // A header is flushed before the first frame.
        let has_more = fill(log, &mut frame[..1])?;
        return Ok(if has_more { LogContent::Torn } else { LogContent::Nothing });
    }
    let (mut is_readable, mut commits, mut unreadable_commits) = (true, 0_usize, 0_usize);
    while fill(log, &mut frame)? {
        let is_of_this_log = frame[8..16] == header[16..24];
        if is_readable {
            chain.add(&frame[..8]);
            chain.add(&frame[FRAME_HEADER_BYTES..]);
            is_readable = is_of_this_log && chain.sums == [word(&frame, 16), word(&frame, 20)];
        }
        if is_of_this_log && word(&frame, 4) != 0 {
            *(if is_readable { &mut commits } else { &mut unreadable_commits }) += 1;
        }
    }
    Ok(match (commits, unreadable_commits) {
        (_, 2..) => LogContent::Torn,
        (0, _) => LogContent::Nothing,
        _ => LogContent::Changes,
    })
}

/// Fills the bytes; returns whether the source had enough.
fn fill(source: &mut impl Read, bytes: &mut [u8]) -> io::Result<bool> {
    match source.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// The running checksum of a log.
struct Chain {
    is_big_endian: bool,
    sums: [u32; 2],
}

impl Chain {
    fn add(&mut self, bytes: &[u8]) {
        for pair in bytes.chunks_exact(8) {
            for (index, half) in pair.chunks_exact(4).enumerate() {
                let half = [half[0], half[1], half[2], half[3]];
                let value = if self.is_big_endian {
                    u32::from_be_bytes(half)
                } else {
                    u32::from_le_bytes(half)
                };
                let added = value.wrapping_add(self.sums[1 - index]);
                self.sums[index] = self.sums[index].wrapping_add(added);
            }
        }
    }
}
