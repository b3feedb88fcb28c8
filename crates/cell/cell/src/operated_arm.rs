//! The arm of an operator, with the fixtures of its tool.

use elbowroom_robot::ObjectId;
use elbowroom_shared_control::{GuidedArm, NavigatorError};

use crate::{Cell, CellOperator, FixtureRef};

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
    /// The first guide that is on.
    guide: Option<usize>,
}

impl FixturesOn {
    /// Those that an operator wants to be on at a time (s); minus infinity is the start.
    pub fn at(cell: &Cell, operator: &CellOperator, t_s: f64) -> Self {
        let (guidance, switches) = (&cell.guidance, &operator.switches);
        let is_shield_on = |(index, f): (usize, &crate::CellFixture)| {
            f.tool == Some(operator.tool) && switches.is_on(FixtureRef::Shield(index), f.active, t_s)
        };
        let is_guide_on = |(index, g): (usize, &crate::CellGuide)| {
            g.tool == operator.tool && switches.is_on(FixtureRef::Guide(index), g.active, t_s)
        };
        Self {
            shields: guidance.fixtures.iter().enumerate().map(is_shield_on).collect(),
            guide: guidance.guides.iter().enumerate().position(is_guide_on),
        }
    }

    /// Whether the tool keeps off a surface: a shield that is on takes the place of its object.
    pub fn keep_off(&self, cell: &Cell, surface: SurfaceOwner) -> bool {
        let protects = |(f, is_on): (&crate::CellFixture, &bool)| *is_on && surface == SurfaceOwner::Object(f.protects);
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
    /// Those that were refused last.
    pub(crate) refused: Option<FixturesOn>,
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

impl OperatedArm<'_> {
    /// Switches the fixtures as the stream wants it at a time (s), all that change at once. Reports each that changes or is
    /// refused, with its name.
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
        let wanted = FixturesOn::at(cell, operator, t_s);
        if wanted == self.on {
            self.refused = None;
            return;
        }
        let surfaces = &self.surfaces;
        let switched: Result<(), NavigatorError> = self.arm.switch(|index| wanted.keep_off(cell, surfaces[index]));
        let is_refused = switched.is_err();
        if is_refused && self.refused.as_ref() == Some(&wanted) {
            return;
        }
        let change = |is_on: bool| match (is_refused, is_on) {
            (true, _) => FixtureChange::Refused,
            (false, true) => FixtureChange::On,
            (false, false) => FixtureChange::Off,
        };
        let (guides, fixtures) = (&cell.guidance.guides, &cell.guidance.fixtures);
        for ((fixture, before), after) in fixtures.iter().zip(&self.on.shields).zip(&wanted.shields) {
            if before != after {
                report(&fixture.name, change(*after));
            }
        }
        if self.on.guide != wanted.guide {
            self.on.guide.iter().for_each(|index| report(&guides[*index].name, change(false)));
            wanted.guide.iter().for_each(|index| report(&guides[*index].name, change(true)));
        }
        if is_refused {
            self.refused = Some(wanted);
            return;
        }
        if self.on.guide != wanted.guide {
            self.arm.set_guide(wanted.guide.map(|index| guides[index].guide.clone()));
        }
        (self.on, self.refused) = (wanted, None);
    }
}
