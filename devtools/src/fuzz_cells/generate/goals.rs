//! Moves of robots with six joints to poses of the tool centre point.

use elbowroom_cell::Cell;
use elbowroom_spatial::Vec3;

use crate::fuzz_cells::oracle::{Arm, Frame};
use crate::fuzz_cells::spec::{CellSpec, GoalSpec, Model, StepSpec, Vector, list};

/// Number of joints of a robot whose configuration can be chosen.
const JOINTS: usize = 6;
/// Least angle of the fifth joint from its straight position, at which the wrist turns over, rad.
const TURNED_RAD: f64 = 0.1;

/// Lets joint moves end at the poses that their joint values have: near these values, or with the wrist turned as they
/// turn it.
pub fn some(spec: &mut CellSpec, cell: &Cell, is_near: bool) {
    for (robot, r) in spec.robots.iter_mut().zip(&cell.robots) {
        if robot.start.len() != JOINTS || !r.payload.tools.is_empty() || !robot.program.steps.iter().all(is_plain) {
            continue;
        }
        // The arms of files have spherical wrists.
        let has_wrist = matches!(robot.model, Model::File(_));
        let arm = Arm::new(r);
        for step in &mut robot.program.steps {
            let StepSpec::Joint { to, .. } = step else { continue };
            let choice = if is_near {
                format!(", near = {}", list(to))
            } else if to[4].abs() > TURNED_RAD && has_wrist {
                let wrist = if to[4] > 0.0 { "no_flip" } else { "flip" };
                format!(", configuration = [\"{wrist}\"]")
            } else {
                continue;
            };
            let tcp = arm.frames(to)[r.flange.0].then(&Frame::of(&r.tcp_in_flange));
            let goal = GoalSpec { at: tcp.at.to_array(), rpy: rpy(&tcp), choice };
            *step = StepSpec::Pose { to: std::mem::take(to), goal };
        }
    }
}

/// Whether a step does not go on from where a move ends.
fn is_plain(step: &StepSpec) -> bool {
    matches!(step, StepSpec::Joint { .. } | StepSpec::Wait(_) | StepSpec::Override(_) | StepSpec::Switch { .. })
}

/// Roll, pitch and yaw of a frame.
fn rpy(frame: &Frame) -> Vector {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| frame.vector(axis));
    [y.z.atan2(z.z), (-x.z).clamp(-1.0, 1.0).asin(), x.y.atan2(x.x)]
}
