//! What can be wrong with a scene, a state or a pair matrix.

/// Why a scene was not built or a state not changed. Nothing is changed then.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// Two members share a name.
    #[error("two things are called `{0}`; robots, objects and links need names of their own, messages use them")]
    DuplicateName(String),
    /// A robot's index is out of range.
    #[error("there is no robot {index}; the scene has {count}, counted from 0")]
    NoSuchRobot {
        /// The index.
        index: usize,
        /// Number of robots.
        count: usize,
    },
    /// An object's index is out of range.
    #[error("there is no object {index}; the scene has {count}, counted from 0")]
    NoSuchObject {
        /// The index.
        index: usize,
        /// Number of objects.
        count: usize,
    },
    /// A link's index is out of range.
    #[error("robot `{robot}` has no link {index}; it has {count}, counted from 0")]
    NoSuchLink {
        /// Name of the robot.
        robot: String,
        /// The index.
        index: usize,
        /// Number of links.
        count: usize,
    },
    /// The bodies of a robot are not listed per link.
    #[error(
        "robot `{robot}` lists bodies for {bodies} links, but its chain has {links}; one list per link, empty where it has no solid"
    )]
    BodiesPerLink {
        /// Name of the robot.
        robot: String,
        /// Length of the list.
        bodies: usize,
        /// Number of links.
        links: usize,
    },
    /// A shape has a dimension that cannot be.
    #[error("{member}: {source}")]
    Shape {
        /// Whose shape.
        member: String,
        /// What is wrong.
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
        /// Independent joints.
        expected: usize,
        /// Their names.
        joints: String,
        /// Length of the vector.
        given: usize,
    },
    /// A joint value is NaN or infinite.
    #[error("robot `{robot}`, joint `{joint}`: {value} is no position; write a finite number of rad or m")]
    JointNotFinite {
        /// Name of the robot.
        robot: String,
        /// Name of the joint.
        joint: String,
        /// The value.
        value: f64,
    },
    /// A padding cannot be.
    #[error("padding of {member}: {value} m; write a finite number of metres, 0 or more")]
    Padding {
        /// Whose.
        member: String,
        /// The value.
        value: f64,
    },
    /// A scale cannot be.
    #[error("scale of {member}: {value}; write a finite factor above 0")]
    Scale {
        /// Whose.
        member: String,
        /// The value.
        value: f64,
    },
    /// A scaled mesh is no mesh any more.
    #[error("scale of {member}: {what}")]
    ScaledShape {
        /// Whose.
        member: String,
        /// What is wrong.
        what: String,
    },
    /// The object is already part of a robot.
    #[error("`{object}` is attached to `{link}`; detach it first")]
    AlreadyAttached {
        /// Name of the object.
        object: String,
        /// `robot/link` that holds it.
        link: String,
    },
    /// The object is not part of a robot.
    #[error("`{0}` is attached to nothing")]
    NotAttached(String),
    /// The object goes where its link goes.
    #[error("`{object}` is attached to `{link}` and goes where it goes; detach it before placing it")]
    PlacedWhileAttached {
        /// Name of the object.
        object: String,
        /// `robot/link` that holds it.
        link: String,
    },
    /// A motion names it more than once.
    #[error("`{0}` moves twice in one motion; name it once, and sweep a path for one motion after another")]
    MovesTwice(String),
    /// Something about the pair matrix.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
}

/// Why a pair matrix was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MatrixError {
    /// Not TOML of the shape that [`PairMatrix::to_text`](crate::PairMatrix::to_text) writes.
    #[error("the pair matrix cannot be read: {0}")]
    Syntax(String),
    /// The file is of another version.
    #[error("version {0} of the pair matrix is unknown; this program reads version 1")]
    Version(i64),
    /// A name that the scene does not have.
    #[error("the pair matrix names `{name}`, which the scene does not have (or which has no solid); {hint}")]
    UnknownName {
        /// The name.
        name: String,
        /// What it could be.
        hint: String,
    },
    /// No pair of the matrix.
    #[error("{a} and {b} are no pair of the matrix: it holds links with solids, and links with objects")]
    NoSuchPair {
        /// One side.
        a: String,
        /// Other side.
        b: String,
    },
    /// A pair is there twice.
    #[error("the pair {a}, {b} is there twice; leave one")]
    Twice {
        /// One side.
        a: String,
        /// Other side.
        b: String,
    },
    /// A margin or weight that cannot be.
    #[error("{a}, {b}: {what} is {value}; write a finite number, 0 or more")]
    Number {
        /// One side.
        a: String,
        /// Other side.
        b: String,
        /// `margin_m` or `weight`.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// The file gives a reason that the model contradicts.
    #[error(
        "{a}, {b}: the matrix says {state} because `{reason}`, the model says `{model}`; save the matrix anew, or write reason = {{ by_hand = \"why\" }}"
    )]
    Contradiction {
        /// One side.
        a: String,
        /// Other side.
        b: String,
        /// The state in the file.
        state: &'static str,
        /// The reason in the file.
        reason: String,
        /// The reason by the model.
        model: String,
    },
}
