//! What an SRDF says.

use crate::Warning;

/// The content of an SRDF, in the file's order.
#[derive(Debug, Clone, Default)]
pub struct Srdf {
    /// Name of the robot, where it is stated.
    pub robot: Option<String>,
    /// Groups of joints and links.
    pub groups: Vec<Group>,
    /// Named states of groups.
    pub states: Vec<GroupState>,
    /// Groups that are the tools of links.
    pub end_effectors: Vec<EndEffector>,
    /// Joints between the world and the robot.
    pub virtual_joints: Vec<VirtualJoint>,
    /// Joints that are not actuated.
    pub passive_joints: Vec<String>,
    /// Pairs of links that are not tested.
    pub disabled: Vec<DisabledPair>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// One `<group>`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// Names of links.
    pub links: Vec<String>,
    /// Names of joints.
    pub joints: Vec<String>,
    /// Chains, each from its base link to its tip link.
    pub chains: Vec<[String; 2]>,
    /// Names of other groups.
    pub subgroups: Vec<String>,
}

/// One `<group_state>`: values of the joints of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupState {
    /// Its name. States of several groups may share one.
    pub name: String,
    /// The group.
    pub group: String,
    /// Joints and their values, rad or m.
    pub values: Vec<(String, f64)>,
}

/// One `<end_effector>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EndEffector {
    /// Its name.
    pub name: String,
    /// The group of its links.
    pub group: String,
    /// The link that carries it.
    pub parent_link: String,
    /// The group of that link, where it is stated.
    pub parent_group: Option<String>,
}

/// One `<virtual_joint>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VirtualJoint {
    /// Its name.
    pub name: String,
    /// `fixed`, `planar` or `floating`.
    pub kind: String,
    /// The frame that it is in.
    pub parent_frame: String,
    /// The root link of the robot.
    pub child_link: String,
}

/// One `<disable_collisions>`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DisabledPair {
    /// The first link.
    pub link1: String,
    /// The second link.
    pub link2: String,
    /// The reason as written; empty if none is stated.
    pub reason: String,
    /// Its line in the file; 0 for one that is written.
    pub line: usize,
}
