//! How near to a corner a blend may begin: its triangle must lie in free cells.

use elbowroom_cspace::Table;

use super::legs::Legs;
use super::limits::{MotionError, MotionLimits};
use super::trajectory::Trajectory;
use crate::path::Path;
use crate::planner::Planner;
use crate::sight::box_is_free;
use crate::space::Point;

/// So often a corner's triangle is made half as large before the motion stops at the corner.
const SMALLER: i32 = 6;
/// A triangle is halved so often before it counts as not free.
const DEPTH: u32 = 7;

/// True where every cell that the triangle touches is free; may be false where only its neighbours are blocked.
fn triangle_is_free(table: &Table, corners: [Point; 3]) -> bool {
    halved(table, corners, DEPTH)
}

fn halved(table: &Table, [a, b, c]: [Point; 3], depth: u32) -> bool {
    let low = [0, 1, 2].map(|i| a[i].min(b[i]).min(c[i]));
    let high = [0, 1, 2].map(|i| a[i].max(b[i]).max(c[i]));
    if box_is_free(table, low, high) {
        return true;
    }
    if depth == 0 {
        return false;
    }
    // The longest edge first in the list.
    let far = |p: Point, q: Point| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>();
    let (ab, bc, ca) = (far(a, b), far(b, c), far(c, a));
    let [p, q, tip] = if ab >= bc && ab >= ca {
        [a, b, c]
    } else if bc >= ca {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let middle = [0, 1, 2].map(|i| 0.5 * (p[i] + q[i]));
    halved(table, [p, middle, tip], depth - 1) && halved(table, [middle, q, tip], depth - 1)
}

/// Halves the room until the triangle is free.
fn room(from: f64, mut is_free: impl FnMut(f64) -> bool) -> f64 {
    let halves = (0..SMALLER).map(|n| from * 0.5_f64.powi(n));
    halves.into_iter().find(|&away| is_free(away)).unwrap_or(0.0)
}

impl Planner {
    /// Times a path within limits. Straight legs are kept; corners are rounded where the triangle that is cut off lies in
    /// free cells of the table, up to half of the shorter leg; elsewhere the motion stops at the corner.
    ///
    /// ```
    /// # use elbowroom_cspace::{Axis, Grid, Table};
    /// # use elbowroom_planner::{MotionLimits, Path, Planner};
    /// # let axis = |name| Axis::new(name, 0.0, 1.0, 0.05);
    /// # let grid = Grid::new([axis("a")?, axis("b")?, axis("c")?])?;
    /// # let planner = Planner::new(&grid, &Table::new(grid.shape()))?;
    /// # let waypoints = vec![[0.1, 0.1, 0.1], [0.9, 0.1, 0.1], [0.9, 0.9, 0.1]];
    /// # let path = Path { waypoints, length_rad: 1.6, start_moved_rad: 0.0, goal_moved_rad: 0.0 };
    /// let limits = MotionLimits { velocity: vec![2.0; 3], acceleration: vec![10.0; 3], jerk: vec![200.0; 3] };
    /// let motion = planner.time(&path, &limits)?;
    /// assert_eq!((motion.at(0.0).q, motion.stops()), (vec![0.1, 0.1, 0.1], 0));
    /// assert_eq!(motion.at(motion.seconds()).q, [0.9, 0.9, 0.1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Limits that are not three finite numbers above 0 each; a path without waypoints.
    pub fn time(&self, path: &Path, limits: &MotionLimits) -> Result<Trajectory, MotionError> {
        let legs = Legs::new(&path.waypoints, limits)?;
        let mut rooms = vec![0.0; legs.count()];
        for n in 1..legs.count() {
            rooms[n] = room(legs.half(n), |away| {
                let corners = legs.triangle(n, away).map(|q| self.space.point([q[0], q[1], q[2]]));
                triangle_is_free(&self.table, corners)
            });
        }
        Ok(legs.timed(&rooms))
    }
}
