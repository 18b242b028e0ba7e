//! Two heads of the audit log in a small file beside the store. They reveal a lost log of SQLite, and a store that went back.
//!
//! The file has two lines of fixed length, `NUMBER:HASH`: the last acknowledged change, and the last one that was surely in the
//! main file. It is written in place after the commit, so it is never ahead of the store. It is never torn either, because a disk
//! writes a sector as a whole. It is not flushed: after a loss of power it may lag behind, which weakens it but gives no false
//! alarm.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::audit::Head;
use crate::beside::{HEADS, beside, remove};
use crate::error::StoreError;
use crate::privacy;

/// Length of both lines.
const LENGTH: usize = 2 * (20 + 1 + 64 + 1);

/// The heads that are kept beside a store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Heads {
    /// The last change that was acknowledged.
    pub last: Head,
    /// The last one that was in the main file at some time.
    pub in_main: Head,
}

impl Heads {
    /// The heads beside a store, if they are there.
    ///
    /// # Errors
    /// [`StoreError::Damaged`] for another text.
    pub fn read(store: &Path) -> Result<Option<Self>, StoreError> {
        let mut bytes = Vec::new();
        let Ok(file) = File::open(beside(store, HEADS)) else { return Ok(None) };
        let read = file.take(LENGTH as u64 + 1).read_to_end(&mut bytes);
        // After a loss of power, a new file may be there without its content.
        if read.is_err() || bytes.iter().all(|&byte| byte == 0) {
            return Ok(None);
        }
        let heads = std::str::from_utf8(&bytes).ok().and_then(parse);
        heads.map(Some).ok_or_else(|| StoreError::damaged(format!("its file `{HEADS}`")))
    }

    fn text(&self) -> String {
        let line = |head: &Head| format!("{:020}:{:0>64}\n", head.entries, head.hash.as_str());
        line(&self.last) + &line(&self.in_main)
    }
}

fn parse(text: &str) -> Option<Heads> {
    let (last, in_main) = text.strip_suffix('\n')?.split_once('\n')?;
    let head = |line: &str| {
        let (entries, hash) = line.split_once(':')?;
        Head::parse(entries, hash)
    };
    Some(Heads { last: head(last)?, in_main: head(in_main)? })
}

/// The open file of the heads, for a store that is written.
#[derive(Debug)]
pub(crate) struct HeadFile {
    file: File,
    heads: Heads,
}

impl HeadFile {
    /// Opens or makes it, with these heads.
    pub fn open(store: &Path, heads: Heads) -> Result<Self, StoreError> {
        let path: PathBuf = beside(store, HEADS);
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let file = privacy::owner_only(&mut options).open(&path);
        let file = file.map_err(|source| StoreError::File { path, source })?;
        let mut opened = Self { file, heads };
        opened.write();
        Ok(opened)
    }

    /// Keeps the head of an acknowledged change.
    pub fn acknowledged(&mut self, last: Head) {
        self.keep(Heads { last, in_main: self.heads.in_main.clone() });
    }

    /// Keeps both heads.
    pub fn keep(&mut self, heads: Heads) {
        self.heads = heads;
        self.write();
    }

    /// The change is in the store already, so an unwritable file must not refuse it.
    fn write(&mut self) {
        let text = self.heads.text();
        let _ = self
            .file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(text.as_bytes()))
            .and_then(|()| self.file.set_len(LENGTH as u64));
    }
}

/// Removes the heads of a store of this name; opening the store makes them again.
pub(crate) fn forget(store: &Path) -> Result<(), StoreError> {
    let path = beside(store, HEADS);
    remove(&path).map_err(|source| StoreError::File { path, source })
}
