//! Grids.

use std::fmt::Write as _;

/// A grid of one robot.
#[derive(Debug, Clone)]
pub struct GridSpec {
    pub name: String,
    pub robot: usize,
    /// Lines of the box or of the joints.
    pub space: String,
    pub cells: Vec<u32>,
    pub output: u8,
    /// In the unit of the grid's axes; `None` for the default.
    pub hysteresis: Option<f64>,
}

impl GridSpec {
    pub(super) fn write(&self, t: &mut String) {
        let Self { name, robot, space, cells, output, hysteresis } = self;
        let _ = writeln!(t, "[grid.{name}]\nrobots = [\"r{robot}\"]\n{space}cells = {cells:?}\noutput = {output}");
        if let Some(hysteresis) = hysteresis {
            let _ = writeln!(t, "hysteresis = {hysteresis}");
        }
        t.push('\n');
    }
}
