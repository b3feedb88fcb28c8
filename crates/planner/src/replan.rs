//! What is left of a path when cells have changed, and how it is mended.

use crate::path::{End, Path, PlanError};
use crate::planner::{Place, PlanOptions, Planner};
use crate::polish::Ground;
use crate::sidestep::sidestep;
use crate::sight::first_blocked;
use crate::space::{Point, Scale};

/// The mended part begins and ends this many widths of cells (the mean of the joints') away from what is blocked.
const AWAY: f64 = 8.0;
/// Mending gives up, and all is planned anew, after so many nodes.
const MOST_NODES: usize = 1500;

/// Where the arm is on a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// It goes from `waypoints[leg]` to `waypoints[leg + 1]`.
    pub leg: usize,
    /// Where it is, radians.
    pub q: [f64; 3],
}

/// Whether the rest of a path is still free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Standing {
    /// All of it.
    Clear,
    /// Only a part.
    Blocked {
        /// The leg on which it ends.
        leg: usize,
        /// Up to here every cell is free, radians.
        free_until: [f64; 3],
        /// So far it is from where the arm is, along the path, weighted radians; 0: stop.
        free_rad: f64,
    },
}

/// How a path came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// The rest of the old one: nothing on it changed.
    Kept,
    /// The blocked part was gone around; the rest is the old one.
    Mended,
    /// Planned anew.
    Anew,
}

impl Planner {
    /// Looks along the rest of a path, after [`update`](Self::update), for what is blocked now. Only the path's own cells
    /// are looked at, however large the change was.
    ///
    /// ```
    /// use elbowroom_cspace::{Axis, Grid, Span, Table};
    /// use elbowroom_planner::{How, PlanOptions, Planner, Progress, Standing};
    /// let axis = |name| Axis::new(name, 0.0, 1.0, 0.05);
    /// let grid = Grid::new([axis("a")?, axis("b")?, axis("c")?])?;
    /// let mut table = Table::new(grid.shape());
    /// let mut planner = Planner::new(&grid, &table)?;
    /// let options = PlanOptions::default();
    /// let path = planner.plan([0.02, 0.5, 0.5], [0.98, 0.5, 0.5], &options)?;
    /// table.block(Span { row: 10 * 20 + 10, first: 9, last: 11 }); // in the way
    /// planner.update(&table)?;
    /// let here = Progress { leg: 0, q: [0.1, 0.5, 0.5] };
    /// let Standing::Blocked { free_rad, .. } = planner.standing(&path, here, &options)? else { panic!() };
    /// assert!((free_rad - 0.4).abs() < 1e-6);
    /// let (around, how) = planner.replan(&path, here, &options)?;
    /// assert!(how == How::Mended && around.length_rad < 0.95);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The arm or a waypoint is outside the map; options that cannot be used.
    pub fn standing(&self, path: &Path, here: Progress, options: &PlanOptions) -> Result<Standing, PlanError> {
        let scale = self.scale(options)?;
        let points = self.rest(path, here)?;
        let mut so_far = 0.0;
        for (n, w) in points.windows(2).enumerate() {
            if let Some(t) = first_blocked(&self.table, w[0], w[1]) {
                let free_rad = so_far + t * scale.distance(w[0], w[1]);
                return Ok(Standing::Blocked { leg: here.leg + n, free_until: self.space.q(on(w, t)), free_rad });
            }
            so_far += scale.distance(w[0], w[1]);
        }
        if points.len() == 1 && first_blocked(&self.table, points[0], points[0]).is_some() {
            return Ok(Standing::Blocked { leg: here.leg, free_until: here.q, free_rad: 0.0 });
        }
        Ok(Standing::Clear)
    }

    /// A path from where the arm is to the end of the old one: the old one as far as it is free, around what is blocked
    /// on it now, and all anew only where that is not done in a short search. That cells became free elsewhere is not
    /// looked at: plan anew for that.
    ///
    /// # Errors
    /// As [`plan`](Self::plan).
    pub fn replan(&mut self, path: &Path, here: Progress, options: &PlanOptions) -> Result<(Path, How), PlanError> {
        let scale = self.scale(options)?;
        let mut points = self.rest(path, here)?;
        let how = match self.blocked_part(&points) {
            None => How::Kept,
            Some(blocked) if self.mend(&mut points, blocked, scale) => How::Mended,
            Some(_) => {
                let goal = path.waypoints.last().copied().unwrap_or(here.q);
                return Ok((self.plan(here.q, goal, options)?, How::Anew));
            }
        };
        let goal = path.waypoints.last().copied().unwrap_or(here.q);
        let mut rest = self.path(&points, scale, &[self.place(End::Start, here.q)?, self.place(End::Goal, goal)?]);
        rest.goal_moved_rad = path.goal_moved_rad;
        Ok((rest, how))
    }

