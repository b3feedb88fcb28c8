//! The tick of a node, its input and its controller's client do not allocate. Without the test harness, because the
//! counter includes all threads of the process.

use std::collections::BTreeSet;
use std::sync::Arc;

use elbowroom_cell::configure::{self, MonitorSetup};
use elbowroom_cell::{Cell, CellRobot, EditedRegions, RegionEdit};
use elbowroom_interlock::wire::{MAX_BYTES, decode_state, encode_grants};
use elbowroom_interlock::{Arbiter, ArbiterSettings, Boot, Micros, RobotSettings, StateMessage};
use elbowroom_live::messages::{AttachedVolume, MAX_JOINT_STATE_BYTES, OVERRIDE_ANSWER_BYTES};
use elbowroom_live::node::{NodeMonitor, NodeTick, RegionBuilder};
use elbowroom_live::{CellVersions, ControllerClient, ControllerState, RegionTable, configuration_number};
use elbowroom_monitor::{EventKind, Fault, OverrideReason, Presence, RobotSlot, SlotId, TickReport, VolumeId};
use elbowroom_robot::RobotId;
use elbowroom_status::StatusSample;
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_testkit::random::split_mix;

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

const TICK_US: u64 = 2_000;
const TICKS: u64 = 20_000;
/// Number of the first ticks, which are not counted.
const WARM_UP: u64 = 4_000;

