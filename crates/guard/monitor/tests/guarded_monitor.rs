//! Monitor, guard and arbiter together: carriages on rails at an exchange region.

use crate::rail;
use crate::rail::{BORDERS, Carriage, Cell, REGION, SLOT, WARNING_M, configuration};
use elbowroom_interlock::{Boot, Guard, Ignored};
use elbowroom_monitor::{
    AccessClass, ConfigError, ExchangeState, GuardedMonitor, Laws, NotObeyed, Occupancy, OverrideReason, RobotSlot,
    SlotId,
};

fn state(cell: &Cell, r: usize) -> ExchangeState {
    cell.carriages[r].robot.grants().state(SLOT)
}

#[test]
fn one_goes_through_and_the_other_waits() {
    let mut cell = Cell::new(vec![Carriage::new(0, 0.0, 1.0), Carriage::new(1, 0.2, 1.0)]);
    cell.until("one is inside", |cell| cell.carriages[1].is_inside());
    assert_eq!((cell.arbiter.holder(SLOT), state(&cell, 0)), (Some(RobotSlot(1)), ExchangeState::Waiting));
    assert_eq!(cell.carriages[0].report.unwrap().reason, OverrideReason::Waiting(REGION));
    cell.until("the other one is inside, too", |cell| cell.carriages[0].is_inside());
    cell.until("both are through", |cell| cell.carriages.iter().all(|c| c.x > BORDERS.1 + WARNING_M + 0.1));
    cell.run(0.05);
    assert_eq!(cell.arbiter.holder(SLOT), None);
}

#[test]
fn a_grant_that_ends_during_the_approach_stops_the_robot_before_the_border() {
    for x in [1.25, 1.3, 1.4, 1.45, 1.5] {
        let mut cell = Cell::new(vec![Carriage::new(0, 0.0, 1.0)]);
        cell.until("it approaches", |cell| cell.carriages[0].x > x);
        assert_eq!((state(&cell, 0), cell.carriages[0].speed_override()), (ExchangeState::Granted, 1.0));
        cell.carriages[0].is_connected = false;
        cell.until("the grant ends", |cell| state(cell, 0) != ExchangeState::Granted);
        assert_eq!(state(&cell, 0), ExchangeState::Waiting, "{x}");
        // The carriage is limited again in the same tick.
        assert!(cell.carriages[0].speed_override() < 1.0);
        cell.run(3.0);
        assert!(cell.carriages[0].x < BORDERS.0 && cell.carriages[0].v < 0.01, "{}", cell.carriages[0].x);
        cell.carriages[0].is_connected = true;
        cell.until("it goes on", |cell| cell.carriages[0].x > BORDERS.1);
    }
}

#[test]
fn a_committed_robot_goes_on_without_the_network_and_keeps_the_slot() {
    let mut cell = Cell::new(vec![Carriage::new(0, 0.0, 1.0), Carriage::new(1, -0.8, 1.0)]);
    cell.until("it is committed", |cell| state(cell, 0) == ExchangeState::Committed);
    cell.carriages[0].is_connected = false;
    cell.until("it is through", |cell| {
        assert!(cell.carriages[0].speed_override() > 0.99, "at {}", cell.carriages[0].x);
        cell.carriages[0].x > BORDERS.1
    });
    cell.run(2.0);
    // The arbiter has not received the message that the carriage is through.
    assert_eq!((cell.arbiter.holder(SLOT), state(&cell, 1)), (Some(RobotSlot(0)), ExchangeState::Waiting));
    cell.carriages[0].is_connected = true;
    cell.until("the other one is inside", |cell| cell.carriages[1].is_inside());
}

/// Its node pauses, or sees nothing: the controller stops it. Another node of the robot may have given the slot up meanwhile.
#[test]
fn a_committed_robot_waits_after_a_pause_until_its_grant_is_confirmed() {
    let mut cell = Cell::new(vec![Carriage::new(0, 0.0, 1.0)]);
    cell.until("it is committed", |cell| state(cell, 0) == ExchangeState::Committed);
    cell.carriages[0].program = 0.0;
    // At rest just before the border, where it cannot be proven to stop outside once it moves.
    cell.carriages[0].by_hand = Some(0.0);
    (cell.carriages[0].x, cell.carriages[0].v) = (BORDERS.0 - 0.001, 0.0);
    (cell.carriages[0].is_connected, cell.carriages[0].is_seen) = (false, false);
    cell.run(0.1);
    (cell.carriages[0].is_seen, cell.carriages[0].by_hand, cell.carriages[0].program) = (true, None, 1.0);
    cell.run(1.0);
    assert!(cell.carriages[0].x < BORDERS.0, "{}", cell.carriages[0].x);
    cell.carriages[0].is_connected = true;
    cell.until("it goes on", |cell| cell.carriages[0].x > BORDERS.1);
}

#[test]
fn a_region_that_is_switched_off_keeps_its_slot_until_the_robot_has_left() {
    let mut cell = Cell::new(vec![Carriage::new(0, 0.0, 1.0), Carriage::new(1, -0.5, 1.0)]);
    cell.until("it is inside", |cell| cell.carriages[0].x > 1.9);
    cell.carriages[0].program = 0.0;
    cell.run(0.5);
    cell.carriages[0].robot.monitor_mut().switch(REGION, false, AccessClass::Programmer).unwrap();
    cell.run(1.0);
    assert_eq!((cell.arbiter.holder(SLOT), state(&cell, 0)), (Some(RobotSlot(0)), ExchangeState::Inside));
    assert_eq!((cell.carriages[0].speed_override(), state(&cell, 1)), (1.0, ExchangeState::Waiting));
    cell.carriages[0].program = 1.0;
    cell.until("the other one is inside", |cell| cell.carriages[1].is_inside());
    assert!(cell.carriages[0].x > BORDERS.1);
}

