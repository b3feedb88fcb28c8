//! The hit point of a robot, and the velocity that its joints give it.

use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_spatial::Vec3;

/// Velocity that each joint gives a point at its top speed, in the frame of the base.
#[derive(Debug)]
pub(crate) struct HitPoint {
    /// Per joint, m/s.
    pub velocity: Vec<Vec3>,
    chain: ChainState,
    columns: Vec<[f64; 6]>,
}

impl HitPoint {
    pub fn new(chain: &Chain) -> Self {
        let n = chain.dof();
        Self { velocity: vec![Vec3::ZERO; n], chain: ChainState::new(chain), columns: vec![[0.0; 6]; n] }
    }

    /// Computes the velocities for a point of a link, given in the root frame (m), at the configuration that `place`
    /// writes, with the joints' top speeds, rad/s or m/s.
    pub fn update(
        &mut self,
        chain: &Chain,
        place: impl FnOnce(&mut [f64]),
        (link, in_root): (LinkId, Vec3),
        speeds: impl Iterator<Item = f64>,
    ) {
        place(&mut self.chain.q);
        chain.forward(&mut self.chain);
        let in_link = self.chain.link_in_root(link).inverse().transform_point(in_root);
        chain.jacobian(&self.chain, link, in_link, &mut self.columns);
        for ((velocity, c), speed) in self.velocity.iter_mut().zip(&self.columns).zip(speeds) {
            *velocity = Vec3::new(c[0], c[1], c[2]) * speed;
        }
    }
}
