//! All places of a solid behind joints that may be anywhere, enclosed.

use std::f64::consts::PI;

use elbowroom_proximity::{ConvexHull, Shape, Sphere};
use elbowroom_spatial::{Pose, Vec3};

use super::joints::Loose;

/// Sides of the prism around what turns.
const SIDES: u32 = 24;

/// What is known to hold the solid, in the frame of the joint at hand.
pub(super) struct Enclosure {
    /// It lies within `fat` of the convex hull of these.
    pub points: Vec<Vec3>,
    pub fat: f64,
    /// And within this ball.
    pub center: Vec3,
    pub radius: f64,
}

/// A solid of the last link, placed in it, in all its places: a shape in the frame of the link before the first joint.
/// `None` where it has no end.
pub(super) fn enclose(shape: &Shape, in_link: Pose, joints: &[Loose]) -> Option<(Shape, Pose)> {
    let mut all = Enclosure::of(shape, in_link)?;
    for (at, joint) in joints.iter().enumerate().rev() {
        if let Some(ends) = joint.slide {
            all.slide(joint.along, ends);
        } else {
            // A centre where this axis meets the one before it stays small when that one turns.
            let before = joints[..at].last().filter(|j| j.slide.is_none() && j.child == joint.parent);
            all.turn(joint.along, before.map(|b| nearest_on_axis(joint, b)));
        }
        all.place(joint.origin);
    }
    all.shape()
}

/// The point of a joint's axis nearest to the axis of the joint before it, as a length along it.
fn nearest_on_axis(joint: &Loose, before: &Loose) -> f64 {
    // In the parent's frame, where the axis before passes through the origin.
    let (o, a, b) = (joint.origin.translation, joint.origin.transform_vector(joint.along), before.along);
    let cos = a.dot(b);
    let sin2 = 1.0 - cos * cos;
    if sin2 < 1e-6 { 0.0 } else { (cos * o.dot(b) - o.dot(a)) / sin2 }
}

impl Enclosure {
    /// Of a solid placed in a frame; `None` where it has no end.
    pub fn of(shape: &Shape, in_link: Pose) -> Option<Self> {
        let (points, fat) = match shape {
            Shape::Sphere(s) => (vec![Vec3::ZERO], s.radius),
            Shape::Capsule(c) => (vec![Vec3::Z * c.half_length, Vec3::Z * -c.half_length], c.radius),
            Shape::Cylinder(c) => (prism(Vec3::Z, [-c.half_length, c.half_length], c.radius), 0.0),
            Shape::Mesh(m) => (m.vertices().to_vec(), 0.0),
            Shape::Hull(h) => (h.vertices().to_vec(), 0.0),
            Shape::Cuboid(c) => {
                let side = |i: u8, bit: u8| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
                let corner = |i: u8| c.half_extents.scale(Vec3::new(side(i, 0), side(i, 1), side(i, 2)));
                ((0..8).map(corner).collect(), 0.0)
            }
            Shape::HalfSpace(_) => return None,
        };
        let mut all = Self { points, fat, center: Vec3::ZERO, radius: f64::INFINITY };
        all.place(in_link);
        let bounds = elbowroom_spatial::Aabb::from_points(all.points.iter().copied());
        all.center = bounds.center();
        all.radius = all.fat + all.points.iter().map(|p| p.distance(all.center)).fold(0.0, f64::max);
        all.radius.is_finite().then_some(all)
    }

    fn place(&mut self, in_parent: Pose) {
        self.points.iter_mut().for_each(|p| *p = in_parent.transform_point(*p));
        self.center = in_parent.transform_point(self.center);
    }

    fn slide(&mut self, along: Vec3, [low, high]: [f64; 2]) {
        if low < high {
            let ends = |p: &Vec3| [*p + along * low, *p + along * high];
            self.points = self.points.iter().flat_map(ends).collect();
        } else {
            self.points.iter_mut().for_each(|p| *p += along * low);
        }
        self.center += along * (0.5 * (low + high));
        self.radius += 0.5 * (high - low);
    }

    fn turn(&mut self, along: Vec3, meet: Option<f64>) {
        let level = |p: Vec3| (p.dot(along), (p - along * p.dot(along)).length());
        let (mut low, mut high, mut wide) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for &p in &self.points {
            let (z, off) = level(p);
            (low, high, wide) = (low.min(z), high.max(z), wide.max(off));
        }
        let (old, off) = level(self.center);
        let z = meet.unwrap_or(old);
        let center = along * z;
        let from_points =
            self.fat + self.points.iter().map(|&p| (level(p).0 - z).hypot(level(p).1)).fold(0.0, f64::max);
        let from_ball = self.radius + off.hypot(old - z);
        (self.center, self.radius) = (center, from_points.min(from_ball));
        self.points = prism(along, [low - self.fat, high + self.fat], wide + self.fat);
        self.fat = 0.0;
    }

    /// The smaller of the two.
    fn shape(self) -> Option<(Shape, Pose)> {
        // A hair for rounding on the way.
        let radius = self.radius * (1.0 + 1e-9);
        if !(radius.is_finite() && self.center.is_finite()) {
            return None;
        }
        let ball = Shape::Sphere(Sphere { radius });
        if self.fat == 0.0
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
    // Corners lie outside, so that the sides touch; a hair more for rounding.
    let out = radius / (PI / f64::from(SIDES)).cos() * (1.0 + 1e-9);
    let corner = |i: u32| (2.0 * PI * f64::from(i) / f64::from(SIDES)).sin_cos();
    let hair = 1e-9 * (ends[1] - ends[0]).abs();
    let ends = [ends[0] - hair, ends[1] + hair];
    (0..SIDES).map(corner).flat_map(|(s, c)| ends.map(|z| along * z + (u * c + v * s) * out)).collect()
}

#[cfg(test)]
mod tests {
    use elbowroom_kinematics::LinkId;
    use elbowroom_proximity::{Capsule, Cuboid, Cylinder, project_point};

    use super::*;

    /// A joint that turns, at a place, about an axis.
    fn turning(at: usize, origin: Pose, along: Vec3) -> Loose {
        Loose { child: LinkId(at + 1), parent: LinkId(at), origin, along, slide: None }
    }

    #[test]
    fn no_point_is_outside_wherever_the_joints_are() {
        let joints = [
            turning(0, Pose::from_xyz_rpy([0.1, 0.0, 0.3], [0.2, 0.0, 0.1]), Vec3::Z),
            turning(1, Pose::from_xyz_rpy([0.0, 0.02, 0.05], [0.0, 0.3, 0.0]), Vec3::Y),
            Loose { slide: Some([-0.1, 0.2]), ..turning(2, Pose::from_xyz_rpy([0.0, 0.0, 0.06], [0.0; 3]), Vec3::X) },
            turning(3, Pose::from_xyz_rpy([0.03, 0.0, 0.06], [0.0; 3]), Vec3::Z),
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
                let (around, placed) = enclose(shape, in_link, joints).unwrap();
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
