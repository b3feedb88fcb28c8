//! What a region can guard: solids of the robot as they are, not the volumes that enclose them.

use elbowroom_cell::CellRobot;
use elbowroom_monitor::Guards;
use elbowroom_spatial::{Pose, Vec3};

use super::frame::Frame;
use super::solid::{Bounds, OracleSolid};

/// A solid of a robot, or its tool centre point.
#[derive(Debug, Clone)]
pub struct Guarded {
    /// Index of the link that carries it.
    pub link: usize,
    in_link: Frame,
    solid: OracleSolid,
    part: GuardedPart,
    /// Farthest of its points from the link's origin, m.
    pub radius_m: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum GuardedPart {
    Tcp,
    Tool,
    Arm,
}

impl Guarded {
    /// All that can count of a robot: the tool centre point first.
    pub fn all(robot: &CellRobot) -> Vec<Self> {
        let flange = robot.flange.0;
        let mut all = vec![Self::new(flange, &robot.tcp_in_flange, OracleSolid::point(), GuardedPart::Tcp)];
        let carried = [&robot.tool, &robot.load].into_iter().flatten();
        all.extend(
            carried.map(|b| Self::new(flange, &b.in_link, OracleSolid::eroded(&b.shape, 0.0), GuardedPart::Tool)),
        );
        for (link, colliders) in robot.without_payload().colliders.iter().enumerate() {
            all.extend(
                colliders
                    .iter()
                    .map(|b| Self::new(link, &b.in_link, OracleSolid::eroded(&b.shape, 0.0), GuardedPart::Arm)),
            );
        }
        all
    }

    fn new(link: usize, in_link: &Pose, solid: OracleSolid, part: GuardedPart) -> Self {
        let in_link = Frame::of(in_link);
        let radius_m = in_link.at.length() + solid.reach_from(Vec3::ZERO);
        Self { link, in_link, solid, part, radius_m }
    }

    pub fn counts_for(&self, guards: Guards) -> bool {
        match self.part {
            GuardedPart::Tcp => guards.tcp,
            GuardedPart::Tool => guards.tool || guards.arm,
            GuardedPart::Arm => guards.arm,
        }
    }

    /// Where it is, roughly; `frames` are those of all links.
    pub fn center(&self, frames: &[Frame]) -> Vec3 {
        frames[self.link].then(&self.in_link).at
    }

    pub fn distance(&self, frames: &[Frame], region: &OracleSolid, region_at: &Frame, limit: f64) -> Bounds {
        self.solid.distance(&frames[self.link].then(&self.in_link), region, region_at, limit)
    }
}
