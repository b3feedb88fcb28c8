//! Errors of a scene, a state or an allowed collision matrix.

use crate::{PairNumber, PairState};

/// Why a scene was not built or a state was not changed. On an error nothing changes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// Two robots, links or objects share a name.
    #[error("the name `{0}` is used twice; give robots, objects and links names of their own, messages use them")]
    DuplicateName(String),
    /// A robot's index is out of range.
    #[error("there is no robot {index}; the scene has {count}, counted from 0")]
    NoSuchRobot {
        /// The invalid index.
        index: usize,
        /// Number of robots.
        count: usize,
    },
    /// The robots cannot be merged.
    #[error("the robots cannot be merged to `{robot}`: {what}: name each robot once")]
    Merge {
        /// Name of the merged robot.
        robot: String,
        /// The reason, in words.
        what: String,
    },
    /// An object's index is out of range.
    #[error("there is no object {index}; the scene has {count}, counted from 0")]
    NoSuchObject {
        /// The invalid index.
        index: usize,
        /// Number of objects.
        count: usize,
    },
    /// A link's index is out of range.
    #[error("robot `{robot}` has no link {index}; it has {count}, counted from 0")]
    NoSuchLink {
        /// Name of the robot.
        robot: String,
        /// The invalid index.
        index: usize,
        /// Number of links.
        count: usize,
    },
    /// The lists of colliders of a robot do not match its links.
    #[error(
        "robot `{robot}` lists colliders for {colliders} links, but its chain has {links}; one list per link, empty where it has no collision shape"
    )]
    CollidersPerLink {
        /// Name of the robot.
        robot: String,
        /// Length of the list.
        colliders: usize,
        /// Number of links.
        links: usize,
    },
    /// A shape has an invalid dimension.
    #[error("{geometry}: {source}")]
    Shape {
        /// Name of the link or object.
        geometry: String,
        /// The error of the shape.
        source: elbowroom_proximity::ShapeError,
    },
    /// A pose holds a NaN or an infinity.
    #[error("the pose of {0} holds a number that is NaN or infinite")]
    PoseNotFinite(String),
    /// The vector of joint values has the wrong length.
    #[error("robot `{robot}` takes {expected} joint values ({joints}), not {given}")]
    JointCount {
        /// Name of the robot.
        robot: String,
        /// Number of independent joints.
        expected: usize,
        /// Names of the independent joints.
        joints: String,
        /// Length of the given vector.
        given: usize,
    },
    /// A joint value is NaN or infinite.
    #[error("robot `{robot}`, joint `{joint}`: {value} is no position; write a finite number of rad or m")]
    JointNotFinite {
        /// Name of the robot.
        robot: String,
        /// Name of the joint.
        joint: String,
        /// The joint value.
        value: f64,
    },
    /// A padding is invalid.
    #[error("padding of {geometry}: {value} m; write a finite number of metres, 0 or more")]
    Padding {
        /// Name of the link or object.
        geometry: String,
        /// The padding, m.
        value: f64,
    },
    /// A scale is invalid.
    #[error("scale of {geometry}: {value}; write a finite factor above 0")]
    Scale {
        /// Name of the link or object.
        geometry: String,
        /// The factor.
        value: f64,
    },
    /// A mesh or hull is invalid after scaling.
    #[error("scale of {geometry}: {what}")]
    ScaledShape {
        /// Name of the link or object.
        geometry: String,
        /// The error of the scaled shape, in words.
        what: String,
    },
    /// The object is already attached.
    #[error("`{object}` is attached to `{link}`; detach it first")]
    AlreadyAttached {
        /// Name of the object.
        object: String,
        /// `robot/link` that holds it.
        link: String,
    },
    /// The object is not attached.
    #[error("`{0}` is attached to nothing")]
    NotAttached(String),
    /// The object is attached, so its link determines its pose.
    #[error("`{object}` is attached to `{link}` and moves with it; detach it before placing it")]
    PlacedWhileAttached {
        /// Name of the object.
        object: String,
        /// `robot/link` that holds it.
        link: String,
    },
    /// A sweep names a robot or object more than once.
    #[error("`{0}` moves twice in one sweep; name it once, and sweep a path for one motion after another")]
    MovesTwice(String),
    /// An error of the allowed collision matrix.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
}

/// Why an allowed collision matrix was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MatrixError {
    /// The text is not TOML in the format of [`AllowedCollisionMatrix::to_text`](crate::AllowedCollisionMatrix::to_text).
    #[error("the allowed collision matrix cannot be read: {0}")]
    Syntax(String),
    /// The file has another version.
    #[error("version {0} of the allowed collision matrix is unknown; this program reads version 1")]
    Version(i64),
    /// The scene does not have this name.
    #[error(
        "the allowed collision matrix names `{name}`, which the scene does not have (or which has no collision shape); {hint}"
    )]
    UnknownName {
        /// The unknown name.
        name: String,
        /// Similar names, as a hint.
        hint: String,
    },
    /// The matrix has no such pair.
    #[error(
        "{a} and {b} are no pair of the matrix: it has pairs of links with collision shapes, of such links and objects, and of two objects"
    )]
    NoSuchPair {
        /// First side of the pair.
        a: String,
        /// Second side of the pair.
        b: String,
    },
    /// A pair is listed twice.
    #[error("the pair {a}, {b} is listed twice; remove one")]
    Twice {
        /// First side of the pair.
        a: String,
        /// Second side of the pair.
        b: String,
    },
    /// A margin or weight is invalid.
    #[error("{a}, {b}: {what} is {value}; write a finite number, 0 or more")]
    Number {
        /// First side of the pair.
        a: String,
        /// Second side of the pair.
        b: String,
        /// The field.
        what: PairNumber,
        /// The value.
        value: f64,
    },
    /// The file gives a reason that the model contradicts.
    #[error(
        "{a}, {b}: the matrix has {state} because `{reason}`, the model has `{model}`; write the matrix again, or set reason = {{ by_hand = \"why\" }}"
    )]
    Contradiction {
        /// First side of the pair.
        a: String,
        /// Second side of the pair.
        b: String,
        /// The state in the file.
        state: PairState,
        /// The reason in the file.
        reason: String,
        /// The reason from the model.
        model: String,
    },
}