/// An arm with two tools and a part swings past a post, through an exchange region, through a region that is switched,
/// and past one that follows a carriage.
const CELL: &str = r#"
version = 1
name = "swing"
units = { length = "mm", angle = "deg" }
tick_ms = 2
[robot.arm]
dh = [
  { d = 400, alpha = 90, min = -170, max = 170, speed = 200 },
  { a = 400, min = -170, max = 170, speed = 200 },
  { a = 300, min = -170, max = 170, speed = 200 },
]
links = [[], { capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 60 } }, { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 50 } }]
[robot.arm.tools.gripper]
tcp = { at = [120, 0, 0], rpy = [0, 90, 0] }
box = { at = [60, 0, 0], size = [120, 80, 80] }
[robot.arm.tools.torch]
tcp = { at = [200, 0, 0], rpy = [0, 90, 0] }
box = { at = [100, 0, 0], size = [200, 60, 60] }
mounted = false
[robot.carriage]
base = { at = [1300, 0, 400], rpy = [0, -90, 0] }
dh = [{ kind = "prismatic", min = 0, max = 1000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
[object.part]
shape = "box"
at = [820, 0, 400]
size = [100, 100, 100]
[region.post]
shape = "sphere"
centre = [600, -700, 400]
radius = 100
warning = 250
life = "permanent"
robots = ["arm"]
[region.table]
shape = "sphere"
centre = [500, 550, 400]
radius = 100
kind = "exchange"
warning = 200
guards = ["tool"]
robots = ["arm"]
[region.gate]
shape = "sphere"
centre = [900, 200, 400]
radius = 60
warning = 200
life = "temporary"
robots = ["arm"]
[region.hand]
shape = "sphere"
centre = [0, 0, 0]
radius = 80
warning = 200
follow = { robot = "carriage", frame = "flange" }
robots = ["arm"]
[encoder.belt]
speed = 0
wrap = 500
measured = true
[object.cart]
shape = "box"
size = [100, 100, 100]
at = [600, 900, 400]
measured = true
[region.on_belt]
shape = "sphere"
centre = [300, -900, 400]
radius = 80
warning = 200
follow = { encoder = "belt", max_speed = 2000 }
robots = ["arm"]
[region.on_cart]
shape = "sphere"
centre = [0, 0, 0]
radius = 80
warning = 200
follow = { object = "cart" }
robots = ["arm"]
[monitor]
stopping_distance = true
direction_aware = true
[program.arm]
steps = [{ grip = "part" }, { release = "part" }]
"#;

/// The node of the arm, its controller, the controller of the carriage, and the arbiter.
struct Setup {
    cell: Arc<Cell>,
    versions: Arc<CellVersions>,
    node: NodeTick,
    builder: RegionBuilder,
    /// The configuration that was due last.
    present: String,
    /// Number of times that the node got other regions.
    built: usize,
    client: ControllerClient,
    carriage: ControllerClient,
    /// The controllers of the measured sources.
    sources: [ControllerClient; 2],
    arbiter: Arbiter,
    /// Attached volumes of the arm, in turn: none named, tools, a part, and an unknown volume.
    carried: Vec<Vec<AttachedVolume>>,
}

impl Setup {
    fn new() -> Self {
        let cell = Arc::new(Cell::parse("swing.toml", CELL).expect("a cell"));
        let checksum = configuration_number(&cell);
        let setup = configure::setups(&cell).expect("setups").remove(0);
        let settings = ArbiterSettings::new(vec![RobotSettings::new("arm", [SlotId(0)])], 1);
        let monitor = NodeMonitor::new(&setup, RobotSlot(0), 1, checksum, Boot(1)).expect("a monitor");
        let edited = EditedRegions::parse("swing.toml", CELL).expect("a file");
        let versions = Arc::new(CellVersions::new(&cell, Some(edited), |cell| cell));
        let carried = carried(&setup, &cell.robots[0]);
        let node = NodeTick::new(cell.clone(), setup, monitor, checksum, None);
        Self {
            carried,
            builder: node.region_builder(RobotId(0), versions.clone()),
            present: cell.approval.checksum.chars().take(16).collect(),
            built: 0,
            versions,
            node,
            client: ControllerClient::new(1, checksum),
            carriage: ControllerClient::new(1, checksum),
            sources: [0, checksum].map(|checksum| ControllerClient::new(1, checksum)),
            arbiter: Arbiter::new(ArbiterSettings { checksum, ..settings }, Boot(1)),
            cell,
        }
    }
}

fn carried(setup: &MonitorSetup, robot: &CellRobot) -> Vec<Vec<AttachedVolume>> {
    let of_tool = |tool: usize| -> Vec<AttachedVolume> {
        let volumes = setup.tool_volumes(robot.payload.tools[tool].link);
        volumes.map(|(volume, v)| AttachedVolume { volume, in_link: v.in_link }).collect()
    };
    let [gripper, torch] = [of_tool(0), of_tool(1)];
    let (_, part) = setup.gripped[0];
    let in_link = setup.configuration.volumes()[part.0].in_link;
    let part = AttachedVolume { volume: part, in_link };
    let nowhere = AttachedVolume { volume: VolumeId(999), in_link };
    assert!(setup.configuration.volumes().iter().filter(|v| v.presence != Presence::Always).count() >= 3);
    vec![Vec::new(), gripper.clone(), torch, [gripper, vec![part]].concat(), vec![nowhere], Vec::new()]
}

/// Observations.
#[derive(Default)]
struct Seen {
    allocations: usize,
    reasons: BTreeSet<&'static str>,
    granted: usize,
    switched: usize,
    ticks: u64,
    limited: usize,
    obeyed: usize,
}

impl Seen {
    fn report(&mut self, report: &TickReport) {
        self.ticks += 1;
        self.limited += usize::from(report.speed_override > 0.0 && report.speed_override < 1.0);
        self.reasons.insert(match report.reason {
            OverrideReason::Free => "free",
            OverrideReason::Waiting(_) => "waiting",
            OverrideReason::Fault(Fault::Stale) => "stale",
            OverrideReason::Fault(Fault::WrongLength) => "wrong length",
            OverrideReason::Fault(Fault::NotFinite) => "not finite",
            OverrideReason::Fault(_) => "another fault",
            _ => "a region",
        });
    }

    fn sample(&mut self, sample: &mut StatusSample) {
        let (events, _) = sample.take_events();
        for event in events {
            self.granted += usize::from(event.kind == EventKind::Granted);
            self.switched += usize::from(matches!(event.kind, EventKind::On | EventKind::Off));
        }
    }
}

fn main() {
    let mut s = Setup::new();
    let mut seen = Seen::default();
    let mut sample = s.node.new_sample();
    let mut interlock = Vec::with_capacity(MAX_BYTES);
    let (mut sent, mut old) = (Vec::with_capacity(MAX_JOINT_STATE_BYTES), Vec::with_capacity(MAX_JOINT_STATE_BYTES));
    let mut answer_bytes = Vec::with_capacity(OVERRIDE_ANSWER_BYTES);
    let mut random = 5;
    for n in 0..TICKS {
        let now = Micros(1 + n * TICK_US);
        if n % 25 == 0 {
            // Done by the node's other thread: reading the table allocates.
            hear_regions(&mut s, n, now);
        }
        let counter = AllocationCounter::start();
        send_joint_states(&mut s, n, now, &mut sent);
        send_hostile(&s.node, n, now, &sent, &mut old, &mut random);
        if let Some(report) = s.node.tick(now) {
            seen.report(&report);
        }
        if let Some(answer) = s.node.take_answer() {
            answer.encode(&mut answer_bytes);
            // Answers to earlier messages of a silent controller are late.
            let _ = s.client.receive(&answer_bytes);
            // A damaged answer.
            answer_bytes[9] ^= 4;
            assert!(s.client.receive(&answer_bytes).is_err());
        }
        seen.obeyed += usize::from(s.client.speed_override(now) > 0.0);
        let has_interlock = s.node.take_interlock_state(&mut interlock);
        if s.node.take_sample(&mut sample) {
            seen.sample(&mut sample);
        }
        let mut allocations = counter.changes();
        if has_interlock {
            allocations += answer_interlock(&mut s, &interlock, now);
        }
        if n >= WARM_UP {
            seen.allocations += allocations;
        }
    }
    let expected = ["a region", "free", "not finite", "stale", "waiting", "wrong length"];
    assert!(expected.iter().all(|reason| seen.reasons.contains(reason)), "not all was seen: {:?}", seen.reasons);
    let counts = [seen.granted, seen.switched, seen.limited, seen.obeyed];
    assert!(counts.iter().zip([5, 5, 500, 1000]).all(|(count, least)| *count >= least), "{counts:?}");
    assert!(seen.ticks > TICKS / 2, "{} ticks", seen.ticks);
    assert!(s.built >= 10, "regions were built {} times", s.built);
    assert_eq!(seen.allocations, 0);
}

/// Publishes tables: the gate is switched, and is in turn at its place, elsewhere with one more region beside it, and
/// removed.
fn hear_regions(s: &mut Setup, n: u64, now: Micros) {
    let edited = s.versions.edited().expect("a file");
    let edit = |name: &str, table: Option<String>| RegionEdit { name: name.into(), table };
    let table = edited.table(&[], "gate").expect("a region");
    let edits = match n / 1_500 % 3 {
        0 => Vec::new(),
        1 => {
            let moved = edited.moved("gate", &table, "centre = [800, 300, 400]").expect("a place");
            vec![edit("gate", Some(moved)), edit("second", Some(table))]
        }
        _ => vec![edit("gate", None)],
    };
    let cell = s.versions.cell(&edits).expect("a cell");
    let present = cell.approval.checksum.chars().take(16).collect();
    let of_cell = RegionTable::initial(&cell);
    let mut table =
        RegionTable { revision: (1, n), edits, present, active: of_cell.active, ..RegionTable::initial(&s.cell) };
    if let Some(gate) = cell.regions.iter().position(|r| r.region.name == "gate") {
        table.active[gate] = n % 4_000 < 2_000;
    }
    // Not due at first, so that the tick continues with the former regions.
    if n % 1_500 <= 100 {
        table.former.clone_from(&s.present);
    } else {
        s.present.clone_from(&table.present);
    }
    s.node.regions(&table.message(&cell), now);
    if n.is_multiple_of(100) {
        s.built += usize::from(s.builder.build().expect("regions that can be built"));
    }
}

/// Sends joint states: the arm swings, the carriage moves back and forth; every second both are silent for 40 ms.
fn send_joint_states(s: &mut Setup, n: u64, now: Micros, sent: &mut Vec<u8>) {
    if n % 500 < 20 && n > 500 {
        return;
    }
    let t = n as f64 * TICK_US as f64 * 1e-6;
    let (swing, speed) = ((1.5 * t).sin(), 1.5 * (1.5 * t).cos());
    // From time to time NaN for one tick.
    let first = if n % 500 == 400 { f64::NAN } else { swing };
    let state = ControllerState {
        q: &[first, 0.1 * swing, 0.0],
        qd: &[speed, 0.1 * speed, 0.0],
        intent: &[speed, 0.1 * speed, 0.0],
        programmed_override: 1.0,
        attached: &s.carried[n as usize / 300 % s.carried.len()],
        stamp: None,
    };
    sent.clear();
    sent.extend_from_slice(s.client.joint_state(now, &state));
    s.node.joint_state(sent, now);
    let state = ControllerState {
        q: &[0.3 + 0.2 * swing],
        qd: &[0.2 * speed],
        programmed_override: 1.0,
        ..ControllerState::default()
    };
    let bytes = s.carriage.joint_state(now, &state);
    s.node.followed_joint_state(RobotId(1), bytes, now);
    // The belt runs on; the cart swings, now and then with velocities.
    let cart = [0.6, 0.9 + 0.02 * swing, 0.4, 0.0, 0.0, 0.0, 1.0, 0.0, 0.02 * speed, 0.0, 0.0, 0.0, 0.0];
    let values: [(&[f64], &[f64]); 2] =
        [(&[0.2 * t], &[0.2]), (if n.is_multiple_of(3) { &cart } else { &cart[..7] }, &[])];
    for (index, (q, qd)) in values.into_iter().enumerate() {
        let state = ControllerState { q, qd, programmed_override: 1.0, ..ControllerState::default() };
        let bytes = s.sources[index].joint_state(now, &state);
        s.node.measured(index, bytes, now);
    }
}

/// Sends messages that must be refused: replayed, damaged, truncated, empty.
fn send_hostile(node: &NodeTick, n: u64, now: Micros, sent: &[u8], old: &mut Vec<u8>, random: &mut u64) {
    match n % 7 {
        0 => {
            old.clear();
            old.extend_from_slice(sent);
        }
        1 => node.joint_state(old, now),
        2 if !old.is_empty() => {
            let at = split_mix(random) as usize % old.len();
            old[at] ^= 1 << (split_mix(random) % 8);
            node.joint_state(old, now);
            node.followed_joint_state(RobotId(1), old, now);
            node.measured(0, old, now);
        }
        3 => node.joint_state(&sent[..sent.len() / 2], now),
        4 => node.grants(old),
        _ => node.joint_state(&[], now),
    }
}

/// Passes a message to the arbiter, which allocates and is not part of the node, and its answer to the node. Returns
/// the number of allocations of the node.
fn answer_interlock(s: &mut Setup, bytes: &[u8], now: Micros) -> usize {
    let mut message = StateMessage::with_slots(1);
    decode_state(bytes, &mut message).expect("a state");
    let mut grants = Vec::with_capacity(MAX_BYTES);
    let mut allocations = 0;
    for reply in &s.arbiter.receive(&message, now).replies {
        assert!(encode_grants(reply, &mut grants));
        let counter = AllocationCounter::start();
        s.node.grants(&grants);
        allocations += counter.changes();
    }
    allocations
}
