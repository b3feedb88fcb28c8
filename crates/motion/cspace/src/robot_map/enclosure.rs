//! Enclosures of the volume that a solid sweeps.

use std::f64::consts::PI;

use elbowroom_proximity::{ConvexHull, Shape, Sphere};
use elbowroom_spatial::{Pose, Vec3};

use super::driven_chain::SweptJoint;
use crate::cuboid;

/// Number of sides of the prism around a solid of revolution.
const PRISM_SIDES: u32 = 24;

/// A bounding volume of the solid, in the frame of the current joint.
pub(super) struct Enclosure {
    /// Points: the solid is within `margin` of their convex hull.
    pub points: Vec<Vec3>,
    pub margin: f64,
    /// Centre of a ball that also contains the solid.
    pub center: Vec3,
    pub radius: f64,
}

/// Encloses all poses of a solid of the last link in a shape in the frame of the link before the first joint. `None`
/// for an unbounded solid.
pub(super) fn swept_enclosure(shape: &Shape, in_link: Pose, joints: &[SweptJoint]) -> Option<(Shape, Pose)> {
    let mut all = Enclosure::new(shape, in_link)?;
    for (at, joint) in joints.iter().enumerate().rev() {
        if let Some(ends) = joint.slide {
            all.sweep_translation(joint.along, ends);
        } else {
            // With its centre where this axis meets the previous one, the ball does not grow by the rotation about the
            // previous axis.
            let before = joints[..at].last().filter(|j| j.slide.is_none() && j.child == joint.parent);
            all.sweep_rotation(joint.along, before.map(|b| nearest_on_axis(joint, b)));
        }
        all.transform(joint.origin);
    }
    all.shape()
}

/// The point of a joint's axis nearest to the previous joint's axis, as a length along the axis.
fn nearest_on_axis(joint: &SweptJoint, before: &SweptJoint) -> f64 {
    // In the parent's frame, the previous axis passes through the origin.
    let (o, a, b) = (joint.origin.translation, joint.origin.transform_vector(joint.along), before.along);
    let cos = a.dot(b);
    let sin2 = 1.0 - cos * cos;
    if sin2 < 1e-6 { 0.0 } else { (cos * o.dot(b) - o.dot(a)) / sin2 }
}

impl Enclosure {
    /// Encloses a solid placed in a frame; `None` for an unbounded solid.
    pub fn new(shape: &Shape, in_link: Pose) -> Option<Self> {
        let (points, margin) = match shape {
            Shape::Sphere(s) => (vec![Vec3::ZERO], s.radius),
            Shape::Capsule(c) => (vec![Vec3::Z * c.half_length, Vec3::Z * -c.half_length], c.radius),
            Shape::Cylinder(c) => (prism(Vec3::Z, [-c.half_length, c.half_length], c.radius), 0.0),
            Shape::Mesh(m) => (m.vertices().to_vec(), 0.0),
            Shape::Hull(h) => (h.vertices().to_vec(), 0.0),
            Shape::Cuboid(c) => (cuboid::corners(c.half_extents).to_vec(), 0.0),
            Shape::HalfSpace(_) => return None,
        };
        let mut all = Self { points, margin, center: Vec3::ZERO, radius: f64::INFINITY };
        all.transform(in_link);
        let bounds = elbowroom_spatial::Aabb::from_points(all.points.iter().copied());
        all.center = bounds.center();
        all.radius = all.margin + all.points.iter().map(|p| p.distance(all.center)).fold(0.0, f64::max);
        all.radius.is_finite().then_some(all)
    }

    fn transform(&mut self, in_parent: Pose) {
        self.points.iter_mut().for_each(|p| *p = in_parent.transform_point(*p));
        self.center = in_parent.transform_point(self.center);
    }

    fn sweep_translation(&mut self, along: Vec3, [low, high]: [f64; 2]) {
        if low < high {
            let ends = |p: &Vec3| [*p + along * low, *p + along * high];
            self.points = self.points.iter().flat_map(ends).collect();
        } else {
            self.points.iter_mut().for_each(|p| *p += along * low);
        }
        self.center += along * (0.5 * (low + high));
        self.radius += 0.5 * (high - low);
    }

    /// Sweeps the enclosure by a full turn; places the ball's centre at `center_at` along the axis, if given.
    fn sweep_rotation(&mut self, along: Vec3, center_at: Option<f64>) {
        let height_and_radius = |p: Vec3| (p.dot(along), (p - along * p.dot(along)).length());
        let (mut low, mut high, mut wide) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for &p in &self.points {
            let (z, off) = height_and_radius(p);
            (low, high, wide) = (low.min(z), high.max(z), wide.max(off));
        }
        let (old, off) = height_and_radius(self.center);
        let z = center_at.unwrap_or(old);
        let center = along * z;
        let distance = |&p: &Vec3| (height_and_radius(p).0 - z).hypot(height_and_radius(p).1);
        let from_points = self.margin + self.points.iter().map(distance).fold(0.0, f64::max);
        let from_ball = self.radius + off.hypot(old - z);
        (self.center, self.radius) = (center, from_points.min(from_ball));
        self.points = prism(along, [low - self.margin, high + self.margin], wide + self.margin);
        self.margin = 0.0;
    }

