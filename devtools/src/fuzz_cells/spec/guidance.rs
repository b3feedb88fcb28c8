//! An operator who guides the first robot, and tables of fixtures and forces.

use std::fmt::Write as _;

use super::files::CellFile;

/// Guidance of the first robot.
#[derive(Debug, Clone, Default)]
pub struct GuidanceSpec {
    /// Keys of the operator.
    pub operator: String,
    /// Keys of a virtual robot, which has the stream instead of an operator; empty for an operator.
    pub virtual_robot: String,
    pub rows: Vec<HandRow>,
    /// Whether the stream switches the fixture `shield`.
    pub switches: bool,
    /// Tables `[fixture.NAME]` and `[force.NAME]`.
    pub tables: Vec<String>,
    /// Files of shields.
    pub shields: Vec<CellFile>,
}

/// A row of the stream: pose of the hand in the world, metres.
#[derive(Debug, Clone, Copy)]
pub struct HandRow {
    /// Milliseconds.
    pub t_ms: u32,
    /// Micrometres.
    pub at: [i64; 3],
    /// Components x, y, z, w of the quaternion, in millionths.
    pub turn: [i64; 4],
    pub enable: bool,
    pub clutch: bool,
    /// Whether the fixture `shield` is on, if the stream switches it.
    pub shield: bool,
}

impl GuidanceSpec {
    pub(super) fn write(&self, t: &mut String) {
        let file = self.file().name;
        let _ = if self.virtual_robot.is_empty() {
            writeln!(t, "[operator.hand]\nrobot = \"r0\"\nstream = \"{file}\"\n{}", self.operator)
        } else {
            writeln!(t, "[virtual_robot.pair]\nstream = \"{file}\"\n{}", self.virtual_robot)
        };
        for table in &self.tables {
            let _ = writeln!(t, "{table}");
        }
    }

    /// The file of the stream.
    pub(super) fn file(&self) -> CellFile {
        let fixture = if self.switches { ",fixture.shield" } else { "" };
        let row = |row: &HandRow| {
            let mut values = vec![f64::from(row.t_ms) * 1e-3];
            values.extend(row.at.iter().chain(&row.turn).map(|v| *v as f64 * 1e-6));
            values.extend([row.enable, row.clutch].map(f64::from));
            values.extend(self.switches.then_some(f64::from(row.shield)));
            values
        };
        CellFile::csv("hand", &format!("t_s,x,y,z,qx,qy,qz,qw,enable,clutch{fixture}"), self.rows.iter().map(row))
    }
}
