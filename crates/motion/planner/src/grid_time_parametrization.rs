//! Time parametrization of grid paths: a corner is blended if the triangle that is cut off lies in free cells.

use elbowroom_cspace::OccupancyBitmap;
use elbowroom_kinematics::JointLimits;

use crate::grid_path::GridPath;
use crate::grid_planner::GridPlanner;
use crate::grid_space::GridPoint;
use crate::line_of_sight::box_is_free;
use crate::time_parametrization::{BlendedTrajectory, PathSegments, TimeParametrizationError};

/// Number of times that the triangle of a corner is halved before the trajectory stops at the corner.
const MAX_HALVINGS: i32 = 6;
/// Number of times that a triangle is bisected before it counts as blocked.
const MAX_DEPTH: u32 = 7;

/// Whether all cells that the triangle touches are free. May be false if only their neighbours are blocked.
fn triangle_is_free(occupancy: &OccupancyBitmap, corners: [GridPoint; 3]) -> bool {
    halves_are_free(occupancy, corners, MAX_DEPTH)
}

fn halves_are_free(occupancy: &OccupancyBitmap, [a, b, c]: [GridPoint; 3], depth: u32) -> bool {
    let low = [0, 1, 2].map(|i| a[i].min(b[i]).min(c[i]));
    let high = [0, 1, 2].map(|i| a[i].max(b[i]).max(c[i]));
    if box_is_free(occupancy, low, high) {
        return true;
    }
    if depth == 0 {
        return false;
    }
    // Bisect the longest edge.
    let far = |p: GridPoint, q: GridPoint| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>();
    let (ab, bc, ca) = (far(a, b), far(b, c), far(c, a));
    let [p, q, tip] = if ab >= bc && ab >= ca {
        [a, b, c]
    } else if bc >= ca {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let middle = [0, 1, 2].map(|i| 0.5 * (p[i] + q[i]));
    halves_are_free(occupancy, [p, middle, tip], depth - 1) && halves_are_free(occupancy, [middle, q, tip], depth - 1)
}

/// Halves a blend distance until its triangle is free; 0 if no triangle is free.
fn free_blend_distance(from: f64, mut is_free: impl FnMut(f64) -> bool) -> f64 {
    let halves = (0..MAX_HALVINGS).map(|n| from * 0.5_f64.powi(n));
    halves.into_iter().find(|&blend_distance| is_free(blend_distance)).unwrap_or(0.0)
}

impl GridPlanner {
    /// Computes the time parametrization of a path within limits. Straight segments are kept. A corner is blended if
    /// the triangle that is cut off lies in free cells, up to half of the shorter segment; otherwise the trajectory
    /// stops at the corner.
    ///
    /// ```
    /// # use elbowroom_cspace::{Grid, GridAxis, OccupancyBitmap};
    /// # use elbowroom_kinematics::JointLimits;
    /// # use elbowroom_planner::{GridPlanner, GridPath};
    /// # let axis = |name| GridAxis::new(name, 0.0, 1.0, 0.05);
    /// # let grid = Grid::new([axis("a")?, axis("b")?, axis("c")?])?;
    /// # let planner = GridPlanner::new(&grid, &OccupancyBitmap::new(grid.shape()))?;
    /// # let waypoints = vec![[0.1, 0.1, 0.1], [0.9, 0.1, 0.1], [0.9, 0.9, 0.1]];
    /// # let path = GridPath { waypoints, length_rad: 1.6, start_moved_rad: 0.0, goal_moved_rad: 0.0 };
    /// let limits = vec![JointLimits::new(2.0, 10.0, 200.0); 3];
    /// let trajectory = planner.time_parametrize(&path, &limits)?;
    /// assert_eq!((trajectory.at(0.0).q, trajectory.stops()), (vec![0.1, 0.1, 0.1], 0));
    /// assert_eq!(trajectory.at(trajectory.seconds()).q, [0.9, 0.9, 0.1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The limits are not three finite numbers above 0 each, or the path has no waypoints.
    pub fn time_parametrize(
        &self,
        path: &GridPath,
        limits: &[JointLimits],
    ) -> Result<BlendedTrajectory, TimeParametrizationError> {
        let segments = PathSegments::new(&path.waypoints, limits)?;
        let mut blend_distances = vec![0.0; segments.count()];
        for n in 1..segments.count() {
            blend_distances[n] = free_blend_distance(segments.max_blend_distance(n), |blend_distance| {
                let corners = segments.triangle(n, blend_distance).map(|q| self.space.point([q[0], q[1], q[2]]));
                triangle_is_free(&self.occupancy, corners)
            });
        }
        Ok(BlendedTrajectory::new(segments, &blend_distances))
    }
}
