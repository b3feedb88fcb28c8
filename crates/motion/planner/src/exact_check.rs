//! Continuous check of a path in the exact scene.

use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Checker, SceneError, SceneState, SweepHit, SweepOptions};

use crate::path::Path;

/// The joints of a robot that the map's three axes are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MappedJoints {
    /// Index of the robot in the scene.
    pub robot: RobotId,
    /// Indices of the map's joints among the robot's joint values.
    pub joints: [usize; 3],
}

/// Why a path is rejected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CheckError {
    /// A pair comes too near.
    #[error(
        "the path is free in the map and not in the scene: before waypoint {waypoint}, at {share:.3} of the segment, {q:?} rad, `{a}` and `{b}` are {metres} m apart{}: is the map that of this scene?",
        if *.certain { "" } else { " and no more could be proven" }
    )]
    Collision {
        /// The waypoint at the end of the segment; 0: the first one itself.
        waypoint: usize,
        /// Fraction of the segment that is free.
        share: f64,
        /// The map's joint values there, radians.
        q: [f64; 3],
        /// Name of one of the pair.
        a: String,
        /// Name of the other.
        b: String,
        /// Distance of the pair there less its security margin, metres.
        metres: f64,
        /// False where the proof ended without a contact.
        certain: bool,
    },
    /// A joint of the map is no joint of the robot.
    #[error(
        "the map's joint {map} is said to be value {joint} of a robot that has {dof}: name each joint once, counted from 0"
    )]
    Joint {
        /// Number of the joint in the map.
        map: usize,
        /// Its index given.
        joint: usize,
        /// The robot's number of joint values.
        dof: usize,
    },
    /// A waypoint that the scene rejects, or a robot that it does not have.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl Path {
    /// Proves that no pair of the scene comes too near along the path, the robot's other joints fixed as in `state`.
    ///
    /// Segments are straight between waypoints. For a trajectory that blends corners, give its points to
    /// [`Path::check_polyline`].
    ///
    /// ```
    /// use elbowroom_planner::{CheckError, MappedJoints, Path};
    /// use elbowroom_robot::RobotId;
    /// use elbowroom_scene::{Checker, CheckerOptions, SceneState, SweepOptions, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, RobotId(0), &[-0.9, 1.3, 0.6])?;
    /// let mut checker = Checker::new(&scene, CheckerOptions::default());
    /// let path = |waypoints: &[[f64; 3]]| {
    ///     Path { waypoints: waypoints.to_vec(), length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 }
    /// };
    /// let arm = MappedJoints { robot: RobotId(0), joints: [0, 1, 2] };
    /// let over = path(&[[-0.9, 1.3, 0.6], [-0.9, 0.2, 0.6], [0.9, 0.2, 0.6], [0.9, 1.3, 0.6]]);
    /// assert!(over.check(&mut checker, &state, arm, &SweepOptions::default()).is_ok());
    /// let through = path(&[[-0.9, 1.3, 0.6], [0.9, 1.3, 0.6]]);
    /// let error = through.check(&mut checker, &state, arm, &SweepOptions::default()).unwrap_err();
    /// assert!(matches!(error, CheckError::Collision { waypoint: 1, .. }), "{error}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A pair comes too near, or the proof is not complete within the steps that `options` allow; joints or waypoints that
    /// are not the robot's.
    pub fn check(
        &self,
        checker: &mut Checker,
        state: &SceneState,
        arm: MappedJoints,
        options: &SweepOptions,
    ) -> Result<(), CheckError> {
        Self::check_polyline(&self.waypoints, checker, state, arm, options)
    }

    /// The same along a polyline: straight from each point (radians) to the next.
    ///
    /// # Errors
    /// As [`Path::check`].
    pub fn check_polyline(
        waypoints: &[[f64; 3]],
        checker: &mut Checker,
        state: &SceneState,
        arm: MappedJoints,
        options: &SweepOptions,
    ) -> Result<(), CheckError> {
        let count = checker.scene().robots().len();
        if arm.robot.0 >= count {
            return Err(SceneError::NoSuchRobot { index: arm.robot.0, count }.into());
        }
        let held = state.q(arm.robot);
        validate(arm, held.len())?;
        let whole: Vec<Vec<f64>> = waypoints.iter().map(|q| all_joint_values(held, arm, *q)).collect();
        // The sweep begins at the state: set it to the first waypoint.
        let Some(first) = whole.first() else { return Ok(()) };
        let mut start = state.clone();
        start.set_q(checker.scene(), arm.robot, first)?;
        match checker.sweep_path(&start, arm.robot, &whole, options)? {
            None => Ok(()),
            Some((waypoint, hit)) => Err(collision_error(waypoints, waypoint, &hit, |m| checker.scene().name(m))),
        }
    }
}

fn validate(arm: MappedJoints, dof: usize) -> Result<(), CheckError> {
    let joints = arm.joints;
    let bad = (0..3).find(|&i| joints[i] >= dof || joints[..i].contains(&joints[i]));
    bad.map_or(Ok(()), |map| Err(CheckError::Joint { map, joint: joints[map], dof }))
}

fn all_joint_values(held: &[f64], arm: MappedJoints, q: [f64; 3]) -> Vec<f64> {
    let mut all = held.to_vec();
    (0..3).for_each(|i| all[arm.joints[i]] = q[i]);
    all
}

fn collision_error(
    waypoints: &[[f64; 3]],
    waypoint: usize,
    hit: &SweepHit,
    name: impl Fn(GeometryId) -> String,
) -> CheckError {
    let (from, to) = (waypoints[waypoint.saturating_sub(1)], waypoints[waypoint]);
    CheckError::Collision {
        waypoint,
        share: hit.time,
        q: [0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * hit.time),
        a: name(hit.a),
        b: name(hit.b),
        metres: hit.metres,
        certain: hit.certain,
    }
}
