//! The keys under which a cell's messages are published.

/// The keys of a cell: `elbowroom/CELL/ROBOT/…`.
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
    /// The keys of the cell of this name. What a key may not have (`/ * $ ? #`) is written as `_`.
    pub fn new(cell: &str) -> Self {
        Self { cell: chunk(cell) }
    }

    /// From the controller: [`JointState`](crate::messages::JointState).
    pub fn joint_states(&self, robot: &str) -> String {
        self.of(robot, "joint_states")
    }

    /// To the controller: [`OverrideAnswer`](crate::messages::OverrideAnswer).
    pub fn speed_override(&self, robot: &str) -> String {
        self.of(robot, "override")
    }

    /// For everybody: [`RobotStatus`](elbowroom_status::RobotStatus) as JSON.
    pub fn status(&self, robot: &str) -> String {
        self.of(robot, "status")
    }

    /// That a process is about to guard a robot: when it started, nanoseconds since 1970 as eight bytes, the least first, and whether it has the robot by now.
    pub fn claim(&self, robot: &str) -> String {
        self.of(robot, "claim")
    }

    /// From the guard of a robot to the arbiter.
    pub fn interlock_state(&self, robot: &str) -> String {
        self.of(robot, "interlock/state")
    }

    /// From the arbiter to the guard of a robot.
    pub fn interlock_grants(&self, robot: &str) -> String {
        self.of(robot, "interlock/grants")
    }

    /// That a process guards a robot: a token of Zenoh's liveliness, without messages.
    pub fn presence(&self, robot: &str) -> String {
        format!("elbowroom/{}/present/robots/{}", self.cell, chunk(robot))
    }

    /// That the arbiter is there.
    pub fn presence_of_arbiter(&self) -> String {
        format!("elbowroom/{}/present/arbiter", self.cell)
    }

    /// Everybody who is there.
    pub fn presences(&self) -> String {
        format!("elbowroom/{}/present/**", self.cell)
    }

    /// With what all keys of the cell begin.
    pub fn prefix(&self) -> String {
        format!("elbowroom/{}", self.cell)
    }

    /// Pictures or clouds of a sensor: each message is one, as in a file.
    pub fn frames(&self, sensor: &str) -> String {
        format!("elbowroom/{}/sensor/{}/frames", self.cell, chunk(sensor))
    }

    /// Which regions are switched on, from the arbiter's process: JSON.
    pub fn regions(&self) -> String {
        format!("elbowroom/{}/regions", self.cell)
    }

    /// A request to switch a region: JSON.
    pub fn switch(&self) -> String {
        format!("elbowroom/{}/switch", self.cell)
    }

    /// Who holds and waits for exchange regions, from the arbiter: JSON.
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
