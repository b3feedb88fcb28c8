//! Gate of a controller's joint states: which are accepted, and how old they are.

use elbowroom_interlock::Micros;
use thiserror::Error;

use crate::messages::JointState;

/// Silence after which a controller may have started again with a lower number, because its clock was set back.
const FORGOTTEN: Micros = Micros(1_000_000);
/// Largest lead of a stamp: a stamp farther ahead is not from a clock.
const MOST_AHEAD: Micros = Micros(1_000_000);
/// Clocks drift apart by less than 1 µs in this many µs: the least observed delay increases at this rate as time passes.
const DRIFT_ONE_IN: u64 = 1_000;

/// Why a joint state is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Rejected {
    /// Its number is not higher than the last one: it is late, doubled or replayed.
    #[error("a joint state with a higher number was there before")]
    Late,
    /// It is of a controller start before the present one.
    #[error("the joint state is of a former start of the controller")]
    FormerStart,
    /// The controller expects another configuration.
    #[error("the controller expects another configuration: load the same cell file on both sides")]
    OtherConfiguration,
    /// The controller accepts any configuration, in a cell with exchange regions: an old cell file could lead it into
    /// an occupied one.
    #[error(
        "the controller does not say which configuration it expects, in a cell with exchange regions: give it the number that the service prints at its start"
    )]
    NoConfiguration,
    /// Its stamp is far ahead of the controller's clock.
    #[error("the stamp is more than a second ahead of the controller's clock, which must not jump")]
    Stamp,
}

/// Accepts the joint states of one controller in order, and computes their age.
///
/// Stamps stay on the controller's clock, so that their differences are exact whatever the network does. The message
/// with the least delay gives the present time of that clock: a delay that is there from the start is not noticed (the
/// controller's watchdog bounds the delay there and back); any additional delay makes a message that much older. As the
/// clocks may drift apart, an additional delay decays by 1 ms per second. A restarted controller continues with the
/// time of its earlier start.
#[derive(Debug, Clone, Default)]
pub struct InputGate {
    checksum: u64,
    /// Whether controllers that accept any configuration are refused.
    needs_configuration: bool,
    last: Option<Last>,
    /// Offset added to stamps: continues the time of an earlier start of the controller.
    base_us: i64,
    /// The least difference between arrival and stamp, and its time.
    least: Option<Delay>,
    /// The latest time returned by [`Self::now`], which never decreases.
    shown: Micros,
    /// Number of refused messages.
    pub rejected: u64,
}

#[derive(Debug, Clone, Copy)]
struct Delay {
    us: i64,
    seen: Micros,
}

impl Delay {
    /// Largest value of the delay at a later time, as the clocks may have drifted apart, µs.
    fn at(self, local: Micros) -> i64 {
        self.us.saturating_add(signed_us(Micros((local - self.seen).0 / DRIFT_ONE_IN)))
    }
}

#[derive(Debug, Clone, Copy)]
struct Last {
    boot: u64,
    sequence: u64,
    arrived: Micros,
}

impl InputGate {
    /// Creates a gate for controllers with this configuration, or with 0 for any.
    pub fn new(checksum: u64) -> Self {
        Self { checksum, ..Self::default() }
    }

    /// Sets whether controllers that accept any configuration are refused.
    #[must_use]
    pub fn needs_configuration(self, needs: bool) -> Self {
        Self { needs_configuration: needs, ..self }
    }

