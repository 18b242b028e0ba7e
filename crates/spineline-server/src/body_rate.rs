//! Bodies with a minimum rate. A limit of the pause between two pieces alone would let a body trickle for days.

use std::pin::Pin;
use std::task::{Context, Poll};

use axum::body::{Body, Bytes, HttpBody};
use hyper::body::{Frame, SizeHint};
use tokio::time::{Instant, Sleep, sleep_until};

use crate::limits::BodyRate;

/// Why a body was given up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooSlow;

impl std::fmt::Display for TooSlow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("the body did not arrive in time")
    }
}

impl std::error::Error for TooSlow {}

/// A body with its remaining time, which starts at the first poll.
pub struct TimedBody {
    body: Body,
    rate: BodyRate,
    begun: Option<Instant>,
    received: u64,
    alarm: Pin<Box<Sleep>>,
}

impl TimedBody {
    pub fn new(body: Body, rate: BodyRate) -> Self {
        let alarm = Box::pin(sleep_until(Instant::now()));
        Self { body, rate, begun: None, received: 0, alarm }
    }

    /// When the received part is too small.
    fn deadline(&mut self) -> Instant {
        let begun = *self.begun.get_or_insert_with(Instant::now);
        let earned_ms = self.received.saturating_mul(1000) / self.rate.bytes_per_s.max(1);
        begun + self.rate.grace + std::time::Duration::from_millis(earned_ms)
    }
}

impl HttpBody for TimedBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let deadline = self.deadline();
        match Pin::new(&mut self.body).poll_frame(cx) {
            Poll::Ready(frame) => {
                let data = frame.as_ref().and_then(|frame| frame.as_ref().ok()?.data_ref());
                self.received += data.map_or(0, |data| data.len() as u64);
                Poll::Ready(frame)
            }
            Poll::Pending => {
                self.alarm.as_mut().reset(deadline);
                let late = self.alarm.as_mut().poll(cx);
                late.map(|()| Some(Err(axum::Error::new(TooSlow))))
            }
        }
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use axum::body::{Body, Bytes, to_bytes};
    use tokio_stream::StreamExt;
    use tokio_stream::wrappers::IntervalStream;

    use super::{BodyRate, TimedBody};

    /// Whether a body of 100 pieces, one a second, arrives. Time is simulated.
    async fn arrives(piece: &'static [u8], bytes_per_s: u64) -> bool {
        let seconds = IntervalStream::new(tokio::time::interval(Duration::from_secs(1))).take(100);
        let body = Body::from_stream(
            seconds.map(move |_| Ok::<_, std::convert::Infallible>(Bytes::from_static(piece))),
        );
        let rate = BodyRate { grace: Duration::from_secs(10), bytes_per_s };
        to_bytes(Body::new(TimedBody::new(body, rate)), usize::MAX).await.is_ok()
    }

    #[tokio::test(start_paused = true)]
    async fn a_body_may_be_slow_and_must_not_trickle() {
        assert!(arrives(b"1234567890", 10).await, "as fast as it must be");
        assert!(!arrives(b"1", 10).await, "never silent for long, and never done");
    }
}
