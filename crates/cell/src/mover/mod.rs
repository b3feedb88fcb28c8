//! Solid things that move by themselves: on a belt, or along a way of their own.

mod belt;
mod leg;
mod way;

use elbowroom_spatial::{Motion, Pose};

pub use leg::Leg;
pub use way::{Repeat, Way};

use crate::Encoder;

/// An object that moves: where it is at any time, and how fast.
///
/// ```
/// # use elbowroom_cell::{Cell, Leg};
/// # use elbowroom_spatial::Vec3;
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [object.cart]
/// shape = "box"
/// size = [400, 300, 200]
/// at = [2000, 0, 100]
/// motion = { via = [[2000, 1000, 100]], speed = 500, start = 0.5 }
/// "#)?;
/// let cart = &cell.movers[0];
/// assert_eq!(cart.motion(1.5).velocity, Vec3::Y * 0.5);
/// assert!((cart.pose(1.5).translation - Vec3::new(2.0, 0.5, 0.1)).length() < 1e-12);
/// // The same as a path from one tick to the next, for `Checker::sweep`:
/// let leg: Leg = cart.between(1.5, 1.504);
/// # let _ = leg;
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Mover {
    /// Index of the object in the cell.
    pub object: usize,
    /// Where the file places it: at travel 0, or before its way begins.
    pub rest_in_world: Pose,
    /// What moves it.
    pub drive: Drive,
}

/// What moves an object.
#[derive(Debug, Clone)]
pub enum Drive {
    /// A belt or a rail that it rides on.
    Belt(Encoder),
    /// It goes by itself.
    Way(Way),
}

impl Mover {
    /// Where the object's frame is at a time (s), in the world.
    pub fn pose(&self, t_s: f64) -> Pose {
        match &self.drive {
            Drive::Belt(encoder) => Pose::from_translation(encoder.direction * encoder.at(t_s).0) * self.rest_in_world,
            Drive::Way(way) => way.pose(self.rest_in_world, t_s),
        }
    }

    /// How the object's frame moves at a time (s), in the world: where the speed jumps, as it goes on. Accelerations are
    /// left out: between its corners there are none, but for the turning.
    pub fn motion(&self, t_s: f64) -> Motion {
        match &self.drive {
            Drive::Belt(encoder) => Motion { velocity: encoder.direction * encoder.at(t_s).1, ..Motion::REST },
            Drive::Way(way) => way.motion(t_s),
        }
    }

    /// Its path from one time to a later one (s).
    pub fn between(&self, from_s: f64, to_s: f64) -> Leg<'_> {
        Leg::new(self, from_s, to_s)
    }

    /// True where it does not stand still.
    pub(crate) fn moving(&self, t_s: f64) -> bool {
        self.motion(t_s) != Motion::REST
    }
}
