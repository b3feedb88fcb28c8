//! Checking and repairing a path after cells changed.

use crate::grid_planner::{FreeEnd, GridPlanner, GridPlannerSettings};
use crate::grid_shortcutting::PathContext;
use crate::grid_space::{CellPoint, CellScale, GridPoint};
use crate::line_of_sight::first_blocked;
use crate::local_detour::single_corner_detour;
use crate::path::{GridPlannerError, Path, PathEnd};

/// Position of the arm on a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathProgress {
    /// The arm is between `waypoints[segment]` and `waypoints[segment + 1]`.
    pub segment: usize,
    /// Its configuration, radians.
    pub q: [f64; 3],
}

/// Whether the rest of a path is free: its straight segments, cell by cell. `CurveStatus` in the crate `perception` says the
/// same of the curve with blended corners that is executed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathStatus {
    /// All of it.
    Clear,
    /// Only a part.
    Blocked {
        /// The segment on which the free part ends.
        segment: usize,
        /// The end of the free part, radians.
        free_until: [f64; 3],
        /// Length of the free part from the arm along the path, weighted radians; 0: stop. It is a length in joint space only
        /// with unit weights.
        weighted_free_rad: f64,
    },
}

/// How a path was obtained from the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReplanKind {
    /// It is the rest of the old one: no cell on it is blocked.
    Kept,
    /// It bypasses the blocked part; the rest is the old one.
    Repaired,
    /// It was planned again, from the arm to the goal.
    Replanned,
}

/// A place on a polyline of points.
#[derive(Debug, Clone, Copy)]
struct Place {
    segment: usize,
    /// Fraction of the segment.
    share: f64,
}

impl GridPlanner {
    /// Checks the rest of a path after [`update`](Self::update). Only cells on the path are checked, however large the
    /// change is.
    ///
    /// ```
    /// use elbowroom_cspace::{Grid, GridAxis, OccupancyBitmap, RowSpan};
    /// use elbowroom_planner::{GridPlanner, GridPlannerSettings, PathProgress, PathStatus, ReplanKind};
    /// let axis = |name| GridAxis::new(name, 0.0, 1.0, 0.05);
    /// let grid = Grid::new([axis("a")?, axis("b")?, axis("c")?])?;
    /// let mut occupancy = OccupancyBitmap::new(grid.shape());
    /// let mut planner = GridPlanner::new(&grid, &occupancy)?;
    /// let settings = GridPlannerSettings::default();
    /// let path = planner.plan([0.02, 0.5, 0.5], [0.98, 0.5, 0.5], &settings)?;
    /// occupancy.block(RowSpan { row: 10 * 20 + 10, first: 9, last: 11 }); // on the path
    /// planner.update(&occupancy)?;
    /// let here = PathProgress { segment: 0, q: [0.1, 0.5, 0.5] };
    /// let PathStatus::Blocked { weighted_free_rad, .. } = planner.path_status(&path, here, &settings)? else { panic!() };
    /// assert!((weighted_free_rad - 0.4).abs() < 1e-6);
    /// let (repaired, kind) = planner.replan(&path, here, &settings)?;
    /// assert!(kind == ReplanKind::Repaired && repaired.length_rad < 0.95);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The arm or a waypoint is outside the grid; invalid settings.
    pub fn path_status(
        &self,
        path: &Path,
        here: PathProgress,
        settings: &GridPlannerSettings,
    ) -> Result<PathStatus, GridPlannerError> {
        let scale = self.scale(settings)?;
        let points = self.remaining_points(path, here)?;
        let mut so_far = 0.0;
        for (n, w) in points.windows(2).enumerate() {
            if let Some(t) = first_blocked(&self.occupancy, w[0], w[1]) {
                let weighted_free_rad = so_far + t * scale.distance(w[0], w[1]);
                let free_until = self.space.q(interpolate(w, t));
                return Ok(PathStatus::Blocked { segment: here.segment + n, free_until, weighted_free_rad });
            }
            so_far += scale.distance(w[0], w[1]);
        }
        if points.len() == 1 && first_blocked(&self.occupancy, points[0], points[0]).is_some() {
            return Ok(PathStatus::Blocked { segment: here.segment, free_until: here.q, weighted_free_rad: 0.0 });
        }
        Ok(PathStatus::Clear)
    }

    /// A path from the arm to the end of the old path: the old path where it is free, a bypass of its blocked part where a
    /// short search finds one, else a new path. Cells that became free elsewhere are not used: plan again for that.
    ///
    /// # Errors
    /// As [`plan`](Self::plan).
    pub fn replan(
        &mut self,
        path: &Path,
        here: PathProgress,
        settings: &GridPlannerSettings,
    ) -> Result<(Path, ReplanKind), GridPlannerError> {
        let scale = self.scale(settings)?;
        let mut points = self.remaining_points(path, here)?;
        let goal = path.waypoints.last().copied().unwrap_or(here.q);
        let kind = match self.blocked_range(&points) {
            None => ReplanKind::Kept,
            Some(blocked) if self.repair(&mut points, blocked, scale, settings) => ReplanKind::Repaired,
            Some(_) => return Ok((self.plan(here.q, goal, settings)?, ReplanKind::Replanned)),
        };
        let ends = [self.present_end(PathEnd::Start, here.q)?, self.present_end(PathEnd::Goal, goal)?];
        let mut rest = self.path(&points, scale, &ends);
        rest.goal_moved_rad = path.goal_moved_rad;
        Ok((rest, kind))
    }

