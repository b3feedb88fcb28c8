//! Section motions: motion along the part of a path from one rest to the next.

use super::super::limits::TimeParametrizationError;
use super::blended_path::PathSection;
use super::interior_point;
use super::jerk_constraints::JerkConstraints;
use super::limit_excess::{Ratios, ratios, time_stretch};
use super::path_grid::{GridDensity, PathGrid};
use super::path_speed::{PathState, SpeedLaw, SpeedPiece};
use super::scaled_limits::ScaledLimits;
use super::speed_spline::SpeedSpline;
use super::topp_ra::ReachabilityAnalysis;
use elbowroom_kinematics::JointLimits;

/// Densities without and with the limit of jerk.
const DENSITIES: [GridDensity; 2] = [
    GridDensity { per_blend: 16, per_straight: [32.0, 32.0] },
    GridDensity { per_blend: 8, per_straight: [6.0, 16.0] },
];
/// Time stretches, without and with the limit of jerk, below which another solution with tightened constraints gains
/// nothing.
const FINE_STRETCH: [f64; 2] = [1.002, 1.01];
const MAX_REFINEMENTS: [usize; 2] = [4, 1];

/// A motion in time.
#[derive(Debug, Clone)]
pub(super) struct SectionMotion {
    pieces: Vec<SpeedPiece>,
    /// Index of the path element of each piece.
    elements: Vec<u32>,
    /// Time of the pieces per second, 1/s.
    pub rate: f64,
    /// Duration in the time unit of the pieces.
    duration: f64,
}

/// A section with its limits, its grid, and the order of the highest derivative that is limited.
struct Problem<'p> {
    section: &'p PathSection,
    scaled: ScaledLimits,
    grid: PathGrid,
    orders: usize,
}

/// A motion, if it is finite, and the excess of each piece over the limits before time is stretched.
struct Attempt {
    motion: Option<SectionMotion>,
    ratios: Vec<Ratios>,
    stretch: f64,
}

impl SectionMotion {
    /// The fastest motion within limits of velocity and acceleration.
    pub fn without_jerk_limit(section: &PathSection, limits: &[JointLimits]) -> Result<Self, TimeParametrizationError> {
        let problem = Problem::new(section, limits, 2)?;
        let mut analysis = ReachabilityAnalysis::new(section, &problem.grid, &problem.scaled.limits);
        let solve = |analysis: &ReachabilityAnalysis| {
            problem.attempt(constant_pieces(&problem.grid, &analysis.squared_speeds(&problem.grid)))
        };
        let mut best = solve(&analysis);
        for _ in 0..MAX_REFINEMENTS[0] {
            if best.stretch < FINE_STRETCH[0] {
                break;
            }
            analysis.tighten(&best.ratios);
            best = best.or_better(solve(&analysis));
        }
        best.motion.ok_or(TimeParametrizationError::Path)
    }

    /// The fastest motion within limits of velocity, acceleration and jerk.
    pub fn with_jerk_limit(section: &PathSection, limits: &[JointLimits]) -> Result<Self, TimeParametrizationError> {
        let problem = Problem::new(section, limits, 3)?;
        let (grid, limits) = (&problem.grid, &problem.scaled.limits);
        let most = ReachabilityAnalysis::new(section, grid, limits).squared_speeds(grid);
        let spline = SpeedSpline::new(grid);
        let mut constraints = JerkConstraints::new(section, grid, &spline, limits, &most);
        let first = constraints.feasible_coefficients(section, grid, limits, &most);
        let mut coefficients = interior_point::fastest(&constraints, first.clone());
        let mut best = problem.attempt(spline.pieces(&coefficients));
        for _ in 0..MAX_REFINEMENTS[1] {
            if best.stretch < FINE_STRETCH[1] {
                break;
            }
            constraints.tighten(&best.ratios);
            coefficients = interior_point::fastest(&constraints, constraints.made_feasible(coefficients));
            best = best.or_better(problem.attempt(spline.pieces(&coefficients)));
        }
        let motion = best.motion.or_else(|| problem.attempt(spline.pieces(&first)).motion);
        motion.ok_or(TimeParametrizationError::Path)
    }

    /// Duration, s.
    pub fn seconds(&self) -> f64 {
        self.duration / self.rate
    }

    /// Number of grid intervals.
    pub fn intervals(&self) -> usize {
        self.pieces.len()
    }

    /// State along the path after `t` seconds, in seconds and their powers, and the path element.
    pub fn at(&self, t: f64) -> (PathState, usize) {
        let time = (t * self.rate).clamp(0.0, self.duration);
        let n = self.pieces.partition_point(|p| p.time <= time).saturating_sub(1);
        let piece = &self.pieces[n];
        let [s, v, a, j] = piece.at((time - piece.time).min(piece.seconds));
        let r = self.rate;
        ([s, v * r, a * r * r, j * r * r * r], self.elements[n] as usize)
    }
}

impl<'p> Problem<'p> {
    fn new(section: &'p PathSection, limits: &[JointLimits], orders: usize) -> Result<Self, TimeParametrizationError> {
        let scaled = ScaledLimits::new(section, limits)?;
        let grid = PathGrid::new(section, &scaled.limits, DENSITIES[orders - 2]);
        Ok(Self { section, scaled, grid, orders })
    }

    /// The motion slowed down to keep all limits.
    fn attempt(&self, (pieces, duration): (Vec<SpeedPiece>, f64)) -> Attempt {
        let elements = &self.grid.elements;
        let ratios = ratios(self.section, elements, &pieces, &self.scaled.limits, self.orders);
        let stretch = time_stretch(&ratios);
        let rate = 1.0 / (stretch * self.scaled.unit);
        let is_valid = (duration / rate).is_finite() && rate.is_finite() && rate > 0.0;
        let motion = is_valid.then(|| SectionMotion { pieces, elements: elements.clone(), rate, duration });
        Attempt { motion, ratios, stretch }
    }
}

impl Attempt {
    fn seconds(&self) -> f64 {
        self.motion.as_ref().map_or(f64::INFINITY, SectionMotion::seconds)
    }

    fn or_better(self, other: Self) -> Self {
        if other.seconds() < self.seconds() { other } else { self }
    }
}

/// Pieces of constant acceleration along the path, and their duration.
fn constant_pieces(grid: &PathGrid, x: &[f64]) -> (Vec<SpeedPiece>, f64) {
    let mut time = 0.0;
    let pieces = (0..grid.intervals()).map(|n| {
        let h = grid.spacing(n);
        let (law, seconds) = SpeedLaw::linear(h, x[n], x[n + 1], 0.5 * (x[n + 1] - x[n]) / h, 0.0);
        let piece = SpeedPiece { time, position: grid.nodes[n], seconds, law };
        time += seconds;
        piece
    });
    let pieces = pieces.collect();
    (pieces, time)
}
