//! Speeds and accelerations of a recording beyond the limits of the cell.

use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::Chain;
use elbowroom_kinematics::motion_bound::max_motion_bounds;
use elbowroom_monitor::Volume;
use elbowroom_robot::RobotId;

use super::playback::Playback;
use crate::{Cell, CellRobot, Program, ProgramBody};

/// Factor on the stated accelerations of programs: linear moves are timed from samples of their path.
const ACCELERATION_MARGIN: f64 = 1.1;
/// Tolerance (m) for rows beside a smooth path: half of the 0.5 mm that the stopping-distance law keeps in reserve.
const BESIDE_M: f64 = 0.25e-3;
/// Motion per tick (m) below which the reserve covers a change of velocity: the law assumes one and a half times the
/// actual time, and 4 / (4 · 1.5²) mm is less than 0.5 mm.
const SHORT_M: f64 = 4e-3;

/// Number of ticks. A speed that a joint reaches within them causes no warning.
const UNSEEN_TICKS: f64 = 5.0;

/// Largest speed and acceleration of a joint in a recording, and their times (s, on the recording's own time axis).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointDemand {
    /// Largest speed, rad/s or m/s.
    pub speed: f64,
    /// Time of that speed.
    pub speed_at_s: f64,
    /// Bound A of the acceleration, rad/s² or m/s²; 0 if it does not exceed the stated one.
    ///
    /// Within a time u, the joint leaves its straight course by at most A·u²/2.
    pub acceleration: f64,
    /// Time of that acceleration.
    pub acceleration_at_s: f64,
    /// Speed at the first row, rad/s or m/s.
    pub first_speed: f64,
}

/// Demand of a robot's recording per joint; empty without a recording.
pub fn demands(cell: &Cell, robot: RobotId) -> Vec<JointDemand> {
    let at = &cell.robots[robot.0];
    let Some(ProgramBody::Trajectory(trajectory)) = at.program.as_ref().map(|p| &p.body) else { return Vec::new() };
    let motion_bounds = motion_bounds(at);
    let play = Playback::new(trajectory.clone(), &motion_bounds);
    let jumps: f64 = motion_bounds.iter().enumerate().map(|(j, bound)| bound * play.largest_jump(j)).sum();
    let least_s = if jumps * cell.timing.tick_s > SHORT_M { SHORT_M / jumps } else { cell.timing.tick_s };
    let first = play.at(0.0);
    let of = |(j, bound): (usize, &f64)| {
        let stated = ACCELERATION_MARGIN * at.limits[j].acceleration;
        let beside = BESIDE_M / (bound.max(1e-3) * motion_bounds.len() as f64);
        let (acceleration, acceleration_at_s) = play.hardest(j, stated, least_s, beside);
        let (speed, speed_at_s) = play.fastest(j);
        JointDemand { speed, speed_at_s, acceleration, acceleration_at_s, first_speed: first.dq[j].abs() }
    };
    motion_bounds.iter().enumerate().map(of).collect()
}

/// Accelerations that no program of this robot exceeds, rad/s² or m/s².
pub fn accelerations(cell: &Cell, robot: RobotId) -> Vec<f64> {
    let demands = demands(cell, robot);
    let demanded = |j: usize| demands.get(j).map_or(0.0, |d| d.acceleration);
    let limits = cell.robots[robot.0].limits.iter().enumerate();
    limits.map(|(j, l)| ACCELERATION_MARGIN * l.acceleration.max(demanded(j))).collect()
}

/// Warns of joints whose speed in a recording exceeds their limit, that begin in motion, or, with the stopping-distance
/// law, whose acceleration exceeds the stated one.
pub fn recording_warnings(cell: &Cell, robot: RobotId) -> Vec<Diagnostic> {
    let Some(program) = &cell.robots[robot.0].program else { return Vec::new() };
    let mut warnings = Vec::new();
    for (j, demand) in demands(cell, robot).iter().enumerate() {
        let joint = RecordedJoint { cell, robot: &cell.robots[robot.0], program, j };
        warnings.extend(joint.too_fast(demand));
        warnings.extend(joint.begins_in_motion(demand));
        if cell.monitoring.stopping_reaction_s.is_some() {
            warnings.extend(joint.too_hard(demand));
        }
    }
    warnings
}

struct RecordedJoint<'a> {
    cell: &'a Cell,
    robot: &'a CellRobot,
    program: &'a Program,
    j: usize,
}

impl RecordedJoint<'_> {
    fn too_fast(&self, demand: &JointDemand) -> Option<Diagnostic> {
        let (stated, demanded) = (self.robot.limits[self.j].velocity, demand.speed * self.program.speed_override);
        if demanded <= stated * (1.0 + 1e-6) {
            return None;
        }
        let what = format!(
            "moves at {}/s at {:.3} s, faster than its `speed` of {}/s",
            self.show(demanded),
            demand.speed_at_s,
            self.show(stated)
        );
        let share = (100.0 * stated / demand.speed).floor();
        Some(self.warning(&what, format!("times in the recording that are farther apart, or override = {share}")))
    }

    fn begins_in_motion(&self, demand: &JointDemand) -> Option<Diagnostic> {
        let needed_s = demand.first_speed / self.robot.limits[self.j].acceleration;
        if needed_s <= self.cell.timing.tick_s * UNSEEN_TICKS {
            return None;
        }
        let what = format!(
            "moves at {}/s in its first row: the robot starts from rest, and is as fast after {:.0} ms",
            self.show(demand.first_speed),
            needed_s * 1e3
        );
        Some(self.warning(&what, "a recording that begins at rest".into()))
    }

    fn too_hard(&self, demand: &JointDemand) -> Option<Diagnostic> {
        if demand.acceleration <= 0.0 {
            return None;
        }
        let what = format!(
            "accelerates by {}/s² at {:.3} s; `acceleration` is {}/s². The stopping distance uses the larger value: \
             the robot slows down earlier",
            self.show(demand.acceleration),
            demand.acceleration_at_s,
            self.show(self.robot.limits[self.j].acceleration),
        );
        let write = "more rows around that time, a smoother recording, or times that are farther apart";
        Some(self.warning(&what, write.into()))
    }

    fn warning(&self, what: &str, write: String) -> Diagnostic {
        let (robot, joint) = (&self.robot.name, &self.robot.joint_names()[self.j]);
        let what = format!("the recording in [program.{robot}]: joint \"{joint}\" {what}");
        Diagnostic::new(&self.cell.file, self.program.line, what).hint(write)
    }

    /// To four digits, in the file's unit.
    fn show(&self, value: f64) -> String {
        let chain = &self.robot.robot.chain;
        let slides = !chain.joints()[chain.active_joints()[self.j].0].kind.turns();
        let scale = 10_f64.powi(3 - value.abs().max(1e-9).log10().floor() as i32);
        self.cell.units.show_joint(slides, (value * scale).round() / scale)
    }
}

/// Per joint the motion bound of all guarded volumes, m per rad or m.
pub fn motion_bounds(robot: &CellRobot) -> Vec<f64> {
    volume_motion_bounds(&robot.robot.chain, &robot.guarded_volumes())
}

/// Per joint the motion bound of these volumes, m per rad or m.
pub fn volume_motion_bounds(chain: &Chain, volumes: &[Volume]) -> Vec<f64> {
    max_motion_bounds(chain, volumes.iter().map(|v| (v.link, v.radius_in_link())))
}
