//! Names of a robot's joints in messages.

use std::collections::{HashMap, HashSet};

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_ros2::rmw_zenoh::ros_name;

use super::input_error::RosInputError;
use super::settings::Ros2Robot;

/// The joints of one robot by the names that messages on its topic may use: the name in its model, alone or after the
/// name of the robot and `_` or `/`.
#[derive(Debug, Clone)]
pub(super) struct JointNames {
    /// Joint names in the order of the chain.
    joints: Vec<String>,
    indices: HashMap<String, usize>,
    /// Joint names of other robots with the same topic.
    others: HashSet<String>,
    /// Names that this robot shares with another one of the topic.
    ambiguous: HashSet<String>,
}

impl JointNames {
    /// Creates the names for one of the robots whose controllers use ROS 2.
    pub(super) fn new(cell: &Cell, robot: &Ros2Robot, all: &[Ros2Robot]) -> Self {
        let joints = joints_of(cell, &robot.robot);
        let indices: HashMap<String, usize> = names(&robot.robot, &joints).collect();
        let neighbours = all.iter().filter(|r| r.robot != robot.robot && r.joint_states == robot.joint_states);
        let others: HashSet<String> = neighbours
            .flat_map(|r| names(&r.robot, &joints_of(cell, &r.robot)).map(|(name, _)| name).collect::<Vec<_>>())
            .collect();
        let ambiguous = indices.keys().filter(|name| others.contains(*name)).cloned().collect();
        Self { joints, indices, others, ambiguous }
    }

    /// Sorts the values of the robot's joints into the order of the chain.
    ///
    /// `values` has one value per name, or is empty; then `sorted` is too.
    pub(super) fn sort(&self, places: &[Option<usize>], values: &[f64], sorted: &mut Vec<f64>) {
        sorted.clear();
        if !values.is_empty() {
            sorted.resize(self.joints.len(), f64::NAN);
            for (place, value) in places.iter().zip(values) {
                if let Some(place) = place {
                    sorted[*place] = *value;
                }
            }
        }
    }

    /// Finds the index of the robot's joint for each name; `None` for joints of other robots.
    ///
    /// Every joint of the robot must occur once.
    pub(super) fn places(&self, names: &[String], places: &mut Vec<Option<usize>>) -> Result<(), RosInputError> {
        places.clear();
        for name in names {
            let place = match self.indices.get(name) {
                Some(_) if self.ambiguous.contains(name) => return Err(RosInputError::Ambiguous(shown(name))),
                None if !self.others.contains(name) => return Err(RosInputError::Unknown(shown(name))),
                place => place.copied(),
            };
            if place.is_some() && places.contains(&place) {
                return Err(RosInputError::Twice(shown(name)));
            }
            places.push(place);
        }
        match (0..self.joints.len()).find(|joint| !places.contains(&Some(*joint))) {
            Some(missing) => Err(RosInputError::Missing(self.joints[missing].clone())),
            None => Ok(()),
        }
    }
}

/// Shortens a name for a line of text.
fn shown(name: &str) -> String {
    name.chars().take(60).collect()
}

fn joints_of(cell: &Cell, robot: &str) -> Vec<String> {
    cell.robots.iter().find(|r| r.name == robot).map(CellRobot::joint_names).unwrap_or_default()
}

/// Names of the joints of a robot, with and without the robot's name.
fn names<'a>(robot: &'a str, joints: &'a [String]) -> impl Iterator<Item = (String, usize)> + 'a {
    joints.iter().enumerate().flat_map(move |(i, joint)| {
        [joint.clone(), format!("{}_{joint}", ros_name(robot)), format!("{robot}/{joint}")].map(|name| (name, i))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell() -> Cell {
        let robot = |name: &str| {
            format!(
                "[robot.{name}]\ndh = [{{ kind = \"prismatic\", min = 0, max = 2000, speed = 1000 }}, \
                 {{ kind = \"revolute\", min = -90, max = 90, speed = 90 }}]\n"
            )
        };
        let text =
            format!("version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n{}{}", robot("left"), robot("right"));
        Cell::parse("two.toml", &text).unwrap()
    }

    fn names_of(topics: [&str; 2]) -> (JointNames, Vec<String>) {
        let cell = cell();
        let robots = ["left", "right"].map(|robot| {
            let topic = topics[usize::from(robot == "right")];
            format!("{robot}={topic}").parse::<Ros2Robot>().unwrap()
        });
        (JointNames::new(&cell, &robots[0], &robots), cell.robots[0].joint_names())
    }

    fn sorted(names: &JointNames, given: &[&str]) -> Result<Vec<f64>, RosInputError> {
        let given: Vec<String> = given.iter().map(|name| (*name).to_owned()).collect();
        let values: Vec<f64> = (0..given.len()).map(|i| i as f64).collect();
        let (mut places, mut sorted) = (Vec::new(), Vec::new());
        names.places(&given, &mut places)?;
        names.sort(&places, &values, &mut sorted);
        Ok(sorted)
    }

    #[test]
    fn values_are_put_in_the_order_of_the_chain() {
        let (names, joints) = names_of(["/a", "/b"]);
        let [first, second] = [&joints[0][..], &joints[1][..]];
        assert_eq!(sorted(&names, &[first, second]), Ok(vec![0.0, 1.0]));
        assert_eq!(sorted(&names, &[second, first]), Ok(vec![1.0, 0.0]));
        let prefixed = [format!("left_{second}"), format!("left/{first}")];
        assert_eq!(sorted(&names, &[&prefixed[0], &prefixed[1]]), Ok(vec![1.0, 0.0]));
        assert_eq!(sorted(&names, &[first]), Err(RosInputError::Missing(second.into())));
        assert_eq!(sorted(&names, &[first, second, "finger"]), Err(RosInputError::Unknown("finger".into())));
        assert_eq!(sorted(&names, &[first, second, first]), Err(RosInputError::Twice(first.into())));
        let again = format!("left_{first}");
        assert_eq!(sorted(&names, &[first, second, &again]), Err(RosInputError::Twice(again.clone())));
        // Of a robot that has another topic.
        let other = format!("right_{first}");
        assert_eq!(sorted(&names, &[first, second, &other]), Err(RosInputError::Unknown(other.clone())));
    }

    #[test]
    fn robots_of_one_topic_are_known_by_their_names() {
        let (names, joints) = names_of(["/joint_states", "/joint_states"]);
        let of = |robot: &str, joint: usize| format!("{robot}_{}", joints[joint]);
        let all = [of("right", 0), of("left", 1), of("right", 1), of("left", 0)];
        assert_eq!(sorted(&names, &all.each_ref().map(String::as_str)), Ok(vec![3.0, 1.0]));
        assert_eq!(sorted(&names, &[&joints[0], &joints[1]]), Err(RosInputError::Ambiguous(joints[0].clone())));
    }
}