    fn present_end(&self, end: PathEnd, q: [f64; 3]) -> Result<FreeEnd, GridPlannerError> {
        Ok(self.exact_end(q, self.cell(end, q)?))
    }

    /// The arm and the waypoints ahead of it, as points.
    fn remaining_points(&self, path: &Path, here: PathProgress) -> Result<Vec<GridPoint>, GridPlannerError> {
        let ahead = path.waypoints.get(here.segment + 1..).unwrap_or(&[]);
        let mut points = Vec::with_capacity(ahead.len() + 1);
        points.push(self.present_end(PathEnd::Start, here.q)?.at.point);
        for &q in ahead {
            points.push(self.present_end(PathEnd::Goal, q)?.at.point);
        }
        Ok(points)
    }

    /// The first and the last blocked place.
    fn blocked_range(&self, points: &[GridPoint]) -> Option<[Place; 2]> {
        let segments = 0..points.len().saturating_sub(1);
        let first = |segment: usize| {
            let share = first_blocked(&self.occupancy, points[segment], points[segment + 1])?;
            Some(Place { segment, share })
        };
        let last = |segment: usize| {
            let share = 1.0 - first_blocked(&self.occupancy, points[segment + 1], points[segment])?;
            Some(Place { segment, share })
        };
        let from = segments.clone().find_map(first);
        let is_single = points.len() == 1 && first_blocked(&self.occupancy, points[0], points[0]).is_some();
        let from = from.or(is_single.then_some(Place { segment: 0, share: 0.0 }))?;
        Some([from, segments.rev().find_map(last).unwrap_or(from)])
    }

    /// Bypasses the blocked part; false where a short search finds no bypass.
    fn repair(
        &mut self,
        points: &mut Vec<GridPoint>,
        [from, to]: [Place; 2],
        scale: CellScale,
        settings: &GridPlannerSettings,
    ) -> bool {
        let margin = settings.repair_margin_cells * scale.0.iter().sum::<f64>() / 3.0;
        if points.len() < 2 {
            return false;
        }
        let context = PathContext { occupancy: &self.occupancy, space: &self.space, scale };
        let blocked = [from, to].map(|place| interpolate(&points[place.segment..], place.share));
        let ends = [points[from.segment], points[to.segment + 1]];
        if let Some(corner) = single_corner_detour(context, ends, blocked) {
            points.splice(from.segment + 1..=to.segment, [corner]);
            return true;
        }
        let (first, a) = point_before(points, from, margin, scale);
        let (last, b) = point_after(points, to, margin, scale);
        let ends = [a, b].map(|point| CellPoint { point, cell: point.map(|x| x.max(0.0) as u16) });
        let mut detour = Vec::new();
        if !self.connect(scale, ends, settings.max_repair_nodes, &mut detour) {
            return false;
        }
        // With the corners before and after: where the detour leaves the old path need not stay a corner.
        detour.insert(0, points[first]);
        detour.push(points[last + 1]);
        let context = PathContext { occupancy: &self.occupancy, space: &self.space, scale };
        self.shortcutting.run(context, &mut detour);
        points.splice(first..=last + 1, detour);
        true
    }
}

/// Between the first two points.
fn interpolate(segment: &[GridPoint], t: f64) -> GridPoint {
    [0, 1, 2].map(|i| segment[0][i] + (segment[1][i] - segment[0][i]) * t)
}

/// The point at a distance before a place, and its segment.
fn point_before(points: &[GridPoint], place: Place, mut distance: f64, scale: CellScale) -> (usize, GridPoint) {
    let mut segment = place.segment;
    let mut at = interpolate(&points[segment..], place.share);
    loop {
        let far = scale.distance(points[segment], at);
        if far > distance {
            let share = distance / far;
            return (segment, interpolate(&[at, points[segment]], share));
        }
        if segment == 0 {
            return (0, points[0]);
        }
        distance -= far;
        at = points[segment];
        segment -= 1;
    }
}

/// The point at a distance after a place, and its segment.
fn point_after(points: &[GridPoint], place: Place, mut distance: f64, scale: CellScale) -> (usize, GridPoint) {
    let mut segment = place.segment;
    let mut at = interpolate(&points[segment..], place.share);
    loop {
        let far = scale.distance(at, points[segment + 1]);
        if far > distance {
            return (segment, interpolate(&[at, points[segment + 1]], distance / far));
        }
        if segment + 2 == points.len() {
            return (segment, points[segment + 1]);
        }
        distance -= far;
        at = points[segment + 1];
        segment += 1;
    }
}
