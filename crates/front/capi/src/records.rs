//! Structures that C reads and writes.

use std::ffi::{c_char, c_int};

use elbowroom::query::Level;
use elbowroom::spatial::{Pose, Rotation, Vec3};

use crate::failure::Failure;

/// Largest difference of the length of a quaternion from 1: more is another convention, not a rounding.
const QUATERNION_SLACK: f64 = 1e-3;

/// A resolution level: `elbowroom_level` in C.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LevelCode {
    /// From coarse to exact; answers like `L3`.
    Auto = 0,
    /// Axis-aligned boxes of robots.
    L1 = 1,
    /// Oriented boxes of links.
    L2 = 2,
    /// Capsules of links.
    Capsule = 3,
    /// Convex hulls of colliders.
    Hull = 4,
    /// The exact geometry.
    L3 = 5,
}

impl LevelCode {
    pub(crate) fn of(level: Level) -> Self {
        match level {
            Level::Auto => Self::Auto,
            Level::L1 => Self::L1,
            // No checker of C has the deeper boxes of L2.
            Level::L2 | Level::L2Depth(_) => Self::L2,
            Level::Capsule => Self::Capsule,
            Level::Hull => Self::Hull,
            Level::L3 => Self::L3,
        }
    }

    /// The level of a number from C.
    pub(crate) fn level(code: c_int) -> Result<Level, Failure> {
        let levels = [Level::Auto, Level::L1, Level::L2, Level::Capsule, Level::Hull, Level::L3];
        usize::try_from(code).ok().and_then(|code| levels.get(code)).copied().ok_or_else(|| {
            Failure::invalid(format!(
                "{code} is no resolution level\n  write: ELBOWROOM_LEVEL_AUTO, _L1, _L2, _CAPSULE, _HULL or _L3"
            ))
        })
    }
}

/// A pose: `elbowroom_pose` in C.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseRecord {
    /// The origin, m.
    pub position_m: [f64; 3],
    /// The rotation, as a unit quaternion.
    pub quaternion_xyzw: [f64; 4],
}

impl PoseRecord {
    pub(crate) fn of(pose: Pose) -> Self {
        Self { position_m: pose.translation.to_array(), quaternion_xyzw: pose.rotation.to_quaternion_xyzw() }
    }

    pub(crate) fn pose(self, name: &str) -> Result<Pose, Failure> {
        let [x, y, z] = self.position_m;
        let length = self.quaternion_xyzw.iter().map(|v| v * v).sum::<f64>().sqrt();
        let rotation = Rotation::from_quaternion_xyzw(self.quaternion_xyzw);
        // Written so that NaN fails.
        let is_unit = (length - 1.0).abs() <= QUATERNION_SLACK;
        match rotation {
            Some(rotation) if is_unit && self.position_m.iter().all(|v| v.is_finite()) => {
                Ok(Pose { rotation, translation: Vec3::new(x, y, z) })
            }
            _ => Err(Failure::invalid(format!(
                "the base of `{name}` is no pose: position {:?} m, quaternion {:?}\n  write: finite metres, and a quaternion \
                 x, y, z, w of length 1, as {{0, 0, 0, 1}}",
                self.position_m, self.quaternion_xyzw
            ))),
        }
    }
}

/// A robot to load: `elbowroom_robot_file` in C. Texts are UTF-8.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RobotFile {
    /// The robot's name in the model.
    pub name: *const c_char,
    /// The file: URDF, 3DS, GLB or glTF.
    pub path: *const c_char,
    /// Its SRDF, or NULL.
    pub srdf: *const c_char,
    /// The joints file of a 3DS, GLB or glTF model, or NULL: the file beside the model.
    pub joints: *const c_char,
    /// The unit of meshes whose format has none: `m`, `cm`, `mm` or `in`; NULL: metres.
    pub unit: *const c_char,
    /// The pose of the root link in the world.
    pub base_in_world: PoseRecord,
}

/// An answer about a state: `elbowroom_answer` in C.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    /// 1 on contact; with a tolerance, if the distance is at most the tolerance; else 0.
    pub collides: c_int,
    /// The finest level that was needed.
    pub level: c_int,
    /// The distance, m, 0 on contact; NaN if it was not asked for, or if there is no pair.
    pub distance_m: f64,
    /// Name of the first of the pair, or NULL. It lives as long as the model.
    pub a: *const c_char,
    /// Name of the second of the pair, or NULL.
    pub b: *const c_char,
    /// Witness point on `a`, world, m; NaN if there is none.
    pub point_a_m: [f64; 3],
    /// Witness point on `b`, world, m; NaN if there is none.
    pub point_b_m: [f64; 3],
}

impl Answer {
    /// An error never reads as "free".
    pub(crate) const UNKNOWN: Self = Self {
        collides: 1,
        level: LevelCode::Auto as c_int,
        distance_m: f64::NAN,
        a: std::ptr::null(),
        b: std::ptr::null(),
        point_a_m: [f64::NAN; 3],
        point_b_m: [f64::NAN; 3],
    };
}
