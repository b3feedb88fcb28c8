//! When do two moving shapes first touch? Proven between the samples, not sampled.
//!
//! [`time_of_impact`] takes any two shapes and how they move: at rest (a [`Pose`](elbowroom_spatial::Pose)), straight,
//! about an axis or along a screw ([`Steady`]), or any [`Path`] that can bound its own speed. `None` means that the
//! shapes are apart during all of the motion, ends included; no thin plate is jumped over. `Some` means that they are
//! within the tolerance at [`Impact::time`] and were apart before. A pass within the tolerance may be reported as an
//! impact, a contact is never left out.
//!
//! How: conservative advancement (Mirtich, 1996). README.md beside this file derives the bounds.
//!
//! ```
//! use elbowroom_proximity::impact::{Options, Steady, time_of_impact};
//! use elbowroom_proximity::{Cuboid, Shape, Sphere};
//! use elbowroom_spatial::{Pose, Vec3};
//! let bullet = Shape::Sphere(Sphere { radius: 0.004 });
//! let sheet = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.0005, 1.0, 1.0) });
//! let flight = Steady::linear(Pose::from_translation(Vec3::X * -3.0), Vec3::X * 8.0);
//! let hit = time_of_impact(&bullet, &flight, &sheet, &Pose::IDENTITY, &Options::default()).unwrap();
//! assert!((hit.time - 2.9955 / 8.0).abs() < 1e-4 / 8.0 && hit.separation <= 1e-4);
//! assert!((hit.normal.unwrap() + Vec3::X).length() < 1e-12); // from the sheet to the bullet
//! let past = Steady::linear(Pose::from_translation(Vec3::new(-3.0, 1.01, 0.0)), Vec3::X * 8.0);
//! assert!(time_of_impact(&bullet, &past, &sheet, &Pose::IDENTITY, &Options::default()).is_none());
//! ```

mod advance;
mod bound;
mod carrier;
mod path;
mod slab;
mod steady;
mod warning;

use elbowroom_spatial::Vec3;

use crate::Shape;
use crate::mesh::Scratch;

pub use path::Path;
pub use steady::Steady;
pub use warning::{TimeToCollision, earliest, time_to_collision};

/// How closely to look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// At a reported impact the shapes are no farther apart than this, metres. Not finer than what poses of that size
    /// can tell apart (about 1e-14 of the largest coordinate); 0, a negative number or NaN ask for just that.
    pub tolerance: f64,
    /// After so many looks the answer is an impact that is not [`Impact::certain`]. A mesh that slides along another
    /// just outside the tolerance advances by about the distance per look.
    pub max_steps: u32,
    /// For bodies that start nearer than the tolerance without touching: the start is no impact, coming nearer than
    /// half the distance of the start is. Bodies that touch at the start are reported at time 0 all the same.
    pub free_to_leave: bool,
}

impl Default for Options {
    /// 0.1 mm, 10,000 looks, and a start within the tolerance is an impact.
    fn default() -> Self {
        Self { tolerance: 1e-4, max_steps: 10_000, free_to_leave: false }
    }
}

/// The first touch of two moving shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// When, as a fraction of the motion in `[0, 1]`: no contact before. 0 where they touch at the start.
    pub time: f64,
    /// Nearest point of the first shape at that time, in the world.
    pub on_a: Vec3,
    /// Nearest point of the second shape at that time, in the world.
    pub on_b: Vec3,
    /// Unit vector from the second shape to the first; `None` where the distance is 0: they overlap, which they can at
    /// the start only, or are too close to be told from touching.
    pub normal: Option<Vec3>,
    /// Distance at that time, metres: at most the tolerance where certain.
    pub separation: f64,
    /// How often the distance was asked.
    pub steps: u32,
    /// False where the proof ended here without a contact: steps used up, a number that is not finite, a bound of
    /// speed that is infinite. It is free before `time` and unknown after, and unknown is not free.
    pub certain: bool,
}

impl Impact {
    /// True where the shapes were within the tolerance from the start.
    pub fn at_start(&self) -> bool {
        self.time == 0.0
    }
}

/// The first time that two moving shapes come within the tolerance of contact; `None` where they are apart all along.
///
/// A NaN or an infinity in a pose, a dimension or a motion is an impact, not certain: what is unknown is not free.
pub fn time_of_impact(a: &Shape, a_path: &dyn Path, b: &Shape, b_path: &dyn Path, options: &Options) -> Option<Impact> {
    time_of_impact_with(a, a_path, b, b_path, options, &mut Scratch::new())
}

/// [`time_of_impact`] with memory that is used again.
pub fn time_of_impact_with(
    a: &Shape,
    a_path: &dyn Path,
    b: &Shape,
    b_path: &dyn Path,
    options: &Options,
    scratch: &mut Scratch,
) -> Option<Impact> {
    advance::advance((a, a_path), (b, b_path), options, scratch)
}
