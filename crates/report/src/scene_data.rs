//! Data of the 3-D scene for the script of the page: geometry once, poses per frame.

use std::collections::HashMap;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::project_point;
use elbowroom_sim::{Recording, RegionPoses, RegionTrack, RobotTrack, Span};
use elbowroom_spatial::{Pose, Vec3};
use serde_json::{Value, json};

use crate::downsample::every;
use crate::explanation::explanation;
use crate::region_surface::{self, Surface};
use crate::scene::{ReportMesh, ReportRobot, ReportScene};
use crate::{palette, summary};

/// Largest number of frames of the animation.
pub const MAX_FRAMES: usize = 1500;

/// Data for the script of the page. Large arrays are base64 of little-endian 32-bit values.
pub fn data(scene: &ReportScene, runs: &[(&str, &Recording)]) -> Value {
    let regions = runs.first().map_or(&[][..], |(_, rec)| &rec.regions[..]);
    json!({
        "robots": scene.robots.iter().map(robot).collect::<Vec<_>>(),
        "objects": scene.objects.iter().map(|o| {
            let surface = (o.vertices.clone(), o.triangles.clone());
            let moves = runs.iter().any(|(_, rec)| rec.objects.iter().any(|t| t.name == o.name));
            // Moving objects are placed per frame.
            let (pose, color) = if moves { (&Pose::IDENTITY, palette::MOVING) } else { (&o.in_world, palette::OBJECT) };
            json!({ "name": o.name, "mesh": mesh(&surface, pose), "color": color })
        }).collect::<Vec<_>>(),
        "regions": regions.iter().map(region).collect::<Vec<_>>(),
        "runs": runs.iter().map(|(label, rec)| run(scene, label, rec)).collect::<Vec<_>>(),
    })
}

fn floats(values: impl IntoIterator<Item = f64>) -> String {
    STANDARD.encode(values.into_iter().flat_map(|v| (v as f32).to_le_bytes()).collect::<Vec<u8>>())
}

/// Merges coincident vertices, so that the page can smooth normals.
fn mesh(surface: &Surface, in_frame: &Pose) -> Value {
    let mut first: HashMap<[u32; 3], u32> = HashMap::new();
    let mut corners: Vec<f32> = Vec::new();
    let index: Vec<u32> = surface
        .0
        .iter()
        .map(|&v| {
            let p = in_frame.transform_point(v).to_array().map(|c| c as f32);
            *first.entry(p.map(f32::to_bits)).or_insert_with(|| {
                corners.extend(p);
                (corners.len() / 3 - 1) as u32
            })
        })
        .collect();
    let known = |i: u32| index.get(i as usize).copied();
    let triangles = surface.1.iter().filter_map(|t| Some([known(t[0])?, known(t[1])?, known(t[2])?])).flatten();
    json!({
        "v": STANDARD.encode(corners.iter().flat_map(|c| c.to_le_bytes()).collect::<Vec<u8>>()),
        "i": STANDARD.encode(triangles.flat_map(u32::to_le_bytes).collect::<Vec<u8>>()),
    })
}

fn link_mesh(m: &ReportMesh) -> Value {
    let [r, g, b] = m.color;
    json!({ "mesh": mesh(&(m.vertices.clone(), m.triangles.clone()), &m.in_link), "color": format!("#{r:02x}{g:02x}{b:02x}") })
}

fn robot(robot: &ReportRobot) -> Value {
    let links: Vec<Value> = shown_links(robot)
        .into_iter()
        .map(|link| {
            let tool = if link == robot.flange.0 { &robot.tool[..] } else { &[] };
            let own = robot.link_meshes.get(link).map_or(&[][..], |m| &m[..]);
            Value::from(own.iter().chain(tool).map(link_mesh).collect::<Vec<_>>())
        })
        .collect();
    json!({ "name": robot.name, "links": links })
}

/// Links with visible geometry.
fn shown_links(robot: &ReportRobot) -> Vec<usize> {
    let drawn = |link: usize| {
        robot.link_meshes.get(link).is_some_and(|m| !m.is_empty()) || (link == robot.flange.0 && !robot.tool.is_empty())
    };
    (0..robot.chain.links().len()).filter(|&link| drawn(link)).collect()
}

fn region(region: &RegionTrack) -> Value {
    json!({
        "name": region.name, "kind": region.kind.name(), "color": palette::of_kind(region.kind),
        "solid": mesh(&region_surface::solid(&region.shape), &Pose::IDENTITY),
        "shell": region_surface::warning(&region.shape, region.warning_m).map(|s| mesh(&s, &Pose::IDENTITY)),
    })
}

