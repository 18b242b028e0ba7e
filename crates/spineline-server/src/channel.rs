//! The channel that sends changes of studies to all open pages.

use spineline_store::Name;
use tokio::sync::broadcast;

use crate::api::Change;

/// Capacity of the channel; a slower listener misses changes.
const LAG: usize = 256;

/// What listeners receive.
#[derive(Clone)]
pub enum Message {
    /// A change of a study.
    Change(Name, Change),
    /// Sessions, roles or grants have changed: listeners must be checked again.
    Rights,
    /// The server is shutting down.
    End,
}

/// Sends changes to all listeners.
pub struct Channel(broadcast::Sender<Message>);

impl Default for Channel {
    fn default() -> Self {
        Self(broadcast::channel(LAG).0)
    }
}

impl Channel {
    /// Sends a change that is committed.
    pub fn send(&self, study: &Name, change: Change) {
        // Without listeners this is an error, which is ignored.
        let _ = self.0.send(Message::Change(study.clone(), change));
    }

    /// Makes all listeners check their rights again.
    pub fn rights_changed(&self) {
        let _ = self.0.send(Message::Rights);
    }

    /// Ends all streams.
    pub fn close(&self) {
        let _ = self.0.send(Message::End);
    }

    /// Listens from now on.
    pub fn subscribe(&self) -> broadcast::Receiver<Message> {
        self.0.subscribe()
    }
}
