//! `<geometry>`: box, sphere, cylinder, capsule, mesh.

use elbowroom_spatial::Vec3;
use roxmltree::Node;

use super::model::Geometry;
use super::parser::UrdfParser;
use crate::tokens::show;
use crate::{Diagnostic, xml};

const SHAPES: &str = "<box size=\"1 1 1\"/>, <sphere radius=\"0.1\"/>, <cylinder radius=\"0.1\" length=\"1\"/>, \
                      <capsule radius=\"0.1\" length=\"1\"/> or <mesh filename=\"part.stl\"/>";

impl UrdfParser<'_> {
    pub(super) fn geometry(&self, solid: Node<'_, '_>) -> Result<Geometry, Diagnostic> {
        let element = solid.tag_name().name();
        let geometry = xml::child(solid, "geometry").ok_or_else(|| {
            self.error(solid, format!("<{element}> has no <geometry>")).hint(format!("<geometry> with {SHAPES}"))
        })?;
        let mut shapes = geometry.children().filter(Node::is_element);
        let shape = shapes.next().ok_or_else(|| self.error(geometry, "<geometry> is empty").hint(SHAPES))?;
        if let Some(second) = shapes.next() {
            return Err(self
                .error(second, "<geometry> has a second shape")
                .hint(format!("a second <{element}> for it")));
        }
        match shape.tag_name().name() {
            "box" => self.dimensions(shape, "size").map(Geometry::Box),
            "sphere" => Ok(Geometry::Sphere { radius: self.dimension(shape, "radius")? }),
            "cylinder" => Ok(Geometry::Cylinder {
                radius: self.dimension(shape, "radius")?,
                length: self.dimension(shape, "length")?,
            }),
            "capsule" => Ok(Geometry::Capsule {
                radius: self.dimension(shape, "radius")?,
                length: self.dimension(shape, "length")?,
            }),
            "mesh" => self.mesh(shape),
            other => Err(self.error(shape, format!("the shape <{}> is unknown", show(other.as_bytes()))).hint(SHAPES)),
        }
    }

    fn mesh(&self, node: Node<'_, '_>) -> Result<Geometry, Diagnostic> {
        let filename = self.required(node, "filename")?.to_owned();
        let scale = self.vector(node, "scale")?.map_or(Vec3::splat(1.0), Vec3::from);
        if scale.abs().min_element() == 0.0 {
            return Err(self
                .error(node, "a scale of 0 flattens the mesh")
                .hint("scale=\"1 1 1\", or 0.001 for millimetres"));
        }
        Ok(Geometry::Mesh { filename, scale })
    }

    /// Reads a required, non-negative length.
    fn dimension(&self, node: Node<'_, '_>, attribute: &str) -> Result<f64, Diagnostic> {
        let name = node.tag_name().name();
        let hint = format!("<{name} {attribute}=\"0.1\" …>");
        let value = self.number(node, attribute)?;
        let value = value.ok_or_else(|| self.error(node, format!("<{name}> has no {attribute}")).hint(&hint))?;
        if value < 0.0 {
            return Err(self.error(node, format!("{attribute}=\"{value}\" of <{name}> is negative")).hint(hint));
        }
        Ok(value)
    }

    fn dimensions(&self, node: Node<'_, '_>, attribute: &str) -> Result<Vec3, Diagnostic> {
        let hint = "<box size=\"1 1 1\"/>: whole edges in metres";
        let size = self.vector(node, attribute)?.map(Vec3::from);
        let size = size.ok_or_else(|| self.error(node, "<box> has no size").hint(hint))?;
        if size.min_element() < 0.0 {
            return Err(self.error(node, "an edge of the box is negative").hint(hint));
        }
        Ok(size)
    }
}
