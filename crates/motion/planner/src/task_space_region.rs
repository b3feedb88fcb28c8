//! Goals in space: task space regions (Berenson, Srinivasa, Kuffner: *Task space regions*, 2011). The smallest region
//! is a pose.

use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::interpolation::length;
use crate::rrt_connect::Random;

/// Tolerance for rounding at the region's border, m or rad.
const BORDER: f64 = 1e-8;

/// A set of poses of a tip in which a robot may end.
///
/// ```
/// use elbowroom_planner::TaskSpaceRegion;
/// use elbowroom_kinematics::LinkId;
/// use elbowroom_spatial::{Pose, Vec3};
/// // Anywhere on a table of 0.4 m by 0.6 m, gripper down, turned as it likes about the vertical.
/// let down = Pose::from_xyz_rpy([0.5, 0.0, 0.3], [std::f64::consts::PI, 0.0, 0.0]);
/// let region = TaskSpaceRegion {
///     half_extents_m: Vec3::new(0.2, 0.3, 0.0),
///     half_angles_rad: Vec3::new(0.0, 0.0, std::f64::consts::PI),
///     ..TaskSpaceRegion::at_pose(LinkId(3), Pose::IDENTITY, down)
/// };
/// assert!(region.contains(&Pose::from_xyz_rpy([0.6, 0.2, 0.3], [std::f64::consts::PI, 0.0, 1.0])));
/// assert!(!region.contains(&Pose::from_xyz_rpy([0.6, 0.2, 0.4], [std::f64::consts::PI, 0.0, 1.0])));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TaskSpaceRegion {
    /// The link that the tip belongs to.
    pub link: LinkId,
    /// Pose of the tip in the frame of the link.
    pub tip_in_link: Pose,
    /// Centre of the region.
    pub centre_in_world: Pose,
    /// Largest offset of the tip from the centre along the centre's axes, m.
    pub half_extents_m: Vec3,
    /// Largest rotation of the tip from the centre: roll, pitch and yaw in the frame of the centre, rad.
    pub half_angles_rad: Vec3,
}

impl TaskSpaceRegion {
    /// Creates a region of a single pose of the tip.
    pub fn at_pose(link: LinkId, tip_in_link: Pose, tip_in_world: Pose) -> Self {
        Self {
            link,
            tip_in_link,
            centre_in_world: tip_in_world,
            half_extents_m: Vec3::ZERO,
            half_angles_rad: Vec3::ZERO,
        }
    }

    /// Whether a pose of the tip is in the region, up to rounding.
    pub fn contains(&self, tip_in_world: &Pose) -> bool {
        let from_centre = self.centre_in_world.inverse_mul(tip_in_world);
        let within = |value: f64, half: f64| value.abs() <= half + BORDER;
        let turned = Vec3::from(from_centre.rotation.to_rpy());
        (0..3).all(|i| within(from_centre.translation[i], self.half_extents_m[i]))
            && (0..3).all(|i| within(turned[i], self.half_angles_rad[i]))
    }

    /// Finds configurations of a robot (rad, m for prismatic joints) within its limits with the tip in the region: all
    /// that inverse kinematics finds for the centre and for `samples` more poses, the nearest to the robot's
    /// configuration in `start` first. This includes solutions that differ by whole turns of a joint within its limits.
    /// The configurations may be in collision. An empty result proves nothing for more than six joints.
    ///
    /// # Panics
    /// The scene does not have this robot, or the robot does not have this link.
    pub fn configurations(
        &self,
        scene: &Scene,
        start: &SceneState,
        robot: RobotId,
        samples: usize,
        seed: u64,
    ) -> Vec<Vec<f64>> {
        let r = &scene.robots()[robot.0];
        let chain = &r.robot.chain;
        let mut solver = IkSolver::new(chain, self.link, self.tip_in_link, IkOptions::default());
        let (mut random, mut found) = (Random::new(seed), Vec::new());
        let from = start.q(robot);
        let mut state = ChainState::new(chain);
        for n in 0..=samples {
            let tip_in_world = if n == 0 { self.centre_in_world } else { self.sample(&mut random) };
            for q in solver.solve_all(&r.base_in_world.inverse_mul(&tip_in_world), from) {
                state.q.copy_from_slice(&q);
                chain.forward(&mut state);
                // Numerical solutions of poses at the border may be slightly outside.
                if self.contains(&(r.base_in_world * state.link_in_root(self.link) * self.tip_in_link)) {
                    found.push(q);
                }
            }
        }
        add_whole_turns(&mut found, &chain.lower(), &chain.upper());
        found.sort_by(|a, b| length(from, a).total_cmp(&length(from, b)));
        found.dedup();
        found
    }

    /// A random pose of the region, uniform in position and in each angle.
    fn sample(&self, random: &mut Random) -> Pose {
        let mut within = |half: Vec3| Vec3::from([0, 1, 2].map(|i| random.between(-half[i], half[i])));
        let (at, turned) = (within(self.half_extents_m), within(self.half_angles_rad));
        self.centre_in_world * Pose::new(Rotation::from_rpy(turned.x, turned.y, turned.z), at)
    }
}

/// Adds the configurations in which one joint is turned by a whole turn more or less, if its limits are wider than a
/// turn.
fn add_whole_turns(found: &mut Vec<Vec<f64>>, lower: &[f64], upper: &[f64]) {
    for i in 0..found.len() {
        for joint in (0..lower.len()).filter(|&j| upper[j] - lower[j] > std::f64::consts::TAU && upper[j].is_finite()) {
            for turn in [-std::f64::consts::TAU, std::f64::consts::TAU] {
                let value = found[i][joint] + turn;
                if value >= lower[joint] && value <= upper[joint] {
                    let mut other = found[i].clone();
                    other[joint] = value;
                    found.push(other);
                }
            }
        }
    }
}
