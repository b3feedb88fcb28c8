//! Names of frames and joints.

/// The frame of the cell.
pub(super) const WORLD: &str = "world";

/// A link of a robot.
pub(super) fn link(robot: &str, link: &str) -> String {
    format!("{robot}/{link}")
}

/// A joint of a robot, in the description of the whole cell.
pub(super) fn joint(robot: &str, joint: &str) -> String {
    format!("{robot}/{joint}")
}

/// The tool centre point of a robot.
pub(super) fn tcp(robot: &str) -> String {
    format!("{robot}/tcp")
}

/// An object.
pub(super) fn object(name: &str) -> String {
    format!("object/{name}")
}

/// A region.
pub(super) fn region(name: &str) -> String {
    format!("region/{name}")
}
