//! The triangles of one `<geometry>`.

use std::collections::HashMap;
use std::path::Path;

use elbowroom_spatial::Vec3;
use roxmltree::{Node, NodeId};

use super::source::{indices, points, target};
use crate::mesh_data::{MAX_ELEMENTS, MeshData, split_vertices};
use crate::warning_list::WarningList;
use crate::{Diagnostic, polygon, xml};

type Ids<'a, 'i> = HashMap<&'a str, Node<'a, 'i>>;

/// Reads all primitives of a geometry as one mesh, in the numbers of the file.
pub(super) fn read<'a, 'i>(
    geometry: Node<'a, 'i>,
    ids: &Ids<'a, 'i>,
    file: &Path,
    warnings: &mut WarningList,
    points_read: &mut usize,
) -> Result<MeshData, Diagnostic> {
    let name = geometry.attribute("name").or(geometry.attribute("id")).unwrap_or("geometry");
    let mut reader = GeometryReader {
        ids,
        file,
        vertices: Vec::new(),
        first_of: HashMap::new(),
        triangles: Vec::new(),
        warnings,
        points_read,
    };
    let body = xml::child(geometry, "mesh").or_else(|| xml::child(geometry, "convex_mesh"));
    for primitive in body.iter().flat_map(Node::children).filter(Node::is_element) {
        match primitive.tag_name().name() {
            "triangles" | "polylist" | "polygons" | "tristrips" | "trifans" => reader.primitive(primitive)?,
            _ => {}
        }
    }
    let GeometryReader { vertices, triangles, .. } = reader;
    let mut meshes = [MeshData { name: name.to_owned(), vertices: Vec::new(), triangles }];
    split_vertices(&vertices, &mut meshes);
    let [mesh] = meshes;
    Ok(mesh)
}

struct GeometryReader<'a, 'i, 'w> {
    ids: &'w Ids<'a, 'i>,
    file: &'w Path,
    vertices: Vec<Vec3>,
    /// Per source: its first point in `vertices`, and its number of points.
    first_of: HashMap<NodeId, (u32, u32)>,
    triangles: Vec<[u32; 3]>,
    warnings: &'w mut WarningList,
    /// Number of points read from the whole file. Thousands of geometries may share one source, and each reads it again.
    points_read: &'w mut usize,
}

/// Positions of the vertex indices in `<p>`, and the points to which they refer.
struct Layout {
    stride: usize,
    offset: usize,
    first: u32,
    count: u32,
}

