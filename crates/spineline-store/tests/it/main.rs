//! Tests of the study store: guarantees, crashes, full disks, damaged files and other programs.

#![allow(clippy::float_cmp, reason = "tests compare with exact values")]

#[macro_use]
mod refused;

mod corruption;
mod crash;
mod current_case;
mod foreign_logs;
mod history;
mod inputs;
mod journal;
mod lateral;
mod locks;
mod options;
mod origins;
mod plan;
mod schema;
mod session;
mod small_disk;
mod withdrawals;
