//! WebSocket of one page: the token first, then frames to the page and commands from it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket};
use serde::Deserialize;
use tokio::time::{Instant, MissedTickBehavior, interval, timeout};

use super::shared::Shared;
use crate::http::Place;
use crate::source::Command;

/// Codes of the close message; the page shows the reason.
const WRONG_TOKEN: u16 = 4401;
/// Code for "try again later": a browser on a busy computer may be too slow once.
const LATE: u16 = 1013;
const NOT_UNDERSTOOD: u16 = 4400;
const TOO_MANY: u16 = 4429;
const ENDED: u16 = 1001;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Hello {
    token: String,
}

/// Messages of a page after its token.
#[derive(Deserialize)]
#[serde(untagged)]
enum Sent {
    /// The page has shown the frame of this number.
    Shown {
        shown: u64,
    },
    Command(Command),
}

/// Reason for the end of a session: code and text; `None` if the page is gone.
type Ended = Option<(u16, &'static str)>;

/// Serves a page until it disconnects. Until the page has sent its token, it holds the place of its connection.
pub(crate) async fn run(mut socket: WebSocket, place: Place, shared: Arc<Shared>) {
    let admitted = tokio::select! {
        admitted = timeout(shared.limits.head, admit(&mut socket, &shared)) => admitted.unwrap_or(Err(Some((LATE, "no token has come")))),
        () = place.vacated() => return,
    };
    let ended = match admitted {
        Err(ended) => ended,
        Ok(()) => match shared.browsers.clone().try_acquire_owned() {
            Err(_) => Some((TOO_MANY, "too many browsers show this cell; close one")),
            Ok(_permit) => {
                drop(place);
                let mut session =
                    Session { socket: &mut socket, shared: &shared, unshown: VecDeque::new(), next_event: 0 };
                session.serve().await
            }
        },
    };
    if let Some((code, reason)) = ended {
        let close = Message::Close(Some(CloseFrame { code, reason: reason.into() }));
        let _ = timeout(Duration::from_secs(1), socket.send(close)).await;
        // The page needs time to read the message before the connection is cut.
        let _ = timeout(Duration::from_secs(1), socket.recv()).await;
    }
}

/// Checks that the first message is the token.
async fn admit(socket: &mut WebSocket, shared: &Shared) -> Result<(), Ended> {
    let Some(Ok(first)) = socket.recv().await else { return Err(None) };
    let Message::Text(text) = first else { return Err(Some((NOT_UNDERSTOOD, "the first message is the token"))) };
    let hello: Hello =
        serde_json::from_str(&text).map_err(|_| Some((NOT_UNDERSTOOD, "the first message is {\"token\": …}")))?;
    if shared.token.is(&hello.token) { Ok(()) } else { Err(Some((WRONG_TOKEN, "the token is another one"))) }
}

struct Session<'s> {
    socket: &'s mut WebSocket,
    shared: &'s Shared,
    /// Numbers of the frames that were sent to the page and are not shown yet.
    unshown: VecDeque<u64>,
    /// Number of the first event that was not sent.
    next_event: u64,
}

impl Session<'_> {
    async fn serve(&mut self) -> Ended {
        let limits = &self.shared.limits;
        let hello = format!("{{\"type\":\"hello\",\"mode\":\"{}\"}}", self.shared.mode);
        if !self.send(Message::Text(hello.into())).await {
            return None;
        }
        let mut frames = self.shared.frames.clone();
        frames.mark_changed();
        let mut heard = Instant::now();
        let mut ping = interval(limits.silence / 3);
        ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut next_frame = Instant::now();
        loop {
            let may_send = self.unshown.len() < limits.unshown_frames;
            tokio::select! {
                received = self.socket.recv() => {
                    let Some(Ok(message)) = received else { return None };
                    heard = Instant::now();
                    match message {
                        Message::Text(text) => match serde_json::from_str::<Sent>(&text) {
                            Ok(Sent::Shown { shown }) => self.unshown.retain(|number| *number > shown),
                            Ok(Sent::Command(command)) => self.shared.inbox.command(command),
                            Err(_) => return Some((NOT_UNDERSTOOD, "not a command")),
                        },
                        Message::Binary(_) => return Some((NOT_UNDERSTOOD, "commands are text")),
                        Message::Close(_) => return None,
                        Message::Ping(_) | Message::Pong(_) => {}
                    }
                }
                changed = async {
                    tokio::time::sleep_until(next_frame).await;
                    frames.changed().await
                }, if may_send => {
                    if changed.is_err() {
                        return Some((ENDED, "the program has ended"));
                    }
                    let frame = frames.borrow_and_update().clone();
                    if frame.number == 0 {
                        continue;
                    }
                    next_frame = Instant::now() + limits.frame_period;
                    if !self.send(Message::Text(frame.text)).await || !self.send_events().await {
                        return None;
                    }
                    self.unshown.push_back(frame.number);
                }
                _ = ping.tick() => {
                    if heard.elapsed() > limits.silence || !self.send(Message::Ping(axum::body::Bytes::new())).await {
                        return None;
                    }
                }
            }
        }
    }

    /// Sends the events that the page does not have yet.
    async fn send_events(&mut self) -> bool {
        let next = self.next_event;
        let text: Option<Utf8Bytes> = self.shared.inbox.with_events(|log| {
            self.next_event = log.next();
            let new = log.since(next);
            let document = serde_json::json!({ "type": "events", "events": new });
            (!new.is_empty()).then(|| document.to_string().into())
        });
        match text {
            Some(text) => self.send(Message::Text(text)).await,
            None => true,
        }
    }

    /// Sends a message; false if the page does not accept it in time.
    async fn send(&mut self, message: Message) -> bool {
        matches!(timeout(self.shared.limits.send, self.socket.send(message)).await, Ok(Ok(())))
    }
}
