//! Residual of a table: how well the product of its rows reproduces a chain.

use elbowroom_spatial::Pose;

use crate::inverse::sequence::sample_configuration;
use crate::{Chain, ChainState, LinkId};

/// Number of configurations at which the residual is measured.
const CONFIGURATIONS: usize = 32;

/// Returns a joint's value for its name.
pub type JointValues<'a> = &'a dyn Fn(&str) -> f64;

/// Largest difference of an entry between `product` and forward kinematics over a fixed set of configurations; NaN if an
/// entry is NaN.
pub fn residual(chain: &Chain, tip: LinkId, tool_in_tip: Pose, product: impl Fn(JointValues<'_>) -> Pose) -> f64 {
    let mut state = ChainState::new(chain);
    let mut worst: f64 = 0.0;
    for index in 0..CONFIGURATIONS {
        sample_configuration(chain, index, &mut state.q);
        chain.forward(&mut state);
        let value = |name: &str| chain.joint(name).map_or(f64::NAN, |id| chain.joint_value(id, &state.q));
        let difference = largest_difference(&product(&value), &(state.link_in_root(tip) * tool_in_tip));
        // `max` would drop a NaN.
        worst = if difference.is_nan() { f64::NAN } else { worst.max(difference) };
    }
    worst
}

fn largest_difference(a: &Pose, b: &Pose) -> f64 {
    let pairs = a.to_rows().into_iter().flatten().zip(b.to_rows().into_iter().flatten());
    pairs.map(|(x, y)| (x - y).abs()).fold(0.0, |m, d| if d > m || d.is_nan() { d } else { m })
}
