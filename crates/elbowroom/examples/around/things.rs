//! What really moves in the cell: upright boxes on given ways.

use elbowroom::proximity::{Cuboid, Shape};
use elbowroom::scene::Object;
use elbowroom::spatial::{Pose, Vec3};
use elbowroom::vision::Point2;
use elbowroom::vision::render::Solid;

/// An upright box that goes straight from place to place.
pub struct Thing {
    pub name: &'static str,
    pub size_m: Vec3,
    pub grey: u8,
    /// When it is where; before the first and after the last it stands.
    pub way: Vec<(f64, Point2)>,
}

impl Thing {
    /// Its middle on the floor.
    pub fn at(&self, t: f64) -> Point2 {
        let after = self.way.partition_point(|(time, _)| *time <= t);
        match (after.checked_sub(1).and_then(|n| self.way.get(n)), self.way.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * ((t - a.0) / (b.0 - a.0)),
            (Some(only), None) | (None, Some(only)) => only.1,
            (None, None) => Point2::new(0.0, 0.0),
        }
    }

    /// For the renderer.
    pub fn solid(&self, t: f64) -> Solid {
        Solid::cuboid(self.at(t), self.size_m, 0.0, self.grey)
    }

    /// Where its box stands in the world.
    pub fn in_world(&self, t: f64) -> Pose {
        let at = self.at(t);
        Pose::from_translation(Vec3::new(at.x, at.y, self.size_m.z / 2.0))
    }

    /// For the judge.
    pub fn object(&self) -> Object {
        let shape = Shape::Cuboid(Cuboid { half_extents: self.size_m * 0.5 });
        Object { name: self.name.into(), shape, in_world: self.in_world(0.0) }
    }
}

/// A trolley that nobody told of crosses in front of the robot; a bin whose kind is known is brought to a station and taken
/// away again.
pub fn things() -> Vec<Thing> {
    let at = Point2::new;
    vec![
        Thing {
            name: "trolley",
            size_m: Vec3::new(0.5, 0.6, 1.7),
            grey: 215,
            way: vec![(5.0, at(1.9, -3.6)), (19.4, at(1.9, 3.6))],
        },
        Thing {
            name: "bin",
            size_m: Vec3::new(0.8, 0.6, 0.45),
            grey: 30,
            way: vec![(20.0, at(5.6, 1.7)), (26.0, at(1.1, 1.7)), (30.0, at(1.1, 1.7)), (36.0, at(5.6, 1.7))],
        },
    ]
}