    /// Accepts a joint state; returns the time of its values on the controller's clock.
    ///
    /// # Errors
    /// The reason for refusing it.
    pub fn pass(&mut self, state: &JointState, arrived: Micros) -> Result<Micros, Rejected> {
        if let Err(why) = self.check(state, arrived) {
            return Err(self.reject(why));
        }
        let now = self.now(arrived);
        let raw_us = signed_us(Micros(state.stamp_us));
        let based = |base_us: i64| Micros(raw_us.saturating_add(base_us).max(0) as u64);
        let is_ahead = based(self.base_us) - now > MOST_AHEAD;
        if is_ahead && !self.was_silent(arrived) {
            return Err(self.reject(Rejected::Stamp));
        }
        if is_ahead || self.last.is_none_or(|last| last.boot != state.boot) {
            // The time of the first start begins at the present time of this process's clock.
            let from = if self.last.is_none() { arrived } else { now };
            self.base_us = signed_us(from).saturating_sub(raw_us);
            self.least = None;
        }
        let stamp = based(self.base_us);
        self.last = Some(Last { boot: state.boot, sequence: state.sequence, arrived });
        let delay = Delay { us: signed_us(arrived).saturating_sub(signed_us(stamp)), seen: arrived };
        if self.least.is_none_or(|least| delay.us <= least.at(arrived)) {
            self.least = Some(delay);
        }
        Ok(stamp)
    }

    /// Time on the controller's clock when this process's clock shows `local`.
    ///
    /// It never decreases, and is never before the last stamp.
    pub fn now(&mut self, local: Micros) -> Micros {
        if let Some(least) = self.least {
            self.shown = self.shown.max(Micros(signed_us(local).saturating_sub(least.at(local)).max(0) as u64));
        }
        self.shown
    }

    fn check(&self, state: &JointState, arrived: Micros) -> Result<(), Rejected> {
        if state.checksum != 0 && state.checksum != self.checksum {
            return Err(Rejected::OtherConfiguration);
        }
        if state.checksum == 0 && self.needs_configuration {
            return Err(Rejected::NoConfiguration);
        }
        match self.last {
            Some(last) if state.boot == last.boot && state.sequence <= last.sequence => Err(Rejected::Late),
            Some(last) if state.boot < last.boot && !self.was_silent(arrived) => Err(Rejected::FormerStart),
            _ => Ok(()),
        }
    }

    fn was_silent(&self, now: Micros) -> bool {
        self.last.is_none_or(|last| now - last.arrived >= FORGOTTEN)
    }

    fn reject(&mut self, why: Rejected) -> Rejected {
        self.rejected += 1;
        why
    }
}

