//! Trees of balls: a node encloses all balls below it.

use elbowroom_validity::Ball;

/// Children of an inner node.
const FAN_OUT: usize = 4;

/// A node of a tree, in a list in depth-first order.
#[derive(Debug, Clone, Copy)]
pub(super) struct BallNode {
    pub ball: Ball,
    /// Number of the node after all that are below this one, counted from the root.
    pub end: usize,
    pub is_leaf: bool,
}

/// The tree of some balls; empty without balls.
pub(super) fn ball_tree(balls: &[Ball]) -> Vec<BallNode> {
    let mut nodes = Vec::new();
    if !balls.is_empty() {
        push(&mut nodes, &mut balls.to_vec());
    }
    nodes
}

fn push(nodes: &mut Vec<BallNode>, balls: &mut [Ball]) {
    let is_leaf = balls.len() == 1;
    let ball = if is_leaf { balls[0] } else { Ball::enclosing(balls) };
    let index = nodes.len();
    nodes.push(BallNode { ball, end: 0, is_leaf });
    if !is_leaf {
        for part in split(balls, FAN_OUT) {
            push(nodes, part);
        }
    }
    nodes[index].end = nodes.len();
}

/// Splits balls at medians along the longest axis into at most `parts` groups, none empty.
fn split(balls: &mut [Ball], parts: usize) -> Vec<&mut [Ball]> {
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
    let (low, high) = balls.split_at_mut(balls.len() / 2);
    let mut groups = split(low, parts / 2);
    groups.extend(split(high, parts / 2));
    groups
}
