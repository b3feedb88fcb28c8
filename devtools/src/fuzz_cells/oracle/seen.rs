//! Check of robots that avoid what sensors see: they touch no box that has stood in view from the beginning, do not move on
//! when pictures are old, and are not held for nothing.
//!
//! The oracle knows where the boxes are, and when pictures were taken, from the generator.

use elbowroom_cell::{Cell, CellSensor};
use elbowroom_sim::{HoldReason, Recording, Sample};

use super::arm::Arm;
use super::findings::{Finding, Findings};
use super::frame::Frame;
use super::planned_paths::first_touch;
use super::seen_box::{apart_m, is_clear_of_box, solid};
use super::seen_part::seen_part;
use super::solid::OracleSolid;
use crate::fuzz_cells::spec::{CellSpec, SeenBox, SensorSpec, SensorView};

/// Least distance of a box from all robots at the start, m: what is nearer is taken for a part of a robot.
const CLEAR_M: f64 = 0.15;
/// Least distance of a box from boxes that were learnt and from known objects, m: what is nearer is taken for a part of them.
const ALONE_M: f64 = 0.5;
/// Largest change of a joint within a tick that is not a motion, rad or m.
const NO_MOTION: f64 = 1e-9;
/// A stop takes at most this multiple of the time that it should take, and this much longer, s.
const STOP: (f64, f64) = (1.5, 0.1);

/// Checks the robots of all sensors.
pub fn check(spec: &CellSpec, cell: &Cell, recording: &Recording, findings: &mut Findings) {
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    for sensor in &spec.extras.sensors {
        let Some(read) = cell.sensors.iter().find(|s| s.name == sensor.name) else { continue };
        let boxes = seen_boxes(sensor, read, cell);
        let view = match sensor.view {
            SensorView::Points { .. } => 0,
            SensorView::Depths { .. } => 1,
            SensorView::Camera { .. } => 2,
        };
        for &robot in &sensor.avoiding {
            findings.judged.boxes[view] += boxes.len();
            let touched = (!boxes.is_empty()).then(|| first_touch(cell, recording, (robot, &arms[robot]), &boxes));
            findings.list.extend(touched.flatten().map(|t_s| Finding::TouchedSeen { robot, t_s }));
            moved_unseen(sensor, cell, recording, robot, findings);
            findings.judged.holds += recording.robots[robot].perception.as_ref().map_or(0, |track| track.holds.len());
            findings.list.extend(held_for_nothing(sensor, recording, robot));
        }
    }
}

/// The boxes that robots must not touch, without what the sensor may not see of them.
fn seen_boxes(sensor: &SensorSpec, read: &CellSensor, cell: &Cell) -> Vec<(OracleSolid, Frame)> {
    let moves = |index: usize| cell.moving_objects.iter().any(|m| m.object.0 == index);
    let fixed = cell.objects.iter().enumerate().filter(|(index, _)| !moves(*index)).map(|(_, object)| object);
    let known: Vec<(OracleSolid, Frame)> =
        fixed.map(|object| (OracleSolid::eroded(&object.shape, 0.0), Frame::of(&object.in_world))).collect();
    // Only points are compared with known objects.
    let is_known = |one: &SeenBox| {
        let is_camera = matches!(sensor.view, SensorView::Camera { .. });
        !is_camera && known.iter().any(|object| apart_m(&solid(one), object) <= ALONE_M)
    };
    let stands = |one: &&SeenBox| one.stands() && !one.is_learnt && is_clear_of_box(cell, one, CLEAR_M);
    let is_alone = |one: &&SeenBox| {
        let mut learnt = sensor.boxes.iter().filter(|other| other.is_learnt);
        learnt.all(|other| apart_m(&solid(one), &solid(other)) > ALONE_M) && !is_known(one)
    };
    let seen = sensor.boxes.iter().filter(stands).filter(is_alone);
    seen.filter_map(|one| seen_part(sensor, read, cell, one)).map(|part| solid(&part)).collect()
}

