//! Which joint states of a controller count, and how old they are.

use elbowroom_interlock::Micros;
use thiserror::Error;

use crate::messages::JointState;

/// A controller that was silent for this long may have started again with a lower number: its clock was set back.
const FORGOTTEN: Micros = Micros(1_000_000);
/// The least delay of messages is that of the last two such spans, so that clocks of different rates do not drift apart.
const SPAN: Micros = Micros(2_000_000);

/// Why a joint state does not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Rejected {
    /// Its number is not higher than that of the last one: late, doubled or replayed.
    #[error("a joint state with a higher number was there before")]
    Late,
    /// Of a controller that was started before the present one.
    #[error("the joint state is of a former start of the controller")]
    FormerStart,
    /// The controller expects another configuration.
    #[error("the controller expects another configuration: load the same cell file on both sides")]
    OtherConfiguration,
}

/// Passes the joint states of one controller in order, and maps their stamps to this process's clock.
///
/// The clocks of two processes have nothing in common but their rates. The difference of stamp and arrival is smallest for the
/// message with the least delay; by this, every other one is that much older than its arrival. A constant delay is not
/// noticed: the controller's watchdog bounds the way there and back.
#[derive(Debug, Clone, Default)]
pub struct InputGate {
    checksum: u64,
    last: Option<Last>,
    /// The least difference of arrival and stamp in this span and the one before.
    offset: [Option<i64>; 2],
    span_began: Micros,
    /// Messages that did not count.
    pub rejected: u64,
}

#[derive(Debug, Clone, Copy)]
struct Last {
    boot: u64,
    sequence: u64,
    arrived: Micros,
}

impl InputGate {
    /// For controllers that expect this configuration, or say 0.
    pub fn new(checksum: u64) -> Self {
        Self { checksum, ..Self::default() }
    }

    /// The time of the joint values on this process's clock.
    ///
    /// # Errors
    /// Why they do not count.
    pub fn pass(&mut self, state: &JointState, arrived: Micros) -> Result<Micros, Rejected> {
        let checked = self.check(state, arrived);
        if checked.is_err() {
            self.rejected += 1;
            return Err(checked.unwrap_err());
        }
        if self.last.is_none_or(|last| last.boot != state.boot) {
            self.offset = [None, None];
            self.span_began = arrived;
        }
        self.last = Some(Last { boot: state.boot, sequence: state.sequence, arrived });
        if arrived - self.span_began > SPAN {
            self.offset = [None, self.offset[0]];
            self.span_began = arrived;
        }
        let offset = (arrived.0 as i64).saturating_sub(state.stamp_us as i64);
        self.offset[0] = Some(self.offset[0].map_or(offset, |least| least.min(offset)));
        let least = self.offset.iter().flatten().min().copied().unwrap_or(offset);
        Ok(Micros((state.stamp_us as i64).saturating_add(least).max(0) as u64))
    }

    fn check(&self, state: &JointState, arrived: Micros) -> Result<(), Rejected> {
        if state.checksum != 0 && state.checksum != self.checksum {
            return Err(Rejected::OtherConfiguration);
        }
        let Some(last) = self.last else { return Ok(()) };
        if state.boot == last.boot {
            return if state.sequence > last.sequence { Ok(()) } else { Err(Rejected::Late) };
        }
        if state.boot < last.boot && arrived - last.arrived < FORGOTTEN { Err(Rejected::FormerStart) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(boot: u64, sequence: u64, stamp_us: u64) -> JointState {
        JointState { boot, sequence, stamp_us, ..JointState::default() }
    }

    #[test]
    fn late_doubled_and_replayed_messages_do_not_count() {
        let mut gate = InputGate::new(5);
        gate.pass(&state(10, 4, 0), Micros(100)).unwrap();
        for sequence in [4, 3, 0] {
            assert_eq!(gate.pass(&state(10, sequence, 0), Micros(200)), Err(Rejected::Late));
        }
        assert_eq!(gate.pass(&state(9, 99, 0), Micros(200)), Err(Rejected::FormerStart));
        assert!(gate.pass(&state(11, 1, 0), Micros(300)).is_ok(), "a later start begins at 1");
        let other = JointState { checksum: 6, ..state(11, 2, 0) };
        assert_eq!(gate.pass(&other, Micros(400)), Err(Rejected::OtherConfiguration));
        assert_eq!(gate.rejected, 5);
        assert!(gate.pass(&state(3, 1, 0), Micros(2_000_000)).is_ok(), "the clock of the controller was set back");
    }

    #[test]
    fn a_delayed_message_is_as_old_as_it_is_late() {
        let mut gate = InputGate::new(0);
        // The controller's clock shows 1 s more; the way takes 100 µs, once 30 ms.
        let sent = |n: u64, delay: u64| (state(1, n, 1_000_000 + n * 2_000), Micros(n * 2_000 + delay));
        for n in 1..50 {
            let (state, arrived) = sent(n, 100);
            assert_eq!(gate.pass(&state, arrived), Ok(arrived));
        }
        let (state, arrived) = sent(50, 30_000);
        assert_eq!(gate.pass(&state, arrived), Ok(Micros(50 * 2_000 + 100)));
    }

    #[test]
    fn clocks_of_different_rates_do_not_drift_apart() {
        let mut gate = InputGate::new(0);
        // The controller's clock is 0.1 % slow: 60 ms per minute.
        for n in 1..60_000_u64 {
            let arrived = Micros(n * 2_000);
            let stamp = gate.pass(&state(1, n, n * 1_998), arrived).unwrap();
            assert!(arrived - stamp <= Micros(5_000), "{arrived:?} {stamp:?}");
        }
    }
}
