//! Parser of links, and of attributes that all elements share.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use elbowroom_spatial::{Pose, Vec3};
use roxmltree::Node;

use super::model::{LinkGeometry, UrdfLink};
use crate::tokens::{LineIndex, show, show_name};
use crate::warning_list::WarningList;
use crate::{Diagnostic, xml};

/// The use of a geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum GeometryRole {
    Collision,
    Visual,
}

impl GeometryRole {
    fn element(self) -> &'static str {
        match self {
            Self::Collision => "collision",
            Self::Visual => "visual",
        }
    }
}

/// Parses links and joints.
pub(super) struct UrdfParser<'w> {
    pub(super) file: &'w Path,
    pub(super) lines: LineIndex,
    pub(super) warnings: WarningList,
}

impl UrdfParser<'_> {
    pub(super) fn error(&self, node: Node<'_, '_>, what: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(self.file, self.lines.line_at(node.range().start), what)
    }

    pub(super) fn warn(&mut self, node: Node<'_, '_>, what: impl std::fmt::Display, hint: &str) {
        let line = self.lines.line_at(node.range().start);
        self.warnings.push(Diagnostic::new(self.file, line, what).hint(hint));
    }

    /// An attribute that is present and not empty.
    pub(super) fn required<'a>(&self, node: Node<'a, '_>, attribute: &str) -> Result<&'a str, Diagnostic> {
        let element = node.tag_name().name();
        node.attribute(attribute).map(str::trim).filter(|n| !n.is_empty()).ok_or_else(|| {
            self.error(node, format!("<{element}> has no {attribute}")).hint(format!("<{element} {attribute}=\"…\">"))
        })
    }

    pub(super) fn number(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<f64>, Diagnostic> {
        let Some(text) = node.attribute(attribute) else { return Ok(None) };
        let [value] = self.numbers(node, attribute, text, "one finite number, such as 0.25")?;
        Ok(Some(value))
    }

    pub(super) fn vector(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<[f64; 3]>, Diagnostic> {
        let Some(text) = node.attribute(attribute) else { return Ok(None) };
        self.numbers(node, attribute, text, "three finite numbers: \"0 0 1\"").map(Some)
    }

    fn numbers<const N: usize>(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
        text: &str,
        hint: &str,
    ) -> Result<[f64; N], Diagnostic> {
        let error = |why: &str| {
            let what = format!("{attribute}=\"{}\" of <{}> {why}", show(text.as_bytes()), node.tag_name().name());
            Diagnostic::new(self.file, xml::attribute_line(node, attribute), what).hint(hint)
        };
        let numbers: Option<Vec<f64>> = text.split_ascii_whitespace().take(N + 1).map(|w| w.parse().ok()).collect();
        let numbers = numbers.ok_or_else(|| error("is not made of numbers"))?;
        if numbers.iter().any(|x| !x.is_finite()) {
            return Err(error("is not finite"));
        }
        <[f64; N]>::try_from(numbers).map_err(|n| error(&format!("has {} numbers, not {N}", n.len())))
    }

    /// Reads `<origin xyz="…" rpy="…"/>`; missing attributes are zero.
    pub(super) fn origin(&self, node: Node<'_, '_>) -> Result<Pose, Diagnostic> {
        let Some(origin) = xml::child(node, "origin") else { return Ok(Pose::IDENTITY) };
        let xyz = self.vector(origin, "xyz")?.unwrap_or_default();
        let rpy = self.vector(origin, "rpy")?.unwrap_or_default();
        Ok(Pose::from_xyz_rpy(xyz, rpy))
    }

    pub(super) fn links(&mut self, root: Node<'_, '_>) -> Result<Vec<UrdfLink>, Diagnostic> {
        let mut links = Vec::new();
        let mut lines: HashMap<&str, usize> = HashMap::new();
        for node in xml::children(root, "link") {
            let name = self.required(node, "name")?;
            let line = self.lines.line_at(node.range().start);
            if let Some(first) = lines.insert(name, line) {
                let what = format!("a second link `{}`; the first is on line {first}", show_name(name));
                return Err(self.error(node, what).hint("a name of its own for each link"));
            }
            let collisions = self.geometries(node, GeometryRole::Collision)?;
            let visuals = self.geometries(node, GeometryRole::Visual)?;
            links.push(UrdfLink { name: name.to_owned(), line, visuals, collisions });
        }
        Ok(links)
    }

    /// Reads the geometries of a link. Invalid collision geometry is an error, invalid visual geometry a warning.
    fn geometries(&mut self, link: Node<'_, '_>, role: GeometryRole) -> Result<Vec<LinkGeometry>, Diagnostic> {
        let mut geometries = Vec::new();
        for node in xml::children(link, role.element()) {
            match self.link_geometry(node) {
                Ok(geometry) => geometries.push(geometry),
                Err(e) if role == GeometryRole::Visual => self.warnings.push(e),
                Err(e) => return Err(e),
            }
        }
        Ok(geometries)
    }

    fn link_geometry(&self, node: Node<'_, '_>) -> Result<LinkGeometry, Diagnostic> {
        let name = node.attribute("name").filter(|n| !n.is_empty()).map(str::to_owned);
        Ok(LinkGeometry {
            name,
            line: self.lines.line_at(node.range().start),
            in_link: self.origin(node)?,
            geometry: self.geometry(node)?,
        })
    }

    /// Warns about ignored elements of extensions, once per kind.
    pub(super) fn warn_of_extensions(&mut self, root: Node<'_, '_>) {
        let mut seen = HashSet::new();
        for node in root.children().filter(Node::is_element) {
            let tag = node.tag_name();
            if tag.namespace() != root.tag_name().namespace() && seen.insert((tag.namespace(), tag.name())) {
                self.warn(
                    node,
                    format!("<{}> of an extension is ignored", show(tag.name().as_bytes())),
                    "nothing, if it does not concern collisions",
                );
            }
        }
    }

    pub(super) fn axis(&self, joint: Node<'_, '_>, moves: bool) -> Result<Vec3, Diagnostic> {
        let Some(node) = xml::child(joint, "axis") else { return Ok(Vec3::X) };
        let xyz = self.vector(node, "xyz")?;
        match xyz.map_or(Vec3::X, Vec3::from).try_normalize() {
            Some(axis) => Ok(axis),
            None if moves => Err(self.error(node, "the axis 0 0 0 is no direction").hint("<axis xyz=\"0 0 1\"/>")),
            None => Ok(Vec3::X),
        }
    }
}