    /// The smaller one of hull and ball.
    fn shape(self) -> Option<(Shape, Pose)> {
        // Enlarged for rounding.
        let radius = self.radius * (1.0 + 1e-9);
        if !(radius.is_finite() && self.center.is_finite()) {
            return None;
        }
        let ball = Shape::Sphere(Sphere { radius });
        if self.margin == 0.0
            && let Ok(hull) = ConvexHull::from_points(&self.points)
            && hull.volume() < ball.volume()
        {
            return Some((Shape::Hull(std::sync::Arc::new(hull)), Pose::IDENTITY));
        }
        Some((ball, Pose::from_translation(self.center)))
    }
}

/// Corners of a prism around the cylinder about an axis.
fn prism(along: Vec3, ends: [f64; 2], radius: f64) -> Vec<Vec3> {
    let u = along.any_perpendicular();
    let v = along.cross(u);
    // Corners are outside the cylinder, so that the sides touch it; enlarged for rounding.
    let out = radius / (PI / f64::from(PRISM_SIDES)).cos() * (1.0 + 1e-9);
    let corner = |i: u32| (2.0 * PI * f64::from(i) / f64::from(PRISM_SIDES)).sin_cos();
    let rounding = 1e-9 * (ends[1] - ends[0]).abs();
    let ends = [ends[0] - rounding, ends[1] + rounding];
    (0..PRISM_SIDES).map(corner).flat_map(|(s, c)| ends.map(|z| along * z + (u * c + v * s) * out)).collect()
}

#[cfg(test)]
mod tests {
    use elbowroom_kinematics::LinkId;
    use elbowroom_proximity::{Capsule, Cuboid, Cylinder, project_point};

    use super::*;

    /// Creates a revolute joint.
    fn revolute(at: usize, origin: Pose, along: Vec3) -> SweptJoint {
        SweptJoint { child: LinkId(at + 1), parent: LinkId(at), origin, along, slide: None }
    }

    #[test]
    fn no_point_is_outside_wherever_the_joints_are() {
        let joints = [
            revolute(0, Pose::from_xyz_rpy([0.1, 0.0, 0.3], [0.2, 0.0, 0.1]), Vec3::Z),
            revolute(1, Pose::from_xyz_rpy([0.0, 0.02, 0.05], [0.0, 0.3, 0.0]), Vec3::Y),
            SweptJoint {
                slide: Some([-0.1, 0.2]),
                ..revolute(2, Pose::from_xyz_rpy([0.0, 0.0, 0.06], [0.0; 3]), Vec3::X)
            },
            revolute(3, Pose::from_xyz_rpy([0.03, 0.0, 0.06], [0.0; 3]), Vec3::Z),
        ];
        let shapes = [
            Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.02, 0.05, 0.03) }),
            Shape::Cylinder(Cylinder { half_length: 0.05, radius: 0.03 }),
            Shape::Capsule(Capsule { half_length: 0.05, radius: 0.03 }),
            Shape::Sphere(Sphere { radius: 0.04 }),
        ];
        let in_link = Pose::from_xyz_rpy([0.0, 0.03, 0.06], [0.4, 0.1, 0.0]);
        for shape in &shapes {
            for first in 0..joints.len() {
                let joints = &joints[first..];
                let (around, placed) = swept_enclosure(shape, in_link, joints).unwrap();
                for i in 0..4000u32 {
                    let value = |j: usize| (f64::from(i) * (j as f64 + 1.0) * 0.618_033_988).fract();
                    let mut pose = Pose::IDENTITY;
                    for (j, joint) in joints.iter().enumerate() {
                        let moved = match joint.slide {
                            Some([low, high]) => Pose::from_translation(joint.along * (low + (high - low) * value(j))),
                            None => Pose::new(
                                elbowroom_spatial::Rotation::from_axis_angle(joint.along, value(j) * 2.0 * PI),
                                Vec3::ZERO,
                            ),
                        };
                        pose = pose * joint.origin * moved;
                    }
                    let direction =
                        Vec3::new((f64::from(i) * 0.7).sin(), (f64::from(i) * 1.3).cos(), (f64::from(i) * 0.37).sin());
                    let p = (pose * in_link).transform_point(shape.support(direction));
                    assert!(project_point(&around, &placed, p).signed_distance <= 0.0, "{shape:?} {first} {i}");
                }
            }
        }
    }
}
