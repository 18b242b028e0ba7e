//! Tests of the server: every request passes the whole app.

#![allow(clippy::float_cmp, reason = "tests compare with exact values")]

mod access;
mod accounts;
mod archives;
mod blinded;
mod browser;
mod computations;
mod crowd;
mod demo;
#[path = "../../../spineline-dicomweb/tests/it/orthanc_program.rs"]
mod dicomweb_orthanc;
#[path = "../../../spineline-dicomweb/tests/it/server.rs"]
mod dicomweb_server;
mod drawn;
mod example;
mod exports;
mod film_answers;
mod films;
mod guards;
mod marking;
mod messages;
mod numbers;
mod openapi;
mod passwords;
mod privacy;
mod repeated_films;
mod results;
mod routes;
mod scales;
mod sessions;
mod streams;
mod study_edits;
#[path = "../../../spineline-cli/tests/it/unpacked.rs"]
mod unpacked;
