//! The host names under which the program answers.

use axum::http::uri::Authority;

/// Whether a text can be the host in a browser's address, with a port or without.
#[must_use]
pub fn is_host(text: &str) -> bool {
    text.parse::<Authority>().is_ok_and(|host| !host.host().is_empty() && !text.contains('@'))
}

/// The host names under which the program answers. Other names may come from DNS rebinding and are refused.
#[derive(Debug)]
pub struct Hosts(Vec<String>);

impl Hosts {
    /// The address itself and the loopback names with its port. Further names are allowed with this port, with their
    /// own port, or without a port, as a proxy sends them.
    pub fn new(address: std::net::SocketAddr, further: &[String]) -> Self {
        let port = address.port();
        let own = ["localhost", "127.0.0.1", "[::1]"].map(|name| format!("{name}:{port}"));
        let mut hosts = Vec::from(own);
        hosts.push(address.to_string());
        if port == 80 {
            hosts.extend(["localhost", "127.0.0.1", "[::1]"].map(str::to_owned));
        }
        for name in further {
            let name = name.to_ascii_lowercase();
            hosts.push(format!("{name}:{port}"));
            hosts.push(name);
        }
        Self(hosts)
    }

    /// Whether the program answers under this host name, in lower case.
    pub fn allow(&self, host: &str) -> bool {
        self.0.iter().any(|allowed| allowed == host)
    }
}
