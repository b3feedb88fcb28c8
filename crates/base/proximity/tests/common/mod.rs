//! Random shapes and poses for the tests, the same on every machine.
#![allow(dead_code)]

pub mod exact;

use std::sync::Arc;

use elbowroom_proximity::{
    Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh, tessellate::tessellate,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};
pub use elbowroom_testkit::random::SplitMix;

/// A sphere that is stretched along the axes and has waves: closed, but not convex.
pub fn lump(radius: f64, fine: f64, stretch: Vec3, wave: f64) -> TriMesh {
    let (mut v, t) = tessellate(&Shape::Sphere(Sphere { radius }), fine);
    for p in &mut v {
        let n = *p / radius;
        *p = (*p * (1.0 + wave * (4.0 * n.x).sin() * (3.0 * n.y).cos())).scale(stretch);
    }
    TriMesh::new(v, t).unwrap()
}

/// Random geometry.
pub trait RandomGeometry {
    /// A vector with each coordinate within `half` of 0.
    fn vec(&mut self, half: f64) -> Vec3;
    /// A pose. One in four has its axes along the world's axes, one in eight its origin on a round number.
    fn pose(&mut self, half: f64) -> Pose;
    /// A dimension. One in eight is zero or tiny.
    fn size(&mut self) -> f64;
    fn shape(&mut self, kind: &str) -> Shape;
    fn hull(&mut self) -> ConvexHull;
}

impl RandomGeometry for SplitMix {
    fn vec(&mut self, half: f64) -> Vec3 {
        Vec3::from(self.within(half))
    }

    fn pose(&mut self, half: f64) -> Pose {
        let quarter = std::f64::consts::FRAC_PI_2;
        let rotation = match self.below(8) {
            0 => Rotation::IDENTITY,
            1 => Rotation::from_rpy(quarter * self.below(4) as f64, quarter * self.below(4) as f64, 0.0),
            2 => Rotation::from_rpy(self.between(-1e-7, 1e-7), self.between(-1e-9, 1e-9), 0.0),
            _ => Rotation::from_rotation_vector(self.vec(3.0)),
        };
        let at = self.vec(half);
        let at = if self.below(8) == 0 { Vec3::new(at.x.round(), at.y.round(), at.z.round()) } else { at };
        Pose::new(rotation, at)
    }

    fn size(&mut self) -> f64 {
        match self.below(16) {
            0 => 0.0,
            1 => 1e-9,
            _ => self.between(0.02, 1.0),
        }
    }

    fn shape(&mut self, kind: &str) -> Shape {
        match kind {
            "sphere" => Shape::Sphere(Sphere { radius: self.size() }),
            "capsule" => Shape::Capsule(Capsule { half_length: self.size(), radius: self.size() }),
            "cylinder" => Shape::Cylinder(Cylinder { half_length: self.size(), radius: self.size() }),
            "box" => Shape::Cuboid(Cuboid { half_extents: Vec3::new(self.size(), self.size(), self.size()) }),
            "plane" => Shape::HalfSpace(HalfSpace),
            "hull" => Shape::Hull(Arc::new(self.hull())),
            "mesh" => {
                let hull = Shape::Hull(Arc::new(self.hull()));
                let (v, t) = tessellate(&hull, 0.01);
                Shape::Mesh(Arc::new(TriMesh::new(v, t).unwrap()))
            }
            _ => unreachable!("{kind}"),
        }
    }

    fn hull(&mut self) -> ConvexHull {
        let n = 4 + self.below(30);
        let size = self.between(0.1, 1.0);
        let points: Vec<Vec3> = (0..n).map(|_| self.vec(size)).collect();
        ConvexHull::from_points(&points).unwrap()
    }
}

/// Number of cases per pair: a million with `ELBOWROOM_LONG=1`.
pub fn cases(usual: usize) -> usize {
    elbowroom_testkit::extent::amount(usual, 1_000_000)
}

pub const CONVEX: [&str; 5] = ["sphere", "capsule", "cylinder", "box", "hull"];