/// The time of the last picture that a robot can know at a time; `None` if there was none.
fn last_seen_s(sensor: &SensorSpec, t_s: f64) -> Option<f64> {
    let is_usable = |index: &usize| !sensor.is_learning(*index) && !sensor.pictures.unusable.contains(index);
    let usable = (0..sensor.pictures.times.len()).filter(is_usable).map(|index| sensor.pictures.times[index]);
    usable.take_while(|taken_s| taken_s + sensor.latency_ms / 1e3 <= t_s + 1e-9).last()
}

/// Whether the last picture is too old at a time, by at least so much (s).
fn is_stale(sensor: &SensorSpec, t_s: f64, by_s: f64) -> bool {
    last_seen_s(sensor, t_s).is_none_or(|taken_s| t_s - taken_s > sensor.stale_ms / 1e3 + by_s)
}

/// Finds a motion at a time at which the last picture has been too old for longer than a stop takes; a robot that rests does not
/// begin to move once what it was told before has taken effect (before that, a test of the simulation looks).
fn moved_unseen(sensor: &SensorSpec, cell: &Cell, recording: &Recording, robot: usize, findings: &mut Findings) {
    let stop_s = cell.robots[robot].limits.iter().map(|l| l.velocity / l.stop).fold(0.0, f64::max);
    let told_s = cell.monitoring.reaction_delay_s + 3.0 * recording.tick_s;
    let longest_s = STOP.0 * (stop_s + told_s) + STOP.1;
    let moves = |w: &[Sample]| w[0].q.iter().zip(&w[1].q).any(|(a, b)| (a - b).abs() > NO_MOTION);
    let (mut fresh_s, mut rests) = (f64::NEG_INFINITY, true);
    for w in recording.robots[robot].samples.windows(2) {
        let t_s = w[0].t_s;
        if !is_stale(sensor, t_s, 0.0) {
            (fresh_s, rests) = (t_s, false);
            continue;
        }
        let moves = moves(w);
        let must_rest = rests || t_s - fresh_s > longest_s;
        findings.judged.stale_ticks += usize::from(must_rest);
        if moves && must_rest {
            findings.list.push(Finding::MovedUnseen { robot, t_s });
            return;
        }
        rests |= !moves && t_s - fresh_s > told_s;
    }
}

/// Finds a hold for an old picture while the last one is fresh, or for an obstacle before any picture shows one. What a camera
/// takes for an obstacle may be floor that a robot hid.
fn held_for_nothing(sensor: &SensorSpec, recording: &Recording, robot: usize) -> Option<Finding> {
    let holds = &recording.robots[robot].perception.as_ref()?.holds;
    let tick_s = 2.0 * recording.tick_s;
    let judges_obstacles = !matches!(sensor.view, SensorView::Camera { .. });
    let is_shown = |one: &SeenBox, t_s: f64| !one.is_learnt && one.from_s + sensor.latency_ms / 1e3 <= t_s + tick_s;
    let found = holds.iter().find(|hold| match hold.reason {
        HoldReason::Stale => !is_stale(sensor, hold.from_s, -tick_s),
        HoldReason::Obstacle => judges_obstacles && !sensor.boxes.iter().any(|one| is_shown(one, hold.from_s)),
    })?;
    Some(Finding::HeldForNothing { robot, t_s: found.from_s })
}

#[cfg(test)]
mod tests {
    use elbowroom_sim::{RunOptions, simulate};

    use super::*;
    use crate::fuzz_cells::pictures::PictureFolders;
    use crate::fuzz_cells::spec::{Extras, PictureTimes};

