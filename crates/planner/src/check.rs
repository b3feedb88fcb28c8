//! The last word: a path in the exact scene, continuously.

use elbowroom_scene::{Checker, Impact, Member, SceneError, SceneState, SweepOptions};

use crate::path::Path;

/// Which joints of which robot the map's three are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MappedJoints {
    /// Index of the robot in the scene.
    pub robot: usize,
    /// Places of the map's joints among the robot's joint values.
    pub joints: [usize; 3],
}

/// Why a path is not accepted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CheckError {
    /// Something is too near on the way.
    #[error(
        "the path is free in the map and not in the scene: on the way to waypoint {waypoint}, {share:.3} of the leg gone, at {q:?} rad, `{a}` and `{b}` are {metres} m apart{}: is the map that of this scene?",
        if *.certain { "" } else { " and no more could be proven" }
    )]
    Impact {
        /// The waypoint that was being gone to; 0: the first one itself.
        waypoint: usize,
        /// How much of the leg was gone: free until there.
        share: f64,
        /// The map's joints there, radians.
        q: [f64; 3],
        /// Name of one member.
        a: String,
        /// Name of the other.
        b: String,
        /// Distance of the two at that time less the pair's margin, metres.
        metres: f64,
        /// False where the proof ended without a contact.
        certain: bool,
    },
    /// A joint of the map is none of the robot's.
    #[error(
        "the map's joint {map} is said to be value {joint} of a robot that has {dof}: name each joint once, counted from 0"
    )]
    Joint {
        /// Number of the joint in the map.
        map: usize,
        /// Where it was said to be.
        joint: usize,
        /// The robot's number of joint values.
        dof: usize,
    },
    /// A waypoint that the scene refuses, or a robot that it does not have.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl Path {
    /// Proves that no pair of the scene comes too near on the way, the robot's other joints held as in `state`.
    ///
    /// The legs are the straight ones between waypoints. Where a motion rounds corners, give [`Path::check_through`] points
    /// of the motion.
    ///
    /// ```
    /// use elbowroom_planner::{CheckError, MappedJoints, Path};
    /// use elbowroom_scene::{Checker, Options, SceneState, SweepOptions, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, 0, &[-0.9, 1.3, 0.6])?;
    /// let mut checker = Checker::new(&scene, Options::default());
    /// let path = |waypoints: &[[f64; 3]]| {
    ///     Path { waypoints: waypoints.to_vec(), length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 }
    /// };
    /// let arm = MappedJoints { robot: 0, joints: [0, 1, 2] };
    /// let over = path(&[[-0.9, 1.3, 0.6], [-0.9, 0.2, 0.6], [0.9, 0.2, 0.6], [0.9, 1.3, 0.6]]);
    /// assert!(over.check(&mut checker, &state, arm, &SweepOptions::default()).is_ok());
    /// let through = path(&[[-0.9, 1.3, 0.6], [0.9, 1.3, 0.6]]);
    /// let error = through.check(&mut checker, &state, arm, &SweepOptions::default()).unwrap_err();
    /// assert!(matches!(error, CheckError::Impact { waypoint: 1, .. }), "{error}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Something is too near, or more could not be proven within the steps that `options` allow; joints or waypoints that
    /// are not the robot's.
    pub fn check(
        &self,
        checker: &mut Checker,
        state: &SceneState,
        arm: MappedJoints,
        options: &SweepOptions,
    ) -> Result<(), CheckError> {
        Self::check_through(&self.waypoints, checker, state, arm, options)
    }

    /// The same along any points (radians), straight from each to the next.
    ///
    /// # Errors
    /// As [`Path::check`].
    pub fn check_through(
        waypoints: &[[f64; 3]],
        checker: &mut Checker,
        state: &SceneState,
        arm: MappedJoints,
        options: &SweepOptions,
    ) -> Result<(), CheckError> {
        let count = checker.scene().robots().len();
        if arm.robot >= count {
            return Err(SceneError::NoSuchRobot { index: arm.robot, count }.into());
        }
        let held = state.q(arm.robot);
        validate(arm, held.len())?;
        let whole: Vec<Vec<f64>> = waypoints.iter().map(|q| filled(held, arm, *q)).collect();
        // The sweep's first leg is from where the state is: that is not on the path.
        let Some(first) = whole.first() else { return Ok(()) };
        let mut start = state.clone();
        start.set_q(checker.scene(), arm.robot, first)?;
        match checker.sweep_path(&start, arm.robot, &whole, options)? {
            None => Ok(()),
            Some((waypoint, hit)) => Err(impact(waypoints, waypoint, &hit, |m| checker.scene().name(m))),
        }
    }
}

fn validate(arm: MappedJoints, dof: usize) -> Result<(), CheckError> {
    let joints = arm.joints;
    let bad = (0..3).find(|&i| joints[i] >= dof || joints[..i].contains(&joints[i]));
    bad.map_or(Ok(()), |map| Err(CheckError::Joint { map, joint: joints[map], dof }))
}

fn filled(held: &[f64], arm: MappedJoints, q: [f64; 3]) -> Vec<f64> {
    let mut all = held.to_vec();
    (0..3).for_each(|i| all[arm.joints[i]] = q[i]);
    all
}

fn impact(waypoints: &[[f64; 3]], waypoint: usize, hit: &Impact, name: impl Fn(Member) -> String) -> CheckError {
    let (from, to) = (waypoints[waypoint.saturating_sub(1)], waypoints[waypoint]);
    CheckError::Impact {
        waypoint,
        share: hit.time,
        q: [0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * hit.time),
        a: name(hit.a),
        b: name(hit.b),
        metres: hit.metres,
        certain: hit.certain,
    }
}
