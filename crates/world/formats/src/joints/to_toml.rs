//! Writer of the joints of a robot as a joints file.

use std::fmt::Write;

use elbowroom_kinematics::{Chain, JointKind};

/// Writes the joints of a robot as the text of a joints file, in metres and radians, without loss of digits.
///
/// Nodes are named after the links.
///
/// ```
/// use elbowroom_formats::joints;
/// use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
/// let row = ClassicalRow {
///     joint: "turn".into(), kind: JointKind::Revolute, a: 0.3, alpha: 0.0, d: 0.5, theta: 0.0,
///     limits: Limits::symmetric(2.5),
/// };
/// let text = joints::to_toml(&Chain::from_dh("one", &[row])?);
/// let specs = joints::parse(&text, "one.joints.toml".as_ref())?;
/// assert_eq!((specs[0].name.as_deref(), specs[0].min), (Some("turn"), Some(-2.5)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_toml(chain: &Chain) -> String {
    let mut text = String::from("units = { length = \"m\", angle = \"rad\" }\n");
    for joint in chain.joints().iter().filter(|j| j.kind.moves()) {
        let kind = match joint.kind {
            JointKind::Prismatic => "prismatic",
            JointKind::Continuous => "continuous",
            JointKind::Revolute => "revolute",
            JointKind::Fixed => "fixed",
        };
        let [x, y, z] = joint.axis.to_array();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\n[joint.{}]", key(&chain.links()[joint.child.0]));
        let _ = writeln!(text, "name = {}\nkind = \"{kind}\"\naxis = [{x:?}, {y:?}, {z:?}]", quoted(&joint.name));
        let mut line = |key: &str, value: Option<f64>| {
            if let Some(value) = value.filter(|v| v.is_finite()) {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        };
        line("min", Some(joint.limits.lower));
        line("max", Some(joint.limits.upper));
        line("speed", joint.limits.velocity.filter(|v| *v > 0.0));
        line("acceleration", joint.limits.acceleration.filter(|v| *v > 0.0));
        if let Some(mimic) = joint.mimic {
            let (name, multiplier, offset) = (&chain.joints()[mimic.joint.0].name, mimic.multiplier, mimic.offset);
            let name = quoted(name);
            let _ = writeln!(text, "mimic = {{ joint = {name}, multiplier = {multiplier:?}, offset = {offset:?} }}");
        }
    }
    text
}

/// Quotes a name as a TOML key, if necessary.
pub(crate) fn key(name: &str) -> String {
    let bare = !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
    if bare { name.to_owned() } else { quoted(name) }
}

/// Quotes a name as a TOML string.
fn quoted(name: &str) -> String {
    let mut text = String::from("\"");
    for c in name.chars() {
        match c {
            '"' | '\\' => text.extend(['\\', c]),
            c if c.is_control() => text.push('_'),
            c => text.push(c),
        }
    }
    text.push('"');
    text
}
