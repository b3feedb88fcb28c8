//! What a person learns about a shield: its size, its opening, and whether its tool reaches the target.

use elbowroom_formats::Diagnostic;
use serde::Serialize;

use crate::{Cell, CellFixture};

/// Report on the shield of a fixture, in metres and in the world.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShieldReport {
    /// Name of the fixture.
    pub name: String,
    /// Name of the protected object.
    pub protects: String,
    /// Whether the shield is on at the start.
    pub active: bool,
    /// Number of its triangles.
    pub triangles: usize,
    /// Whether it encloses a solid and faces outwards.
    pub closed: bool,
    /// Number of its connected parts.
    pub components: usize,
    /// Its largest error, metres; `None` for a shield that was read.
    pub tolerance_m: Option<f64>,
    /// Smallest width of the opening above the surface, metres; `None` for a shield that was read.
    pub narrowest_m: Option<f64>,
    /// Width of the part of the tool that enters, metres; `None` without a tool.
    pub tool_width_m: Option<f64>,
    /// Whether the tool reaches the target; `None` if the file names no tool.
    pub reachable: Option<bool>,
    /// A point of the target that the tool does not reach, in the world, metres.
    pub blocked_at_m: Option<[f64; 3]>,
}

impl CellFixture {
    /// Reports on the shield, which is made if it is not yet.
    ///
    /// # Errors
    /// As [`Self::shield`].
    pub fn report(&self, cell: &Cell) -> Result<ShieldReport, Diagnostic> {
        let shield = self.shield(cell)?;
        let object = &cell.objects[self.protects.0];
        let mesh = shield.mesh.report();
        let passage = self.passage(shield, cell);
        let blocked_at = passage.and_then(|p| p.blocked_at);
        Ok(ShieldReport {
            name: self.name.clone(),
            protects: object.name.clone(),
            active: self.active,
            triangles: shield.mesh.triangles().len(),
            closed: mesh.closed && !mesh.inside_out,
            components: shield.mesh.component_vertices().len(),
            tolerance_m: self.settings().map(|s| s.tolerance_m),
            narrowest_m: passage.map(|p| p.narrowest_m).or_else(|| self.settings().map(|s| shield.narrowest_m(s))),
            tool_width_m: passage.map(|p| p.tool_width_m),
            reachable: passage.map(|p| p.blocked_at.is_none()),
            blocked_at_m: blocked_at.map(|p| object.in_world.transform_point(p).to_array()),
        })
    }
}