impl<'a, 'i> GeometryReader<'a, 'i, '_> {
    fn primitive(&mut self, node: Node<'a, 'i>) -> Result<(), Diagnostic> {
        let lists: Vec<Node<'a, 'i>> = xml::children(node, "p").collect();
        let holed: Vec<Node<'a, 'i>> = xml::children(node, "ph").collect();
        if lists.is_empty() && holed.is_empty() {
            return Ok(());
        }
        let layout = self.layout(node)?;
        if let Some(first) = holed.first() {
            let what = "polygons with holes are read without their holes";
            self.warnings.push_with(|| Diagnostic::new(self.file, xml::line(*first), what).hint("triangles"));
        }
        let outlines = holed.iter().filter_map(|ph| xml::child(*ph, "p"));
        for list in lists.iter().copied().chain(outlines) {
            let corners = self.corners(list, &layout)?;
            match node.tag_name().name() {
                "triangles" => self.triangles(list, &corners)?,
                "polylist" => self.polylist(node, list, &corners)?,
                "tristrips" => polygon::strip(&corners, &mut self.triangles),
                "trifans" => polygon::fan(&corners, &mut self.triangles),
                _ => polygon::triangulate(&self.vertices, &corners, &mut self.triangles),
            }
        }
        Ok(())
    }

    fn layout(&mut self, node: Node<'a, 'i>) -> Result<Layout, Diagnostic> {
        let (mut stride, mut vertex) = (1, None);
        for input in xml::children(node, "input") {
            let text = input.attribute("offset").unwrap_or("0");
            // Exporters never write a larger offset; a huge offset would only cause a huge stride.
            let offset = text.trim().parse::<usize>().ok().filter(|&o| o < 1000).ok_or_else(|| {
                Diagnostic::new(self.file, xml::line(input), "the input's offset is no small integer")
                    .hint("offset=\"0\"")
            })?;
            stride = stride.max(offset + 1);
            if matches!(input.attribute("semantic"), Some("VERTEX" | "POSITION")) && vertex.is_none() {
                vertex = Some((input, offset));
            }
        }
        let (input, offset) = vertex.ok_or_else(|| {
            Diagnostic::new(
                self.file,
                xml::line(node),
                format!("<{}> does not state its vertices", node.tag_name().name()),
            )
            .hint("<input semantic=\"VERTEX\" source=\"#VERTICES\" offset=\"0\"/>")
        })?;
        let (first, count) = self.positions(input)?;
        Ok(Layout { stride, offset, first, count })
    }

    /// Reads the points of an input, once per source.
    fn positions(&mut self, input: Node<'a, 'i>) -> Result<(u32, u32), Diagnostic> {
        let mut source = target(self.ids, input, "source", self.file)?;
        if source.tag_name().name() == "vertices" {
            let position = xml::children(source, "input").find(|i| i.attribute("semantic") == Some("POSITION"));
            let position = position.ok_or_else(|| {
                Diagnostic::new(self.file, xml::line(source), "<vertices> has no positions")
                    .hint("<input semantic=\"POSITION\" source=\"#POSITIONS\"/>")
            })?;
            source = target(self.ids, position, "source", self.file)?;
        }
        if let Some(known) = self.first_of.get(&source.id()) {
            return Ok(*known);
        }
        let points = points(source, self.file)?;
        *self.points_read += points.len();
        if *self.points_read > MAX_ELEMENTS {
            let what = format!("the geometries together read more than {MAX_ELEMENTS} points");
            return Err(Diagnostic::new(self.file, xml::line(source), what).hint("a coarser mesh"));
        }
        let range = (self.vertices.len() as u32, points.len() as u32);
        self.vertices.extend(points);
        self.first_of.insert(source.id(), range);
        Ok(range)
    }

    fn corners(&self, list: Node<'a, 'i>, layout: &Layout) -> Result<Vec<u32>, Diagnostic> {
        let numbers = indices(list, self.file)?;
        if !numbers.len().is_multiple_of(layout.stride) {
            let what = format!(
                "<p> has {} numbers, which is no multiple of the {} of one corner",
                numbers.len(),
                layout.stride
            );
            return Err(Diagnostic::new(self.file, xml::line(list), what).hint("one number per input and corner"));
        }
        let corners = numbers.chunks_exact(layout.stride).map(|c| c[layout.offset]);
        corners
            .map(|i| if i < layout.count { Ok(layout.first + i) } else { Err(i) })
            .collect::<Result<_, u32>>()
            .map_err(|i| {
                let what = format!("<p> names the vertex {i}, but there are {}", layout.count);
                Diagnostic::new(self.file, xml::line(list), what).hint("numbers of vertices, counted from 0")
            })
    }

    fn triangles(&mut self, list: Node<'a, 'i>, corners: &[u32]) -> Result<(), Diagnostic> {
        if !corners.len().is_multiple_of(3) {
            let what = format!("<triangles> with {} corners", corners.len());
            return Err(Diagnostic::new(self.file, xml::line(list), what).hint("three corners for each triangle"));
        }
        self.triangles.extend(corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]));
        Ok(())
    }

    fn polylist(&mut self, node: Node<'a, 'i>, list: Node<'a, 'i>, corners: &[u32]) -> Result<(), Diagnostic> {
        let sizes = xml::child(node, "vcount").map_or(Ok(Vec::new()), |v| indices(v, self.file))?;
        let mut rest = corners;
        for size in sizes {
            let Some((polygon, after)) = rest.split_at_checked(size as usize) else {
                let what = format!("<vcount> needs more corners than the {} of <p>", corners.len());
                return Err(
                    Diagnostic::new(self.file, xml::line(list), what).hint("as many corners as the sum of <vcount>")
                );
            };
            polygon::triangulate(&self.vertices, polygon, &mut self.triangles);
            rest = after;
        }
        if !rest.is_empty() {
            let what = format!("{} corners of <p> belong to no polygon of <vcount>; they are dropped", rest.len());
            self.warnings.push_with(|| {
                Diagnostic::new(self.file, xml::line(list), what).hint("as many corners as the sum of <vcount>")
            });
        }
        Ok(())
    }
}
