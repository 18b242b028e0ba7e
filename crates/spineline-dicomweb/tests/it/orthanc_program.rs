//! Orthanc for one test, if Debian's packages `orthanc` and `orthanc-dicomweb` are installed.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use tempfile::TempDir;

const PROGRAM: &str = "/usr/sbin/Orthanc";
const PLUGIN: &str = "/usr/share/orthanc/plugins/libOrthancDicomWeb.so";
/// `films:secret`.
const LOGIN: &str = "Basic ZmlsbXM6c2VjcmV0";

/// Ended with the test.
pub struct Orthanc {
    child: Child,
    port: u16,
    _folder: TempDir,
}

impl Drop for Orthanc {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("an address").port()
}

impl Orthanc {
    /// An empty archive with the login `films:secret`; `None`, with a message, if it is not installed.
    pub fn start() -> Option<Self> {
        if !Path::new(PROGRAM).exists() || !Path::new(PLUGIN).exists() {
            eprintln!("left out: Orthanc is not installed (Debian: orthanc orthanc-dicomweb)");
            return None;
        }
        let folder = tempfile::tempdir().expect("a folder");
        let port = free_port();
        let config = serde_json::json!({
            "HttpPort": port, "DicomServerEnabled": false, "RemoteAccessAllowed": false,
            "AuthenticationEnabled": true, "RegisteredUsers": { "films": "secret" },
            "StorageDirectory": folder.path().join("storage"), "Plugins": [PLUGIN],
        });
        let file = folder.path().join("orthanc.json");
        std::fs::write(&file, config.to_string()).expect("a file");
        let child = Command::new(PROGRAM)
            .arg(&file)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("Orthanc");
        let orthanc = Self { child, port, _folder: folder };
        let answers = || orthanc.ask("GET", "/system", b"").is_some_and(|answer| is_ok(&answer));
        let is_ready = (0..600).any(|_| {
            sleep(Duration::from_millis(50));
            answers()
        });
        assert!(is_ready, "Orthanc answers");
        Some(orthanc)
    }

    /// Address of its DICOMweb service.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/dicom-web", self.port)
    }

    /// Stores the file of a film.
    pub fn store(&self, film: &[u8]) {
        let answer = self.ask("POST", "/instances", film).expect("an answer");
        assert!(is_ok(&answer), "{answer}");
    }

    fn ask(&self, method: &str, path: &str, body: &[u8]) -> Option<String> {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).ok()?;
        let length = body.len();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nhost: 127.0.0.1\r\nauthorization: {LOGIN}\r\nconnection: close\r\ncontent-length: {length}\r\n\r\n"
        );
        stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body)).ok()?;
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).ok()?;
        Some(String::from_utf8_lossy(&answer).into_owned())
    }
}

fn is_ok(answer: &str) -> bool {
    answer.starts_with("HTTP/1.1 200")
}
