//! Carried volumes of robots: exchanged tools, and parts that are gripped and released.

use elbowroom_cell::{CellRobot, VirtualRobotMember};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::VolumeId;
use elbowroom_spatial::Pose;

use super::own_motion::OwnMotion;
use super::simulated_robot::absent_links;
use super::simulation::Simulation;
use crate::motion::GripAction;
use crate::recording::RunEvent;

impl Simulation<'_> {
    /// Makes tools active, and exchanges tools that are not mounted.
    pub(super) fn apply_tools(&mut self, t_s: f64) -> Result<(), Diagnostic> {
        for i in 0..self.robots.len() {
            for tool in self.robots[i].clock.take_tools() {
                let robot = &mut self.robots[i];
                let present = robot.present.with_tool(tool);
                let before = std::mem::replace(&mut robot.present, present);
                self.exchange_volumes(i, &before)?;
                let robot = &mut self.robots[i];
                robot.track.absent_links.extend(absent_links(&robot.present).map(|links| (t_s, links)));
                self.journal.event(t_s, robot.id, &robot.present.payload.tools[tool].name, RunEvent::Tool);
            }
        }
        Ok(())
    }

    /// Attaches and detaches the exchanged tools, for collisions and for regions.
    fn exchange_volumes(&mut self, i: usize, before: &CellRobot) -> Result<(), Diagnostic> {
        let robot = &self.robots[i];
        let (id, setup, line) = (robot.id, robot.setup, robot.present.line);
        let tools = robot.present.payload.tools.iter().zip(&before.payload.tools);
        let changed = tools.filter(|(now, old)| now.mounted != old.mounted).map(|(now, _)| (now.link, now.mounted));
        for (link, is_mounted) in changed.collect::<Vec<_>>() {
            self.contacts.checker.set_present(id, link, is_mounted, &self.states.iter().collect::<Vec<_>>());
            for (volume, tool) in setup.tool_volumes(link) {
                self.carry(i, volume, is_mounted.then_some(&tool.in_link), line)?;
            }
        }
        Ok(())
    }

    /// Guards a part or a tool that a robot carries from now on, at its pose in the link. Without a pose, marks it for
    /// detachment.
    fn carry(&mut self, i: usize, volume: VolumeId, in_link: Option<&Pose>, line: usize) -> Result<(), Diagnostic> {
        self.released.retain(|released| *released != (i, volume));
        let Some(in_link) = in_link else {
            self.released.push((i, volume));
            return Ok(());
        };
        let robot = &mut self.robots[i];
        let attached = robot.monitor.attach(volume, in_link);
        let attached = attached.and_then(|()| self.regions.attach(robot.id, volume, in_link));
        attached.map_err(|e| Diagnostic::new(&self.cell.file, line, e))?;
        self.journal.attached(robot.id, volume, in_link);
        Ok(())
    }

    /// Detaches what robots have released. It counts up to the instant of the release.
    pub(super) fn detach_released(&mut self) -> Result<(), Diagnostic> {
        for (i, volume) in std::mem::take(&mut self.released) {
            let robot = &mut self.robots[i];
            let detached = robot.monitor.detach(volume).and_then(|()| self.regions.detach(robot.id, volume));
            detached.map_err(|e| Diagnostic::new(&self.cell.file, self.cell.robots[i].line, e))?;
            self.journal.detached(robot.id, volume);
        }
        Ok(())
    }

    /// Applies grips and releases in the order of each program.
    ///
    /// A robot that grips what another one holds waits for the other's steps of this instant, so that it can take a
    /// part over.
    pub(super) fn apply_grips(&mut self, t_s: f64) -> Result<(), Diagnostic> {
        let mut late = Vec::new();
        for i in 0..self.robots.len() {
            let mut actions = self.robots[i].clock.take_grips().into_iter();
            while let Some(action) = actions.next() {
                let holder = self.contacts.parts.carrier(action.object);
                if action.grips && holder.is_some_and(|r| r.0 != i) {
                    late.extend(std::iter::once(action).chain(actions).map(|a| (i, a)));
                    break;
                }
                self.apply_grip(i, &action, t_s)?;
            }
        }
        late.into_iter().try_for_each(|(i, action)| self.apply_grip(i, &action, t_s))
    }

    fn apply_grip(&mut self, i: usize, action: &GripAction, t_s: f64) -> Result<(), Diagnostic> {
        let states: Vec<&ChainState> = self.states.iter().collect();
        let (robot, contacts) = (&self.robots[i], &mut self.contacts);
        contacts.parts.apply(robot.id, action, t_s, &robot.present, &mut contacts.checker, &states)?;
        let event = if action.grips { RunEvent::Grip } else { RunEvent::Release };
        self.journal.event(t_s, robot.id, &self.cell.objects[action.object.0].name, event);
        self.guard_part(i, action)
    }

    /// Updates the guarded volumes after a grip or a release, also in the avoidance of all robots.
    fn guard_part(&mut self, i: usize, action: &GripAction) -> Result<(), Diagnostic> {
        let attachment = self.contacts.checker.attachment(action.object).cloned();
        let in_link = attachment.as_ref().map_or(Pose::IDENTITY, |a| a.in_link);
        for avoiding in self.robots.iter_mut().filter_map(|robot| robot.own_motion.avoiding_mut()) {
            let applied = match &attachment {
                Some(attachment) => avoiding.attach(action.object, attachment.clone()),
                None => avoiding.detach(action.object),
            };
            applied.map_err(|e| Diagnostic::new(&self.cell.file, action.line, e))?;
        }
        let slot = self.robots[i].setup.gripped_volume(action.object, action.link, &in_link);
        let none = || Diagnostic::new(&self.cell.file, action.line, "grips what its monitor has no volume for");
        let (volume, in_link) = slot.ok_or_else(none)?;
        self.carry(i, volume, action.grips.then_some(&in_link), action.line)
    }

    /// The members of virtual robots hold their work-pieces, before anything moves.
    pub(super) fn hold_work_pieces(&mut self) -> Result<(), Diagnostic> {
        self.update_states(0.0);
        (0..self.virtual_robots.len()).try_for_each(|index| self.hold_work_piece(index, 0.0))
    }

    /// Moves the members of the virtual robots from `t_s` to the next tick.
    pub(super) fn cooperate(&mut self, t_s: f64) -> Result<(), Diagnostic> {
        for index in 0..self.virtual_robots.len() {
            let Self { cell, options, robots, states, journal, virtual_robots, .. } = self;
            let virtual_robot = &mut virtual_robots[index];
            let spec = virtual_robot.spec;
            let of_member =
                |m: &VirtualRobotMember| if options.is_silent(m.robot, t_s) { 0.0 } else { robots[m.robot.0].applied };
            let overrides: Vec<f64> = spec.members.iter().map(of_member).collect();
            let part = &cell.objects[spec.work_piece.0].name;
            virtual_robot.advance(cell, states, (t_s, &overrides), |robot, event| {
                let concerns = if event == RunEvent::Yield { "" } else { part };
                journal.event(t_s, robot, concerns, event);
            })?;
            for (member, m) in spec.members.iter().enumerate() {
                if let OwnMotion::Cooperating(own) = &mut robots[m.robot.0].own_motion {
                    virtual_robot.write(member, cell.timing.tick_s, overrides[member], own);
                }
            }
            self.hold_work_piece(index, t_s)?;
        }
        Ok(())
    }

    /// Follows a change of how a work-piece is held: for contacts, and in the monitors of giver and receiver.
    fn hold_work_piece(&mut self, index: usize, t_s: f64) -> Result<(), Diagnostic> {
        let spec = self.virtual_robots[index].spec;
        let (object, held) = (spec.work_piece, self.virtual_robots[index].attachment());
        let before = self.contacts.checker.attachment(object);
        if held == before {
            return Ok(());
        }
        let (before, Some(held)) = (before.cloned(), held.cloned()) else { return Ok(()) };
        let states: Vec<&ChainState> = self.states.iter().collect();
        self.contacts.parts.hold(object, &held, &mut self.contacts.checker, &states);
        if before.as_ref().is_some_and(|b| (b.robot, b.link, b.in_link) == (held.robot, held.link, held.in_link)) {
            return Ok(());
        }
        for (attachment, holds) in before.iter().map(|b| (b, false)).chain([(&held, true)]) {
            let robot = attachment.robot.0;
            let slot = self.robots[robot].setup.gripped_volume(object, attachment.link, &attachment.in_link);
            let none = || Diagnostic::new(&self.cell.file, spec.line, "carries what a monitor has no volume for");
            let (volume, in_link) = slot.ok_or_else(none)?;
            self.carry(robot, volume, holds.then_some(&in_link), spec.line)?;
            let event = if holds { RunEvent::Grip } else { RunEvent::Release };
            self.journal.event(t_s, attachment.robot, &self.cell.objects[object.0].name, event);
        }
        Ok(())
    }
}
