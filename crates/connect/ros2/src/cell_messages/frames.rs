//! Names of frames and joints.

/// The frame of the cell.
pub(super) const WORLD: &str = "world";

/// Frame of a link of a robot.
pub(super) fn link(robot: &str, link: &str) -> String {
    format!("{robot}/{link}")
}

/// Name of a joint of a robot, in the description of the whole cell.
pub(super) fn joint(robot: &str, joint: &str) -> String {
    format!("{robot}/{joint}")
}

/// Frame of the tool centre point of a robot.
pub(super) fn tcp(robot: &str) -> String {
    format!("{robot}/tcp")
}

/// Frame of an object.
pub(super) fn object(name: &str) -> String {
    format!("object/{name}")
}

/// Frame of a region.
pub(super) fn region(name: &str) -> String {
    format!("region/{name}")
}
