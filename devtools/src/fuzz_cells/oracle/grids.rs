//! Numbers of the occupied cells of grids on the outputs of robots.

use elbowroom_cell::{Cell, CellGrid, CellRobot};
use elbowroom_kinematics::JointKind;
use elbowroom_monitor::{Fault, GridSpace, OverrideReason};
use elbowroom_sim::Recording;
use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::findings::{Finding, Findings};
use super::frame::Frame;
use super::mounted::MountedTools;

/// By how much a coordinate may be off a border, m and rad: rounding errors are smaller.
const TOLERANCE: f64 = 1e-9;

/// Adds a finding for each grid with a wrong number.
pub fn check(cell: &Cell, recording: &Recording, arms: &[Arm], findings: &mut Findings) {
    for of_robot in &cell.monitoring.grids {
        let robot = of_robot.robot.0;
        let place = Place { robot: &cell.robots[robot], arm: &arms[robot], of_robot };
        let mounted = MountedTools::new(place.robot, recording);
        let mut former = 0;
        for (tick, sample) in recording.robots[robot].samples.iter().enumerate() {
            let number = bits(of_robot, sample.outputs);
            // In the tick of an exchange both tools count.
            let is_exchanged = mounted.changes().any(|change| change == tick);
            let is_held = holds_outputs(sample.reason) && number == former;
            let is_right = || place.is_right(place.coordinates(&sample.q, &mounted, tick).as_deref(), former, number);
            if !is_exchanged && !is_held && !is_right() {
                findings.list.push(Finding::WrongCell { robot, t_s: sample.t_s, number });
                break;
            }
            former = number;
        }
    }
}

/// Whether outputs stay as they are, because there is no sensible input or a region moves faster than allowed. A robot that
/// brakes too little, or whose regions are unknown, is where it is.
fn holds_outputs(reason: OverrideReason) -> bool {
    matches!(reason, OverrideReason::Fault(fault) if !matches!(fault, Fault::Braking | Fault::Regions))
}

/// The number on the outputs of a grid: as many bits as its largest number has.
fn bits(of_robot: &CellGrid, outputs: u64) -> u64 {
    let most: u64 = of_robot.grid.axes.iter().map(|a| u64::from(a.count)).product();
    let mut bits = 0;
    while most >> bits > 0 {
        bits += 1;
    }
    (outputs >> of_robot.grid.output) % (1 << bits)
}

struct Place<'a> {
    robot: &'a CellRobot,
    arm: &'a Arm,
    of_robot: &'a CellGrid,
}

impl Place<'_> {
    /// The coordinates of the robot; `None` if no tool is mounted.
    fn coordinates(&self, q: &[f64], mounted: &MountedTools, tick: usize) -> Option<Vec<f64>> {
        match &self.of_robot.grid.space {
            GridSpace::Tcp { frame_in_world } => {
                let tcp = self.tcp(q, mounted, tick)?;
                let frame = Frame::of(frame_in_world);
                let p = frame.vector_back(tcp - frame.at);
                Some(vec![p.x, p.y, p.z])
            }
            GridSpace::Joints(joints) => Some(joints.iter().map(|j| q[*j]).collect()),
        }
    }

    fn tcp(&self, q: &[f64], mounted: &MountedTools, tick: usize) -> Option<Vec3> {
        let frames = self.arm.frames(q);
        let tools = &self.robot.payload.tools;
        if tools.is_empty() {
            return Some(frames[self.robot.flange.0].point(self.robot.tcp_in_flange.translation));
        }
        let tool = tools.iter().enumerate().find(|(i, _)| mounted.has(*i, tick))?.1;
        Some(frames[tool.link.0].point(tool.tcp_in_link.translation))
    }

    /// Whether a robot at these coordinates, whose number was `former`, has this number.
    fn is_right(&self, coordinates: Option<&[f64]>, former: u64, number: u64) -> bool {
        let Some(coordinates) = coordinates else { return number == 0 };
        let h = self.of_robot.grid.hysteresis;
        if former != 0 && self.is_in(coordinates, former, h - TOLERANCE) {
            return number == former;
        }
        // Per axis the former division may be kept, beside those that hold the coordinate.
        let is_near = number != 0 && self.is_in(coordinates, number, h + TOLERANCE);
        let is_outside = (0..coordinates.len()).any(|k| {
            let (axis, x) = (&self.of_robot.grid.axes[k], self.wrapped(coordinates, k));
            x <= axis.from + TOLERANCE || x >= axis.to - TOLERANCE
        });
        is_near || (number == 0 && is_outside)
    }

    /// The coordinate of an axis; that of a joint that turns without end within a turn from its low end.
    fn wrapped(&self, coordinates: &[f64], k: usize) -> f64 {
        let (axis, mut x) = (&self.of_robot.grid.axes[k], coordinates[k]);
        if self.turns(k) {
            while x < axis.from {
                x += std::f64::consts::TAU;
            }
            while x >= axis.from + std::f64::consts::TAU {
                x -= std::f64::consts::TAU;
            }
        }
        x
    }

    /// Whether the coordinates are in a cell, or at most `beyond` off it, in any turn.
    fn is_in(&self, coordinates: &[f64], number: u64, beyond: f64) -> bool {
        let mut rest = number - 1;
        let is_in = |(k, axis): (usize, &elbowroom_monitor::OutputGridAxis)| {
            let count = u64::from(axis.count);
            let (place, width) = ((rest % count) as f64, (axis.to - axis.from) / count as f64);
            rest /= count;
            let turn = if self.turns(k) { std::f64::consts::TAU } else { 0.0 };
            let x = self.wrapped(coordinates, k);
            let low = axis.from + place * width - beyond;
            [x - turn, x, x + turn].iter().any(|x| *x >= low && *x <= low + width + 2.0 * beyond)
        };
        self.of_robot.grid.axes.iter().enumerate().all(is_in) && rest == 0
    }

    /// Whether an axis is that of a joint that turns without end.
    fn turns(&self, k: usize) -> bool {
        let GridSpace::Joints(joints) = &self.of_robot.grid.space else { return false };
        let chain = &self.robot.robot.chain;
        chain.joints()[chain.active_joints()[joints[k]].0].kind == JointKind::Continuous
    }
}
