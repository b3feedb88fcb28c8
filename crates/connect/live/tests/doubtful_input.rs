//! The tick of a node, and a controller's client, if answers are lost, cell files differ or clocks are set.

use std::sync::Arc;

use crate::common::two_rails;
use elbowroom_cell::{Cell, configure};
use elbowroom_interlock::wire::{self, Message};
use elbowroom_interlock::{Boot, Micros};
use elbowroom_live::messages::OverrideAnswer;
use elbowroom_live::node::{NodeMonitor, NodeTick};
use elbowroom_live::{ControllerClient, ControllerState, RegionTable, RegionTableMessage, configuration_number};
use elbowroom_monitor::{Fault, Occupancy, OverrideReason, RobotSlot};

const TICK: Micros = Micros(4_000);
/// The rails end in a region which both enter: the left one reaches it at 1.65 m.
const MORE: &str = r#"[monitor]
stopping_distance = true
direction_aware = true
[region.pallet]
shape = "sphere"
centre = [0, 0, 1900]
radius = 200
kind = "exchange"
warning = 100
"#;

/// The node of the left rail, and its controller.
struct Rig {
    cell: Arc<Cell>,
    node: NodeTick,
    client: ControllerClient,
    now: Micros,
}

impl Rig {
    /// Creates a rig whose controller states this configuration number.
    fn new(configuration: impl FnOnce(u64) -> u64) -> Self {
        let cell = Arc::new(two_rails(MORE));
        let checksum = configuration_number(&cell);
        let setup = configure::setups(&cell).expect("setups").remove(0);
        let monitor = NodeMonitor::new(&setup, RobotSlot(0), 1, checksum, Boot(1)).expect("a monitor");
        let node = NodeTick::new(cell.clone(), setup, monitor, checksum, None);
        let client = ControllerClient::new(1, configuration(checksum));
        Self { cell, node, client, now: Micros(1) }
    }

    /// Returns the override that the robot applies after a tick in which it is at `q` and its program moves on;
    /// `is_heard`: whether the answer arrives.
    fn tick(&mut self, q: f64, is_heard: bool) -> f64 {
        self.now = self.now + TICK;
        let state = ControllerState {
            q: &[q],
            qd: &[0.0],
            intent: &[1.0],
            programmed_override: 1.0,
            ..ControllerState::default()
        };
        self.node.joint_state(self.client.joint_state(self.now, &state), self.now);
        self.node.tick(self.now);
        if let Some(answer) = self.node.take_answer().filter(|_| is_heard) {
            let mut bytes = Vec::new();
            answer.encode(&mut bytes);
            // An answer to another start of the controller is not obeyed.
            let _ = self.client.receive(&bytes);
        }
        self.client.speed_override(self.now)
    }

    /// Returns the occupancy that the node reports to the arbiter.
    fn occupancy(&mut self) -> Option<Occupancy> {
        let mut bytes = Vec::new();
        self.node.take_interlock_state(&mut bytes).then(|| match wire::decode(&bytes) {
            Ok(Message::State(state)) => state.slots[0].occupancy,
            other => panic!("{other:?}"),
        })
    }
}

/// On a busy machine no answer arrives for seconds, while a robot that may go waits 350 mm before a region. The node
/// must not report for ever that the robot cannot stop outside, which would halt both robots of the cell.
#[test]
fn a_robot_whose_answers_are_lost_can_stop_and_goes_on() {
    for silent_ticks in [10, 40, 500] {
        let mut rig = Rig::new(|number| number);
        let first = (0..10).map(|_| rig.tick(1.3, true)).fold(0.0, f64::max);
        assert!(first > 0.5, "{first}");
        for _ in 0..silent_ticks {
            rig.tick(1.3, false);
        }
        let again: Vec<f64> = (0..10).map(|_| rig.tick(1.3, true)).collect();
        assert!(again[3..].iter().all(|o| *o > 0.8 * first), "{silent_ticks} ticks without an answer: {again:?}");
        assert_eq!(rig.occupancy(), Some(Occupancy::Outside), "{silent_ticks} ticks without an answer");
    }
}

#[test]
fn a_controller_that_expects_any_configuration_is_not_guarded_where_regions_are_exchanged() {
    let mut any = Rig::new(|_| 0);
    assert!((0..100).all(|_| any.tick(1.0, true) == 0.0));
    assert_eq!(any.occupancy(), Some(Occupancy::Unknown));
    let mut right = Rig::new(|number| number);
    assert!((0..100).any(|_| right.tick(1.0, true) == 1.0));
}

#[test]
fn a_node_that_hears_another_cell_file_stops_its_robot() {
    let mut rig = Rig::new(|number| number);
    let own = RegionTable { revision: (1, 1), ..RegionTable::initial(&rig.cell) }.message(&rig.cell);
    let other = RegionTableMessage { configuration: "0123456789abcdef".into(), boot: 9, ..own.clone() };
    rig.node.regions(&own, rig.now);
    assert_eq!((0..10).map(|_| rig.tick(1.0, true)).last(), Some(1.0));
    // Both tables alternate, as from two arbiters.
    for table in [&other, &own, &other, &own] {
        rig.node.regions(table, rig.now);
        assert!((0..10).all(|_| rig.tick(1.0, true) == 0.0));
    }
    let reason_of = |rig: &mut Rig| {
        rig.now = rig.now + TICK;
        let state = ControllerState { q: &[1.0], qd: &[0.0], programmed_override: 1.0, ..ControllerState::default() };
        rig.node.joint_state(rig.client.joint_state(rig.now, &state), rig.now);
        rig.node.tick(rig.now).expect("a tick").reason
    };
    assert_eq!(reason_of(&mut rig), OverrideReason::Fault(Fault::Regions));
    // It continues a second after the last table of the other cell file.
    let goes = (0..260).position(|_| {
        rig.node.regions(&own, rig.now);
        rig.tick(1.0, true) == 1.0
    });
    assert!(goes.is_some_and(|ticks| ticks > 200), "{goes:?}");
}

#[test]
fn an_answer_is_not_fresh_on_a_clock_that_was_set_back() {
    let mut client = ControllerClient::new(1, 0);
    let state = ControllerState { q: &[0.1], programmed_override: 1.0, ..ControllerState::default() };
    client.joint_state(Micros(1_000_000), &state);
    let mut answer = Vec::new();
    OverrideAnswer { boot: 1, echo: 1, sequence: 1, speed_override: 0.7, ..Default::default() }.encode(&mut answer);
    client.receive(&answer).unwrap();
    assert_eq!(client.speed_override(Micros(1_010_000)), 0.7);
    for now in [0, 1, 500_000, 999_999] {
        assert_eq!(client.speed_override(Micros(now)), 0.0, "{now}");
    }
}
