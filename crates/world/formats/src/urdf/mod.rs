//! URDF files, parsed and checked, with the line in every message. [`robot`](crate::robot) loads the meshes.

mod geometry;
mod joint;
mod model;
mod parser;
mod tree;

use std::path::Path;

use roxmltree::Node;

use crate::tokens::{LineIndex, show};
use crate::warning_list::WarningList;
use crate::{Diagnostic, input, xml};
pub use model::{Geometry, LinkGeometry, UrdfJoint, UrdfLink, UrdfMimic, UrdfModel};

/// Description of a file with the root element `<sdf>`.
pub(crate) const SDF: &str = "is SDF, the format of Gazebo";
/// What to use instead of the file.
pub(crate) const SDF_HINT: &str = "the URDF that the SDF was made from, or the one that a converter makes of it; of a mesh the file that its <uri> names";

/// Parses a URDF. Meshes are named, not opened. `file` is named in messages.
///
/// # Errors
/// [`Diagnostic`] for content that is not a tree of links with finite numbers, an unexpanded xacro, or another format.
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
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn parse(bytes: &[u8], file: &Path) -> Result<UrdfModel, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text(bytes, file)?;
    let document = xml::parse(&text, file)?;
    let root = document.root_element();
    check_root(root, file)?;
    refuse_xacro(root, file)?;
    let mut parser = parser::UrdfParser { file, lines: LineIndex::new(&text), warnings: WarningList::default() };
    refuse_extensions(root, file)?;
    let name = root.attribute("name").map_or_else(|| input::stem(file), str::to_owned);
    let links = parser.links(root)?;
    let joints = parser.joints(root, &links)?;
    parser.warn_of_extensions(root);
    tree::check(&links, &joints, file)?;
    Ok(UrdfModel { name, links, joints, warnings: parser.warnings.finish(file) })
}

fn check_root(root: Node<'_, '_>, file: &Path) -> Result<(), Diagnostic> {
    let name = root.tag_name().name();
    if name == "robot" && xml::children(root, "link").next().is_some() {
        return Ok(());
    }
    let (what, hint) = match name {
        "robot" if xml::child(root, "disable_collisions").is_some() || xml::child(root, "group").is_some() => {
            ("is an SRDF, not a URDF".to_owned(), "the URDF as the model, and this file as its srdf")
        }
        "robot" => ("the robot has no links".to_owned(), "<link name=\"base_link\"/>"),
        "sdf" => (format!("{SDF}, not URDF"), SDF_HINT),
        "mujoco" => ("is MuJoCo's MJCF, not URDF".to_owned(), "the robot as URDF"),
        "COLLADA" => ("is a COLLADA mesh, not a URDF".to_owned(), "a URDF that names this mesh"),
        _ => {
            (format!("the root element is <{}>, not <robot>", show(name.as_bytes())), "<robot name=\"arm\"> … </robot>")
        }
    };
    // An unexpanded xacro may have no links.
    refuse_xacro(root, file)?;
    Err(Diagnostic::new(file, xml::line(root), what).hint(hint))
}

fn refuse_xacro(root: Node<'_, '_>, file: &Path) -> Result<(), Diagnostic> {
    let is_macro = |n: &Node<'_, '_>| n.tag_name().namespace().is_some_and(|ns| ns.contains("xacro"));
    let has_expression =
        |n: &Node<'_, '_>| n.attributes().any(|a| a.value().contains("${") || a.value().contains("$("));
    let Some(node) = root.descendants().filter(Node::is_element).find(|n| is_macro(n) || has_expression(n)) else {
        return Ok(());
    };
    let found = if is_macro(&node) {
        format!("<xacro:{}>", node.tag_name().name())
    } else {
        "an expression, ${…} or $(…)".to_owned()
    };
    Err(Diagnostic::new(file, xml::line(node), format!("is a xacro file that is not expanded: {found}"))
        .hint(xml::xacro_hint(file)))
}

/// Refuses `<drake:joint>` and `<drake:link>`. They belong to the tree: without them the robot would be a different one.
fn refuse_extensions(root: Node<'_, '_>, file: &Path) -> Result<(), Diagnostic> {
    let is_foreign = |n: &Node<'_, '_>| n.is_element() && n.tag_name().namespace() != root.tag_name().namespace();
    let extension = root.children().filter(is_foreign).find(|n| matches!(n.tag_name().name(), "joint" | "link"));
    extension.map_or(Ok(()), |node| {
        let name = node.tag_name().name();
        let what = format!(
            "a <{name}> of an extension ({}), `{}` of type `{}`, is not read",
            show(node.tag_name().namespace().unwrap_or_default().as_bytes()),
            show(node.attribute("name").unwrap_or_default().as_bytes()),
            show(node.attribute("type").unwrap_or_default().as_bytes())
        );
        Err(Diagnostic::new(file, xml::line(node), what).hint(format!(
            "<{name} …> without prefix; a joint of type \"revolute\", \"continuous\", \"prismatic\" or \"fixed\""
        )))
    })
}
