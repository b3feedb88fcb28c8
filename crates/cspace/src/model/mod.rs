//! The obstacle models of S2, each conservative and each selectable.

mod slices;
mod spheres;

use std::str::FromStr;

use elbowroom_spatial::{Pose, Vec3};

use crate::obstacle::Solid;
use crate::{Filler, Layer, Obstacle};
pub use spheres::spheres_until;

/// How an obstacle is represented while it is turned into cells (S2, sections II to V).
///
/// | model | what is filled | in the paper |
/// | --- | --- | --- |
/// | `exact` | the solid itself | |
/// | `sphere` | the sphere around it | single sphere |
/// | `spheres=N` | N spheres around N parts; with a deadline: [`spheres_until`] | 2, 4, 8 … spheres |
/// | `box` | the box around it, edges along the base frame's axes | six-sided parallelepiped |
/// | `slices` | one slice of base angle, radial and height bounds, copied to all θ1 in the bounds | 2-D slices |
///
/// ```
/// use elbowroom_cspace::Model;
/// assert_eq!("spheres=8".parse(), Ok(Model::Spheres(8)));
/// assert_eq!(Model::Slices.to_string(), "slices");
/// assert!("cubes".parse::<Model>().unwrap_err().to_string().contains("exact"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Model {
    /// The solid itself.
    #[default]
    Exact,
    /// One slice, copied to every θ1 within bounds.
    Slices,
    /// The enclosing sphere.
    Sphere,
    /// Spheres around this many parts (rounded up to a power of two, at most 4096).
    Spheres(u32),
    /// The axis-aligned box around it.
    Box,
}

/// A word that names no model.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no obstacle model: write exact, slices, sphere, spheres=N (N from 1 to 4096) or box")]
pub struct UnknownModel(pub String);

impl FromStr for Model {
    type Err = UnknownModel;

    fn from_str(word: &str) -> Result<Self, UnknownModel> {
        let unknown = || UnknownModel(word.to_owned());
        match word {
            "exact" => Ok(Self::Exact),
            "slices" => Ok(Self::Slices),
            "sphere" => Ok(Self::Sphere),
            "box" => Ok(Self::Box),
            _ => {
                let count = word.strip_prefix("spheres=").and_then(|n| n.parse().ok());
                count.filter(|n| (1..=spheres::MOST).contains(n)).map(Self::Spheres).ok_or_else(unknown)
            }
        }
    }
}

impl std::fmt::Display for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::Slices => f.write_str("slices"),
            Self::Sphere => f.write_str("sphere"),
            Self::Spheres(count) => write!(f, "spheres={count}"),
            Self::Box => f.write_str("box"),
        }
    }
}

impl Model {
    /// Replaces a layer by what the model of an obstacle blocks: never less than the obstacle itself.
    pub fn fill(self, filler: &mut Filler, obstacle: &Obstacle, layer: &mut Layer) {
        match self {
            Self::Exact => filler.fill(obstacle, layer),
            Self::Slices => slices::fill(filler, obstacle, layer),
            Self::Sphere => {
                let (center, radius) = obstacle.enclosing_sphere();
                filler.fill(&Obstacle { solid: Solid::Sphere { center, radius } }, layer);
            }
            Self::Spheres(count) => {
                spheres_until(filler, obstacle, count, None, layer);
            }
            Self::Box => {
                let (min, max) = bounds(obstacle);
                let in_base = Pose::from_translation((min + max) * 0.5);
                filler.fill(&Obstacle { solid: Solid::Cuboid { in_base, half_extents: (max - min) * 0.5 } }, layer);
            }
        }
    }
}

/// Corners of the axis-aligned box around an obstacle.
fn bounds(obstacle: &Obstacle) -> (Vec3, Vec3) {
    let (shape, in_base) = obstacle.shape();
    let around = shape.aabb(&in_base);
    (around.min, around.max)
}
