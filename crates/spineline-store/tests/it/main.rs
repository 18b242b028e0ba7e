//! The study store: what it promises, and what crashes, full disks, damaged files and other programs do to it.

mod corruption;
mod crash;
mod current_case;
mod history;
mod journal;
mod locks;
mod plan;
mod schema;
mod session;
mod small_disk;
