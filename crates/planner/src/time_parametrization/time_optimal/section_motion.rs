//! Section motions: the motion along a part of a path from rest to rest.

use super::super::limits::{KinematicLimits, TimeParametrizationError};
use super::blended_path::PathSection;
use super::interior_point;
use super::jerk_constraints::JerkConstraints;
use super::limit_excess::time_stretch;
use super::path_grid::PathGrid;
use super::path_speed::{PathState, SpeedLaw, SpeedPiece};
use super::scaled_limits::ScaledLimits;
use super::speed_spline::SpeedSpline;
use super::topp_ra;

/// A motion in time.
#[derive(Debug, Clone)]
pub(super) struct SectionMotion {
    pieces: Vec<SpeedPiece>,
    /// Index of the path element of each piece.
    elements: Vec<u32>,
    /// Time of the pieces per second, 1/s.
    pub rate: f64,
    /// Duration in the pieces' time.
    duration: f64,
}

impl SectionMotion {
    /// The fastest motion within velocity and acceleration.
    pub fn without_jerk_limit(
        section: &PathSection,
        limits: &KinematicLimits,
    ) -> Result<Self, TimeParametrizationError> {
        let scaled = ScaledLimits::new(section, limits)?;
        let grid = PathGrid::new(section, &scaled.limits);
        let x = topp_ra::squared_speeds(section, &grid, &scaled.limits);
        let motion = Self::new(section, grid.elements.clone(), constant_pieces(&grid, &x), &scaled, 2);
        motion.ok_or(TimeParametrizationError::Path)
    }

    /// The fastest motion within velocity, acceleration and jerk.
    pub fn with_jerk_limit(section: &PathSection, limits: &KinematicLimits) -> Result<Self, TimeParametrizationError> {
        let scaled = ScaledLimits::new(section, limits)?;
        let grid = PathGrid::new(section, &scaled.limits);
        let most = topp_ra::squared_speeds(section, &grid, &scaled.limits);
        let spline = SpeedSpline::new(&grid);
        let constraints = JerkConstraints::new(section, &grid, &spline, &scaled.limits, &most);
        let feasible = constraints.feasible_coefficients(section, &grid, &scaled.limits, &most);
        let fastest = interior_point::fastest(&constraints, feasible.clone());
        let motion =
            |coefficients: &[f64]| Self::new(section, grid.elements.clone(), spline.pieces(coefficients), &scaled, 3);
        motion(&fastest).or_else(|| motion(&feasible)).ok_or(TimeParametrizationError::Path)
    }

    /// Slowed down to keep all limits; none where that is not finite.
    fn new(
        section: &PathSection,
        elements: Vec<u32>,
        (pieces, duration): (Vec<SpeedPiece>, f64),
        scaled: &ScaledLimits,
        orders: usize,
    ) -> Option<Self> {
        let stretch = time_stretch(section, &elements, &pieces, &scaled.limits, orders);
        let rate = 1.0 / (stretch * scaled.unit);
        let is_valid = (duration / rate).is_finite() && rate.is_finite() && rate > 0.0;
        is_valid.then_some(Self { pieces, elements, rate, duration })
    }

    /// Duration, s.
    pub fn seconds(&self) -> f64 {
        self.duration / self.rate
    }

    /// Number of grid intervals.
    pub fn intervals(&self) -> usize {
        self.pieces.len()
    }

    /// State along the path after `t` seconds, per second and its powers, and the path element.
    pub fn at(&self, t: f64) -> (PathState, usize) {
        let time = (t * self.rate).clamp(0.0, self.duration);
        let n = self.pieces.partition_point(|p| p.time <= time).saturating_sub(1);
        let piece = &self.pieces[n];
        let [s, v, a, j] = piece.at((time - piece.time).min(piece.seconds));
        let r = self.rate;
        ([s, v * r, a * r * r, j * r * r * r], self.elements[n] as usize)
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