fn run(scene: &ReportScene, label: &str, rec: &Recording) -> Value {
    let ticks = rec.robots.iter().map(|r| r.samples.len()).min().unwrap_or(0);
    let frames = every(ticks, MAX_FRAMES);
    let times = rec.robots.first().map(|r| floats(frames.iter().map(|&i| r.samples[i].t_s)));
    let spans = |list: &[Span]| list.iter().map(|s| json!([s.robot.0, s.from_s, s.to_s])).collect::<Vec<_>>();
    let regions = rec.regions.iter().map(|r| json!({
        "poses": match &r.poses {
            RegionPoses::Fixed(pose) => floats(pose_values(pose)),
            RegionPoses::Moving(poses) => floats(frames.iter().flat_map(|&i| pose_values(poses.get(i).unwrap_or(&Pose::IDENTITY)))),
        },
        "moving": matches!(r.poses, RegionPoses::Moving(_)),
        "active": r.active.iter().map(|(t, on)| json!([t, on])).collect::<Vec<_>>(),
        "warning": spans(&r.warning_spans),
        "inside": spans(&r.inside_spans),
    })).collect::<Vec<_>>();
    let objects = scene.objects.iter().map(|o| {
        let track = rec.objects.iter().find(|t| t.name == o.name)?;
        Some(floats(frames.iter().flat_map(|&i| pose_values(track.poses.get(i).unwrap_or(&o.in_world)))))
    });
    let robots = rec.robots.iter().enumerate().map(|(i, track)| frames_of(scene.robots.get(i), track, rec, &frames));
    json!({
        "label": label, "monitored": rec.monitored, "duration_s": rec.duration_s, "frames": frames.len(),
        "t": times.unwrap_or_default(), "robots": robots.collect::<Vec<_>>(), "regions": regions,
        "objects": objects.collect::<Vec<_>>(),
    })
}

fn frames_of(robot: Option<&ReportRobot>, track: &RobotTrack, rec: &Recording, frames: &[usize]) -> Value {
    let column = |f: &dyn Fn(&elbowroom_sim::Sample) -> f64| floats(frames.iter().map(|&i| f(&track.samples[i])));
    let mut reasons: Vec<String> = Vec::new();
    let mut reason_at = Vec::with_capacity(frames.len());
    for &i in frames {
        let text = explanation(track, i, rec);
        let known = reasons.iter().position(|r| *r == text);
        reason_at.push(known.unwrap_or(reasons.len()));
        if known.is_none() {
            reasons.push(text);
        }
    }
    json!({
        "name": track.name,
        "poses": robot.map(|r| floats(link_poses(r, track, frames))),
        "tcp": floats(frames.iter().flat_map(|&i| track.samples[i].tcp.to_array())),
        "override": column(&|s| s.speed_override),
        "speed": column(&|s| s.tcp_speed),
        "distance": column(&|s| s.distance_m.unwrap_or(f64::NAN)),
        "nearest": floats(frames.iter().flat_map(|&i| nearest(track, rec, i))),
        "reasons": reasons,
        "reason": reason_at,
        "outcome": summary::outcome(track, rec),
        "absent": robot.map_or_else(Vec::new, |r| absent(r, track)),
    })
}

/// Since when which of the shown links are absent.
fn absent(robot: &ReportRobot, track: &RobotTrack) -> Vec<Value> {
    let links = shown_links(robot);
    let rows = |absent: &[LinkId]| -> Vec<usize> {
        absent.iter().filter_map(|l| links.iter().position(|shown| *shown == l.0)).collect()
    };
    track.absent_links.iter().map(|(t_s, absent)| json!([t_s, rows(absent)])).collect()
}

fn link_poses(robot: &ReportRobot, track: &RobotTrack, frames: &[usize]) -> Vec<f64> {
    let links = shown_links(robot);
    let mut state = ChainState::new(&robot.chain);
    let mut out = Vec::with_capacity(frames.len() * links.len() * 7);
    for &i in frames {
        let q = &track.samples[i].q;
        let known = q.len().min(state.q.len());
        state.q[..known].copy_from_slice(&q[..known]);
        robot.chain.forward(&mut state);
        for &link in &links {
            out.extend(pose_values(&(robot.base_in_world * state.link_in_root(LinkId(link)))));
        }
    }
    out
}

/// Quaternion x y z w, then the translation.
fn pose_values(pose: &Pose) -> [f64; 7] {
    let [x, y, z, w] = pose.rotation.to_quaternion_xyzw();
    let t = pose.translation;
    [x, y, z, w, t.x, t.y, t.z]
}

/// The point of the region nearest to the governing point; NaN where that point is not the TCP.
fn nearest(track: &RobotTrack, rec: &Recording, tick: usize) -> [f64; 3] {
    let sample = &track.samples[tick];
    let unknown = [f64::NAN; 3];
    let (Some(region), Some(distance)) = (sample.region.and_then(|i| rec.regions.get(i.0)), sample.distance_m) else {
        return unknown;
    };
    let pose = match &region.poses {
        RegionPoses::Fixed(pose) => Some(pose),
        RegionPoses::Moving(poses) => poses.get(tick),
    };
    let Some(pose) = pose else { return unknown };
    let on_region: Vec3 = project_point(&region.shape, pose, sample.tcp).on_surface;
    let is_tcp = (on_region.distance(sample.tcp) - distance).abs() < 1e-6 && distance > 0.0;
    if is_tcp { on_region.to_array() } else { unknown }
}
