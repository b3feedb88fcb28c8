//! URDF: what is written, checked line by line; meshes are loaded by [`robot`](crate::robot).

mod geometry;
mod joint;
mod reader;
mod tree;

use std::path::Path;

use elbowroom_kinematics::{JointKind, Limits};
use elbowroom_spatial::{Pose, Vec3};
use roxmltree::Node;

use crate::error::Warnings;
use crate::scan::show;
use crate::{FormatError, Warning, source, xml};

/// A URDF as it is written.
#[derive(Debug, Clone)]
pub struct Model {
    /// The robot's name; the file's stem where it has none.
    pub name: String,
    /// In the file's order. At least one; every name once.
    pub links: Vec<Link>,
    /// In the file's order; together they make a tree over all links.
    pub joints: Vec<Joint>,
    /// What its user should know.
    pub warnings: Vec<Warning>,
}

/// A link and its geometry.
#[derive(Debug, Clone)]
pub struct Link {
    /// Unique among the links.
    pub name: String,
    /// Its line.
    pub line: usize,
    /// Geometry to look at.
    pub visuals: Vec<Solid>,
    /// Geometry that collides.
    pub collisions: Vec<Solid>,
}

/// One `<collision>` or `<visual>`.
#[derive(Debug, Clone)]
pub struct Solid {
    /// Its name, where it has one.
    pub name: Option<String>,
    /// Its line.
    pub line: usize,
    /// Its frame in the link's.
    pub in_link: Pose,
    /// Its shape.
    pub geometry: Geometry,
}

/// A shape; lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// Centred; full edge lengths.
    Box(Vec3),
    /// Centred.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// Along z, centred.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its whole length.
        length: f64,
    },
    /// Along z, centred.
    Capsule {
        /// Its radius.
        radius: f64,
        /// Its length without the caps.
        length: f64,
    },
    /// A file.
    Mesh {
        /// As written: relative, `package://` or `file://`.
        filename: String,
        /// Factor per axis; negative ones mirror.
        scale: Vec3,
    },
}

/// A joint.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Unique among the joints.
    pub name: String,
    /// Its line.
    pub line: usize,
    /// How it moves.
    pub kind: JointKind,
    /// Index of the parent in [`Model::links`].
    pub parent: usize,
    /// Index of the child in [`Model::links`].
    pub child: usize,
    /// The child's frame in the parent's, at value 0.
    pub origin: Pose,
    /// Unit axis in the joint's frame; +x where a fixed joint has none.
    pub axis: Vec3,
    /// Bounds and speeds.
    pub limits: Limits,
    /// Whom it follows.
    pub mimic: Option<Mimic>,
}

/// `value = multiplier · value of joint + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// Index in [`Model::joints`].
    pub joint: usize,
    /// Factor.
    pub multiplier: f64,
    /// Radians or metres.
    pub offset: f64,
}

/// Parses a URDF; meshes are named, not opened. `file` is named in messages.
///
/// # Errors
/// Everything that keeps it from being a tree of links with finite numbers; unexpanded xacro; other files in a URDF's
/// clothes.
///
/// ```
/// use elbowroom_formats::urdf;
/// let text = r#"<robot name="slide">
///   <link name="rail"/>
///   <link name="cart"><collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
///   <joint name="x" type="prismatic">
///     <parent link="rail"/> <child link="cart"/> <limit lower="0" upper="2" velocity="1" effort="0"/>
///   </joint>
/// </robot>"#;
/// let model = urdf::parse(text.as_bytes(), "slide.urdf".as_ref())?;
/// assert_eq!(model.joints[0].limits.upper, 2.0);
///
/// let error = urdf::parse(text.replace("<limit", "<!-- limit").replace("\"0\"/>", "\"0\" -->").as_bytes(), "slide.urdf".as_ref());
/// assert_eq!(error.unwrap_err().line, Some(4));
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub fn parse(bytes: &[u8], file: &Path) -> Result<Model, FormatError> {
    source::check_content(bytes, file)?;
    let text = source::text(bytes, file)?;
    let document = xml::parse(&text, file)?;
    let root = document.root_element();
    check_root(root, file)?;
    refuse_xacro(root, file)?;
    let mut reader = reader::Reader { file, lines: xml::LineIndex::new(&text), warnings: Warnings::default() };
    refuse_extensions(root, file)?;
    let name = root.attribute("name").map_or_else(|| source::stem(file), str::to_owned);
    let links = reader.links(root)?;
    let joints = reader.joints(root, &links)?;
    reader.warn_of_strangers(root);
    tree::check(&links, &joints, file)?;
    Ok(Model { name, links, joints, warnings: reader.warnings.finish(file) })
}

