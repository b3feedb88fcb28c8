//! Settings of a process for ROS 2.

use std::str::FromStr;

use elbowroom_cell::Cell;
use elbowroom_ros2::rmw_zenoh::{Distribution, ros_name};
use thiserror::Error;

use crate::network::{NetworkError, endpoint};

/// Default address of the ROS 2 router.
const DEFAULT_ROUTER: &str = "127.0.0.1:7447";

/// Prefix of the cell's topics, except for topics whose names ROS 2 defines.
const OWN: &str = "/elbowroom/";

/// Settings of a process for ROS 2; by default it does not participate.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Ros2Settings {
    /// Publishes the topics of the cell, and the speed scaling of each robot that this process guards.
    pub publish: bool,
    /// Robots whose controllers use ROS 2.
    pub robots: Vec<Ros2Robot>,
    /// The domain, as in `ROS_DOMAIN_ID`.
    pub domain: u32,
    /// The release of ROS 2.
    pub distribution: Distribution,
    /// The router that the sessions of ROS 2 connect to; 127.0.0.1:7447 if none is given.
    pub router: Option<String>,
}

/// A robot whose controller uses ROS 2, and its topics.
///
/// ```
/// use elbowroom_live::ros2::Ros2Robot;
/// let robot: Ros2Robot = "left=/joint_states,/left_controller/speed_scaling_input".parse()?;
/// assert_eq!((&robot.robot[..], &robot.joint_states[..]), ("left", "/joint_states"));
/// assert_eq!("left".parse::<Ros2Robot>()?.speed_scaling, "/left/speed_scaling_input");
/// assert!("left=joint states".parse::<Ros2Robot>().unwrap_err().to_string().contains("joint states"));
/// # Ok::<(), elbowroom_live::ros2::Ros2Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ros2Robot {
    /// The robot's name in the cell file.
    pub robot: String,
    /// `sensor_msgs/JointState`, from the controller.
    pub joint_states: String,
    /// `control_msgs/SpeedScalingFactor`, to the controller.
    pub speed_scaling: String,
    /// `control_msgs/JointTrajectoryControllerState`, from the controller: the intent.
    pub controller_state: String,
}

/// Why a text is not ROBOT or ROBOT=TOPICS.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RobotArgumentError {
    /// Nothing is before the `=`.
    #[error("the name of the robot is missing")]
    NoName,
    /// More than three topics.
    #[error("at most three topics")]
    ManyTopics,
    /// ROS 2 has no topic of this name.
    #[error("{0} is no name of a topic: letters, digits and underscores between slashes")]
    NoTopic(String),
    /// The service would receive its own messages.
    #[error("{0} is published by the service itself")]
    OwnTopic(String),
}

/// Why the settings for ROS 2 cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Ros2Error {
    /// The text is not ROBOT or ROBOT=TOPICS.
    #[error(
        "--ros2-robot {0}: {1}\n  help: write ROBOT=JOINT_STATES,SPEED_SCALING[,CONTROLLER_STATE], such as \
         left=/joint_states,/left_controller/speed_scaling_input; ROBOT alone is /ROBOT/joint_states, \
         /ROBOT/speed_scaling_input, /ROBOT/controller_state"
    )]
    Robot(String, RobotArgumentError),
    /// The cell has no robot of this name.
    #[error("--ros2-robot {name}: no robot of the cell has this name\n  help: one of {}", known.join(", "))]
    Unknown {
        /// The unknown name.
        name: String,
        /// Names of the cell's robots.
        known: Vec<String>,
    },
    /// A robot is named twice, or two robots have one topic for their speed scaling.
    #[error("--ros2-robot: {0} is named twice: each robot once, and each with a speed_scaling_input of its own")]
    Twice(String),
    /// The address of the router cannot be used.
    #[error("--ros2-router: {0}")]
    Router(#[from] NetworkError),
}

impl Ros2Robot {
    /// Creates the entry of a robot with the topics of its name: `/ROBOT/joint_states` and so on.
    pub fn of(robot: &str) -> Self {
        let topic = |what: &str| format!("/{}/{what}", ros_name(robot));
        Self {
            robot: robot.to_owned(),
            joint_states: topic("joint_states"),
            speed_scaling: topic("speed_scaling_input"),
            controller_state: topic("controller_state"),
        }
    }
}

impl FromStr for Ros2Robot {
    type Err = Ros2Error;

