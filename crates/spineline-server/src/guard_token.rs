//! The token printed in the terminal: anyone who can read the terminal has all permissions of its user.

use subtle::ConstantTimeEq;
use tokio::sync::watch;

use crate::secret::secret;

/// A token that signs in one browser and is then replaced by the next.
#[derive(Debug)]
pub struct OneTimeToken(watch::Sender<String>);

impl OneTimeToken {
    pub fn new() -> Self {
        Self(watch::Sender::new(secret()))
    }

    /// Follows the currently valid token.
    pub fn follow(&self) -> watch::Receiver<String> {
        self.0.subscribe()
    }

    /// Whether this is the current token; a match uses it up.
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
    fn a_token_is_valid_once() {
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