    const GANTRY: &str = r#"
version = 1
units = { length = "m", angle = "rad" }
tick_ms = 4
[robot.r0]
dh = [
  { kind = "prismatic", alpha = 1.5708, theta = 1.5708, min = -1, max = 1, speed = 1 },
  { kind = "prismatic", alpha = 1.5708, theta = 1.5708, min = -1, max = 1, speed = 1 },
  { kind = "prismatic", min = -1, max = 1, speed = 1 },
]
links = [[], [], [{ sphere = { radius = 0.05 } }]]
start = [-0.8, 0, 0]
[map.r0]
step = 0.2
[program.r0]
steps = [{ wait = 0.3 }, { move = "joint", to = [0.8, 0, 0] }]
"#;

    /// A box above the start of the robot, which moves up; pictures come until this time.
    fn sensor(boxes: &[f64], end_s: f64) -> SensorSpec {
        let one = |z: &f64| SeenBox {
            at: [0.0, 0.0, *z],
            size: [0.4, 0.4, 0.3],
            yaw: 0.3,
            from_s: f64::NEG_INFINITY,
            to_s: f64::INFINITY,
            velocity: [0.0; 2],
            is_learnt: false,
        };
        SensorSpec {
            name: "above",
            view: SensorView::Points { spacing: 0.02, is_ply: true },
            at: [0.0, 0.0, 4.0],
            rpy: [3.0, 0.2, 0.5],
            floor: -1.5,
            mapped: 0,
            avoiding: vec![0],
            latency_ms: 20.0,
            stale_ms: 150.0,
            pictures: PictureTimes {
                learning: 0,
                times: (0..50).map(|i| f64::from(i) * 0.1 - 0.1).take_while(|t_s| *t_s <= end_s).collect(),
                unusable: Vec::new(),
            },
            boxes: boxes.iter().map(one).collect(),
            joints: None,
            needed: vec!["ceiling = 4".into(), "voxel = 0.05".into()],
            lines: Vec::new(),
        }
    }

    fn with(sensor: SensorSpec) -> CellSpec {
        CellSpec { extras: Extras { sensors: vec![sensor], ..Extras::default() }, ..CellSpec::default() }
    }

    /// Runs the gantry with what one sensor sees; what is found if another one is judged.
    fn findings(runs: SensorSpec, judged: SensorSpec) -> Vec<Finding> {
        let spec = with(runs);
        let folder = tempfile::tempdir().unwrap();
        let _pictures = PictureFolders::write(&spec, folder.path()).unwrap();
        let text = spec.to_toml();
        let table = &text[text.find("[cloud").unwrap()..];
        let cell = Cell::parse(folder.path().join("cell.toml"), &format!("{GANTRY}{table}")).unwrap();
        let recording = simulate(&cell, &RunOptions::default()).unwrap().recording;
        let mut findings = Findings::default();
        check(&with(judged), &cell, &recording, &mut findings);
        findings.list
    }

    #[test]
    fn robots_that_do_not_see_or_are_held_for_nothing_are_found() {
        let sees = sensor(&[0.0], 4.0);
        assert_eq!(findings(sees.clone(), sees.clone()), []);
        // It had not seen the box.
        let blind = findings(sensor(&[], 4.0), sees.clone());
        assert!(matches!(blind[..], [Finding::TouchedSeen { robot: 0, t_s }] if t_s > 1.0), "{blind:?}");
        // The pictures had ended before.
        let ended = findings(sensor(&[], 4.0), sensor(&[], 0.5));
        assert!(matches!(ended[..], [Finding::MovedUnseen { robot: 0, t_s }] if t_s > 0.65), "{ended:?}");
        // It was held, and nothing was there.
        let held = findings(sees, sensor(&[], 4.0));
        assert!(matches!(held[..], [Finding::HeldForNothing { robot: 0, .. }]), "{held:?}");
        let waits = findings(sensor(&[], 0.5), sensor(&[], 4.0));
        assert!(matches!(waits[..], [Finding::HeldForNothing { robot: 0, .. }]), "{waits:?}");
    }
}
