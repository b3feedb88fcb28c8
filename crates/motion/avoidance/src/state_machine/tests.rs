//! The documented transition table, and the events of ticks.

use super::*;

const TIMEOUT_S: f64 = 0.6;
const DT: f64 = 0.125;

fn detour() -> Detour {
    Detour::new(vec![vec![0.0], vec![1.0]], true)
}

/// The state of a cell of the table: name and idle time; `t` is the idle time of the row.
fn parse_state(cell: &str, t: f64) -> ControlState {
    let (name, time) = cell.trim_matches('`').split_once(' ').unwrap_or((cell.trim_matches('`'), ""));
    let idle_s = match time {
        "" | "0" => 0.0,
        "t" => t,
        "dt" => DT,
        "t+dt" => t + DT,
        other => panic!("{other}"),
    };
    match name {
        "Following" => ControlState::Following,
        "Detouring" => ControlState::Detouring(detour()),
        "Evading" => ControlState::Evading,
        "Holding" => ControlState::Holding { idle_s },
        "Returning" => ControlState::Returning { idle_s },
        other => panic!("{other}"),
    }
}

fn event(name: &str) -> Event {
    match name.trim_matches('`') {
        "DetourPlanned" => Event::DetourPlanned(detour()),
        "DetourActive" => Event::DetourActive,
        "OnPath" => Event::OnPath,
        "Corrected" => Event::Corrected,
        "AtRest" => Event::AtRest { dt: DT },
        "Moving" => Event::Moving,
        "Halted" => Event::Halted,
        "Failed" => Event::Failed,
        "FailedWhileEvading" => Event::FailedWhileEvading,
        other => panic!("{other}"),
    }
}

#[test]
fn every_row_of_the_documented_table_is_a_transition() {
    let lines = include_str!("mod.rs").lines().filter_map(|l| l.strip_prefix("//! | "));
    let cells = |line: &'static str| line.trim_end_matches(" |").split(" | ").collect::<Vec<_>>();
    let mut table = lines.map(cells);
    let events = table.next().unwrap().split_off(1);
    assert_eq!(events.len(), 9);
    let mut checked = 0;
    for row in table.skip(1) {
        let t = if row[0].contains("Returning") { 0.75 } else { 0.25 };
        for (name, expected) in events.iter().zip(&row[1..]) {
            let after = transition(parse_state(row[0], t), event(name), TIMEOUT_S);
            let (after, expected) = (format!("{after:?}"), format!("{:?}", parse_state(expected, t)));
            assert_eq!(after, expected, "{} {name}", row[0]);
            checked += 1;
        }
    }
    assert_eq!(checked, 5 * 9);
}

#[test]
fn while_a_detour_is_planned_the_robot_does_not_return() {
    let mut machine = StateMachine::new(TIMEOUT_S);
    let idle = TickSummary { is_stationary: true, ..tick() };
    for _ in 0..=(TIMEOUT_S / DT) as usize + 1 {
        machine.end_tick(&idle);
    }
    assert!(matches!(machine.state(), ControlState::Returning { .. }), "{:?}", machine.state());
    machine.await_detour();
    assert!(matches!(machine.state(), ControlState::Holding { idle_s: 0.0 }), "{:?}", machine.state());
    machine.end_tick(&TickSummary { is_corrected: true, ..idle });
    machine.await_detour();
    assert!(matches!(machine.state(), ControlState::Evading), "it may evade");
}

#[test]
fn holding_ends_at_the_stall_timeout() {
    let mut state = ControlState::Following;
    for _ in 0..4 {
        state = transition(state, Event::AtRest { dt: DT }, TIMEOUT_S);
        assert!(matches!(state, ControlState::Holding { .. }), "{state:?}");
    }
    state = transition(state, Event::AtRest { dt: DT }, TIMEOUT_S);
    assert!(matches!(state, ControlState::Returning { idle_s } if idle_s == 5.0 * DT), "{state:?}");
}

fn tick() -> TickSummary {
    TickSummary {
        dt: DT,
        is_at_reference: false,
        is_corrected: false,
        is_stalled: false,
        is_stationary: false,
        is_halted: false,
    }
}

#[test]
fn a_tick_is_one_event() {
    let after = |machine: &mut StateMachine, tick: TickSummary| {
        machine.end_tick(&tick);
        format!("{:?}", machine.state()).split([' ', '(']).next().unwrap().to_owned()
    };
    let mut machine = StateMachine::new(TIMEOUT_S);
    assert_eq!(after(&mut machine, TickSummary { is_at_reference: true, ..tick() }), "Following");
    assert_eq!(after(&mut machine, TickSummary { is_corrected: true, ..tick() }), "Evading");
    assert_eq!(after(&mut machine, tick()), "Holding");
    machine.start_detour(detour());
    assert_eq!(after(&mut machine, tick()), "Detouring");
    // At the end of the detour, or when it is abandoned, the robot is off its path again.
    machine.abandon_detour();
    assert_eq!(after(&mut machine, TickSummary { is_stationary: true, ..tick() }), "Holding");
    assert_eq!(machine.state().idle_s(), DT);
    assert_eq!(after(&mut machine, TickSummary { is_halted: true, ..tick() }), "Holding");
    assert_eq!(machine.state().idle_s(), 0.0);
    machine.fail();
    assert!(matches!(machine.state(), ControlState::Holding { .. }));
    assert_eq!(after(&mut machine, TickSummary { is_at_reference: true, ..tick() }), "Following");
}

#[test]
fn reported_states_have_a_precedence() {
    let mut machine = StateMachine::new(TIMEOUT_S);
    let stalled = TickSummary { is_stalled: true, is_stationary: true, ..tick() };
    machine.end_tick(&stalled);
    assert_eq!(machine.reported(&stalled, true), AvoiderState::Waiting);
    assert_eq!(machine.reported(&TickSummary { is_halted: true, ..stalled }, true), AvoiderState::Halted);
    assert_eq!(machine.reported(&tick(), true), AvoiderState::Evading);
    assert_eq!(machine.reported(&tick(), false), AvoiderState::Returning);
}
