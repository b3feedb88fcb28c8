//! A node whose regions are moved, added and removed: no tick grants more than the regions before and after permit.

use std::sync::Arc;

use elbowroom_cell::{Cell, EditedRegions, RegionEdit, configure};
use elbowroom_interlock::{Boot, Micros};
use elbowroom_live::node::{NodeMonitor, NodeTick, RegionBuilder};
use elbowroom_live::{
    CellVersions, ControllerClient, ControllerState, RegionTable, RegionTableMessage, configuration_number,
};
use elbowroom_monitor::{AccessClass, Fault, Life, Monitor, OverrideReason, RegionId, RobotSlot, Snapshot};
use elbowroom_robot::RobotId;
use elbowroom_testkit::random::{self, split_mix};

/// Returns the next number from 0 to 1.
fn unit(state: &mut u64) -> f64 {
    random::unit(split_mix(state))
}

const TICK_US: u64 = 4_000;

const CELL: &str = r#"
version = 1
name = "rail"
units = { length = "mm", angle = "deg" }
tick_ms = 4
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
[region.end]
shape = "sphere"
centre = [0, 0, 2300]
radius = 100
warning = 300
[region.cart]
shape = "sphere"
centre = [0, 0, 1600]
radius = 100
life = "temporary"
warning = 200
[region.slow]
shape = "sphere"
centre = [0, 0, 500]
radius = 200
kind = "monitored"
slow_to = 40
life = "temporary"
"#;

#[test]
fn a_permanent_region_stays_on_whatever_a_message_says() {
    let cell = Cell::parse("rail.toml", CELL).unwrap();
    let mut table = RegionTable::initial(&cell);
    assert_eq!(table.active, [true, false, false]);
    let mut message = table.message(&cell);
    message.revision = 1;
    message.regions.iter_mut().for_each(|(_, on)| *on = !*on);
    assert!(table.take(&message, &cell));
    assert_eq!(table.active, [true, true, true]);
    // A region that is not in the message keeps its state, and a message of other regions does not switch it off either.
    (message.revision, message.regions[0].0) = (2, "other".into());
    message.regions[2].1 = false;
    assert!(table.take(&message, &cell));
    assert_eq!(table.active, [true, true, false]);
}

/// A node, the builder of its regions, and its controller. Its clock advances with each tick.
struct Rig {
    cell: Arc<Cell>,
    versions: Arc<CellVersions>,
    node: NodeTick,
    builder: RegionBuilder,
    client: ControllerClient,
    now: Micros,
    revision: u64,
    /// The configuration that was announced last.
    announced: String,
}

impl Rig {
    fn new() -> Self {
        let cell = Arc::new(Cell::parse("rail.toml", CELL).expect("a cell"));
        let edited = EditedRegions::parse("rail.toml", CELL).expect("a file");
        let versions = Arc::new(CellVersions::new(&cell, Some(edited), |cell| cell));
        let checksum = configuration_number(&cell);
        let setup = configure::setups(&cell).expect("setups").remove(0);
        let monitor = NodeMonitor::new(&setup, RobotSlot(0), 0, checksum, Boot(1)).expect("a monitor");
        let mut node = NodeTick::new(cell.clone(), setup, monitor, checksum, None);
        node.await_regions();
        let builder = node.region_builder(RobotId(0), versions.clone());
        let client = ControllerClient::new(1, checksum);
        let announced = cell.approval.checksum.chars().take(16).collect();
        Self { cell, versions, node, builder, client, now: Micros(1), revision: 0, announced }
    }

    fn moved(&self, name: &str, to: &str) -> String {
        let edited = self.versions.edited().unwrap();
        edited.moved(name, &edited.table(&[], name).unwrap(), to).unwrap()
    }

    /// Makes the table with these regions, all of them on.
    fn message(&mut self, edits: &[RegionEdit], is_due: bool) -> RegionTableMessage {
        let cell = self.versions.cell(edits).unwrap_or_else(|e| panic!("{e}"));
        self.revision += 1;
        let present: String = cell.approval.checksum.chars().take(16).collect();
        let before = std::mem::replace(&mut self.announced, present.clone());
        let former = if is_due { String::new() } else { before };
        let table = RegionTable {
            revision: (1, self.revision),
            active: vec![true; cell.regions.len()],
            present,
            edits: edits.to_vec(),
            former,
            is_editable: true,
            ..RegionTable::initial(&self.cell)
        };
        table.message(&cell)
    }

