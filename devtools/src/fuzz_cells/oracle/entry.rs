//! Check of tools with a point of entry: once the shaft is at the point it stays there, and in its range of depths.

use elbowroom_cell::{Cell, CellGuide};
use elbowroom_sim::Recording;

use super::arm::Arm;
use super::findings::{Finding, Findings};
use super::frame::Frame;

/// Distance of the shaft from the point, and of the tip from its depths, that is stated, m.
const STATED_M: f64 = 2e-6;

pub fn check(cell: &Cell, recording: &Recording, arms: &[Arm], findings: &mut Findings) {
    for operator in &cell.guidance.operators {
        // The generator switches no guides.
        let is_on = |g: &&CellGuide| g.tool == operator.tool && g.active && g.guide.remote_center().is_some();
        if let Some(guide) = cell.guidance.guides.iter().find(is_on) {
            shaft(cell, guide, recording, &arms[operator.robot.0], findings);
        }
    }
}

fn shaft(cell: &Cell, guide: &CellGuide, recording: &Recording, arm: &Arm, findings: &mut Findings) {
    let (Some(center), Some((_, tcp_in_link))) = (guide.guide.remote_center(), guide.tool.solid(cell)) else { return };
    let (robot, link) = (guide.tool.robot.0, guide.tool.link(cell).0);
    let (least_m, most_m) = center.depth_m();
    // What may be left again: a tool that starts elsewhere comes nearer to the point, and no deeper than allowed, but it may
    // go away from the opening until it is in it.
    let mut stated_m = [f64::INFINITY; 3];
    for sample in &recording.robots[robot].samples {
        let tool = arm.frames(&sample.q)[link].then(&Frame::of(&tcp_in_link));
        let axis = tool.vector(center.axis_in_tool());
        let out = tool.at - center.at();
        let depth_m = out.dot(axis);
        let off_m = [(out - axis * depth_m).length() - center.radius_m(), depth_m - most_m, least_m - depth_m];
        // While the shaft turns to the point, the depth changes.
        let judged = if off_m[0] <= STATED_M { 3 } else { 1 };
        for (off_m, stated_m) in off_m.into_iter().zip(&mut stated_m).take(judged) {
            if !(off_m <= *stated_m + STATED_M) {
                findings.list.push(Finding::OffEntry { robot, t_s: sample.t_s, off_m });
                return;
            }
            *stated_m = stated_m.min(off_m.max(0.0));
        }
        if off_m[2] > STATED_M {
            stated_m[2] = f64::INFINITY;
        }
    }
}