fn signed_us(time: Micros) -> i64 {
    i64::try_from(time.0).unwrap_or(i64::MAX)
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
        let mut strict = InputGate::new(5).needs_configuration(true);
        let of = |checksum| JointState { checksum, ..state(1, 1, 0) };
        assert_eq!(strict.pass(&of(0), Micros(100)), Err(Rejected::NoConfiguration));
        assert!(strict.pass(&of(5), Micros(100)).is_ok());
        assert!(gate.pass(&state(3, 1, 0), Micros(2_000_000)).is_ok(), "the clock of the controller was set back");
    }

    /// The `n`-th message of a controller whose clock shows 1 s more, sent every 2 ms, and its arrival.
    fn sent(n: u64, delay_us: u64) -> (JointState, Micros) {
        (state(1, n, 1_000_000 + n * 2_000), Micros(n * 2_000 + delay_us))
    }

    #[test]
    fn a_delayed_message_is_as_old_as_it_is_late() {
        let mut gate = InputGate::new(0);
        for n in 1..50 {
            let (state, arrived) = sent(n, 100);
            let stamp = gate.pass(&state, arrived).unwrap();
            assert_eq!(gate.now(arrived) - stamp, Micros(0));
        }
        let (state, arrived) = sent(50, 30_000);
        let stamp = gate.pass(&state, arrived).unwrap();
        // Less what the clocks may have drifted apart since the message before, 32 ms ago.
        assert_eq!(gate.now(arrived) - stamp, Micros(29_900 - 31));
    }

    /// Values that were on the way for 300 ms are not fresh because all of them are by now.
    #[test]
    fn a_delay_that_stays_is_not_forgotten() {
        let mut gate = InputGate::new(0);
        let delay = |n: u64| if n < 500 { 100 } else { 300_000 };
        for n in 1..30_000 {
            let (state, arrived) = sent(n, delay(n));
            let stamp = gate.pass(&state, arrived).unwrap();
            let age = gate.now(arrived) - stamp;
            // A minute later, at a millisecond per second.
            assert!(n < 500 || age > Micros(230_000), "message {n}: {age:?}");
        }
    }

    #[test]
    fn stamps_keep_their_differences_and_now_never_goes_back() {
        let mut gate = InputGate::new(0);
        let (mut last, mut shown) = (None, Micros(0));
        for n in 1..5_000 {
            let (state, arrived) = sent(n, n * 7919 % 1_900);
            let stamp = gate.pass(&state, arrived).unwrap();
            assert!(last.is_none_or(|last| stamp - last == Micros(2_000)));
            let now = gate.now(arrived);
            assert!(now >= shown && now >= stamp);
            (last, shown) = (Some(stamp), now);
        }
    }

    /// The clock of a virtual machine stops while its host pauses it. Grants that the node still holds have ended long ago.
    #[test]
    fn a_node_that_stood_still_hears_nothing_from_after_the_halt_at_first() {
        let mut gate = InputGate::new(0);
        for n in 1..50 {
            let (state, arrived) = sent(n, 100);
            gate.pass(&state, arrived).unwrap();
        }
        let after = |n: u64| {
            let (state, arrived) = sent(n, 100);
            (JointState { stamp_us: state.stamp_us + 10_000_000, ..state }, arrived)
        };
        let accepted = (50..2_000).find(|n| {
            let (state, arrived) = after(*n);
            gate.pass(&state, arrived).is_ok()
        });
        // A second after the last one that counted: by then grants have ended on this clock as well.
        assert_eq!(accepted, Some(49 + 500));
    }

    #[test]
    fn a_controller_that_starts_again_goes_on_with_the_time_of_the_former_one() {
        let mut gate = InputGate::new(0);
        let before = gate.pass(&state(1, 1, 50_000_000), Micros(0)).unwrap();
        let after = gate.pass(&state(2, 1, 3), Micros(400_000)).unwrap();
        // Less what the clocks may have drifted apart.
        assert_eq!(after - before, Micros(400_000 - 400));
    }

    #[test]
    fn a_clock_that_jumps_is_no_clock() {
        let mut gate = InputGate::new(0);
        gate.pass(&state(1, 1, 0), Micros(0)).unwrap();
        assert_eq!(gate.pass(&state(1, 2, u64::MAX), Micros(2_000)), Err(Rejected::Stamp));
        assert_eq!(gate.pass(&state(1, 3, 5_000_000), Micros(4_000)), Err(Rejected::Stamp));
        assert_eq!(gate.pass(&state(1, 4, 6_000), Micros(6_000)), Ok(Micros(6_000)));
    }

    #[test]
    fn a_pause_costs_no_message() {
        let mut gate = InputGate::new(0);
        gate.pass(&state(1, 1, 0), Micros(0)).unwrap();
        // The controller was about to send when it was paused for 2 s; then it continues with the present time.
        gate.pass(&state(1, 2, 2_000), Micros(2_002_000)).unwrap();
        assert_eq!(gate.pass(&state(1, 3, 2_004_000), Micros(2_004_000)), Ok(Micros(2_004_000)));
    }

    #[test]
    fn clocks_of_different_rates_do_not_drift_apart() {
        let mut gate = InputGate::new(0);
        // The controller's clock is 0.1 % slow: 60 ms per minute.
        for n in 1..60_000_u64 {
            let arrived = Micros(n * 2_000);
            let stamp = gate.pass(&state(1, n, n * 1_998), arrived).unwrap();
            assert!(gate.now(arrived) - stamp <= Micros(5_000), "{arrived:?} {stamp:?}");
        }
    }
}