#[test]
fn a_region_that_is_switched_off_is_not_requested() {
    let mut cell = Cell::new(vec![Carriage::new(0, 1.5, 0.0), Carriage::new(1, 1.0, 1.0)]);
    cell.carriages[0].robot.monitor_mut().switch(REGION, false, AccessClass::Programmer).unwrap();
    cell.until("the other one is inside", |cell| cell.carriages[1].is_inside());
    assert_eq!(cell.carriages[0].robot.grants().occupancy(SLOT), Occupancy::Warning);
}

#[test]
fn two_that_are_found_inside_halt_until_one_is_moved_out() {
    let mut cell = Cell::new(vec![Carriage::new(0, 1.9, 1.0), Carriage::new(1, 2.1, 1.0)]);
    // The carriage whose message arrives first may move until the other's message arrives.
    cell.until("both halt", Cell::is_halted);
    cell.run(0.5);
    for (carriage, x) in cell.carriages.iter().zip([1.9, 2.1]) {
        let report = carriage.report.unwrap();
        assert_eq!((report.speed_override, report.reason), (0.0, OverrideReason::Halted(REGION)));
        assert!((carriage.x - x).abs() < 0.01, "{}", carriage.x);
    }
    cell.carriages[1].by_hand = Some(0.2);
    cell.until("one is out", |cell| cell.carriages[1].x > BORDERS.1 + 0.1);
    cell.carriages[1].by_hand = None;
    cell.until("both go on", |cell| cell.carriages.iter().all(|c| c.x > BORDERS.1 + WARNING_M));
}

#[test]
fn a_robot_that_is_not_seen_any_more_blocks_the_slot() {
    let mut cell = Cell::new(vec![Carriage::new(0, 0.0, 0.0), Carriage::new(1, 0.0, 1.0)]);
    cell.run(0.2);
    cell.carriages[0].is_seen = false;
    cell.run(2.5);
    assert!(cell.carriages[1].x < BORDERS.0 && state(&cell, 1) == ExchangeState::Waiting);
    assert_eq!(cell.carriages[0].robot.grants().occupancy(SLOT), Occupancy::Outside);
    cell.carriages[0].is_seen = true;
    cell.until("it goes on", |cell| cell.carriages[1].is_inside());
}

#[test]
fn a_tick_that_sees_nothing_gives_nothing_up() {
    let mut cell = Cell::new(vec![Carriage::new(0, 0.0, 1.0)]);
    cell.until("it is in the warning zone", |cell| state(cell, 0) == ExchangeState::Granted);
    // The carriage turns back and has just left the zone: its message closes the grant, but the next tick has no valid
    // input.
    cell.carriages[0].program = -1.0;
    cell.until("it closes the grant", |cell| {
        let robot = &cell.carriages[0].robot;
        robot.guard().token(SLOT).is_some() && !robot.guard().may_enter(SLOT, cell.now())
    });
    let token = cell.carriages[0].robot.guard().token(SLOT);
    cell.carriages[0].is_seen = false;
    cell.run(0.05);
    assert_eq!(cell.carriages[0].robot.guard().token(SLOT), token);
    assert_eq!(cell.arbiter.holder(SLOT), Some(RobotSlot(0)));
    cell.carriages[0].is_seen = true;
    cell.run(0.05);
    assert_eq!((cell.carriages[0].robot.guard().token(SLOT), cell.arbiter.holder(SLOT)), (None, None));
}

#[test]
fn a_configuration_without_the_stopping_distance_is_refused() {
    let guard = || Guard::new(RobotSlot(0), 1, 0, Boot(1));
    let refused = GuardedMonitor::new(configuration(Laws::default()), guard()).unwrap_err();
    assert_eq!(refused, ConfigError::NoStoppingDistance("table".into()));
    assert!(refused.to_string().contains("`stopping_distance = true` into `[monitor]`"), "{refused}");
    let none = GuardedMonitor::new(configuration(rail::laws()), Guard::new(RobotSlot(0), 0, 0, Boot(1))).unwrap_err();
    assert_eq!(none, ConfigError::NoArbiter("table".into()));
}

#[test]
fn bytes_for_others_are_not_obeyed() {
    let mut cell = Cell::new(vec![Carriage::new(0, 0.0, 1.0), Carriage::new(1, 0.0, 1.0)]);
    cell.run(0.1);
    let now = cell.now();
    let state = cell.carriages[0].robot.state(now).to_vec();
    let mut message = elbowroom_interlock::StateMessage::with_slots(1);
    elbowroom_interlock::wire::decode_state(&state, &mut message).unwrap();
    let reply = cell.arbiter.receive(&message, now).replies.remove(0);
    let mut bytes = Vec::new();
    elbowroom_interlock::wire::encode_grants(&reply, &mut bytes);
    let other = &mut cell.carriages[1].robot;
    assert_eq!(other.receive(&bytes), Err(NotObeyed::Ignored(Ignored::OtherRobot)));
    assert_eq!(other.receive(&state), Err(NotObeyed::Wire(elbowroom_interlock::frame::MessageError::Kind)));
    assert!(!other.guard().may_enter(SlotId(0), now));
}
