//! Length of the free part of a path, as the motion of the arm is measured.

use elbowroom_planner::{GridPlanner, GridPlannerError, GridPlannerSettings, Path, PathProgress, PathStatus};

/// Unweighted length in joint space (rad) of the part of a path that is free ahead of the arm; `None` where all of it is.
/// The planner's own lengths are weighted by [`ExecutorSettings::weights`](crate::ExecutorSettings::weights): those cannot
/// be compared with stopping distances and arc lengths, so the path is checked with unit weights.
pub(super) fn free_arc_rad(
    planner: &GridPlanner,
    path: &Path,
    here: PathProgress,
) -> Result<Option<f64>, GridPlannerError> {
    let unit_weights = GridPlannerSettings { weights: [1.0; 3], ..GridPlannerSettings::DEFAULT };
    Ok(match planner.path_status(path, here, &unit_weights)? {
        PathStatus::Clear => None,
        PathStatus::Blocked { weighted_free_rad: free_rad, .. } => Some(free_rad),
    })
}