    fn hear(&mut self, edits: &[RegionEdit], is_due: bool) {
        let message = self.message(edits, is_due);
        self.node.regions(&message, self.now);
    }

    /// Returns the override and its reason at these joint values. A controller without an answer yet has sent them once
    /// before, with a waiting program.
    fn tick(&mut self, q: f64, qd: f64) -> (f64, OverrideReason) {
        if self.client.answer(self.now + Micros(TICK_US)).is_none() {
            self.exchange(q, qd);
        }
        self.exchange(q, qd)
    }

    fn exchange(&mut self, q: f64, qd: f64) -> (f64, OverrideReason) {
        self.now = self.now + Micros(TICK_US);
        let state = ControllerState { q: &[q], qd: &[qd], programmed_override: 1.0, ..ControllerState::default() };
        self.node.joint_state(self.client.joint_state(self.now, &state), self.now);
        let report = self.node.tick(self.now).expect("joint values are answered");
        let mut answer = Vec::new();
        self.node.take_answer().expect("an answer").encode(&mut answer);
        self.client.receive(&answer).expect("it is obeyed");
        (report.speed_override, report.reason)
    }
}

fn edit(name: &str, toml: Option<&str>) -> RegionEdit {
    RegionEdit { name: name.into(), table: toml.map(Into::into) }
}

/// A monitor with the regions of a cell, all on.
struct Reference(Monitor);

impl Reference {
    fn new(cell: &Cell) -> Self {
        let setup = configure::setups(cell).unwrap().remove(0);
        let mut monitor = Monitor::new(setup.configuration, None).unwrap();
        for (r, region) in cell.regions.iter().enumerate().filter(|(_, r)| r.region.life == Life::Temporary) {
            monitor.switch(RegionId(r), true, AccessClass::Programmer).unwrap_or_else(|e| panic!("{region:?}: {e}"));
        }
        Self(monitor)
    }

    fn permits(&mut self, now: Micros, q: f64, qd: f64) -> f64 {
        let now_s = now.0 as f64 * 1e-6;
        let (q, qd) = ([q], [qd]);
        let snapshot = Snapshot { qd: &qd, ..Snapshot::stationary(now_s, &q) };
        self.0.tick(&snapshot).speed_override
    }
}

/// A carriage that moves back and forth; its joint values fit its velocities.
struct Carriage {
    q: f64,
    qd: f64,
}

impl Carriage {
    fn step(&mut self, random: &mut u64) {
        if unit(random) < 0.02 || !(0.1..=1.9).contains(&self.q) {
            let away = if self.q < 1.0 { 1.0 } else { -1.0 };
            let towards = if unit(random) < 0.5 { 1.0 } else { -1.0 };
            self.qd = 0.9 * unit(random) * if (0.1..=1.9).contains(&self.q) { towards } else { away };
        }
        self.q += self.qd * TICK_US as f64 * 1e-6;
    }
}

