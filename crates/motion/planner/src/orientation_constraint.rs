//! A constraint on the direction of a link along a path, for example to keep a glass upright.

use elbowroom_kinematics::{Chain, ChainState, JointKind, LinkId};
use elbowroom_robot::RobotId;
use elbowroom_scene::Scene;
use elbowroom_spatial::{Rotation, Vec3};

use crate::rrt_connect::PathConstraint;

/// Longest edge of a tree, rad (and m): the chord of a longer edge leaves the tolerance.
const EDGE_LENGTH: f64 = 0.5;
/// Fraction of the tolerance at which a projection aims.
const PROJECTED_SHARE: f64 = 0.5;
/// Largest number of steps of a projection.
const PROJECTION_STEPS: usize = 12;
/// Damping of a projection's steps.
const DAMPING: f64 = 1e-3;

/// Keeps an axis of a link within an angle of a direction in the world; the link may turn freely about that axis.
///
/// As a [`PathConstraint`], it measures the distances of the point at 1 m along the axis, so that 1 m corresponds to 1
/// rad.
///
/// ```
/// use elbowroom_planner::{OrientationConstraint, PathConstraint};
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::example;
/// use elbowroom_spatial::Vec3;
/// let scene = example::two_arms();
/// let forearm = scene.robots()[0].robot.chain.tip();
/// let mut upright = OrientationConstraint::new(&scene, RobotId(0), forearm, Vec3::Z, Vec3::Z, 0.2);
/// // The arm is upright at zero.
/// assert!((upright.distance_m(&[0.5, 0.0, 0.0], 0.0) - 0.2).abs() < 1e-12);
/// assert!((upright.distance_m(&[0.5, 0.3, 0.0], 0.0) + 0.1).abs() < 1e-12);
/// // A projection turns shoulder and elbow until it is upright again.
/// let mut q = [0.5, 0.8, 0.0];
/// assert!(upright.project(&mut q) && upright.distance_m(&q, 0.0) > 0.0);
/// ```
#[derive(Debug, Clone)]
pub struct OrientationConstraint {
    chain: Chain,
    state: ChainState,
    columns: Vec<[f64; 6]>,
    /// Largest turn of the link per value, rad per rad.
    turns: Vec<f64>,
    link: LinkId,
    axis_in_link: Vec3,
    direction_in_root: Vec3,
    tolerance_rad: f64,
}

impl OrientationConstraint {
    /// Keeps `axis_in_link` within `tolerance_rad` of `direction_in_world`. Directions need not have length 1. If a
    /// direction has length 0, or the tolerance is not a number above 0, every configuration violates the constraint.
    ///
    /// # Panics
    /// The scene does not have this robot, or the robot does not have this link.
    pub fn new(
        scene: &Scene,
        robot: RobotId,
        link: LinkId,
        axis_in_link: Vec3,
        direction_in_world: Vec3,
        tolerance_rad: f64,
    ) -> Self {
        let r = &scene.robots()[robot.0];
        let chain = r.robot.chain.clone();
        let nothing = Vec3::splat(f64::NAN);
        Self {
            state: ChainState::new(&chain),
            columns: vec![[0.0; 6]; chain.dof()],
            turns: turns(&chain, link),
            link,
            axis_in_link: axis_in_link.try_normalize().unwrap_or(nothing),
            direction_in_root: r
                .base_in_world
                .inverse_transform_vector(direction_in_world)
                .try_normalize()
                .unwrap_or(nothing),
            tolerance_rad,
            chain,
        }
    }

    /// Computes the state of the chain; returns the axis in the root's frame.
    fn axis(&mut self, q: &[f64]) -> Vec3 {
        if q.len() != self.state.q.len() {
            return Vec3::splat(f64::NAN);
        }
        self.state.q.copy_from_slice(q);
        self.chain.forward(&mut self.state);
        self.state.link_in_root(self.link).rotation * self.axis_in_link
    }

    fn angle_rad(&mut self, q: &[f64]) -> f64 {
        angle(self.axis(q), self.direction_in_root)
    }

    /// One damped Gauss-Newton step that turns the axis by an angle towards the direction.
    fn turn(&mut self, q: &mut [f64], axis: Vec3, by_rad: f64) {
        let across = axis.cross(self.direction_in_root);
        // If the two are opposite, every perpendicular direction is right.
        let about = across.try_normalize().unwrap_or_else(|| Rotation::from_z(axis).x_axis());
        self.chain.jacobian(&self.state, self.link, Vec3::ZERO, &mut self.columns);
        let angular = |column: &[f64; 6]| {
            let w = Vec3::new(column[3], column[4], column[5]);
            // A turn about the axis itself does not matter.
            w - axis * w.dot(axis)
        };
        let mut rows = [Vec3::X * DAMPING, Vec3::Y * DAMPING, Vec3::Z * DAMPING];
        for w in self.columns.iter().map(angular) {
            (0..3).for_each(|i| rows[i] += w * w[i]);
        }
        let share = solved(rows, about * by_rad);
        for (value, column) in q.iter_mut().zip(&self.columns) {
            *value += angular(column).dot(share);
        }
    }
}

impl PathConstraint for OrientationConstraint {
    fn distance_m(&mut self, q: &[f64], _limit_m: f64) -> f64 {
        self.tolerance_rad - self.angle_rad(q)
    }

    fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        self.turns.iter().zip(from).zip(to).map(|((turns, a), b)| turns * (a - b).abs()).sum()
    }

    fn describe_nearest(&mut self, q: &[f64]) -> String {
        let degrees = self.angle_rad(q).to_degrees();
        let (link, most) = (&self.chain.links()[self.link.0], self.tolerance_rad.to_degrees());
        format!(
            "an orientation that the constraint forbids (an axis of `{link}` is {degrees:.1}° off, {most:.1}° are allowed)"
        )
    }

    fn projected_edge_length(&self) -> Option<f64> {
        Some(EDGE_LENGTH)
    }

    fn project(&mut self, q: &mut [f64]) -> bool {
        for _ in 0..PROJECTION_STEPS {
            let axis = self.axis(q);
            let off = angle(axis, self.direction_in_root);
            if off < 0.99 * self.tolerance_rad {
                return true;
            }
            if off.is_nan() {
                return false;
            }
            self.turn(q, axis, off - PROJECTED_SHARE * self.tolerance_rad);
        }
        false
    }
}

/// Largest turn of a link per value of the chain, rad per rad: 0 for prismatic joints and joints that do not carry the
/// link.
fn turns(chain: &Chain, link: LinkId) -> Vec<f64> {
    let mut turns = vec![0.0; chain.dof()];
    let mut at = link;
    while let Some(id) = chain.parent_joint(at) {
        let joint = &chain.joints()[id.0];
        at = joint.parent;
        if let Some(coupling) = chain.coupling(id).filter(|_| joint.kind != JointKind::Prismatic) {
            turns[coupling.index] += coupling.multiplier.abs();
        }
    }
    turns
}

/// Angle between two directions of length 1, 0 to π.
fn angle(a: Vec3, b: Vec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Solves a symmetric system of three equations, given by its rows (Cramer's rule).
fn solved(rows: [Vec3; 3], right: Vec3) -> Vec3 {
    let [a, b, c] = rows;
    Vec3::new(right.dot(b.cross(c)), right.dot(c.cross(a)), right.dot(a.cross(b))) / a.dot(b.cross(c))
}
