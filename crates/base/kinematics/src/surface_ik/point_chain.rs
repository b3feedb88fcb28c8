//! The chain that ends in a point: forward kinematics and Jacobians.

use elbowroom_spatial::{Pose, Vec3};

use super::error::PointError;
use super::goal::Tangents;
use super::options::SurfaceIkOptions;
use super::oriented_point::OrientedPoint;
use crate::inverse::arm::Arm;
use crate::inverse::levenberg_marquardt::LmWorkspace;
use crate::inverse::sequence::axis_step;
use crate::{Chain, JointId, LinkId};

/// A point fixed on a link, with its outward normal if it is known, and the joints that move the point. Contains its
/// data of the chain and its workspace: only [`PointChain::new`] allocates.
#[derive(Debug, Clone)]
pub struct PointChain {
    pub(super) arm: Arm,
    pub(super) options: SurfaceIkOptions,
    link: LinkId,
    point_in_link: Vec3,
    normal_in_link: Option<Vec3>,
    /// The link's frame in the frame of the last joint before it.
    link_in_last: Pose,
    pub(super) joints: Vec<JointId>,
    pub(super) dof: usize,
    /// Length (m) whose error counts as much as one radian.
    pub(super) scale: f64,
    /// Increments of the sequence of starts, one per variable.
    pub(super) increments: Vec<f64>,
    pub(super) position: LmWorkspace<3>,
    pub(super) surface: LmWorkspace<5>,
    pub(super) x: Vec<f64>,
    pub(super) best: Vec<f64>,
}

impl PointChain {
    /// Creates the chain of the point `point_in_link` (m) of the link, with the outward normal `normal_in_link` (any
    /// length), both in the link's frame.
    ///
    /// # Errors
    /// [`PointError::UnknownLink`], [`PointError::PointNotFinite`] or [`PointError::NormalWithoutDirection`].
    pub fn new(
        chain: &Chain,
        link: LinkId,
        point_in_link: Vec3,
        normal_in_link: Option<Vec3>,
        options: SurfaceIkOptions,
    ) -> Result<Self, PointError> {
        if link.0 >= chain.links().len() {
            return Err(PointError::UnknownLink { link: link.0, last: chain.links().len() - 1 });
        }
        let arm = Arm::new(chain, link, Pose::IDENTITY);
        let n = arm.variables.len();
        let mut this = Self {
            options,
            link,
            point_in_link: Vec3::ZERO,
            normal_in_link: None,
            link_in_last: arm.tip_in_last,
            joints: arm.variables.iter().map(|v| chain.active_joints()[v.q_index]).collect(),
            dof: chain.dof(),
            scale: 1.0,
            increments: (0..n).map(|axis| axis_step(axis, n)).collect(),
            position: LmWorkspace::new(&arm),
            surface: LmWorkspace::new(&arm),
            x: vec![0.0; n],
            best: vec![0.0; n],
            arm,
        };
        this.set_point(point_in_link, normal_in_link)?;
        Ok(this)
    }

    /// Changes to another point of the same link. Does not allocate; on error the old point is kept.
    ///
    /// # Errors
    /// [`PointError::PointNotFinite`] or [`PointError::NormalWithoutDirection`].
    pub fn set_point(&mut self, point_in_link: Vec3, normal_in_link: Option<Vec3>) -> Result<(), PointError> {
        if !point_in_link.is_finite() {
            return Err(PointError::PointNotFinite);
        }
        self.normal_in_link = direction(normal_in_link)?;
        self.point_in_link = point_in_link;
        self.arm.set_tip(self.link_in_last * Pose::from_translation(point_in_link));
        self.scale = self.arm.scale();
        Ok(())
    }

    /// Holds joints at their values in `q` (all of the chain's, rad or m): searches leave them where they are. The
    /// closure is asked with the index of each value. A value that is not finite is refused by the searches themselves.
    pub fn hold(&mut self, q: &[f64], is_held: impl Fn(usize) -> bool) {
        for variable in self.arm.variables.iter_mut().filter(|variable| is_held(variable.q_index)) {
            let value = q.get(variable.q_index).copied().unwrap_or(f64::NAN);
            (variable.lower, variable.upper, variable.wraps) = (value, value, false);
        }
    }

