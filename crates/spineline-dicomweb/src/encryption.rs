//! Encrypted connections, in a program built with the feature `https`.

use ureq::Error;
use ureq::config::ConfigBuilder;
use ureq::typestate::AgentScope;

/// Whether `https://` addresses are supported.
pub const IS_BUILT: bool = cfg!(feature = "https");

/// Trusts the certificates of the system.
#[cfg(feature = "https")]
pub fn trusting_the_system(config: ConfigBuilder<AgentScope>) -> ConfigBuilder<AgentScope> {
    let provider = rustls::crypto::ring::default_provider();
    config.tls_config(
        ureq::tls::TlsConfig::builder()
            .root_certs(ureq::tls::RootCerts::PlatformVerifier)
            .unversioned_rustls_crypto_provider(std::sync::Arc::new(provider))
            .build(),
    )
}

/// Changes nothing: addresses that need encryption are refused.
#[cfg(not(feature = "https"))]
pub const fn trusting_the_system(config: ConfigBuilder<AgentScope>) -> ConfigBuilder<AgentScope> {
    config
}

/// Whether an encrypted connection could not be made.
#[cfg(feature = "https")]
pub fn is_fault(error: &Error) -> bool {
    match error {
        Error::Tls(_) | Error::TlsRequired | Error::Rustls(_) => true,
        // An error at the start of a connection is reported as an error of the connection.
        Error::Io(error) => error.get_ref().is_some_and(|inner| inner.is::<rustls::Error>()),
        _ => false,
    }
}

/// Whether an encrypted connection could not be made.
#[cfg(not(feature = "https"))]
pub const fn is_fault(error: &Error) -> bool {
    matches!(error, Error::Tls(_) | Error::TlsRequired)
}
