//! Trees of balls with sixteen children per node: sixteen lanes test them at the same time.

use elbowroom_validity::Ball;
use elbowroom_validity::lanes::LANES;

/// Number of balls above which a node has sixteen children.
const FULL_NODE: usize = 64;

/// Index that means that a ball has no group below.
pub(super) const LEAF: u32 = u32::MAX;

/// Up to sixteen balls; each ball is a leaf or encloses the balls of another group.
#[derive(Debug, Clone)]
pub(super) struct BallGroup {
    pub balls: Vec<Ball>,
    /// Per ball, the index of the group below, or [`LEAF`].
    pub below: Vec<u32>,
}

/// The tree of some balls, root first; empty if there are no balls.
pub(super) fn ball_tree(balls: &[Ball]) -> Vec<BallGroup> {
    let mut groups = Vec::new();
    if !balls.is_empty() {
        push(&mut groups, &mut balls.to_vec());
    }
    groups
}

fn push(groups: &mut Vec<BallGroup>, balls: &mut [Ball]) -> u32 {
    let number = groups.len();
    groups.push(BallGroup { balls: Vec::new(), below: Vec::new() });
    if balls.len() <= LANES {
        groups[number] = BallGroup { balls: balls.to_vec(), below: vec![LEAF; balls.len()] };
        return number as u32;
    }
    // A large node uses all parts, because large boxes are tested only against the root; other nodes use as few parts
    // as leave full groups at the bottom.
    let parts = if balls.len() > FULL_NODE { LANES } else { balls.len().div_ceil(LANES) };
    for part in split(balls, parts) {
        let ball = Ball::enclosing(part);
        let below = if part.len() == 1 { LEAF } else { push(groups, part) };
        groups[number].balls.push(ball);
        groups[number].below.push(below);
    }
    number as u32
}

/// Splits balls along the longest axis into nonempty groups of about the same size.
pub(super) fn split(balls: &mut [Ball], parts: usize) -> Vec<&mut [Ball]> {
    if parts == 1 || balls.len() == 1 {
        return vec![balls];
    }
    let range = |axis: usize| {
        let values = balls.iter().map(|b| b.centre[axis]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        high - low
    };
    let axis = (0..3).fold(0, |best, k| if range(k) > range(best) { k } else { best });
    balls.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    let below = parts / 2;
    let (low, high) = balls.split_at_mut(balls.len() * below / parts);
    let mut groups = split(low, below);
    groups.extend(split(high, parts - below));
    groups
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::Vec3;
    use elbowroom_testkit::random::Random;

    use super::*;

    #[test]
    fn every_ball_is_a_leaf_and_lies_in_those_above() {
        let mut random = Random(5);
        for count in [1, 2, 15, 16, 17, 40, 257, 900] {
            let balls: Vec<Ball> = (0..count)
                .map(|_| Ball {
                    centre: Vec3::new(random.unit(), random.unit(), random.unit()),
                    radius: 0.1 * random.unit(),
                })
                .collect();
            let groups = ball_tree(&balls);
            let mut leaves = 0;
            let mut open: Vec<(u32, Vec<Ball>)> = vec![(0, Vec::new())];
            while let Some((group, above)) = open.pop() {
                let group = &groups[group as usize];
                assert!((1..=LANES).contains(&group.balls.len()));
                for (ball, &below) in group.balls.iter().zip(&group.below) {
                    if below != LEAF {
                        open.push((below, above.iter().copied().chain([*ball]).collect()));
                        continue;
                    }
                    leaves += 1;
                    let fits = |a: &Ball| a.centre.distance(ball.centre) + ball.radius <= a.radius;
                    assert!(above.iter().all(fits));
                }
            }
            assert_eq!(leaves, count);
        }
    }
}
