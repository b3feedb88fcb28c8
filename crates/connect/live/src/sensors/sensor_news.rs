//! What is told of the sensors of a live cell: each fact once.

use std::collections::BTreeMap;

use elbowroom_cell::Cell;
use elbowroom_formats::Diagnostic;
use elbowroom_robot::RobotId;

use crate::event_handler::EventHandler;

/// A robot that is not heard for this long is named, s.
const SILENCE_S: f64 = 1.0;

/// Tells what the user should know of the sensors.
pub(super) struct SensorNews {
    on_event: Option<EventHandler>,
    /// The robot that is not heard, since when (s), and whether that was told.
    silent: Option<(RobotId, f64, bool)>,
    /// Per sensor why its pictures are rejected.
    rejected: BTreeMap<String, String>,
}

impl SensorNews {
    pub fn new(on_event: Option<EventHandler>) -> Self {
        Self { on_event, silent: None, rejected: BTreeMap::new() }
    }

    pub fn tell(&self, what: &str) {
        if let Some(on_event) = &self.on_event {
            on_event(what);
        }
    }

    pub fn warn(&self, notes: &[Diagnostic]) {
        for note in notes {
            self.tell(&format!("warning: {note}"));
        }
    }

    /// Tells why a sensor's pictures are rejected when that changes, and when they are used again.
    pub fn rejections<'s>(&mut self, sensors: impl Iterator<Item = (&'s str, Option<&'s str>)>) {
        for (sensor, reason) in sensors {
            if self.rejected.get(sensor).map(String::as_str) == reason {
                continue;
            }
            if let Some(reason) = reason {
                self.rejected.insert(sensor.to_owned(), reason.to_owned());
                self.tell(&format!("sensor {sensor}: rejected: {reason}"));
            } else {
                self.rejected.remove(sensor);
                self.tell(&format!("sensor {sensor}: is used again"));
            }
        }
    }

    /// Names a robot that is not heard for a while: the robots that the sensors guard wait for it.
    pub fn silence(&mut self, cell: &Cell, silent: Option<RobotId>, t_s: f64) {
        let since = |robot: &RobotId| self.silent.filter(|(before, ..)| before == robot);
        self.silent = silent.map(|robot| since(&robot).unwrap_or((robot, t_s, false)));
        if let Some((robot, since_s, is_told)) = &mut self.silent
            && !*is_told
            && t_s - *since_s > SILENCE_S
        {
            *is_told = true;
            let name = &cell.robots[robot.0].name;
            let what = format!(
                "{name}: its joint values are not received; the robots that sensors guard wait\n  help: start the process that \
                 guards it; a controller that speaks UDP must speak with this process"
            );
            self.tell(&what);
        }
    }
}
