//! A hand-over: approach, both hold, release, retreat.

use crate::holding::Holding;

/// Phase of a hand-over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HandOverPhase {
    /// The receiver moves to the pre-grasp.
    Reaching,
    /// The receiver moves with the work-piece, nearer to its grasp.
    Approaching,
    /// The receiver is at its grasp and closes its hand; the giver still holds.
    Closing,
    /// The receiver holds; the giver opens its hand.
    Opening,
    /// The giver moves back to its pre-grasp.
    Retreating,
    /// The receiver gave up and moves back to its pre-grasp.
    Withdrawing,
}

/// A hand-over that goes on.
#[derive(Debug)]
pub(crate) struct HandOver {
    /// Index of the giver among the holdings.
    pub giver: usize,
    /// Index of the receiver.
    pub receiver: usize,
    pub phase: HandOverPhase,
    /// Time in this phase, s.
    pub since_s: f64,
    /// Distance of the hand that approaches or leaves from its grasp, m.
    pub before_m: f64,
    /// Joint values of that hand, less those at which it would be exactly there.
    pub residual: Vec<f64>,
    /// Whether the receiver is looked ahead for, which takes a few steps before it begins to move with the work-piece.
    pub looks_ahead: bool,
    /// Time without any progress, s.
    pub stuck_s: f64,
}

impl HandOver {
    pub fn new(giver: usize, receiver: usize, receivers: &[Holding<'_>], joints: usize) -> Self {
        Self {
            giver,
            receiver,
            phase: HandOverPhase::Reaching,
            since_s: 0.0,
            before_m: receivers[receiver].grasp.length_m(),
            residual: vec![0.0; joints],
            looks_ahead: false,
            stuck_s: 0.0,
        }
    }

    /// Begins a phase.
    pub fn enter(&mut self, phase: HandOverPhase) {
        (self.phase, self.since_s, self.stuck_s) = (phase, 0.0, 0.0);
    }

    /// The holding whose hand moves with the work-piece besides the holder's; `None` while nobody's does.
    pub fn follower(&self) -> Option<usize> {
        match self.phase {
            HandOverPhase::Reaching => None,
            HandOverPhase::Approaching | HandOverPhase::Closing | HandOverPhase::Withdrawing => Some(self.receiver),
            HandOverPhase::Opening | HandOverPhase::Retreating => Some(self.giver),
        }
    }

    /// Distance of the follower's hand from its grasp `dt_s` seconds later, m.
    pub fn before_next_m(&self, length_m: f64, speed_m_s: f64, dt_s: f64) -> f64 {
        match self.phase {
            HandOverPhase::Approaching => (self.before_m - speed_m_s * dt_s).max(0.0),
            HandOverPhase::Retreating | HandOverPhase::Withdrawing => (self.before_m + speed_m_s * dt_s).min(length_m),
            HandOverPhase::Reaching => length_m,
            HandOverPhase::Closing | HandOverPhase::Opening => 0.0,
        }
    }
}
