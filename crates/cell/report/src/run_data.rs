//! Data of runs for the scripts of the page: values per frame.

use elbowroom_kinematics::LinkId;
use elbowroom_sim::{EventRow, Recording, RegionPoses, RobotTrack, RunEvent, Sample, Span};
use elbowroom_spatial::Pose;
use serde_json::{Value, json};

use crate::downsample::every;
use crate::explanation::explanation;
use crate::packing::{ArrayPacker, pose_values};
use crate::scene::{ReportRobot, ReportScene};
use crate::sensor_data::sensor;
use crate::summary;

/// Largest number of evenly spaced frames.
const MAX_FRAMES: usize = 1500;
/// Largest number of frames that are added at events.
const MAX_EVENT_FRAMES: usize = 200;

/// Steps of the quantised values: joints (rad or m) and poses; times, s; overrides, speeds and distances.
const EXACT: f64 = 1e-8;
const TIME_STEP_S: f64 = 1e-6;
const SHOWN_STEP: f64 = 1e-6;

/// The ticks that the page contains: evenly spaced, with the start and end of every stop.
pub fn frames(rec: &Recording) -> Vec<usize> {
    let ticks = rec.robots.iter().map(|r| r.samples.len()).min().unwrap_or(0);
    let stops = rec.events.iter().filter(|e| matches!(e.event, RunEvent::Stop | RunEvent::Resume));
    let at_stops = stops.take(MAX_EVENT_FRAMES).map(|e| (e.t_s / rec.tick_s).round() as usize);
    let mut frames = every(ticks, MAX_FRAMES);
    frames.extend(at_stops.filter(|i| *i < ticks));
    frames.sort_unstable();
    frames.dedup();
    frames
}

/// When a fixture was switched on and off: time and state.
fn switches(rec: &Recording, fixture: &str) -> Vec<Value> {
    let of_fixture = rec.events.iter().filter(|e| e.region == fixture);
    let change = |e: &EventRow| match e.event {
        RunEvent::On => Some(json!([e.t_s, true])),
        RunEvent::Off => Some(json!([e.t_s, false])),
        _ => None,
    };
    of_fixture.filter_map(change).collect()
}

/// Data of one run.
pub fn run(scene: &ReportScene, label: &str, rec: &Recording, packer: &mut ArrayPacker) -> Value {
    let frames = frames(rec);
    let first = rec.robots.first();
    let times: Vec<f64> = first.map_or_else(Vec::new, |r| frames.iter().map(|&i| r.samples[i].t_s).collect());
    let spans = |list: &[Span]| list.iter().map(|s| json!([s.robot.0, s.from_s, s.to_s])).collect::<Vec<_>>();
    let mut poses_at = |poses: &dyn Fn(usize) -> Pose, frames: &[usize]| {
        let values: Vec<f64> = frames.iter().flat_map(|&i| pose_values(&poses(i))).collect();
        packer.add(&values, 7, EXACT)
    };
    let regions: Vec<Value> = rec
        .regions
        .iter()
        .map(|r| {
            let poses = match &r.poses {
                RegionPoses::Fixed(pose) => poses_at(&|_| *pose, &[0]),
                RegionPoses::Moving(poses) => poses_at(&|i| poses.get(i).copied().unwrap_or(Pose::IDENTITY), &frames),
            };
            json!({
                "poses": poses,
                "active": r.active.iter().map(|(t, on)| json!([t, on])).collect::<Vec<_>>(),
                "warning": spans(&r.warning_spans),
                "inside": spans(&r.inside_spans),
            })
        })
        .collect();
    let objects: Vec<Value> = scene
        .objects
        .iter()
        .map(|o| {
            let track = rec.objects.iter().find(|t| t.name == o.name);
            let poses = track.map(|t| poses_at(&|i| t.poses.get(i).copied().unwrap_or(o.in_world), &frames));
            json!({ "poses": poses, "held": held(rec, &o.name) })
        })
        .collect();
    let robots: Vec<Value> =
        rec.robots.iter().enumerate().map(|(i, track)| robot(scene, i, track, rec, &frames, packer)).collect();
    json!({
        "label": label, "monitored": rec.monitored, "duration_s": rec.duration_s, "frames": frames.len(),
        "opens_s": opens_s(rec), "t": packer.add(&times, 1, TIME_STEP_S), "robots": robots, "regions": regions, "objects": objects,
        // Per shield its changes: time and state.
        "shields": scene.shields.iter().map(|s| switches(rec, &s.name)).collect::<Vec<_>>(),
        "sensors": rec.sensors.iter().map(sensor).collect::<Vec<_>>(),
    })
}

