//! What a monitor says of itself at an exchange region, from far away until it has left it again.

mod common;

use std::sync::Arc;

use common::{arm_volumes, gantry, parts};
use elbowroom_monitor::{
    Board, Configuration, ConfigurationParts, ExchangeState, Kind, Laws, Monitor, Region, RegionId, RobotSlot, SlotId,
    Snapshot, Stay, Stopping,
};
use elbowroom_spatial::Vec3;

const TICK_S: f64 = 0.002;

/// A gantry that goes through a region at 1 m/s, as long as it is told so; what it was at each tick.
fn states(laws: Laws) -> (Vec<ExchangeState>, Vec<Stay>) {
    let board = Arc::new(Board::new(&["r"], &["shared"]));
    let slot = SlotId(0);
    let region = Region::sphere("shared", Vec3::X * 4.0, 0.3).warning(0.6).kind(Kind::Exchange { slot });
    let parts = ConfigurationParts { laws, ..parts(gantry(), arm_volumes(), vec![region]) };
    let mut monitor = Monitor::new(Configuration::new(parts).unwrap(), Some((board.clone(), RobotSlot(0)))).unwrap();
    let (mut seen, mut said) = (Vec::new(), Vec::new());
    let velocity = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for tick in 0..4500 {
        let t = f64::from(tick) * TICK_S;
        let q = [t, 0.0, 0.0, 0.0, 0.0, 0.0];
        monitor.tick(&Snapshot { qd: &velocity, intent: Some(&velocity), ..Snapshot::still(t, &q) });
        let state = monitor.exchange_state(RegionId(0)).unwrap();
        if seen.last() != Some(&state) {
            seen.push(state);
            said.push(board.stay(slot, RobotSlot(0)));
        }
    }
    (seen, said)
}

#[test]
fn a_robot_says_when_it_cannot_stop_outside_any_more() {
    use ExchangeState::{Committed, Granted, Inside, Outside};
    let stopping = Stopping {
        reaction_s: 0.01,
        period_s: TICK_S,
        joint_deceleration: vec![5.0; 6],
        joint_acceleration: vec![5.0; 6],
    };
    let (seen, said) = states(Laws { stopping_distance: Some(stopping), ..Laws::default() });
    assert_eq!(seen[..4], [Outside, Granted, Committed, Inside], "{seen:?}");
    assert_eq!(seen.last(), Some(&Outside));
    assert_eq!(said[..4], [Stay::Outside, Stay::Warning, Stay::Committed, Stay::Inside]);
    // Without a stated deceleration it may be unable to stop as soon as it moves on with the grant.
    let (seen, _) = states(Laws::default());
    assert_eq!(seen[..4], [Outside, Granted, Committed, Inside], "{seen:?}");
    assert_eq!(seen.last(), Some(&Outside));
}
