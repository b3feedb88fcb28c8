//! Check of robots that avoid what sensors see: they touch no box that has stood in view from the beginning, do not move on
//! when pictures are old, and are not held for nothing.
//!
//! The oracle knows where the boxes are, and when pictures were taken, from the generator.

use elbowroom_cell::{Cell, CellSensor, SensorKind};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_sim::{HoldReason, Recording};
use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::findings::{Finding, Findings};
use super::frame::Frame;
use super::guarded::Guarded;
use super::planned_paths::first_touch;
use super::solid::OracleSolid;
use super::start::start;
use crate::fuzz_cells::spec::{CellSpec, LensSpec, SeenBox, SensorSpec, SensorView, Vector};

/// Distances beyond this are not computed, m.
const FAR_M: f64 = 1.0;
/// Least distance of a box from all robots at the start, m: nearer ones are taken for parts of a robot.
const CLEAR_M: f64 = 0.15;
/// Largest change of a joint within a tick that is not a motion, rad or m.
const NO_MOTION: f64 = 1e-9;
/// How much longer than it should a stop may take, and so much more, s.
const STOP: (f64, f64) = (1.5, 0.1);
/// Where a robot that hides a box from a camera is nearer to the line of sight than this, m, the box may not have been seen.
const HIDES_M: f64 = 0.3;

/// Checks the robots of all sensors.
pub fn check(spec: &CellSpec, cell: &Cell, recording: &Recording, findings: &mut Findings) {
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    for sensor in &spec.extras.sensors {
        let Some(read) = cell.sensors.iter().find(|s| s.name == sensor.name) else { continue };
        let boxes = seen_boxes(sensor, read, cell);
        for &robot in &sensor.avoiding {
            let touched = (!boxes.is_empty()).then(|| first_touch(cell, recording, (robot, &arms[robot]), &boxes));
            findings.list.extend(touched.flatten().map(|t_s| Finding::TouchedSeen { robot, t_s }));
            findings.list.extend(moved_unseen(sensor, cell, recording, robot));
            findings.list.extend(held_for_nothing(sensor, recording, robot));
        }
    }
}

/// Whether all robots are at least so far (m) from a box at the start.
pub fn is_clear_of_box(cell: &Cell, one: &SeenBox, least_m: f64) -> bool {
    let (solid, at) = eroded(one, [0.0; 3]);
    cell.robots.iter().enumerate().all(|(index, robot)| {
        let frames = Arm::new(robot).frames(start(cell, index));
        Guarded::all(robot).iter().all(|part| part.distance(&frames, &solid, &at, FAR_M).lower > least_m)
    })
}

/// A box that stands, smaller by so much on each side, and where it is.
fn eroded(one: &SeenBox, by: Vector) -> (OracleSolid, Frame) {
    let half = Vec3::new(one.size[0], one.size[1], one.size[2]) * 0.5;
    let smaller = Shape::Cuboid(Cuboid { half_extents: half - Vec3::new(by[0], by[1], by[2]) });
    let middle = Vec3::new(one.at[0], one.at[1], one.at[2] + half.z);
    (OracleSolid::eroded(&smaller, 0.0), Frame::shift(middle).then(&Frame::turn(Vec3::Z, one.yaw)))
}

/// The boxes that robots must not touch, without what the sensor may not see of them.
fn seen_boxes(sensor: &SensorSpec, read: &CellSensor, cell: &Cell) -> Vec<(OracleSolid, Frame)> {
    let moves = |index: usize| cell.moving_objects.iter().any(|m| m.object.0 == index);
    // What is on or beside a known object belongs to it.
    if (0..cell.objects.len()).any(|index| !moves(index)) {
        return Vec::new();
    }
    let stands = |one: &&SeenBox| one.stands() && !one.is_learnt && is_clear_of_box(cell, one, CLEAR_M);
    let is_alone =
        |one: &&SeenBox| sensor.boxes.iter().filter(|other| other.is_learnt).all(|other| apart_m(one, other) > 0.5);
    let seen = sensor.boxes.iter().filter(stands).filter(is_alone);
    seen.filter_map(|one| Some(eroded(one, unseen_border(sensor, read, cell, one)?))).collect()
}

