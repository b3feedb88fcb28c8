//! Content of an SRDF.

use crate::Diagnostic;

/// The content of an SRDF, in the order of the file.
#[derive(Debug, Clone, Default)]
pub struct Srdf {
    /// Name of the robot, if stated.
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
    /// Disabled pairs of links, which are not tested.
    pub disabled: Vec<DisabledPair>,
    /// Warnings for the user.
    pub warnings: Vec<Diagnostic>,
}

/// One `<group>`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Group {
    /// Name of the group.
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
    /// Name of the state. States of several groups may share a name.
    pub name: String,
    /// Name of the group.
    pub group: String,
    /// Joints and their values, rad or m.
    pub values: Vec<(String, f64)>,
}

/// One `<end_effector>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EndEffector {
    /// Name of the end effector.
    pub name: String,
    /// Group of its links.
    pub group: String,
    /// Link that carries it.
    pub parent_link: String,
    /// Group of that link, if stated.
    pub parent_group: Option<String>,
}

/// One `<virtual_joint>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VirtualJoint {
    /// Name of the joint.
    pub name: String,
    /// `fixed`, `planar` or `floating`.
    pub kind: String,
    /// Name of the parent frame.
    pub parent_frame: String,
    /// Root link of the robot.
    pub child_link: String,
}

/// One `<disable_collisions>`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DisabledPair {
    /// First link.
    pub link1: String,
    /// Second link.
    pub link2: String,
    /// Reason as written; empty if not stated.
    pub reason: String,
    /// Line in the file; 0 for a pair that was not read from a file.
    pub line: usize,
}
