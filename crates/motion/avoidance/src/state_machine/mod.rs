//! The state machine of the avoidance.
//!
//! The state decides what the robot does if nothing has to be evaded ([`ControlState`]). Each tick ends with one event
//! ([`Event`]), and [`transition`] is the only function that changes the state. `t` is the idle time: the time at rest
//! off the path without a correction.
//!
//! | state | `DetourPlanned` | `DetourActive` | `OnPath` | `Corrected` | `AtRest` | `Moving` | `Halted` | `Failed` | `FailedWhileEvading` |
//! | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
//! | `Following` | `Detouring` | `Following` | `Following` | `Evading` | `Holding dt` | `Holding 0` | `Holding 0` | `Holding 0` | `Evading` |
//! | `Detouring` | `Detouring` | `Detouring` | `Following` | `Evading` | `Holding dt` | `Holding 0` | `Holding 0` | `Holding 0` | `Evading` |
//! | `Evading` | `Detouring` | `Evading` | `Following` | `Evading` | `Holding dt` | `Holding 0` | `Holding 0` | `Holding 0` | `Evading` |
//! | `Holding t` | `Detouring` | `Holding t` | `Following` | `Evading` | `Holding t+dt` | `Holding t` | `Holding 0` | `Holding t` | `Evading` |
//! | `Returning t` | `Detouring` | `Returning t` | `Following` | `Evading` | `Returning t+dt` | `Returning t` | `Holding 0` | `Returning t` | `Evading` |
//!
//! `Holding` with an idle time of at least the stall timeout is `Returning`. `DetourActive` occurs only in `Detouring`.

use crate::detour::Detour;
use crate::state::AvoiderState;

/// Time (s) for which a correction counts as recent.
const RECENT_CORRECTION_S: f64 = 0.1;
/// Time (s) after which a stalled robot is reported as waiting.
const REPORT_WAITING_S: f64 = 0.1;

/// The behaviour of the robot if nothing has to be evaded.
#[derive(Debug, Clone, Default)]
pub(crate) enum ControlState {
    /// Follows its path.
    #[default]
    Following,
    /// Follows a planned detour.
    Detouring(Detour),
    /// Off the path, with a recent correction: returns gently to the path.
    Evading,
    /// Off the path: brakes and waits for a detour.
    Holding { idle_s: f64 },
    /// Off the path, and no detour was planned within the stall timeout: returns straight to the path.
    Returning { idle_s: f64 },
}

/// An event in a tick or between two ticks.
#[derive(Debug, Clone)]
pub(crate) enum Event {
    /// A detour was planned.
    DetourPlanned(Detour),
    /// The robot is on its detour, with remaining waypoints.
    DetourActive,
    /// The robot is on its path.
    OnPath,
    /// Off the path, with a recent correction.
    Corrected,
    /// Off the path without a recent correction, at rest, for this time (s).
    AtRest { dt: f64 },
    /// Off the path without a recent correction, not at rest.
    Moving,
    /// Off the path without a recent correction, at the override 0 or while a detour is being planned.
    Halted,
    /// The tick failed: the robot stops where it is.
    Failed,
    /// The tick failed shortly after a correction.
    FailedWhileEvading,
}

impl ControlState {
    /// The time at rest off the path without a correction, s.
    pub(crate) fn idle_s(&self) -> f64 {
        match self {
            Self::Holding { idle_s } | Self::Returning { idle_s } => *idle_s,
            Self::Following | Self::Detouring(_) | Self::Evading => 0.0,
        }
    }

    fn off_path(idle_s: f64, stall_timeout_s: f64) -> Self {
        if idle_s < stall_timeout_s { Self::Holding { idle_s } } else { Self::Returning { idle_s } }
    }
}

/// The state after an event.
fn transition(state: ControlState, event: Event, stall_timeout_s: f64) -> ControlState {
    let idle_s = state.idle_s();
    match event {
        Event::DetourPlanned(detour) => ControlState::Detouring(detour),
        Event::DetourActive => state,
        Event::OnPath => ControlState::Following,
        Event::Corrected | Event::FailedWhileEvading => ControlState::Evading,
        Event::AtRest { dt } => ControlState::off_path(idle_s + dt, stall_timeout_s),
        Event::Moving | Event::Failed => ControlState::off_path(idle_s, stall_timeout_s),
        Event::Halted => ControlState::off_path(0.0, stall_timeout_s),
    }
}

/// Findings of a tick for the state machine.
#[allow(clippy::struct_excessive_bools, reason = "the guards of the transition table, one each")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct TickSummary {
    pub(crate) dt: f64,
    /// Whether the robot is at the configuration of its path.
    pub(crate) is_at_reference: bool,
    /// Whether a correction was large enough to count.
    pub(crate) is_corrected: bool,
    /// Whether the path requires motion but the robot makes no progress.
    pub(crate) is_stalled: bool,
    pub(crate) is_stationary: bool,
    /// Whether the override is 0.
    pub(crate) is_halted: bool,
}

