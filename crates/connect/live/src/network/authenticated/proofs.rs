//! Proof that a session runs now: it repeats an unpredictable number, which a recording cannot.

use std::sync::Mutex;

use super::message_seal::MessageSeal;
use crate::locked::locked;
use crate::network::{Network, NetworkError, Publisher, Urgency};

/// Asks other sessions for proofs, and answers their questions.
pub(super) struct Proofs {
    question_key: String,
    answer_key: String,
    // Separate channels: a process may be asked while it asks.
    questions: Mutex<Channel>,
    answers: Mutex<Channel>,
}

impl std::fmt::Debug for Proofs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.question_key)
    }
}

/// The answer of a session that has repeated a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Proof {
    pub(super) session: u64,
    pub(super) nonce: u64,
    /// Number of the answer's message; accepted messages have higher numbers.
    pub(super) after: u64,
}

struct Channel {
    publisher: Box<dyn Publisher>,
    bytes: Vec<u8>,
}

/// Key of the questions for proofs.
pub(super) fn question_key(prefix: &str) -> String {
    format!("{prefix}/proof/question")
}

/// Key of the answers.
pub(super) fn answer_key(prefix: &str) -> String {
    format!("{prefix}/proof/answer")
}

impl Proofs {
    pub(super) fn new(network: &dyn Network, prefix: &str) -> Result<Self, NetworkError> {
        let channel = |key: &str| {
            let publisher = network.publisher(key, Urgency::RealTime)?;
            Ok(Mutex::new(Channel { publisher, bytes: Vec::with_capacity(128) }))
        };
        let (question_key, answer_key) = (question_key(prefix), answer_key(prefix));
        Ok(Self { questions: channel(&question_key)?, answers: channel(&answer_key)?, question_key, answer_key })
    }

    /// Asks a session to repeat a number.
    pub(super) fn ask(&self, seal: &MessageSeal, session: u64, nonce: u64) {
        send(&self.questions, seal, &self.question_key, session, nonce);
    }

    /// Answers a question to this process by repeating its number.
    pub(super) fn reply(&self, seal: &MessageSeal, bytes: &[u8]) {
        let Some(question) = seal.open(&self.question_key, bytes) else { return };
        match words(question.contents) {
            Some((session, nonce)) if session == seal.session() => {
                send(&self.answers, seal, &self.answer_key, question.session, nonce);
            }
            _ => {}
        }
    }

    /// Reads an answer to this process.
    pub(super) fn open(&self, seal: &MessageSeal, bytes: &[u8]) -> Option<Proof> {
        let answer = seal.open(&self.answer_key, bytes)?;
        let (session, nonce) = words(answer.contents)?;
        (session == seal.session()).then_some(Proof { session: answer.session, nonce, after: answer.number })
    }
}

fn send(channel: &Mutex<Channel>, seal: &MessageSeal, key: &str, session: u64, nonce: u64) {
    let mut channel = locked(channel);
    let Channel { publisher, bytes } = &mut *channel;
    let mut contents = [0; 16];
    contents[..8].copy_from_slice(&session.to_le_bytes());
    contents[8..].copy_from_slice(&nonce.to_le_bytes());
    seal.close(key, &contents, bytes);
    publisher.publish(bytes);
}

fn words(contents: &[u8]) -> Option<(u64, u64)> {
    let (first, rest) = contents.split_first_chunk()?;
    Some((u64::from_le_bytes(*first), u64::from_le_bytes(rest.try_into().ok()?)))
}