    /// The link that the point is fixed on.
    pub fn link(&self) -> LinkId {
        self.link
    }

    /// The point in the link's frame, m.
    pub fn point_in_link(&self) -> Vec3 {
        self.point_in_link
    }

    /// The unit normal, in the link's frame.
    pub fn normal_in_link(&self) -> Option<Vec3> {
        self.normal_in_link
    }

    /// The independent joints that move the point, from the root outwards (a mimic joint counts as the joint that it
    /// follows). All other joints keep their values in [`PointChain::solve`], and have columns of zeros in the
    /// Jacobians.
    pub fn joints(&self) -> &[JointId] {
        &self.joints
    }

    /// Forward kinematics: point and normal at `q` (all of the chain's values, rad or m). NaN if `q` is too short.
    pub fn place(&mut self, q: &[f64]) -> OrientedPoint {
        self.load(q);
        let tip_in_root = self.position.tip_in_root(&self.arm, &self.x);
        self.place_of(&tip_in_root)
    }

    /// Velocity of the point (x, y, z in the root, m/s) per unit of each entry of the chain's `q`, at `q`.
    ///
    /// `out` has [`Chain::dof`] columns. If it is longer, the additional columns are zeroed; if it is shorter, the last
    /// columns are left out.
    pub fn jacobian(&mut self, q: &[f64], out: &mut [[f64; 3]]) {
        out.fill([0.0; 3]);
        self.load(q);
        let tip_in_root = self.position.tip_in_root(&self.arm, &self.x);
        for (joint, axis) in self.arm.joints.iter().zip(self.position.axes()) {
            let (linear, _) = joint.twist(axis, tip_in_root.translation);
            if let Some(column) = out.get_mut(self.arm.variables[joint.variable].q_index) {
                for i in 0..3 {
                    column[i] += linear[i];
                }
            }
        }
    }

    /// Like [`PointChain::jacobian`], with two more rows: the velocity of the unit normal (1/s) along the first and the
    /// second of the returned tangents (unit vectors in the root, right-handed with the normal). Along itself the normal
    /// has no velocity.
    ///
    /// # Errors
    /// [`PointError::NoNormal`]; then `out` is zeroed.
    pub fn jacobian_with_normal(&mut self, q: &[f64], out: &mut [[f64; 5]]) -> Result<[Vec3; 2], PointError> {
        out.fill([0.0; 5]);
        let normal_in_link = self.normal_in_link.ok_or(PointError::NoNormal)?;
        self.load(q);
        let tip_in_root = self.position.tip_in_root(&self.arm, &self.x);
        let tangents = Tangents::of(tip_in_root.rotation * normal_in_link);
        for (joint, axis) in self.arm.joints.iter().zip(self.position.axes()) {
            let (linear, angular) = joint.twist(axis, tip_in_root.translation);
            let [u, v] = tangents.rate(angular);
            if let Some(column) = out.get_mut(self.arm.variables[joint.variable].q_index) {
                for (sum, value) in column.iter_mut().zip([linear.x, linear.y, linear.z, u, v]) {
                    *sum += value;
                }
            }
        }
        Ok([tangents.t1, tangents.t2])
    }

    pub(super) fn place_of(&self, tip_in_root: &Pose) -> OrientedPoint {
        let normal_in_root = self.normal_in_link.map(|n| tip_in_root.rotation * n);
        OrientedPoint { point_in_root: tip_in_root.translation, normal_in_root }
    }

    /// Loads the arm's variables from the chain's values.
    pub(super) fn load(&mut self, q: &[f64]) {
        for (value, variable) in self.x.iter_mut().zip(&self.arm.variables) {
            *value = q.get(variable.q_index).copied().unwrap_or(f64::NAN);
        }
    }
}

fn direction(normal: Option<Vec3>) -> Result<Option<Vec3>, PointError> {
    match normal {
        None => Ok(None),
        Some(n) => n.try_normalize().map(Some).ok_or(PointError::NormalWithoutDirection),
    }
}
