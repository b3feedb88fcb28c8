//! Where robots start that decide their motion themselves: guided ones, and virtual robots.

use elbowroom_cell::Cell;
use elbowroom_diagnostic::Diagnostic;

/// Whether every guided robot and every virtual robot can start as its table says, as a run demands. Returns the notes of the
/// run.
///
/// # Errors
/// [`Diagnostic`] at the line of the table of the first one that cannot.
pub fn check_starts(cell: &Cell) -> Result<Vec<Diagnostic>, Diagnostic> {
    let guidance = &cell.guidance;
    if guidance.operators.is_empty() && guidance.virtual_robots.is_empty() {
        return Ok(Vec::new());
    }
    let scene = cell.scene_of_guidance()?;
    let mut notes = Vec::new();
    guidance.operators.iter().try_for_each(|operator| operator.arm(cell, &scene, &mut notes).map(|_| ()))?;
    guidance.virtual_robots.iter().try_for_each(|spec| spec.start(cell, &scene).map(|_| ()))?;
    Ok(notes)
}
