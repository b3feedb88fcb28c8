//! Tools that a robot has at each tick, by the steps that its recording names.

use elbowroom_cell::CellRobot;
use elbowroom_sim::{Recording, RunEvent};

/// Ticks at which tools change, each with the tools that are mounted from then on; the first entry is of tick 0.
#[derive(Debug)]
pub struct MountedTools(Vec<(usize, Vec<bool>)>);

impl MountedTools {
    pub fn new(robot: &CellRobot, recording: &Recording) -> Self {
        let mut mounted: Vec<bool> = robot.payload.tools.iter().map(|t| t.mounted).collect();
        let mut changes = vec![(0, mounted.clone())];
        let steps = recording.events.iter().filter(|e| e.event == RunEvent::Tool && e.robot == robot.name);
        for step in steps {
            let Some(tool) = robot.payload.tools.iter().position(|t| t.name == step.region) else { continue };
            if mounted[tool] {
                continue;
            }
            // It replaces the tool on its flange.
            for (other, is_mounted) in robot.payload.tools.iter().zip(&mut mounted) {
                *is_mounted &= other.flange != robot.payload.tools[tool].flange;
            }
            mounted[tool] = true;
            changes.push(((step.t_s / recording.tick_s).round() as usize, mounted.clone()));
        }
        Self(changes)
    }

    /// The ticks at which tools change, without the first.
    pub fn changes(&self) -> impl Iterator<Item = usize> {
        self.0.iter().skip(1).map(|(tick, _)| *tick)
    }

    /// Whether the tool with this index is on its flange at a tick.
    pub fn has(&self, tool: usize, tick: usize) -> bool {
        self.0.iter().rev().find(|(from, _)| *from <= tick).is_some_and(|(_, mounted)| mounted[tool])
    }
}
