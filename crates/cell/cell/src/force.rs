//! Forces between guided tools and their surroundings.

use elbowroom_robot::ObjectId;
use elbowroom_shared_control::force::{BodySettings, ForceLaw, ImpedanceSettings};

use crate::FixtureTool;

/// A force: `[force.NAME]`.
#[derive(Debug, Clone)]
pub struct CellForce {
    /// Its name.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// The guided tool.
    pub tool: FixtureTool,
    /// Whether it acts on the whole arm, and not on the tool alone.
    pub whole_arm: bool,
    /// What it is between, besides the tool or the arm.
    pub other: ForceOther,
    /// What the hand feels, and how the tool answers.
    pub response: ForceResponse,
    /// The repulsion; `None` if there is none.
    pub field: Option<ForceLaw>,
}

/// The other side of a force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceOther {
    /// An object.
    Object(ObjectId),
    /// The shield of a fixture, by its index in [`Guidance::fixtures`](crate::Guidance::fixtures).
    Shield(usize),
}

/// How a tool answers to forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ForceResponse {
    /// As other forces of the tool say; a virtual mass if none does.
    Field,
    /// Force in, motion out: a virtual mass.
    Admittance(BodySettings),
    /// Motion in, force out: a spring between hand and tool.
    Impedance(ImpedanceSettings),
}