fn check_root(root: Node<'_, '_>, file: &Path) -> Result<(), FormatError> {
    let name = root.tag_name().name();
    if name == "robot" && xml::children(root, "link").next().is_some() {
        return Ok(());
    }
    let (what, hint) = match name {
        "robot" if xml::child(root, "disable_collisions").is_some() || xml::child(root, "group").is_some() => {
            ("is an SRDF, not a URDF".to_owned(), "the URDF as the model, and this file as its srdf")
        }
        "robot" => ("the robot has no links".to_owned(), "<link name=\"base_link\"/>"),
        "sdf" => ("is SDF, not URDF".to_owned(), "the robot as URDF"),
        "mujoco" => ("is MuJoCo's MJCF, not URDF".to_owned(), "the robot as URDF"),
        "COLLADA" => ("is a COLLADA mesh, not a URDF".to_owned(), "a URDF that names this mesh"),
        _ => {
            (format!("the root element is <{}>, not <robot>", show(name.as_bytes())), "<robot name=\"arm\"> … </robot>")
        }
    };
    // An unexpanded xacro may have no links of its own.
    refuse_xacro(root, file)?;
    Err(FormatError::new(file, xml::line(root), what).hint(hint))
}

fn refuse_xacro(root: Node<'_, '_>, file: &Path) -> Result<(), FormatError> {
    let is_macro = |n: &Node<'_, '_>| n.tag_name().namespace().is_some_and(|ns| ns.contains("xacro"));
    let has_expression =
        |n: &Node<'_, '_>| n.attributes().any(|a| a.value().contains("${") || a.value().contains("$("));
    let Some(node) = root.descendants().filter(Node::is_element).find(|n| is_macro(n) || has_expression(n)) else {
        return Ok(());
    };
    let sign = if is_macro(&node) {
        format!("<xacro:{}>", node.tag_name().name())
    } else {
        "an expression, ${…} or $(…)".to_owned()
    };
    Err(FormatError::new(file, xml::line(node), format!("is a xacro file that is not expanded: {sign}"))
        .hint("run `xacro FILE > robot.urdf` and name its output"))
}

/// `<drake:joint>` and `<drake:link>` are parts of the tree: without them it would be another robot.
fn refuse_extensions(root: Node<'_, '_>, file: &Path) -> Result<(), FormatError> {
    let is_foreign = |n: &Node<'_, '_>| n.is_element() && n.tag_name().namespace() != root.tag_name().namespace();
    let part = root.children().filter(is_foreign).find(|n| matches!(n.tag_name().name(), "joint" | "link"));
    part.map_or(Ok(()), |node| {
        let name = node.tag_name().name();
        let what = format!(
            "a <{name}> of an extension ({}), `{}` of type `{}`, is not read",
            show(node.tag_name().namespace().unwrap_or_default().as_bytes()),
            show(node.attribute("name").unwrap_or_default().as_bytes()),
            show(node.attribute("type").unwrap_or_default().as_bytes())
        );
        Err(FormatError::new(file, xml::line(node), what).hint(format!(
            "<{name} …> without prefix; a joint of type \"revolute\", \"continuous\", \"prismatic\" or \"fixed\""
        )))
    })
}