/// Least distance of two boxes that stand, m.
fn apart_m(a: &SeenBox, b: &SeenBox) -> f64 {
    let [(a, at), (b, other_at)] = [a, b].map(|one| eroded(one, [0.0; 3]));
    a.distance(&at, &b, &other_at, FAR_M).lower
}

/// How much of a box the sensor may not see on each side, m; `None` if it may not see it at all.
fn unseen_border(sensor: &SensorSpec, read: &CellSensor, cell: &Cell, one: &SeenBox) -> Option<Vector> {
    let (bottom, top) = (one.at[2], one.at[2] + one.size[2]);
    let border = match (&read.kind, &sensor.view) {
        (SensorKind::Cloud { settings, .. }, view) => {
            let least = sensor.floor + settings.floor_thickness_m;
            if !is_in_area(one, &settings.track.area_m) || top > sensor.floor + settings.ceiling_m || bottom < least {
                return None;
            }
            // Cubes with too few points may be at all edges.
            match view {
                // Its lower side is not measured.
                SensorView::Depths { lens, .. } if settings.extend_to_floor && is_in_view(sensor, lens, one) => {
                    let pixel = (sensor.at[2] - sensor.floor) / lens.focal;
                    [1.5 * pixel, 1.5 * pixel, 0.02]
                }
                SensorView::Depths { .. } => return None,
                _ => [settings.voxel_m; 3],
            }
        }
        (SensorKind::Camera { settings, .. }, SensorView::Camera { lens }) => {
            if !is_in_area(one, &settings.track.area_m)
                || !is_in_view(sensor, lens, one)
                || is_hidden(sensor, cell, one)
            {
                return None;
            }
            let pixel = (sensor.at[2] - sensor.floor) / lens.focal;
            [1.5 * pixel, 1.5 * pixel, 0.02]
        }
        (SensorKind::Camera { .. }, _) => return None,
    };
    border.iter().zip(&one.size).all(|(border, side)| 2.0 * border < *side).then_some(border)
}

/// The corners of a box.
fn corners(one: &SeenBox) -> impl Iterator<Item = Vec3> {
    let (_, at) = eroded(one, [0.0; 3]);
    let half = Vec3::new(one.size[0], one.size[1], one.size[2]) * 0.5;
    let side = |corner: u32, bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
    (0..8).map(move |c| at.point(Vec3::new(half.x * side(c, 0), half.y * side(c, 1), half.z * side(c, 2))))
}

