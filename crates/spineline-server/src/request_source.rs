//! The source of a request: its address, and the accounts to which its browser signed in lately.

use std::net::{IpAddr, Ipv6Addr};
use std::time::Duration;

use axum::extract::Request;
use axum::http::HeaderMap;
use axum_extra::extract::CookieJar;
use axum_extra::extract::cookie::{Cookie, SameSite};
use spineline_store::Name;

use crate::connection_slots::RequestSlot;
use crate::guard_rate::Source;
use crate::places::Whose;
use crate::problem::Answer;
use crate::state::AppState;

/// Header in which a proxy appends the address of its client.
const FORWARDED: &str = "x-forwarded-for";
/// Maximum number of accounts for which a browser is known.
const MAX_DEVICES: usize = 8;

/// How long browsers keep the proof, and how long it is valid.
const DEVICE: Duration = Duration::from_secs(30 * 24 * 60 * 60);

/// The source of an attempt to sign in.
#[derive(Debug, Clone, Default)]
pub struct RequestSource {
    address: Option<IpAddr>,
    /// Accounts to which this browser signed in lately, with its proofs.
    devices: Vec<(Name, String)>,
}

impl RequestSource {
    /// The source of a request by its address and head.
    pub async fn of(
        state: &AppState,
        address: Option<IpAddr>,
        headers: &HeaderMap,
    ) -> Answer<Self> {
        let (prefix, now) = (prefix(state), state.now());
        let jar = CookieJar::from_headers(headers);
        let proofs = jar.iter().filter(|cookie| cookie.name().starts_with(&prefix));
        let proofs: Vec<String> =
            proofs.take(MAX_DEVICES).map(|cookie| cookie.value().to_owned()).collect();
        if proofs.is_empty() {
            return Ok(Self { address, devices: Vec::new() });
        }
        let asked = state.store(move |store| {
            let mut devices = Vec::new();
            for proof in proofs {
                if let Some(name) = store.known_device(&proof, now)? {
                    devices.push((name, proof));
                }
            }
            Ok(devices)
        });
        Ok(Self { address, devices: asked.await? })
    }

    /// The source of an attempt to sign in to an account.
    pub fn source(&self, account: &Name) -> Source {
        let device = self.devices.iter().find(|(name, _)| name == account);
        device.map_or(Source::Address(self.address), |(_, proof)| Source::Device(proof.clone()))
    }

    /// Owner of the share of places for its requests, and whether the browser is known.
    pub fn whose(&self) -> (Whose, bool) {
        match self.devices.first() {
            Some((name, _)) => (Whose::Account(name.clone()), true),
            None => (Whose::Address(self.address), false),
        }
    }
}

/// The client's address, without the part that one person can choose freely. With `--https` a proxy reports it.
pub fn address(state: &AppState, request: &Request) -> Option<IpAddr> {
    let forwarded = state.options.https.then(|| forwarded(request.headers())).flatten();
    let peer = || request.extensions().get::<RequestSlot>().and_then(RequestSlot::address);
    forwarded.or_else(peer).map(network)
}

/// The last address of the last header: the client may forge those before it.
fn forwarded(headers: &HeaderMap) -> Option<IpAddr> {
    let last = headers.get_all(FORWARDED).iter().next_back()?.to_str().ok()?;
    last.rsplit(',').next()?.trim().parse().ok()
}

/// One person usually has 2^64 addresses of IPv6.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            let host = u128::from(u64::MAX);
            IpAddr::V6(Ipv6Addr::from(u128::from(address) & !host))
        }
        v4 => v4,
    }
}

fn prefix(state: &AppState) -> String {
    format!("spineline_device_{}_", state.address.port())
}

/// The cookie by which a browser is known for an account, sent with attempts to sign in only.
pub fn device_cookie(state: &AppState, name: &Name, proof: String) -> Cookie<'static> {
    let cookie = Cookie::build((format!("{}{name}", prefix(state)), proof))
        .http_only(true)
        .same_site(SameSite::Strict)
        .secure(state.options.https)
        .path("/api/session")
        .max_age(DEVICE.try_into().unwrap_or_default());
    cookie.build()
}

#[cfg(test)]
mod tests {
    use super::{FORWARDED, HeaderMap, IpAddr, forwarded, network};

    fn ip(text: &str) -> IpAddr {
        text.parse().expect("an address")
    }

    #[test]
    fn an_address_that_the_asker_wrote_is_not_believed() {
        let mut headers = HeaderMap::new();
        assert_eq!(forwarded(&headers), None);
        headers.append(FORWARDED, "1.1.1.1, 2.2.2.2".parse().expect("a value"));
        assert_eq!(forwarded(&headers), Some(ip("2.2.2.2")));
        headers.append(FORWARDED, "10.0.0.7".parse().expect("a value"));
        assert_eq!(forwarded(&headers), Some(ip("10.0.0.7")));
        headers.append(FORWARDED, "nonsense".parse().expect("a value"));
        assert_eq!(forwarded(&headers), None);
    }

    #[test]
    fn all_addresses_of_one_network_are_one() {
        assert_eq!(network(ip("2001:db8::1")), network(ip("2001:db8::ffff:1:2")));
        assert!(network(ip("2001:db8::1")) != network(ip("2001:db8:0:1::1")));
        assert_eq!(network(ip("::ffff:10.0.0.1")), ip("10.0.0.1"));
    }
}
