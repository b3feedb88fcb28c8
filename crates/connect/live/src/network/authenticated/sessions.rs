//! Sessions of other processes, and their proofs that they run now.

use std::collections::HashMap;
use std::time::Duration;

use super::proofs::Proof;

/// Time after which a session without an answer is asked again, for the same number: its answer may be on its way.
const ASK_AGAIN: Duration = Duration::from_millis(50);
/// Time for which an answer is valid after its number was first asked for: a delayed answer does not prove that the
/// session runs now.
const ANSWERS: Duration = Duration::from_millis(500);
/// Time after which a session must prove itself again, so that messages that were held back for long are not accepted.
const RENEW: Duration = Duration::from_millis(400);
/// Time after which a session without a new proof is no longer accepted.
const EXPIRES: Duration = Duration::from_millis(1500);
/// Time without a message after which a session is forgotten, if there are many sessions.
const FORGOTTEN: Duration = Duration::from_secs(3);
/// Most sessions that are remembered: recordings of many starts cannot fill the memory.
const MAX_SESSIONS: usize = 256;

/// Known sessions of other processes. All times are on one clock, which continues while the computer sleeps.
#[derive(Debug, Default)]
pub(super) struct Sessions {
    known: HashMap<u64, Session>,
}

#[derive(Debug, Clone, Copy)]
struct Session {
    asked: Option<Asked>,
    proved: Option<Proved>,
    heard: Duration,
}

/// A question to a session: repeat a number.
#[derive(Debug, Clone, Copy)]
struct Asked {
    nonce: u64,
    first: Duration,
    last: Duration,
}

/// A proof of a session.
#[derive(Debug, Clone, Copy)]
struct Proved {
    at: Duration,
    /// Number of the message with the proof.
    number: u64,
    /// Number of the message with the previous proof: messages sent after it may still be on their way.
    number_before: u64,
}

/// State of a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Standing {
    /// Messages with higher numbers are accepted; `None` if the session has no valid proof.
    pub(super) heard_after: Option<u64>,
    /// The number that the session is to be asked to repeat.
    pub(super) ask: Option<u64>,
}

impl Sessions {
    /// Returns the state of a session from which a message has arrived. `nonce` makes an unpredictable number.
    pub(super) fn standing(&mut self, session: u64, now: Duration, nonce: impl FnOnce() -> u64) -> Standing {
        let Some(known) = self.entry(session, now) else { return Standing { heard_after: None, ask: None } };
        known.heard = now;
        let since = |at: Duration| now.saturating_sub(at);
        known.proved = known.proved.filter(|proved| since(proved.at) < EXPIRES);
        let must_prove = known.proved.is_none_or(|proved| since(proved.at) > RENEW);
        let heard_after = known.proved.map(|proved| proved.number_before);
        let waiting = known.asked.filter(|asked| since(asked.first) < ANSWERS);
        if !must_prove || waiting.is_some_and(|asked| since(asked.last) < ASK_AGAIN) {
            return Standing { heard_after, ask: None };
        }
        let asked = waiting.unwrap_or_else(|| Asked { nonce: nonce(), first: now, last: now });
        known.asked = Some(Asked { last: now, ..asked });
        Standing { heard_after, ask: Some(asked.nonce) }
    }

    fn entry(&mut self, session: u64, now: Duration) -> Option<&mut Session> {
        if self.known.len() >= MAX_SESSIONS {
            self.known.retain(|_, known| now.saturating_sub(known.heard) <= FORGOTTEN);
        }
        let has_room = self.known.len() < MAX_SESSIONS || self.known.contains_key(&session);
        has_room.then(|| self.known.entry(session).or_insert(Session { asked: None, proved: None, heard: now }))
    }

    /// Records a proof, if it answers the present question.
    pub(super) fn prove(&mut self, proof: &Proof, now: Duration) {
        let Some(known) = self.known.get_mut(&proof.session) else { return };
        let is_answer = |asked: Asked| asked.nonce == proof.nonce && now.saturating_sub(asked.first) < ANSWERS;
        if known.asked.is_some_and(is_answer) {
            let number_before = known.proved.map_or(proof.after, |before| before.number);
            known.proved = Some(Proved { at: now, number: proof.after, number_before });
            known.asked = None;
        }
    }

    /// Forgets all sessions: they must prove themselves again.
    pub(super) fn forget(&mut self) {
        self.known.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OTHER: u64 = 7;

    #[test]
    fn what_is_held_back_is_not_heard_and_a_slow_answer_counts() {
        let (mut sessions, start) = (Sessions::default(), Duration::ZERO);
        let at = |ms: u64| start + Duration::from_millis(ms);
        let proof = |nonce: u64, after: u64| Proof { session: OTHER, nonce, after };
        assert_eq!(sessions.standing(OTHER, at(0), || 41), Standing { heard_after: None, ask: Some(41) });
        // Not asked again at once; later asked for the same number, as the answer takes longer.
        assert_eq!(sessions.standing(OTHER, at(10), || 42), Standing { heard_after: None, ask: None });
        assert_eq!(sessions.standing(OTHER, at(60), || 42), Standing { heard_after: None, ask: Some(41) });
        sessions.prove(&proof(40, 100), at(70));
        assert_eq!(sessions.standing(OTHER, at(80), || 42).heard_after, None, "another number");
        sessions.prove(&proof(41, 100), at(100));
        assert_eq!(sessions.standing(OTHER, at(110), || 43), Standing { heard_after: Some(100), ask: None });
        // The session proves itself again; messages sent between the last two proofs may be on their way, earlier ones
        // are refused.
        for round in 0..10_u64 {
            let now = 600 + 500 * round;
            let expected = Standing { heard_after: Some(100 + 50 * round.saturating_sub(1)), ask: Some(50 + round) };
            assert_eq!(sessions.standing(OTHER, at(now), || 50 + round), expected, "round {round}");
            sessions.prove(&proof(50 + round, 150 + 50 * round), at(now + 1));
        }
        // Without further proofs, messages of the session are accepted only until EXPIRES, though old ones still arrive.
        let last = 600 + 500 * 9;
        assert!(sessions.standing(OTHER, at(last + 1400), || 99).heard_after.is_some());
        assert_eq!(sessions.standing(OTHER, at(last + 1600), || 99).heard_after, None);
        // An answer that was held back comes too late, and later questions ask for another number.
        sessions.prove(&proof(99, 900), at(last + 2000));
        assert_eq!(sessions.standing(OTHER, at(last + 2000), || 100), Standing { heard_after: None, ask: Some(100) });
        sessions.prove(&proof(99, 900), at(last + 2010));
        assert_eq!(sessions.standing(OTHER, at(last + 2020), || 101).heard_after, None);
        sessions.prove(&proof(100, 901), at(last + 2030));
        assert_eq!(sessions.standing(OTHER, at(last + 2040), || 101).heard_after, Some(901));
    }

    #[test]
    fn recordings_of_many_starts_do_not_fill_the_memory() {
        let (mut sessions, start) = (Sessions::default(), Duration::ZERO);
        for session in 0..10_000 {
            sessions.standing(session, start, || session);
        }
        assert_eq!(sessions.known.len(), MAX_SESSIONS);
        let later = start + Duration::from_secs(4);
        assert_eq!(sessions.standing(20_000, later, || 1).ask, Some(1), "there is room again");
    }
}
