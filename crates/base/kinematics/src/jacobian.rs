//! The geometric Jacobian.

use elbowroom_spatial::Vec3;

use crate::{Chain, ChainState, JointKind, LinkId};

impl Chain {
    /// Geometric Jacobian of the point `point_in_link` (m, in the link's frame) at the poses of the last
    /// [`Chain::forward`].
    ///
    /// `out[i]` is the velocity of the point (x, y, z, m/s) and the angular velocity of the link (x, y, z, rad/s), both
    /// in the root's frame, per unit of `qd[i]`. The contribution of a mimic joint is added to the column of the joint
    /// that it follows. Does not allocate.
    ///
    /// `out` has [`Chain::dof`] columns. If it is longer, the additional columns are zeroed; if it is shorter, the last
    /// columns are left out.
    ///
    /// # Panics
    /// Panics if the state was created for a chain with fewer links.
    ///
    /// ```
    /// # use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
    /// # use elbowroom_spatial::{Pose, Vec3};
    /// # let joint = Joint { name: "j".into(), kind: JointKind::Revolute, parent: LinkId(0), child: LinkId(1),
    /// #     origin: Pose::IDENTITY, axis: Vec3::Z, limits: Limits::UNLIMITED, mimic: None };
    /// # let chain = Chain::new("a", vec!["base".into(), "arm".into()], vec![joint]).unwrap();
    /// let state = ChainState::new(&chain); // one joint about z
    /// let mut columns = [[0.0; 6]; 1];
    /// chain.jacobian(&state, chain.tip(), Vec3::X * 0.5, &mut columns);
    /// assert_eq!(columns[0], [0.0, 0.5, 0.0, 0.0, 0.0, 1.0]);
    /// ```
    pub fn jacobian(&self, state: &ChainState, link: LinkId, point_in_link: Vec3, out: &mut [[f64; 6]]) {
        out.fill([0.0; 6]);
        let point = state.poses[link.0].transform_point(point_in_link);
        let mut at = link;
        while let Some(id) = self.parent_joint(at) {
            let joint = &self.joints[id.0];
            at = joint.parent;
            let Some(coupling) = self.couplings[id.0] else {
                continue;
            };
            let Some(column) = out.get_mut(coupling.index) else {
                continue;
            };
            let child_in_root = &state.poses[joint.child.0];
            let axis = (child_in_root.rotation * joint.axis) * coupling.multiplier;
            let (linear, angular) = if joint.kind == JointKind::Prismatic {
                (axis, Vec3::ZERO)
            } else {
                (axis.cross(point - child_in_root.translation), axis)
            };
            for i in 0..3 {
                column[i] += linear[i];
                column[i + 3] += angular[i];
            }
        }
    }
}
