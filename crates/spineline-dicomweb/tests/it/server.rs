//! A small HTTP server for one test, which sends given answers and keeps the requests.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;

/// An answer: status, kind, more headers, body.
pub struct Reply {
    pub status: u16,
    pub kind: &'static str,
    pub more: &'static str,
    pub body: Vec<u8>,
}

impl Reply {
    pub fn json(text: &str) -> Self {
        let body = text.as_bytes().to_vec();
        Self { status: 200, kind: "application/dicom+json", more: "", body }
    }

    pub fn status(status: u16) -> Self {
        Self { status, kind: "text/plain", more: "", body: b"DOE^JANE".to_vec() }
    }
}

/// Heads of requests.
pub type Asked = Arc<Mutex<Vec<String>>>;

/// Starts a server; returns its address and its requests.
pub fn serve(mut answer: impl FnMut(&str) -> Option<Reply> + Send + 'static) -> (String, Asked) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    let asked = Asked::default();
    let heads = asked.clone();
    thread::spawn(move || {
        for stream in listener.incoming() {
            let Ok(stream) = stream else { return };
            let head = head_of(&stream);
            heads.lock().expect("heads").push(head.clone());
            match answer(&head) {
                Some(reply) => send(stream, &reply),
                // It never answers, and keeps the connection.
                None => std::mem::forget(stream),
            }
        }
    });
    (format!("http://{address}/dicom-web"), asked)
}

fn head_of(stream: &TcpStream) -> String {
    let lines = BufReader::new(stream).lines().map_while(Result::ok);
    lines.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
}

fn send(mut stream: TcpStream, reply: &Reply) {
    let Reply { status, kind, more, body } = reply;
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status} x\r\ncontent-type: {kind}\r\ncontent-length: {length}\r\nconnection: close\r\n{more}\r\n"
    );
    // The client may have closed the connection.
    let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body));
}