#[test]
fn a_move_never_leaves_a_tick_without_the_region_before_or_the_region_after() {
    let mut random = 11;
    let (mut limited, mut free) = (0, 0);
    for run in 0..60 {
        let mut rig = Rig::new();
        let z = 200.0 + 1600.0 * unit(&mut random);
        let name = if run % 3 == 0 { "slow" } else { "cart" };
        let moved = rig.moved(name, &format!("centre = [0, 0, {z:.1}]"));
        let both = vec![edit("second", Some(&moved))];
        let after = vec![edit(name, Some(&moved))];
        let cells = [Vec::new(), after.clone()].map(|edits| rig.versions.cell(&edits).unwrap());
        let mut old = Reference::new(&cells[0]);
        let mut new = Reference::new(&cells[1]);
        // Each step: the announced regions, and whether the former and the next regions must then be obeyed.
        let steps = [
            (Vec::new(), true, true, false),
            (both.clone(), false, true, false),
            (both, true, true, true),
            (after.clone(), false, false, true),
            (after, true, false, true),
        ];
        let mut carriage = Carriage { q: 0.2 + 1.5 * unit(&mut random), qd: 0.0 };
        for (edits, is_due, obeys_old, obeys_new) in steps {
            rig.hear(&edits, is_due);
            let built_after = split_mix(&mut random) % 40;
            for n in 0..25 {
                // The builder's thread is slow, and sometimes slower than the keeper waits.
                if n == built_after {
                    rig.builder.build().unwrap();
                }
                carriage.step(&mut random);
                let (speed_override, reason) = rig.tick(carriage.q, carriage.qd);
                let permitted =
                    [old.permits(rig.now, carriage.q, carriage.qd), new.permits(rig.now, carriage.q, carriage.qd)];
                let most = |obeys: bool, of: f64| if obeys { of } else { 1.0 };
                let most = most(obeys_old, permitted[0]).min(most(obeys_new, permitted[1]));
                assert!(
                    speed_override <= most + 1e-9,
                    "run {run}: {speed_override} ({reason:?}) at {:.3}, permitted {permitted:?}, obeys {obeys_old} {obeys_new}",
                    carriage.q
                );
                limited += usize::from(speed_override < 1.0);
                free += usize::from(speed_override > 0.0);
            }
        }
    }
    assert!(limited > 500 && free > 500, "limited {limited}, free {free}");
}

#[test]
fn what_is_due_and_not_built_stops_the_robot_until_it_is_built() {
    let mut rig = Rig::new();
    let stops = OverrideReason::Fault(Fault::Regions);
    assert_eq!(rig.tick(1.0, 0.0), (0.0, stops), "no table was heard yet");
    rig.hear(&[], true);
    assert_eq!(rig.tick(1.0, 0.0).0, 1.0);
    let wall = "shape = \"sphere\"\ncentre = [0, 0, 1000]\nradius = 100\nwarning = 100\nlife = \"temporary\"\n";
    let added = vec![edit("new", Some(wall))];
    rig.hear(&added, false);
    assert_eq!(rig.tick(1.0, 0.0).0, 1.0, "nodes prepare");
    rig.hear(&added, true);
    assert_eq!(rig.tick(1.0, 0.0), (0.0, stops));
    assert!(rig.builder.build().unwrap());
    let (speed_override, reason) = rig.tick(1.0, 0.0);
    assert!(speed_override == 0.0 && reason != stops, "it is inside the new region: {reason:?}");
    assert!(!rig.builder.build().unwrap(), "nothing more to build");
    // Removed again; an older table changes nothing.
    let older = rig.message(&added, true);
    rig.hear(&[], true);
    rig.builder.build().unwrap();
    assert_eq!(rig.tick(1.0, 0.0).0, 1.0);
    rig.node.regions(&older, rig.now);
    assert_eq!(rig.tick(1.0, 0.0).0, 1.0);
    // A restarted keeper begins with the file; a keeper that is no longer heard may have changed something.
    for _ in 0..300 {
        rig.tick(1.0, 0.0);
    }
    assert_eq!(rig.tick(1.0, 0.0), (0.0, stops));
}

#[test]
fn tables_that_no_keeper_would_send_are_not_built() {
    let mut rig = Rig::new();
    rig.hear(&[], true);
    assert_eq!(rig.tick(1.0, 0.0).0, 1.0);
    // A stranger on the network removes a permanent region, names another checksum, or sends nonsense.
    for (edits, present) in [
        (vec![edit("end", None)], "0123456789abcdef"),
        (Vec::new(), "0123456789abcdef"),
        (vec![edit("new", Some("shape = "))], "0123456789abcdef"),
    ] {
        rig.revision += 1;
        let message =
            RegionTableMessage { present: present.into(), edits, revision: rig.revision, ..rig.message(&[], true) };
        rig.node.regions(&message, rig.now);
        assert!(rig.builder.build().is_err());
        assert_eq!(rig.tick(1.0, 0.0), (0.0, OverrideReason::Fault(Fault::Regions)));
    }
    rig.hear(&[], true);
    assert_eq!(rig.tick(1.0, 0.0).0, 1.0);
}
