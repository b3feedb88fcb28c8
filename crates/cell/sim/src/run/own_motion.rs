//! The motion of a robot that leaves its program, or has none.

use elbowroom_kinematics::ChainState;

use super::avoiding_robot::AvoidingRobot;
use super::guided_robot::GuidedRobot;
use super::virtual_robot::CooperatingRobot;
use crate::motion::ProgramClock;

/// What moves a robot besides its program.
#[derive(Debug)]
pub(super) enum OwnMotion<'s> {
    /// Nothing.
    None,
    /// Its avoidance.
    Avoiding(Box<AvoidingRobot<'s>>),
    /// A person.
    Guided(Box<GuidedRobot<'s>>),
    /// The virtual robot that it is a member of.
    Cooperating(Box<CooperatingRobot>),
}

impl<'s> OwnMotion<'s> {
    /// Its avoidance; `None` for a robot without.
    pub fn avoiding(&self) -> Option<&AvoidingRobot<'s>> {
        if let Self::Avoiding(avoiding) = self { Some(avoiding) } else { None }
    }

    /// Like [`Self::avoiding`], to change it.
    pub fn avoiding_mut(&mut self) -> Option<&mut AvoidingRobot<'s>> {
        if let Self::Avoiding(avoiding) = self { Some(avoiding) } else { None }
    }

    /// Whether the robot is on its programmed path.
    pub fn is_on_path(&self) -> bool {
        match self {
            Self::None => true,
            Self::Avoiding(avoiding) => avoiding.is_on_path(),
            Self::Guided(_) | Self::Cooperating(_) => false,
        }
    }

    /// Whether it has nothing left to do, besides its program.
    pub fn is_over(&self) -> bool {
        match self {
            Self::Guided(guided) => guided.is_over(),
            Self::Cooperating(member) => member.is_over,
            Self::None | Self::Avoiding(_) => self.is_on_path(),
        }
    }

    /// Whether it may move at any time by itself.
    pub fn awaits_operator(&self) -> bool {
        matches!(self, Self::Guided(_) | Self::Cooperating(_)) && !self.is_over()
    }

    /// Writes joint values, velocities and accelerations of a robot that is not on its programmed path.
    pub fn write_state(&self, state: &mut ChainState) {
        match self {
            Self::None => {}
            Self::Avoiding(avoiding) => avoiding.write_state(state),
            Self::Guided(guided) => guided.write_state(state),
            Self::Cooperating(member) => member.write_state(state),
        }
    }

    /// Joint velocities at override 1.
    pub fn intent<'a>(&'a self, clock: &'a ProgramClock) -> &'a [f64] {
        match self {
            Self::None => clock.intent(),
            Self::Avoiding(avoiding) => avoiding.intent(clock),
            Self::Guided(guided) => guided.intent(),
            Self::Cooperating(member) => &member.intent,
        }
    }
}
