//! What a recording asks of the joints, where that is more than the cell states of them.

use elbowroom_formats::Warning;
use elbowroom_kinematics::Chain;
use elbowroom_monitor::Volume;
use elbowroom_scene::pairs::motion_bound;

use super::Playback;
use crate::{Cell, CellRobot, Program, ProgramBody};

/// Programs are taken to accelerate by so much more than is stated: linear moves are timed from samples of their course.
pub const ACCELERATION_MARGIN: f64 = 1.1;
/// The stopping distance keeps 0.5 mm in reserve. Half of it is for rows that stand beside a smooth course.
const BESIDE_M: f64 = 0.25e-3;
/// Where a robot is so slow that less than this (m) would be passed by a change of velocity, the reserve covers it: the law
/// reckons with one and a half times the time that really passes, and 4 / (4 · 1.5²) mm is less than 0.5 mm.
const SHORT_M: f64 = 4e-3;

/// The most that a recording asks of a joint, and when (s, by the recording's own times).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demand {
    /// rad/s or m/s.
    pub speed: f64,
    /// When.
    pub speed_at_s: f64,
    /// So that no course leaves the straight one by more than half of it times u², rad/s² or m/s²; 0 where it is no more than
    /// is stated.
    pub acceleration: f64,
    /// When.
    pub acceleration_at_s: f64,
}

/// Per joint what the recording of a robot (by index) asks; empty for one that plays none.
pub fn demands(cell: &Cell, robot: usize) -> Vec<Demand> {
    let Some(ProgramBody::Trajectory(rows)) = cell.programs.get(robot).and_then(Option::as_ref).map(|p| &p.body) else {
        return Vec::new();
    };
    let at = &cell.robots[robot];
    let levers = levers(at);
    let play = Playback::new(rows.clone(), &levers);
    let jumps: f64 = levers.iter().enumerate().map(|(j, lever)| lever * play.largest_jump(j)).sum();
    let least_s = if jumps * cell.tick_s > SHORT_M { SHORT_M / jumps } else { cell.tick_s };
    let of = |(j, lever): (usize, &f64)| {
        let stated = ACCELERATION_MARGIN * at.limits[j].acceleration;
        let beside = BESIDE_M / (lever.max(1e-3) * levers.len() as f64);
        let (acceleration, acceleration_at_s) = play.hardest(j, stated, least_s, beside);
        let (speed, speed_at_s) = play.fastest(j);
        Demand { speed, speed_at_s, acceleration, acceleration_at_s }
    };
    levers.iter().enumerate().map(of).collect()
}

/// The accelerations that no program of this robot exceeds, rad/s² or m/s².
pub fn accelerations(cell: &Cell, robot: usize) -> Vec<f64> {
    let demands = demands(cell, robot);
    let asked = |j: usize| demands.get(j).map_or(0.0, |d| d.acceleration);
    let limits = cell.robots[robot].limits.iter().enumerate();
    limits.map(|(j, l)| ACCELERATION_MARGIN * l.acceleration.max(asked(j))).collect()
}

/// Warns of joints that a recording drives faster than they can go, or, where the stopping distance reckons with it,
/// accelerates harder than is stated.
pub fn recording_warnings(cell: &Cell, robot: usize) -> Vec<Warning> {
    let Some(program) = cell.programs.get(robot).and_then(Option::as_ref) else { return Vec::new() };
    let mut warnings = Vec::new();
    for (j, demand) in demands(cell, robot).iter().enumerate() {
        let joint = Joint { cell, robot: &cell.robots[robot], program, j };
        warnings.extend(joint.too_fast(demand));
        if cell.laws.stopping_reaction_s.is_some() {
            warnings.extend(joint.too_hard(demand));
        }
    }
    warnings
}

struct Joint<'a> {
    cell: &'a Cell,
    robot: &'a CellRobot,
    program: &'a Program,
    j: usize,
}

impl Joint<'_> {
    fn too_fast(&self, demand: &Demand) -> Option<Warning> {
        let (stated, asked) = (self.robot.limits[self.j].velocity, demand.speed * self.program.speed_override);
        if asked <= stated * (1.0 + 1e-6) {
            return None;
        }
        let what = format!(
            "goes at {}/s at {:.3} s, faster than its `speed` of {}/s",
            self.show(asked),
            demand.speed_at_s,
            self.show(stated)
        );
        let share = (100.0 * stated / demand.speed).floor();
        Some(self.warning(&what, format!("times in the recording that are farther apart, or override = {share}")))
    }

    fn too_hard(&self, demand: &Demand) -> Option<Warning> {
        if demand.acceleration <= 0.0 {
            return None;
        }
        let what = format!(
            "accelerates by {}/s² at {:.3} s; `acceleration` is {}/s². The stopping distance reckons with the larger figure: \
             the robot slows down earlier",
            self.show(demand.acceleration),
            demand.acceleration_at_s,
            self.show(self.robot.limits[self.j].acceleration),
        );
        let write = "more rows around that time, a smoother recording, or times that are farther apart";
        Some(self.warning(&what, write.into()))
    }

    fn warning(&self, what: &str, write: String) -> Warning {
        let (robot, joint) = (&self.robot.name, &self.robot.joint_names()[self.j]);
        let what = format!("the recording in [program.{robot}]: joint \"{joint}\" {what}");
        Warning::new(&self.cell.file, self.program.line, what).hint(write)
    }

    /// To four digits, in the file's unit.
    fn show(&self, value: f64) -> String {
        let chain = &self.robot.robot.chain;
        let slides = !chain.joints()[chain.active_joints()[self.j].0].kind.turns();
        let scale = 10_f64.powi(3 - value.abs().max(1e-9).log10().floor() as i32);
        self.cell.units.show_joint(slides, (value * scale).round() / scale)
    }
}

/// Per joint the farthest that it moves any guarded point, m per rad or m.
pub fn levers(robot: &CellRobot) -> Vec<f64> {
    levers_of(&robot.robot.chain, &robot.guarded_volumes())
}

/// Per joint the farthest that it moves any point of these volumes, m per rad or m.
pub fn levers_of(chain: &Chain, volumes: &[Volume]) -> Vec<f64> {
    let mut levers = vec![0.0_f64; chain.dof()];
    for volume in volumes {
        let box_in_link = volume.shape.aabb(&volume.in_link);
        let radius = box_in_link.min.abs().max(box_in_link.max.abs()).length();
        let mut own = vec![0.0; levers.len()];
        // Joints that follow one another have its index, and add up.
        for (joint, lever) in motion_bound(chain, volume.link, radius, &chain.path(volume.link)) {
            own[joint] += lever;
        }
        levers.iter_mut().zip(own).for_each(|(most, lever)| *most = most.max(lever));
    }
    levers
}
