//! The starts of other processes, and which of them have proved that they run now.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use super::message_seal::random_number;
use super::proofs::Proof;

/// A session that has not answered is asked again after this time.
const ASK_AGAIN: Duration = Duration::from_millis(50);
/// A session of which nothing was heard for this long must prove itself anew.
const FORGOTTEN: Duration = Duration::from_secs(3);
/// More sessions than this are not remembered: recordings of many starts cannot fill the memory.
const MAX_SESSIONS: usize = 256;

/// What is known of other processes.
#[derive(Debug, Default)]
pub(super) struct Sessions {
    known: HashMap<u64, Session>,
}

#[derive(Debug, Clone, Copy)]
enum Session {
    /// It was asked to repeat this number.
    Asked { nonce: u64, at: Instant },
    /// It has proved itself with its message of this number.
    Proved { after: u64, heard: Instant },
}

/// How a session stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// It runs: its messages with higher numbers are heard.
    Proved { after: u64 },
    /// It is to be asked to repeat this number.
    Ask { nonce: u64 },
    /// It was asked, or there are too many.
    Unknown,
}

impl Session {
    fn is_over(&self, now: Instant) -> bool {
        let (Self::Asked { at: last, .. } | Self::Proved { heard: last, .. }) = self;
        now.duration_since(*last) > FORGOTTEN
    }
}

impl Sessions {
    /// How a session stands of which a message has come.
    pub(super) fn standing(&mut self, session: u64) -> Standing {
        let now = Instant::now();
        match self.known.get_mut(&session) {
            Some(known) if known.is_over(now) => self.ask(session, now),
            Some(Session::Proved { after, heard }) => {
                *heard = now;
                Standing::Proved { after: *after }
            }
            Some(Session::Asked { at, .. }) if now.duration_since(*at) < ASK_AGAIN => Standing::Unknown,
            _ => self.ask(session, now),
        }
    }

    fn ask(&mut self, session: u64, now: Instant) -> Standing {
        if self.known.len() >= MAX_SESSIONS {
            self.known.retain(|_, known| !known.is_over(now));
        }
        if self.known.len() >= MAX_SESSIONS && !self.known.contains_key(&session) {
            return Standing::Unknown;
        }
        let nonce = random_number();
        self.known.insert(session, Session::Asked { nonce, at: now });
        Standing::Ask { nonce }
    }

    /// A session has answered.
    pub(super) fn prove(&mut self, proof: &Proof) {
        if let Some(known) = self.known.get_mut(&proof.session)
            && matches!(known, Session::Asked { nonce, .. } if *nonce == proof.nonce)
        {
            *known = Session::Proved { after: proof.after, heard: Instant::now() };
        }
    }

    /// All must prove themselves anew.
    pub(super) fn forget(&mut self) {
        self.known.clear();
    }
}
