//! The token of the terminal: whoever has it reads the terminal, and so may do whatever its user may.

use subtle::ConstantTimeEq;
use tokio::sync::watch;

use crate::secret::secret;

/// A token that signs one browser in. The next one takes its place.
#[derive(Debug)]
pub struct OneTimeToken(watch::Sender<String>);

impl OneTimeToken {
    pub fn new() -> Self {
        Self(watch::Sender::new(secret()))
    }

    /// Follows the token that is good now.
    pub fn follow(&self) -> watch::Receiver<String> {
        self.0.subscribe()
    }

    /// Whether this is the token; if so, it no longer is.
    pub fn use_up(&self, given: &str) -> bool {
        self.0.send_if_modified(|token| {
            let right = bool::from(given.as_bytes().ct_eq(token.as_bytes()));
            if right {
                *token = secret();
            }
            right
        })
    }
}

#[cfg(test)]
mod tests {
    use super::OneTimeToken;

    #[test]
    fn a_token_is_good_once() {
        let token = OneTimeToken::new();
        let first = token.follow().borrow().clone();
        assert!(!token.use_up(""));
        assert!(!token.use_up(&first[1..]));
        assert!(token.use_up(&first));
        assert!(!token.use_up(&first));
        let second = token.follow().borrow().clone();
        assert!(second != first && token.use_up(&second));
    }
}