    fn place(&self, end: End, q: [f64; 3]) -> Result<Place, PlanError> {
        let cell = self.cell(end, q)?;
        Ok(Place { cell, point: self.space.point_within(q, cell), q, moved: 0.0 })
    }

    /// The arm and the waypoints before it, as points.
    fn rest(&self, path: &Path, here: Progress) -> Result<Vec<Point>, PlanError> {
        let ahead = path.waypoints.get(here.leg + 1..).unwrap_or(&[]);
        let mut points = Vec::with_capacity(ahead.len() + 1);
        points.push(self.place(End::Start, here.q)?.point);
        for &q in ahead {
            points.push(self.place(End::Goal, q)?.point);
        }
        Ok(points)
    }

    /// The first and the last blocked place: leg and fraction of it.
    fn blocked_part(&self, points: &[Point]) -> Option<[(usize, f64); 2]> {
        let legs = 0..points.len().saturating_sub(1);
        let first = |n: usize| Some((n, first_blocked(&self.table, points[n], points[n + 1])?));
        let last = |n: usize| Some((n, 1.0 - first_blocked(&self.table, points[n + 1], points[n])?));
        let from = legs.clone().find_map(first);
        let lone = points.len() == 1 && first_blocked(&self.table, points[0], points[0]).is_some();
        let from = from.or(lone.then_some((0, 0.0)))?;
        Some([from, legs.rev().find_map(last).unwrap_or(from)])
    }

    /// Goes around the blocked part; false where that is no short search.
    fn mend(&mut self, points: &mut Vec<Point>, [from, to]: [(usize, f64); 2], scale: Scale) -> bool {
        let away = AWAY * scale.0.iter().sum::<f64>() / 3.0;
        if points.len() < 2 {
            return false;
        }
        let ground = Ground { table: &self.table, space: &self.space, scale };
        let part = [on(&points[from.0..], from.1), on(&points[to.0..], to.1)];
        if let Some(corner) = sidestep(ground, [points[from.0], points[to.0 + 1]], part) {
            points.splice(from.0 + 1..=to.0, [corner]);
            return true;
        }
        let (first, a) = back(points, from, away, scale);
        let (last, b) = ahead(points, to, away, scale);
        let ends = [a, b].map(|p| (p, p.map(|x| x.max(0.0) as u16)));
        let mut detour = Vec::new();
        if !self.between(scale, ends[0], ends[1], MOST_NODES, &mut detour) {
            return false;
        }
        // With the corners before and after: where the detour leaves the old path need not be one.
        detour.insert(0, points[first]);
        detour.push(points[last + 1]);
        let ground = Ground { table: &self.table, space: &self.space, scale };
        self.polish.run(ground, &mut detour);
        points.splice(first..=last + 1, detour);
        true
    }
}

fn on(leg: &[Point], t: f64) -> Point {
    [0, 1, 2].map(|i| leg[0][i] + (leg[1][i] - leg[0][i]) * t)
}

/// The point so far before a place, and its leg.
fn back(points: &[Point], (mut leg, t): (usize, f64), mut away: f64, scale: Scale) -> (usize, Point) {
    let mut at = on(&points[leg..], t);
    loop {
        let far = scale.distance(points[leg], at);
        if far > away {
            let share = away / far;
            return (leg, on(&[at, points[leg]], share));
        }
        if leg == 0 {
            return (0, points[0]);
        }
        away -= far;
        at = points[leg];
        leg -= 1;
    }
}

/// The point so far after a place, and its leg.
fn ahead(points: &[Point], (mut leg, t): (usize, f64), mut away: f64, scale: Scale) -> (usize, Point) {
    let mut at = on(&points[leg..], t);
    loop {
        let far = scale.distance(at, points[leg + 1]);
        if far > away {
            return (leg, on(&[at, points[leg + 1]], away / far));
        }
        if leg + 2 == points.len() {
            return (leg, points[leg + 1]);
        }
        away -= far;
        at = points[leg + 1];
        leg += 1;
    }
}
