//! The states that a monitor publishes at an exchange region, from the approach until the robot has left.

use std::sync::Arc;

use crate::common::{arm_volumes, gantry, parts};
use elbowroom_monitor::{
    Configuration, ConfigurationParts, ExchangeState, Laws, Monitor, Occupancy, Region, RegionId, RegionKind,
    RobotSlot, SlotId, Snapshot, StoppingSettings, ZoneArbiter,
};
use elbowroom_spatial::Vec3;

const TICK_S: f64 = 0.002;

/// States and published occupancies of a gantry that moves through a region at 1 m/s.
fn states(laws: Laws) -> (Vec<ExchangeState>, Vec<Occupancy>) {
    let arbiter = Arc::new(ZoneArbiter::new(&["r"], &["shared"]));
    let slot = SlotId(0);
    let region = Region::sphere("shared", Vec3::X * 4.0, 0.3).warning(0.6).kind(RegionKind::Exchange { slot });
    let parts = ConfigurationParts { laws, ..parts(gantry(), arm_volumes(), vec![region]) };
    let mut monitor =
        Monitor::new(Configuration::new(parts).unwrap(), Some((arbiter.clone(), RobotSlot(0)).into())).unwrap();
    let (mut states, mut published) = (Vec::new(), Vec::new());
    let velocity = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for tick in 0..4500 {
        let t = f64::from(tick) * TICK_S;
        let q = [t, 0.0, 0.0, 0.0, 0.0, 0.0];
        monitor.tick(&Snapshot { qd: &velocity, intent: Some(&velocity), ..Snapshot::stationary(t, &q) });
        let state = monitor.exchange_state(RegionId(0)).unwrap();
        if states.last() != Some(&state) {
            states.push(state);
            published.push(arbiter.occupancy(slot, RobotSlot(0)));
        }
    }
    (states, published)
}

#[test]
fn a_robot_publishes_that_it_cannot_stop_outside() {
    use ExchangeState::{Committed, Granted, Inside, Outside};
    let stopping = StoppingSettings {
        reaction_s: 0.01,
        period_s: TICK_S,
        joint_deceleration: vec![5.0; 6],
        joint_acceleration: vec![5.0; 6],
    };
    let (observed, published) = states(Laws { stopping_distance: Some(stopping), ..Laws::default() });
    assert_eq!(observed[..4], [Outside, Granted, Committed, Inside], "{observed:?}");
    assert_eq!(observed.last(), Some(&Outside));
    assert_eq!(published[..4], [Occupancy::Outside, Occupancy::Warning, Occupancy::Committed, Occupancy::Inside]);
    // Without a stated deceleration, the robot may be unable to stop as soon as it moves with the grant.
    let (observed, _) = states(Laws::default());
    assert_eq!(observed[..4], [Outside, Granted, Committed, Inside], "{observed:?}");
    assert_eq!(observed.last(), Some(&Outside));
}
