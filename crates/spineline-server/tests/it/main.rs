//! The server as a browser meets it: every request passes the whole app.

mod access;
mod accounts;
mod browser;
mod crowd;
mod example;
mod films;
mod guards;
mod openapi;
mod results;
mod routes;
mod sessions;
mod streams;
