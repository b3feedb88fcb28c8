//! How far joints can move links, at most: for proofs that nothing can happen before the next look.

use elbowroom_kinematics::LinkId;
use elbowroom_scene::{Robot, pairs};

use crate::{Other, Threat};

/// Metres per rad (or m) of each joint, per link, and per pair of links against each other.
#[derive(Debug, Clone)]
pub struct Levers {
    links: usize,
    joints: usize,
    alone: Vec<f64>,
    against: Vec<f64>,
}

impl Levers {
    /// For a robot.
    pub fn new(robot: &Robot) -> Self {
        let chain = &robot.chain;
        let (links, joints) = (chain.links().len(), chain.dof());
        let mut levers =
            Self { links, joints, alone: vec![0.0; links * joints], against: vec![0.0; links * links * joints] };
        let radius = |l: usize| pairs::radius(&robot.bodies[l]);
        for a in 0..links {
            let all = chain.path(LinkId(a));
            for (joint, lever) in pairs::motion_bound(chain, LinkId(a), radius(a), &all) {
                levers.alone[a * joints + joint] += lever;
            }
            for b in 0..links {
                let other = chain.path(LinkId(b));
                let between: Vec<_> = all.iter().copied().filter(|j| !other.contains(j)).collect();
                // Each side moves by the joints that the other does not share.
                for (joint, lever) in pairs::motion_bound(chain, LinkId(a), radius(a), &between) {
                    levers.against[(a * links + b) * joints + joint] += lever;
                    levers.against[(b * links + a) * joints + joint] += lever;
                }
            }
        }
        levers
    }

    /// No point of any link moves farther than this in `dt` seconds at joint velocities `qd`, m.
    pub fn farthest(&self, qd: &[f64], dt: f64) -> f64 {
        let of = |row: &[f64]| row.iter().zip(qd).map(|(lever, v)| lever * v.abs()).sum::<f64>();
        self.alone.chunks(self.joints.max(1)).map(of).fold(0.0, f64::max) * dt
    }

    /// The gap of a threat closes by no more than this in `dt` seconds at joint velocities `qd`, m.
    pub fn closing(&self, threat: &Threat, qd: &[f64], dt: f64) -> f64 {
        let a = threat.link.0;
        let row = match threat.other {
            Other::Own(b) => &self.against[(a * self.links + b.0) * self.joints..][..self.joints],
            _ => &self.alone[a * self.joints..][..self.joints],
        };
        row.iter().zip(qd).map(|(lever, v)| lever * v.abs()).sum::<f64>() * dt
    }
}