/// Time at which the page opens, s: when the first robot stopped or collided; 0 if none did.
fn opens_s(rec: &Recording) -> f64 {
    let stops = rec.robots.iter().flat_map(|r| r.stops.iter().map(|s| s.from_s).chain(r.ending.stopped_at_s));
    let collisions = rec.robots.iter().flat_map(|r| r.collisions.iter().map(|c| c.t_s));
    stops.chain(collisions).min_by(f64::total_cmp).unwrap_or(0.0)
}

/// Periods in which robots hold the object: (robot, start, end), times in seconds.
fn held(rec: &Recording, object: &str) -> Vec<(usize, f64, f64)> {
    let by = |(r, robot): (usize, &RobotTrack)| {
        let grips = rec.events.iter().filter(|e| e.region == object && e.robot == robot.name);
        let edges = grips.filter_map(|e| match e.event {
            RunEvent::Grip => Some((e.t_s, true)),
            RunEvent::Release => Some((e.t_s, false)),
            _ => None,
        });
        crate::spans::pair(edges, rec.duration_s).into_iter().map(move |(from, to)| (r, from, to)).collect::<Vec<_>>()
    };
    rec.robots.iter().enumerate().flat_map(by).collect()
}

/// Tool centre points over time: (time in seconds from which it applies, link, pose in the link).
fn tool_centre_points(robot: &ReportRobot, track: &RobotTrack, rec: &Recording) -> Vec<Value> {
    let value = |t_s: f64, link: LinkId, tcp: &Pose| json!([t_s, link.0, pose_values(tcp)]);
    let changes = rec.events.iter().filter(|e| e.event == RunEvent::Tool && e.robot == track.name).filter_map(|e| {
        let (_, link, tcp) = robot.tools.iter().find(|(name, ..)| *name == e.region)?;
        Some(value(e.t_s, *link, tcp))
    });
    std::iter::once(value(0.0, robot.flange, &robot.tcp_in_flange)).chain(changes).collect()
}

fn robot(
    scene: &ReportScene,
    index: usize,
    track: &RobotTrack,
    rec: &Recording,
    frames: &[usize],
    packer: &mut ArrayPacker,
) -> Value {
    let model = scene.robots.get(index);
    let mut reasons: Vec<String> = Vec::new();
    let mut reason_at = Vec::with_capacity(frames.len());
    for &i in frames {
        let text = explanation(track, i, rec);
        let known = reasons.iter().position(|r| *r == text);
        reason_at.push(known.unwrap_or(reasons.len()) as f64);
        if known.is_none() {
            reasons.push(text);
        }
    }
    let q: Vec<f64> = frames.iter().flat_map(|&i| track.samples[i].q.iter().copied()).collect();
    let region = |i: &usize| track.samples[*i].region.map_or(f64::NAN, |r| r.0 as f64);
    let regions: Vec<f64> = frames.iter().map(region).collect();
    let obstacle = |tick: usize| {
        let name = track.governing_obstacle(tick)?;
        scene.objects.iter().position(|o| o.name == name)
    };
    let obstacles: Vec<f64> = frames.iter().map(|&i| obstacle(i).map_or(f64::NAN, |o| o as f64)).collect();
    let column = |packer: &mut ArrayPacker, f: &dyn Fn(&Sample) -> f64| {
        let values: Vec<f64> = frames.iter().map(|&i| f(&track.samples[i])).collect();
        packer.add(&values, 1, SHOWN_STEP)
    };
    json!({
        "name": track.name,
        "q": packer.add(&q, track.joints.len().max(1), EXACT),
        "override": column(packer, &|s| s.speed_override),
        "speed": column(packer, &|s| s.tcp_speed),
        "distance": column(packer, &|s| s.distance_m.unwrap_or(f64::NAN)),
        "region": packer.add(&regions, 1, 1.0),
        "obstacle": packer.add(&obstacles, 1, 1.0),
        "reason": packer.add(&reason_at, 1, 1.0),
        "reasons": reasons,
        "stops": track.stops.iter().map(|s| (s.from_s, s.to_s)).collect::<Vec<_>>(),
        "outcome": summary::outcome(track, rec),
        "tcps": model.map(|model| tool_centre_points(model, track, rec)),
        "absent": track.absent_links.iter().map(|(t_s, links)| (t_s, links.iter().map(|l| l.0).collect())).collect::<Vec<(_, Vec<_>)>>(),
    })
}
