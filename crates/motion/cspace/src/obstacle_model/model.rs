//! The obstacle models.

use std::str::FromStr;

/// Largest number of spheres of one obstacle.
pub(crate) const MAX_SPHERES: u32 = 4096;

/// The solid that represents an obstacle in a map (the joint-space paper, sections II to V).
///
/// | model | solid | in the paper |
/// | --- | --- | --- |
/// | `exact` | the solid itself | |
/// | `sphere` | the sphere around it | single sphere |
/// | `spheres=N` | N spheres around N parts; with a deadline: [`spheres_until`](crate::spheres_until) | 2, 4, 8 … spheres |
/// | `box` | the box around it, edges along the base frame's axes | six-sided parallelepiped |
/// | `slices` | one slice of base angle, radial and height bounds, copied to all θ1 in the bounds | 2-D slices |
///
/// ```
/// use elbowroom_cspace::ObstacleModel;
/// assert_eq!("spheres=8".parse(), Ok(ObstacleModel::Spheres(8)));
/// assert_eq!(ObstacleModel::Slices.to_string(), "slices");
/// assert!("cubes".parse::<ObstacleModel>().unwrap_err().to_string().contains("exact"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ObstacleModel {
    /// The solid itself.
    #[default]
    Exact,
    /// One slice, copied to every θ1 within its bounds.
    Slices,
    /// The enclosing sphere.
    Sphere,
    /// Spheres around this many parts (rounded up to a power of two, at most 4096).
    Spheres(u32),
    /// The axis-aligned box around the solid.
    Box,
}

impl ObstacleModel {
    /// The models whose common cells this model blocks: 1, 2, 4, 8 … spheres, so that more of them never block more; else
    /// itself alone.
    pub(crate) fn coarser_to_finer(self) -> Vec<Self> {
        match self {
            Self::Spheres(most) => {
                let parts = most.clamp(1, MAX_SPHERES).next_power_of_two();
                (0..=parts.ilog2()).map(|n| Self::Spheres(1 << n)).collect()
            }
            other => vec![other],
        }
    }
}

/// The name is not the name of an obstacle model.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no obstacle model: write exact, slices, sphere, spheres=N (N from 1 to 4096) or box")]
pub struct UnknownObstacleModel(pub String);

impl FromStr for ObstacleModel {
    type Err = UnknownObstacleModel;

    fn from_str(word: &str) -> Result<Self, UnknownObstacleModel> {
        let unknown = || UnknownObstacleModel(word.to_owned());
        match word {
            "exact" => Ok(Self::Exact),
            "slices" => Ok(Self::Slices),
            "sphere" => Ok(Self::Sphere),
            "box" => Ok(Self::Box),
            _ => {
                let count = word.strip_prefix("spheres=").and_then(|n| n.parse().ok());
                count.filter(|n| (1..=MAX_SPHERES).contains(n)).map(Self::Spheres).ok_or_else(unknown)
            }
        }
    }
}

impl std::fmt::Display for ObstacleModel {
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
