//! Bodies with numbers outside of the range of doubles, or nested without end: a refusal, never an error of the server.

use axum::http::Method;

use crate::browser::App;

const NUMBERS: [&str; 6] = ["1e400", "-1e400", "NaN", "1e308", "-0.0", "99999999999999999999"];

#[test]
fn any_number_in_a_body_is_refused_and_not_a_bug() {
    let app = App::with_token();
    let browser = app.observer("A");
    let deep = format!("{}0{}", "[".repeat(100_000), "]".repeat(100_000));
    for number in NUMBERS.into_iter().chain([deep.as_str()]) {
        let corner = format!(
            r#"{{"kind":"place_corner","level":"T5","corner":"superior_left","column_px":{number},"row_px":{number}}}"#
        );
        for (path, body) in [
            ("/api/session", format!(r#"{{"kind":"token","token":{number}}}"#)),
            ("/api/studies", format!(r#"{{"id":"S9","films":[{number}]}}"#)),
            ("/api/films/1/readings", format!(r#"{{"repeat":{number}}}"#)),
            ("/api/readings/1/events", format!(r#"{{"expected_revision":{number},"events":[]}}"#)),
            ("/api/readings/1/events", format!(r#"{{"expected_revision":0,"events":[{corner}]}}"#)),
            ("/api/readings/1/preview", format!(r#"{{"events":[{corner}]}}"#)),
            ("/api/studies/S1/load", format!(r#"{{"loads":[{number}],"amplitude_deg":{number}}}"#)),
        ] {
            let answer = browser.send(Method::POST, path, "application/json", body.into_bytes());
            let shown = &number[..number.len().min(25)];
            assert!(answer.status.is_client_error(), "{path} {shown}: {}", answer.status);
        }
    }
}