/// The state, and the times that all states share.
#[derive(Debug)]
pub(crate) struct StateMachine {
    state: ControlState,
    stall_timeout_s: f64,
    /// Time without progress, s.
    stalled_s: f64,
    /// Time since the last correction, s.
    since_correction_s: f64,
    /// Whether a detour is being planned from the present configuration.
    awaits_detour: bool,
}

impl StateMachine {
    pub(crate) fn new(stall_timeout_s: f64) -> Self {
        let state = ControlState::Following;
        Self { state, stall_timeout_s, stalled_s: 0.0, since_correction_s: f64::INFINITY, awaits_detour: false }
    }

    pub(crate) fn state(&self) -> &ControlState {
        &self.state
    }

    /// The detour that the robot follows, if any.
    pub(crate) fn detour_mut(&mut self) -> Option<&mut Detour> {
        match &mut self.state {
            ControlState::Detouring(detour) => Some(detour),
            _ => None,
        }
    }

    /// Whether the robot is on a detour with remaining waypoints.
    pub(crate) fn has_detour(&self) -> bool {
        matches!(&self.state, ControlState::Detouring(detour) if !detour.is_finished())
    }

    pub(crate) fn abandon_detour(&mut self) {
        if let Some(detour) = self.detour_mut() {
            detour.abandon();
        }
    }

    /// Whether the robot has made no progress for the stall timeout.
    pub(crate) fn is_stalled(&self) -> bool {
        self.stalled_s >= self.stall_timeout_s
    }

    /// Whether a detour is being planned in this tick.
    pub(crate) fn awaits_detour(&self) -> bool {
        self.awaits_detour
    }

    /// Reports that a detour is being planned from the present configuration in this tick: the robot does not return
    /// meanwhile.
    pub(crate) fn await_detour(&mut self) {
        self.awaits_detour = true;
        if matches!(self.state, ControlState::Returning { .. }) {
            self.apply(Event::Halted);
        }
    }

    /// Starts a planned detour. A detour without waypoints leaves the robot where it is.
    pub(crate) fn start_detour(&mut self, detour: Detour) {
        self.stalled_s = 0.0;
        self.apply(if !detour.is_finished() {
            Event::DetourPlanned(detour)
        } else if self.is_recently_corrected() {
            Event::Corrected
        } else {
            Event::Halted
        });
    }

    /// Ends a tick that failed.
    pub(crate) fn fail(&mut self) {
        self.awaits_detour = false;
        self.apply(if self.is_recently_corrected() { Event::FailedWhileEvading } else { Event::Failed });
    }

    fn is_recently_corrected(&self) -> bool {
        self.since_correction_s < RECENT_CORRECTION_S
    }

    /// Ends a tick.
    pub(crate) fn end_tick(&mut self, tick: &TickSummary) {
        self.awaits_detour = false;
        self.stalled_s = if tick.is_stalled { self.stalled_s + tick.dt } else { 0.0 };
        self.since_correction_s = if tick.is_corrected { 0.0 } else { self.since_correction_s + tick.dt };
        self.apply(if self.has_detour() {
            Event::DetourActive
        } else if tick.is_at_reference {
            Event::OnPath
        } else if self.is_recently_corrected() {
            Event::Corrected
        } else if tick.is_halted {
            Event::Halted
        } else if tick.is_stationary {
            Event::AtRest { dt: tick.dt }
        } else {
            Event::Moving
        });
    }

    /// The state to report after a tick. In order of precedence: halted at the override 0, waiting if the robot is
    /// stationary and stalled, then the control state. Off the path, `is_reacting` is reported as evading.
    pub(crate) fn reported(&self, tick: &TickSummary, is_reacting: bool) -> AvoiderState {
        if tick.is_halted {
            return AvoiderState::Halted;
        }
        if tick.is_stalled && tick.is_stationary && self.stalled_s > REPORT_WAITING_S {
            return AvoiderState::Waiting;
        }
        match &self.state {
            ControlState::Following => AvoiderState::Following,
            ControlState::Detouring(_) => AvoiderState::Detouring,
            ControlState::Evading => AvoiderState::Evading,
            ControlState::Holding { .. } | ControlState::Returning { .. } if is_reacting => AvoiderState::Evading,
            ControlState::Holding { .. } | ControlState::Returning { .. } => AvoiderState::Returning,
        }
    }

    fn apply(&mut self, event: Event) {
        self.state = transition(std::mem::take(&mut self.state), event, self.stall_timeout_s);
    }
}

#[cfg(test)]
mod tests;
