//! Joint positions over time.

use elbowroom_kinematics::JointKind;
use elbowroom_robot::RobotId;
use elbowroom_sim::Recording;

use super::figure::{Figure, plain, round};
use super::plot::{Plot, axis, layout, line, stroke};
use super::timing;
use crate::downsample::{MAX_POINTS, pick};
use crate::palette;
use crate::scene::ReportScene;

pub fn chart(scene: &ReportScene, runs: &[(&str, &Recording)], run: usize) -> Option<Figure> {
    let (label, recording) = runs.get(run)?;
    let mut plot = Plot::default();
    let mut lengths = false;
    for (robot, track) in recording.robots.iter().enumerate() {
        let prefix = if recording.robots.len() > 1 { format!("{} · ", track.name) } else { String::new() };
        for (k, joint) in track.joints.iter().enumerate() {
            let prismatic = is_prismatic(scene, RobotId(robot), joint);
            lengths |= prismatic;
            let scale = if prismatic { 1e3 } else { 1f64.to_degrees() };
            let at = |i: usize| track.samples[i].q.get(k).map_or(f64::NAN, |q| scale * q);
            let kept = pick(track.samples.len(), MAX_POINTS, &[&at]);
            let t = kept.iter().map(|&i| round(track.samples[i].t_s)).collect();
            let y = kept.iter().map(|&i| round(at(i))).collect();
            let style = stroke(palette::of_index(k + 3 * robot), 1.6);
            plot.add(line(t, y, &plain(&format!("{prefix}{joint}")), style));
        }
    }
    if plot.traces.is_empty() {
        return None;
    }
    let unit = if lengths { "joint position (° or mm)" } else { "joint position (°)" };
    plot.layout = layout(axis("time (s)"), axis(unit));
    Some(Figure {
        title: timing::title("Joints", label, runs.len()),
        note: String::new(),
        over_time: true,
        run: Some(run),
        height: 340,
        wide: true,
        drawing: plot.into(),
    })
}

fn is_prismatic(scene: &ReportScene, robot: RobotId, joint: &str) -> bool {
    let chain = scene.robots.get(robot.0).map(|r| &r.chain);
    chain.and_then(|c| c.joint(joint).map(|id| c.joints()[id.0].kind == JointKind::Prismatic)).unwrap_or(false)
}