    fn from_str(text: &str) -> Result<Self, Ros2Error> {
        let wrong = |why: RobotArgumentError| Ros2Error::Robot(text.to_owned(), why);
        let (robot, topics) = text.split_once('=').map_or((text, None), |(robot, topics)| (robot, Some(topics)));
        if robot.is_empty() {
            return Err(wrong(RobotArgumentError::NoName));
        }
        let mut settings = Self::of(robot);
        let given: Vec<&str> = topics.map(|topics| topics.split(',').collect()).unwrap_or_default();
        let places = [&mut settings.joint_states, &mut settings.speed_scaling, &mut settings.controller_state];
        if given.len() > places.len() {
            return Err(wrong(RobotArgumentError::ManyTopics));
        }
        for (place, topic) in places.into_iter().zip(given) {
            let topic = format!("/{}", topic.strip_prefix('/').unwrap_or(topic));
            check_topic(&topic).map_err(wrong)?;
            *place = topic;
        }
        Ok(settings)
    }
}

/// Checks a topic by the rules of ROS 2 for absolute names; refuses the service's own topics, so that it never receives
/// its own messages.
fn check_topic(topic: &str) -> Result<(), RobotArgumentError> {
    let is_part = |part: &str| {
        part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && part.starts_with(|c: char| !c.is_ascii_digit())
    };
    if !topic.split('/').skip(1).all(is_part) {
        return Err(RobotArgumentError::NoTopic(topic.to_owned()));
    }
    if topic.starts_with(OWN) {
        return Err(RobotArgumentError::OwnTopic(topic.to_owned()));
    }
    Ok(())
}

impl Ros2Settings {
    /// Whether the process participates in ROS 2.
    pub fn is_used(&self) -> bool {
        self.publish || !self.robots.is_empty()
    }

    /// The address of the router.
    pub fn router(&self) -> &str {
        self.router.as_deref().unwrap_or(DEFAULT_ROUTER)
    }

    /// The entry of a robot whose controller uses ROS 2.
    pub fn robot(&self, name: &str) -> Option<&Ros2Robot> {
        self.robots.iter().find(|robot| robot.robot == name)
    }

    /// Checks the settings against a cell.
    ///
    /// # Errors
    /// The setting that cannot be used, and what to write instead.
    pub fn check(&self, cell: &Cell) -> Result<(), Ros2Error> {
        endpoint(self.router())?;
        for (i, robot) in self.robots.iter().enumerate() {
            if !cell.robots.iter().any(|r| r.name == robot.robot) {
                let known = cell.robots.iter().map(|r| r.name.clone()).collect();
                return Err(Ros2Error::Unknown { name: robot.robot.clone(), known });
            }
            if let Some(other) = self.robots[..i].iter().find(|other| other.robot == robot.robot) {
                return Err(Ros2Error::Twice(other.robot.clone()));
            }
            if let Some(other) = self.robots[..i].iter().find(|other| other.speed_scaling == robot.speed_scaling) {
                return Err(Ros2Error::Twice(other.speed_scaling.clone()));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_that_cannot_be_used_are_refused_with_a_help() {
        for text in [
            "",
            "=/a",
            "left=/a//b",
            "left=/a b",
            "left=/2nd",
            "left=/a,",
            "left=/a,/b,/c,/d",
            "left=/elbowroom/joint_states",
        ] {
            let message = text.parse::<Ros2Robot>().unwrap_err().to_string();
            assert!(message.contains("help: write ROBOT=JOINT_STATES"), "{text}: {message}");
        }
        let robot: Ros2Robot = "2nd arm=joint_states".parse().unwrap();
        assert_eq!(
            (&robot.joint_states[..], &robot.speed_scaling[..]),
            ("/joint_states", "/_2nd_arm/speed_scaling_input")
        );
    }

    #[test]
    fn robots_that_there_are_not_and_robots_named_twice_are_refused() {
        let text = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n[robot.rail]\n\
                    dh = [{ kind = \"prismatic\", min = 0, max = 2000, speed = 1000 }]\n";
        let cell = Cell::parse("rail.toml", text).unwrap();
        let settings = |robots: &[&str]| Ros2Settings {
            robots: robots.iter().map(|r| r.parse().unwrap()).collect(),
            ..Ros2Settings::default()
        };
        assert!(settings(&["rail"]).check(&cell).is_ok());
        assert!(settings(&["arm"]).check(&cell).unwrap_err().to_string().contains("help: one of rail"));
        assert!(settings(&["rail", "rail=/a,/b"]).check(&cell).unwrap_err().to_string().contains("named twice"));
        let wrong = Ros2Settings { router: Some("7447".into()), ..settings(&[]) };
        assert!(wrong.check(&cell).unwrap_err().to_string().contains("--ros2-router: 7447"));
    }
}
