//! Candidate targets of an escape: structured and random joint motions.

use elbowroom_spatial::Vec3;

use crate::escape_trajectory::EscapeStart;
use elbowroom_kinematics::JointLimits;

/// Number of targets of a round: structured ones first, then random ones. The random ones differ from round to round.
pub(crate) const ROUND: usize = 50;
/// Sizes of the motions, in seconds of a joint at full speed.
const SIZES_S: [f64; 3] = [0.4, 0.8, 1.4];
/// Joints that move alone: the first three move the most.
const SINGLE_JOINTS: usize = 3;
/// Distance kept from the position limits, rad or m: a tick at full speed, so that a stop at the limit is never harder
/// than elsewhere.
const LIMIT_RESERVE: f64 = 0.02;

/// The obstacle and the point that targets evade, in the frame of the robot's root.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EscapeDirections<'a> {
    /// Velocity of the hit point, per joint at its top speed, m/s.
    pub(crate) point: &'a [Vec3],
    /// The hit point, m.
    pub(crate) at: Vec3,
    /// Direction in which the obstacle moves, a unit vector.
    pub(crate) along: Vec3,
}

/// Writes target number `index` to `out`. `homes` lists configurations to which the robot may return: its path and its
/// start.
pub(crate) fn target(
    index: usize,
    rest_q: &[f64],
    start: &EscapeStart<'_>,
    directions: &EscapeDirections<'_>,
    homes: [&[f64]; 2],
    out: &mut [f64],
) {
    let (round, n) = (index / ROUND, index % ROUND);
    let joints = SINGLE_JOINTS.min(out.len());
    let by_direction = SIZES_S.len() * DIRECTIONS;
    let single = 2 * SIZES_S.len() * joints;
    match n {
        0 | 1 => out.copy_from_slice(homes[n]),
        n if n < 2 + by_direction => {
            let n = n - 2;
            toward(
                direction(n % DIRECTIONS, directions),
                SIZES_S[n / DIRECTIONS],
                rest_q,
                start.limits,
                directions,
                out,
            );
        }
        n if n < 2 + by_direction + single => {
            let n = n - 2 - by_direction;
            out.copy_from_slice(rest_q);
            let sign = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
            let (joint, size) = ((n / 2) % joints, SIZES_S[n / (2 * joints)]);
            out[joint] += sign * size * start.limits[joint].velocity;
        }
        n => {
            let size = SIZES_S[n % SIZES_S.len()];
            for (j, out) in out.iter_mut().enumerate() {
                *out = rest_q[j] + (2.0 * quasi_random(round * ROUND + n, j) - 1.0) * size * start.limits[j].velocity;
            }
        }
    }
    for (out, limit) in out.iter_mut().zip(start.limits) {
        let middle = 0.5 * (limit.lower + limit.upper);
        let (low, high) = (limit.lower + LIMIT_RESERVE, limit.upper - LIMIT_RESERVE);
        *out = if low <= high { out.clamp(low, high) } else { middle };
    }
}

/// Number of candidate directions.
const DIRECTIONS: usize = 7;

/// Candidate directions: across the motion of the obstacle to four sides, along it, towards the axis of the base, and
/// obliquely up towards that axis.
fn direction(n: usize, directions: &EscapeDirections<'_>) -> Vec3 {
    let along = directions.along;
    let side = along.cross(Vec3::Z).try_normalize().unwrap_or(Vec3::X);
    let up = side.cross(along);
    let inward = (Vec3::Z * directions.at.z - directions.at).try_normalize().unwrap_or(up);
    match n {
        0 => side,
        1 => -side,
        2 => up,
        3 => inward,
        4 => -up,
        5 => along,
        _ => inward + up,
    }
}

/// The smallest joint motion that moves the point in a direction, scaled to a size in seconds.
fn toward(
    direction: Vec3,
    size_s: f64,
    rest_q: &[f64],
    limits: &[JointLimits],
    directions: &EscapeDirections<'_>,
    out: &mut [f64],
) {
    let shares = || directions.point.iter().map(|p| p.dot(direction));
    let largest = shares().map(f64::abs).fold(f64::MIN_POSITIVE, f64::max);
    for (j, share) in shares().enumerate() {
        out[j] = rest_q[j] + share / largest * size_s * limits[j].velocity;
    }
}

/// The additive recurrence of Roberts: evenly spread in up to 16 dimensions, and equal on every machine.
fn quasi_random(n: usize, dimension: usize) -> f64 {
    // Fractional parts of the square roots of the primes are linearly independent over the rationals.
    const PRIMES: [f64; 16] =
        [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0, 47.0, 53.0];
    ((n + 1) as f64 * PRIMES[dimension % PRIMES.len()].sqrt()).fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reversal_limiter::ReversalLimiter;

    #[test]
    fn a_round_holds_homes_structured_and_random_targets_within_the_limits() {
        let limits = [JointLimits::new(2.0, 8.0, f64::INFINITY).within(-2.0, 1.5).stopping_at(20.0); 6];
        let (q, qd, home) = ([0.3; 6], [0.0; 6], [-0.7; 6]);
        let reversals = ReversalLimiter::new(6, 0.25);
        let start = EscapeStart { q: &q, qd: &qd, limits: &limits, speed_share: 1.0, reversals: &reversals };
        let point: Vec<Vec3> = (0..6).map(|j| Vec3::new(f64::from(j), 1.0, -0.5)).collect();
        let directions = EscapeDirections { point: &point, at: Vec3::new(1.0, 0.5, 1.0), along: Vec3::X };
        let all: Vec<Vec<f64>> = (0..2 * ROUND)
            .map(|n| {
                let mut out = vec![0.0; 6];
                target(n, &q, &start, &directions, [&home, &q], &mut out);
                out
            })
            .collect();
        assert_eq!((&all[0][..], &all[1][..]), (&home[..], &q[..]));
        assert!(all.iter().flatten().all(|q| (-2.0..=1.5).contains(q)));
        // To the side: every joint moves the point to this side.
        let side = Vec3::X.cross(Vec3::Z);
        assert!(all[2].iter().zip(&q).zip(&point).all(|((to, from), p)| (to - from) * p.dot(side) >= 0.0));
        // The structured targets repeat, the random ones do not.
        assert_eq!(all[..30], all[ROUND..ROUND + 30]);
        let mut random: Vec<&Vec<f64>> = all[42..ROUND].iter().chain(&all[ROUND + 42..]).collect();
        random.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert!(random.windows(2).all(|w| w[0] != w[1]));
    }
}
