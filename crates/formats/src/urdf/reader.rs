//! Links and the attributes that all elements share.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use elbowroom_spatial::{Pose, Vec3};
use roxmltree::Node;

use super::{Link, Solid};
use crate::error::Warnings;
use crate::scan::show;
use crate::{FormatError, Warning, xml};

pub(super) struct Reader<'w> {
    pub(super) file: &'w Path,
    pub(super) lines: xml::LineIndex,
    pub(super) warnings: Warnings,
}

impl Reader<'_> {
    pub(super) fn error(&self, node: Node<'_, '_>, what: impl Into<String>) -> FormatError {
        FormatError::new(self.file, self.lines.line(node), what)
    }

    pub(super) fn warn(&mut self, node: Node<'_, '_>, what: impl Into<String>, hint: &str) {
        let line = self.lines.line(node);
        self.warnings.push(Warning::new(self.file, line, what).hint(hint));
    }

    /// A name that is there and not empty.
    pub(super) fn required<'a>(&self, node: Node<'a, '_>, attribute: &str) -> Result<&'a str, FormatError> {
        let element = node.tag_name().name();
        node.attribute(attribute).map(str::trim).filter(|n| !n.is_empty()).ok_or_else(|| {
            self.error(node, format!("<{element}> has no {attribute}")).hint(format!("<{element} {attribute}=\"…\">"))
        })
    }

    pub(super) fn number(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<f64>, FormatError> {
        let Some(text) = node.attribute(attribute) else { return Ok(None) };
        let [value] = self.numbers(node, attribute, text, "one finite number, such as 0.25")?;
        Ok(Some(value))
    }

    pub(super) fn vector(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<[f64; 3]>, FormatError> {
        let Some(text) = node.attribute(attribute) else { return Ok(None) };
        self.numbers(node, attribute, text, "three finite numbers: \"0 0 1\"").map(Some)
    }

    fn numbers<const N: usize>(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
        text: &str,
        hint: &str,
    ) -> Result<[f64; N], FormatError> {
        let error = |why: &str| {
            let what = format!("{attribute}=\"{}\" of <{}> {why}", show(text.as_bytes()), node.tag_name().name());
            FormatError::new(self.file, xml::attribute_line(node, attribute), what).hint(hint)
        };
        let numbers: Option<Vec<f64>> = text.split_ascii_whitespace().take(N + 1).map(|w| w.parse().ok()).collect();
        let numbers = numbers.ok_or_else(|| error("is not made of numbers"))?;
        if numbers.iter().any(|x| !x.is_finite()) {
            return Err(error("is not finite"));
        }
        <[f64; N]>::try_from(numbers).map_err(|n| error(&format!("has {} numbers, not {N}", n.len())))
    }

    /// `<origin xyz="…" rpy="…"/>`, each zero where missing.
    pub(super) fn origin(&self, node: Node<'_, '_>) -> Result<Pose, FormatError> {
        let Some(origin) = xml::child(node, "origin") else { return Ok(Pose::IDENTITY) };
        let xyz = self.vector(origin, "xyz")?.unwrap_or_default();
        let rpy = self.vector(origin, "rpy")?.unwrap_or_default();
        Ok(Pose::from_xyz_rpy(xyz, rpy))
    }

    pub(super) fn links(&mut self, root: Node<'_, '_>) -> Result<Vec<Link>, FormatError> {
        let mut links = Vec::new();
        let mut lines: HashMap<&str, usize> = HashMap::new();
        for node in xml::children(root, "link") {
            let name = self.required(node, "name")?;
            let line = self.lines.line(node);
            if let Some(first) = lines.insert(name, line) {
                let what = format!("a second link `{}`; the first is on line {first}", show(name.as_bytes()));
                return Err(self.error(node, what).hint("a name of its own for each link"));
            }
            let collisions = self.solids(node, "collision")?;
            let visuals = self.solids(node, "visual")?;
            links.push(Link { name: name.to_owned(), line, visuals, collisions });
        }
        Ok(links)
    }

    /// What cannot be read is an error where it collides, and a warning where it is only looked at.
    fn solids(&mut self, link: Node<'_, '_>, element: &'static str) -> Result<Vec<Solid>, FormatError> {
        let mut solids = Vec::new();
        for node in xml::children(link, element) {
            match self.solid(node) {
                Ok(solid) => solids.push(solid),
                Err(e) if element == "visual" => self.warnings.push(e.into()),
                Err(e) => return Err(e),
            }
        }
        Ok(solids)
    }

    fn solid(&self, node: Node<'_, '_>) -> Result<Solid, FormatError> {
        let name = node.attribute("name").filter(|n| !n.is_empty()).map(str::to_owned);
        Ok(Solid { name, line: self.lines.line(node), in_link: self.origin(node)?, geometry: self.geometry(node)? })
    }

    /// Elements of other tools are passed over; each kind that may matter is mentioned once.
    pub(super) fn warn_of_strangers(&mut self, root: Node<'_, '_>) {
        let mut seen = HashSet::new();
        for node in root.children().filter(Node::is_element) {
            let tag = node.tag_name();
            if tag.namespace() != root.tag_name().namespace() && seen.insert((tag.namespace(), tag.name())) {
                self.warn(
                    node,
                    format!("<{}> of an extension is passed over", show(tag.name().as_bytes())),
                    "nothing, if it does not concern collisions",
                );
            }
        }
    }

    pub(super) fn axis(&self, joint: Node<'_, '_>, moves: bool) -> Result<Vec3, FormatError> {
        let Some(node) = xml::child(joint, "axis") else { return Ok(Vec3::X) };
        let xyz = self.vector(node, "xyz")?;
        match xyz.map_or(Vec3::X, Vec3::from).try_normalize() {
            Some(axis) => Ok(axis),
            None if moves => Err(self.error(node, "the axis 0 0 0 is no direction").hint("<axis xyz=\"0 0 1\"/>")),
            None => Ok(Vec3::X),
        }
    }
}
