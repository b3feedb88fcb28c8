//! The true motion of the obstacles: upright boxes on given paths.

use elbowroom::proximity::{Cuboid, Shape};
use elbowroom::scene::Object;
use elbowroom::spatial::{Pose, Vec3};
use elbowroom::vision::Point2;
use elbowroom::vision::render::RenderedSolid;

/// An upright box on a piecewise linear path.
pub struct MovingBox {
    pub name: &'static str,
    pub size_m: Vec3,
    pub grey: u8,
    /// Times and positions; constant before the first and after the last.
    pub path: Vec<(f64, Point2)>,
}

impl MovingBox {
    /// Its centre on the floor.
    pub fn at(&self, t: f64) -> Point2 {
        let after = self.path.partition_point(|(time, _)| *time <= t);
        match (after.checked_sub(1).and_then(|n| self.path.get(n)), self.path.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * ((t - a.0) / (b.0 - a.0)),
            (Some(only), None) | (None, Some(only)) => only.1,
            (None, None) => Point2::new(0.0, 0.0),
        }
    }

    /// For the renderer.
    pub fn solid(&self, t: f64) -> RenderedSolid {
        RenderedSolid::cuboid(self.at(t), self.size_m, 0.0, self.grey)
    }

    /// Pose of its box in the world.
    pub fn in_world(&self, t: f64) -> Pose {
        let at = self.at(t);
        Pose::from_translation(Vec3::new(at.x, at.y, self.size_m.z / 2.0))
    }

    /// For the ground truth.
    pub fn object(&self) -> Object {
        let shape = Shape::Cuboid(Cuboid { half_extents: self.size_m * 0.5 });
        Object { name: self.name.into(), shape, in_world: self.in_world(0.0) }
    }
}

/// An unknown trolley crosses in front of the robot; a bin of a known template is moved to a station and away again.
pub fn obstacles() -> Vec<MovingBox> {
    let at = Point2::new;
    vec![
        MovingBox {
            name: "trolley",
            size_m: Vec3::new(0.5, 0.6, 1.7),
            grey: 215,
            path: vec![(5.0, at(1.9, -3.6)), (19.4, at(1.9, 3.6))],
        },
        MovingBox {
            name: "bin",
            size_m: Vec3::new(0.8, 0.6, 0.45),
            grey: 30,
            path: vec![(20.0, at(5.6, 1.7)), (26.0, at(1.1, 1.7)), (30.0, at(1.1, 1.7)), (36.0, at(5.6, 1.7))],
        },
    ]
}
