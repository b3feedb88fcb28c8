//! Limit excess: the factor by which a motion must be slowed down to keep all limits everywhere, not only at the points
//! where they were imposed.

use super::super::limits::in_direction;
use super::blended_path::PathSection;
use super::path_element::PathElement;
use super::path_speed::{PathState, SpeedPiece};
use elbowroom_kinematics::JointLimits;

/// Number of intervals of a piece; between their ends, values are bounded by their second differences.
const SAMPLES: usize = 4;
/// Margin for rounding.
const MARGIN: f64 = 1e-9;

/// Largest ratios of velocity, acceleration and jerk to their limits.
pub(super) type Ratios = [f64; 3];

/// The ratios of each piece. `orders` is 3 with the limit of jerk, 2 without.
pub(super) fn ratios(
    section: &PathSection,
    elements: &[u32],
    pieces: &[SpeedPiece],
    limits: &[JointLimits],
    orders: usize,
) -> Vec<Ratios> {
    let each = pieces.iter().zip(elements).enumerate().map(|(n, (piece, element))| {
        let end = pieces.get(n + 1).map_or(section.length, |next| next.position);
        let states = piece.over(end - piece.position);
        let mut ratios = piece_ratios(&section.elements[*element as usize], &states, limits);
        if orders < 3 {
            ratios[2] = 0.0;
        }
        ratios
    });
    each.collect()
}

/// The factor, at least 1, by which time must be stretched.
pub(super) fn time_stretch(ratios: &[Ratios]) -> f64 {
    let mut stretch = 1.0;
    for [v, a, j] in ratios {
        let needed = v.max(a.sqrt()).max(j.cbrt());
        // Keeps NaN.
        if !(needed <= stretch) {
            stretch = needed;
        }
    }
    stretch * (1.0 + MARGIN)
}

fn piece_ratios(element: &PathElement, states: &[PathState; SAMPLES + 1], limits: &[JointLimits]) -> Ratios {
    let mut ratios: Ratios = [0.0; 3];
    if element.is_straight() {
        let along = in_direction(limits, &element.direction);
        let scales = [along.velocity, along.acceleration, along.jerk].map(f64::recip);
        include(&mut ratios, states.map(|[_, v, a, j]| [v * scales[0], a * scales[1], j * scales[2]]));
        return ratios;
    }
    for joint in 0..limits.len() {
        let scales = [limits[joint].velocity, limits[joint].acceleration, limits[joint].jerk].map(f64::recip);
        include(&mut ratios, states.map(|state| joint_derivatives(element, state, joint, scales)));
    }
    ratios
}

/// Velocity, acceleration and jerk of a joint, each times a scale.
fn joint_derivatives(element: &PathElement, [s, v, a, j]: PathState, joint: usize, scales: [f64; 3]) -> [f64; 3] {
    let [_, p, c, d] = element.at(s, joint);
    [p * v * scales[0], (p * a + c * v * v) * scales[1], (p * j + 3.0 * c * v * a + d * v * v * v) * scales[2]]
}

/// Includes the samples of a smooth function, which exceeds them by at most about an eighth of its second difference.
fn include(ratios: &mut Ratios, samples: [[f64; 3]; SAMPLES + 1]) {
    for order in 0..3 {
        let mut bend: f64 = 0.0;
        let mut most: f64 = 0.0;
        for n in 0..=SAMPLES {
            most = most.max(samples[n][order].abs());
            if n > 1 {
                bend = bend.max((samples[n][order] - 2.0 * samples[n - 1][order] + samples[n - 2][order]).abs());
            }
        }
        ratios[order] = ratios[order].max(most + 0.125 * bend);
    }
}
