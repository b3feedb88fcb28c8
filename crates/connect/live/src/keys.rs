//! Keys under which a cell's messages are published.

/// Keys of a cell: `elbowroom/CELL/ROBOT/…`.
///
/// ```
/// let keys = elbowroom_live::Keys::new("welding column");
/// assert_eq!(keys.status("left"), "elbowroom/welding column/left/status");
/// assert_eq!(elbowroom_live::Keys::new("a/b*").regions(), "elbowroom/a_b_/regions");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Keys {
    cell: String,
}

impl Keys {
    /// Creates the keys of the cell of this name. Characters that a key cannot contain (`/ * $ ? #`) become `_`.
    pub fn new(cell: &str) -> Self {
        Self { cell: chunk(cell) }
    }

    /// Joint states from the controller: [`JointState`](crate::messages::JointState).
    pub fn joint_states(&self, robot: &str) -> String {
        self.of(robot, "joint_states")
    }

    /// Overrides to the controller: [`OverrideAnswer`](crate::messages::OverrideAnswer).
    pub fn speed_override(&self, robot: &str) -> String {
        self.of(robot, "override")
    }

    /// Status of a robot, for all subscribers: [`RobotStatus`](elbowroom_status::RobotStatus) as JSON.
    pub fn status(&self, robot: &str) -> String {
        self.of(robot, "status")
    }

    /// Claim of a process that is about to guard a robot: its start time (nanoseconds since 1970, `u64`, little-endian)
    /// and a byte that says whether it has the robot by now.
    pub fn claim(&self, robot: &str) -> String {
        self.of(robot, "claim")
    }

    /// Interlock state, from the guard of a robot to the arbiter.
    pub fn interlock_state(&self, robot: &str) -> String {
        self.of(robot, "interlock/state")
    }

    /// Grants, from the arbiter to the guard of a robot.
    pub fn interlock_grants(&self, robot: &str) -> String {
        self.of(robot, "interlock/grants")
    }

    /// Presence of the process that guards a robot: a Zenoh liveliness token, without messages.
    pub fn presence(&self, robot: &str) -> String {
        format!("elbowroom/{}/present/robots/{}", self.cell, chunk(robot))
    }

    /// Presence of the arbiter.
    pub fn presence_of_arbiter(&self) -> String {
        format!("elbowroom/{}/present/arbiter", self.cell)
    }

    /// All presences of the cell.
    pub fn presences(&self) -> String {
        format!("elbowroom/{}/present/**", self.cell)
    }

    /// Prefix of all keys of the cell.
    pub fn prefix(&self) -> String {
        format!("elbowroom/{}", self.cell)
    }

    /// Pictures or clouds of a sensor: each message is one, as in a file.
    pub fn frames(&self, sensor: &str) -> String {
        format!("elbowroom/{}/sensor/{}/frames", self.cell, chunk(sensor))
    }

    /// Travel of a measured encoder: [`JointState`](crate::messages::JointState) of one position, m.
    pub fn encoder(&self, name: &str) -> String {
        format!("elbowroom/{}/encoder/{}/travel", self.cell, chunk(name))
    }

    /// Pose of a measured object: [`JointState`](crate::messages::JointState) of seven positions, x, y, z (m) and the quaternion x, y, z, w, or thirteen with
    /// velocity (m/s) and angular velocity (rad/s).
    pub fn object(&self, name: &str) -> String {
        format!("elbowroom/{}/object/{}/pose", self.cell, chunk(name))
    }

    /// Table of the regions and whether they are on, from the arbiter's process: JSON.
    pub fn regions(&self) -> String {
        format!("elbowroom/{}/regions", self.cell)
    }

    /// Request to switch a region: JSON.
    pub fn switch(&self) -> String {
        format!("elbowroom/{}/switch", self.cell)
    }

    /// Holder and queue of each exchange region, from the arbiter: JSON.
    pub fn interlocks(&self) -> String {
        format!("elbowroom/{}/interlocks", self.cell)
    }

    fn of(&self, robot: &str, what: &str) -> String {
        format!("elbowroom/{}/{}/{what}", self.cell, chunk(robot))
    }
}

fn chunk(name: &str) -> String {
    let allowed = name.replace(['/', '*', '$', '?', '#'], "_");
    if allowed.is_empty() { "_".to_owned() } else { allowed }
}
