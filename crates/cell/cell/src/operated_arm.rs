//! The arm of an operator, with the fixtures of its tool.

use elbowroom_robot::{GeometryId, ObjectId};
use elbowroom_shared_control::{ArmLimit, GuidedArm};

use crate::{Cell, CellFixture, CellGuide, CellOperator, FixtureRef};

/// What a surface along which a tool glides belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SurfaceOwner {
    Object(ObjectId),
    /// Index of the fixture.
    Shield(usize),
}

/// The fixtures of a tool that are on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FixturesOn {
    /// Per fixture that protects.
    shields: Vec<bool>,
    /// The guide that is on.
    guide: Option<usize>,
}

impl FixturesOn {
    /// Those that an operator wants to be on at the start.
    pub fn at_start(cell: &Cell, operator: &CellOperator) -> Self {
        let mut on = Self { shields: vec![false; cell.guidance.fixtures.len()], guide: None };
        on.set(cell, operator, f64::NEG_INFINITY);
        on
    }

    /// Makes them those that an operator wants to be on at a time, s.
    fn set(&mut self, cell: &Cell, operator: &CellOperator, t_s: f64) {
        let CellOperator { tool, switches, .. } = operator;
        for (index, (is_on, f)) in self.shields.iter_mut().zip(&cell.guidance.fixtures).enumerate() {
            *is_on = f.tool == Some(*tool) && switches.is_on(FixtureRef::Shield(index), f.active, t_s);
        }
        let is_on = |(index, g): (usize, &CellGuide)| {
            g.tool == *tool && switches.is_on(FixtureRef::Guide(index), g.active, t_s)
        };
        self.guide = cell.guidance.guides.iter().enumerate().position(is_on);
    }

    /// Whether the tool keeps off a surface: a shield that is on takes the place of its object.
    pub fn keep_off(&self, cell: &Cell, surface: SurfaceOwner) -> bool {
        let protects = |(f, is_on): (&CellFixture, &bool)| *is_on && surface == SurfaceOwner::Object(f.protects);
        match surface {
            SurfaceOwner::Shield(index) => self.shields[index],
            SurfaceOwner::Object(_) => !cell.guidance.fixtures.iter().zip(&self.shields).any(protects),
        }
    }

    /// The index of the guide that is on.
    pub fn guide(&self) -> Option<usize> {
        self.guide
    }
}

/// The arm that an operator guides, and what its fixtures do.
#[derive(Debug)]
pub struct OperatedArm<'s> {
    /// The arm.
    pub arm: GuidedArm<'s>,
    pub(crate) surfaces: Vec<SurfaceOwner>,
    pub(crate) on: FixturesOn,
    /// Those that the operator wants to be on.
    pub(crate) wanted: FixturesOn,
    /// Per fixture that protects, whether its change was refused last.
    pub(crate) refused: Vec<bool>,
}

/// What became of a switch of fixtures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FixtureChange {
    /// The fixture is on.
    On,
    /// The fixture is off.
    Off,
    /// The tool is too near to what would protect then; it is tried again.
    Refused,
}

impl CellOperator {
    /// The name of what keeps the arm from following: a joint, or the other one of two parts that would touch; `None` for other
    /// limits.
    pub fn limited_by(&self, cell: &Cell, limit: ArmLimit) -> Option<String> {
        match limit {
            ArmLimit::JointSpeed(joint) => cell.robots[self.robot.0].joint_names().get(joint).cloned(),
            ArmLimit::Contact(a, b) => {
                let is_own = |part: &GeometryId| matches!(part, GeometryId::Link { robot, .. } if *robot == self.robot);
                Some(cell.part_name(if is_own(&a) { b } else { a }))
            }
            _ => None,
        }
    }
}

impl OperatedArm<'_> {
    /// Switches the fixtures as the stream wants it at a time (s): all shields that change at once, and the guide. Reports each
    /// that changes or is refused, with its name.
    pub fn switch(
        &mut self,
        cell: &Cell,
        operator: &CellOperator,
        t_s: f64,
        mut report: impl FnMut(&str, FixtureChange),
    ) {
        if operator.switches.is_empty() {
            return;
        }
        self.wanted.set(cell, operator, t_s);
        self.switch_guide(cell, &mut report);
        let Self { arm, surfaces, on, wanted, refused } = self;
        let changes = wanted.shields != on.shields;
        let is_refused = changes && arm.switch(|index| wanted.keep_off(cell, surfaces[index])).is_err();
        for (index, fixture) in cell.guidance.fixtures.iter().enumerate() {
            let (before, after) = (on.shields[index], wanted.shields[index]);
            let was_refused = std::mem::replace(&mut refused[index], is_refused && before != after);
            if refused[index] && !was_refused {
                report(&fixture.name, FixtureChange::Refused);
            } else if !is_refused && before != after {
                report(&fixture.name, if after { FixtureChange::On } else { FixtureChange::Off });
            }
        }
        if !is_refused {
            on.shields.copy_from_slice(&wanted.shields);
        }
    }

    fn switch_guide(&mut self, cell: &Cell, report: &mut impl FnMut(&str, FixtureChange)) {
        let (guides, wanted) = (&cell.guidance.guides, self.wanted.guide);
        let before = std::mem::replace(&mut self.on.guide, wanted);
        if before == wanted {
            return;
        }
        for (index, change) in [(before, FixtureChange::Off), (wanted, FixtureChange::On)] {
            if let Some(index) = index {
                report(&guides[index].name, change);
            }
        }
        self.arm.set_guide(wanted.map(|index| guides[index].guide.clone()));
    }
}