/// Whether a box is over an area, a rectangle along the axes of the world; an area without corners is everywhere.
fn is_in_area(one: &SeenBox, area: &[elbowroom_vision::Point2]) -> bool {
    let range = |of: fn(&elbowroom_vision::Point2) -> f64| {
        area.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let ((x0, x1), (y0, y1)) = (range(|p| p.x), range(|p| p.y));
    area.is_empty() || corners(one).all(|c| c.x > x0 && c.x < x1 && c.y > y0 && c.y < y1)
}

/// Whether the whole of a box is in a picture, away from its border.
fn is_in_view(sensor: &SensorSpec, lens: &LensSpec, one: &SeenBox) -> bool {
    let [x, y, z] = sensor.at;
    let least = lens.columns.min(lens.rows) as f64 * 0.45;
    corners(one).all(|c| c.z < z && (c.x - x).hypot(c.y - y) / (z - c.z) * lens.focal < least)
}

/// Whether a robot may hide a part of a box from a camera at the start.
fn is_hidden(sensor: &SensorSpec, cell: &Cell, one: &SeenBox) -> bool {
    let [x, y, z] = sensor.at;
    let (_, at) = eroded(one, [0.0; 3]);
    cell.robots.iter().enumerate().any(|(index, robot)| {
        let frames = Arm::new(robot).frames(start(cell, index));
        let parts = Guarded::all(robot);
        let crosses = |to: Vec3| parts.iter().any(|part| part.is_crossed(&frames, [Vec3::new(x, y, z), to], HIDES_M));
        corners(one).chain([at.at]).any(crosses)
    })
}

/// The time of the last picture that a robot can know at a time; `None` if there was none.
fn last_seen_s(sensor: &SensorSpec, t_s: f64) -> Option<f64> {
    let is_usable = |index: &usize| !sensor.is_learning(*index) && !sensor.unusable.contains(index);
    let usable = (0..sensor.times.len()).filter(is_usable).map(|index| sensor.times[index]);
    usable.take_while(|taken_s| taken_s + sensor.latency_ms / 1e3 <= t_s + 1e-9).last()
}

/// Whether the last picture is too old at a time, by at least so much (s).
fn is_stale(sensor: &SensorSpec, t_s: f64, by_s: f64) -> bool {
    last_seen_s(sensor, t_s).is_none_or(|taken_s| t_s - taken_s > sensor.stale_ms / 1e3 + by_s)
}

/// Finds a motion at a time at which the last picture has been too old for longer than a stop takes.
fn moved_unseen(sensor: &SensorSpec, cell: &Cell, recording: &Recording, robot: usize) -> Option<Finding> {
    let stop_s = cell.robots[robot].limits.iter().map(|l| l.velocity / l.stop).fold(0.0, f64::max);
    let longest_s = STOP.0 * (stop_s + cell.monitoring.reaction_delay_s + 3.0 * recording.tick_s) + STOP.1;
    let moves = |w: &[elbowroom_sim::Sample]| w[0].q.iter().zip(&w[1].q).any(|(a, b)| (a - b).abs() > NO_MOTION);
    let mut fresh_s = 0.0;
    recording.robots[robot].samples.windows(2).find_map(|w| {
        let t_s = w[0].t_s;
        if !is_stale(sensor, t_s, 0.0) {
            fresh_s = t_s;
        }
        // At the start it is at rest.
        let may_stop_s = if last_seen_s(sensor, t_s).is_none() { 2.0 * recording.tick_s } else { longest_s };
        (t_s - fresh_s > may_stop_s && moves(w)).then_some(Finding::MovedUnseen { robot, t_s })
    })
}

/// Finds a hold for an old picture while the last one is fresh, or for an obstacle that no picture shows. What a camera takes
/// for an obstacle may be floor that a robot hid.
fn held_for_nothing(sensor: &SensorSpec, recording: &Recording, robot: usize) -> Option<Finding> {
    if matches!(sensor.view, SensorView::Camera { .. }) {
        return None;
    }
    let holds = &recording.robots[robot].perception.as_ref()?.holds;
    let tick_s = 2.0 * recording.tick_s;
    let sees_nothing = sensor.boxes.iter().all(|one| one.is_learnt);
    let found = holds.iter().find(|hold| match hold.reason {
        HoldReason::Stale => !is_stale(sensor, hold.from_s, -tick_s),
        HoldReason::Obstacle => sees_nothing,
    })?;
    Some(Finding::HeldForNothing { robot, t_s: found.from_s })
}

#[cfg(test)]
mod tests {
    use elbowroom_sim::{RunOptions, simulate};

    use super::*;
    use crate::fuzz_cells::pictures::PictureFolders;
    use crate::fuzz_cells::spec::Extras;

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
            learning: 0,
            times: (0..50).map(|i| f64::from(i) * 0.1 - 0.1).take_while(|t_s| *t_s <= end_s).collect(),
            unusable: Vec::new(),
            boxes: boxes.iter().map(one).collect(),
            joints: None,
            lines: vec!["ceiling = 4".into(), "voxel = 0.05".into()],
        }
    }

    fn with(sensor: SensorSpec) -> CellSpec {
        CellSpec { extras: Extras { sensors: vec![sensor], ..Extras::default() }, ..CellSpec::default() }
    }

    /// Runs the gantry with what one sensor sees; what is found if another one is judged.
    fn findings(runs: SensorSpec, judged: SensorSpec) -> Vec<Finding> {
        let spec = with(runs);
        let folder = std::env::temp_dir().join(format!("elbowroom-seen-{}", std::process::id()));
        let _pictures = PictureFolders::write(&spec, &folder).unwrap();
        let text = spec.to_toml();
        let table = &text[text.find("[cloud").unwrap()..];
        let cell = Cell::parse(folder.join("cell.toml"), &format!("{GANTRY}{table}")).unwrap();
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
