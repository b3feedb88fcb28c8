//! The nodes of a scene, nested and instanced.

use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use elbowroom_spatial::{Rotation, Vec3};
use roxmltree::{Node, NodeId};

use super::{geometry, source};
use crate::affine::Affine;
use crate::mesh_data::{MAX_ELEMENTS, MeshData};
use crate::tokens::show;
use crate::warning_list::WarningList;
use crate::{Diagnostic, xml};

/// Limits on the number of visited nodes and on their depth: nodes that instance each other expand exponentially.
const MAX_VISITS: usize = 100_000;
const MAX_DEPTH: usize = 200;

pub(super) struct SceneReader<'a, 'i, 'w> {
    ids: HashMap<&'a str, Node<'a, 'i>>,
    geometries: HashMap<NodeId, Rc<MeshData>>,
    file: &'w Path,
    warnings: &'w mut WarningList,
    elements: usize,
    points_read: usize,
}

/// All objects of the scene of the file; if the scene is empty, all geometries without node transforms.
pub(super) fn meshes(
    root: Node<'_, '_>,
    to_metres: &Affine,
    file: &Path,
    warnings: &mut WarningList,
) -> Result<Vec<MeshData>, Diagnostic> {
    let ids = root.descendants().filter_map(|n| Some((n.attribute("id")?, n))).collect();
    let mut scene = SceneReader { ids, geometries: HashMap::new(), file, warnings, elements: 0, points_read: 0 };
    let mut meshes = match scene.visual_scene_of(root)? {
        Some(visual_scene) => scene.read_scene(visual_scene, to_metres)?,
        None => Vec::new(),
    };
    if meshes.is_empty() {
        scene.all_geometries(root, to_metres, &mut meshes)?;
    }
    Ok(meshes)
}

impl<'a, 'i> SceneReader<'a, 'i, '_> {
    fn visual_scene_of(&self, root: Node<'a, 'i>) -> Result<Option<Node<'a, 'i>>, Diagnostic> {
        let instance = xml::child(root, "scene").and_then(|s| xml::child(s, "instance_visual_scene"));
        match instance {
            Some(instance) => self.target(instance, "url").map(Some),
            None => Ok(xml::child(root, "library_visual_scenes").and_then(|l| xml::child(l, "visual_scene"))),
        }
    }

    /// The element to which a `#reference` refers.
    fn target(&self, node: Node<'a, 'i>, attribute: &str) -> Result<Node<'a, 'i>, Diagnostic> {
        source::target(&self.ids, node, attribute, self.file)
    }

    fn read_scene(&mut self, visual_scene: Node<'a, 'i>, to_metres: &Affine) -> Result<Vec<MeshData>, Diagnostic> {
        let mut meshes = Vec::new();
        let mut visits = 0;
        let mut stack: Vec<_> = xml::children(visual_scene, "node").map(|n| (n, *to_metres, 0)).collect();
        stack.reverse();
        while let Some((node, parent, depth)) = stack.pop() {
            visits += 1;
            if depth > MAX_DEPTH || visits > MAX_VISITS {
                let what = "nodes that contain or instance each other too deeply, or in a cycle";
                return Err(Diagnostic::new(self.file, xml::line(node), what).hint("a scene without instance_node"));
            }
            let to_scene = parent.after(&self.transform(node)?);
            self.read_node(node, &to_scene, &mut meshes)?;
            let first_child = stack.len();
            for child in node.children().filter(Node::is_element) {
                match child.tag_name().name() {
                    "node" => stack.push((child, to_scene, depth + 1)),
                    "instance_node" => stack.push((self.target(child, "url")?, to_scene, depth + 1)),
                    _ => {}
                }
            }
            // Reversed, because the stack is last in, first out.
            stack[first_child..].reverse();
        }
        Ok(meshes)
    }

    /// Reads the geometry of a node itself, as one object.
    fn read_node(&mut self, node: Node<'a, 'i>, to_scene: &Affine, out: &mut Vec<MeshData>) -> Result<(), Diagnostic> {
        let mut object: Option<MeshData> = None;
        for instance in node.children().filter(Node::is_element) {
            let (geometry, bind_shape) = match instance.tag_name().name() {
                "instance_geometry" => (self.target(instance, "url")?, Affine::IDENTITY),
                "instance_controller" => self.skinned(instance)?,
                _ => continue,
            };
            let mut part = self.instance(geometry)?;
            to_scene.after(&bind_shape).apply(&mut part);
            match &mut object {
                Some(whole) => whole.append(part),
                None => object = Some(part),
            }
        }
        if let Some(mut object) = object {
            if let Some(name) = node.attribute("name").or(node.attribute("id")) {
                name.clone_into(&mut object.name);
            }
            out.push(object);
        }
        Ok(())
    }

    /// The geometry of a controller (skins may refer to morphs), and the bind shape of the skin.
    fn skinned(&self, instance: Node<'a, 'i>) -> Result<(Node<'a, 'i>, Affine), Diagnostic> {
        let mut target = self.target(instance, "url")?;
        let mut bind_shape = Affine::IDENTITY;
        for _ in 0..8 {
            if target.tag_name().name() == "geometry" {
                return Ok((target, bind_shape));
            }
            let inner = xml::child(target, "skin").or_else(|| xml::child(target, "morph"));
            let Some(inner) = inner else { break };
            if let Some(matrix) = xml::child(inner, "bind_shape_matrix") {
                bind_shape = bind_shape.after(&self.matrix(matrix)?);
            }
            target = self.target(inner, "source")?;
        }
        Err(Diagnostic::new(self.file, xml::line(instance), "the controller leads to no geometry")
            .hint("<skin source=\"#GEOMETRY\">, or the mesh exported without its armature"))
    }

    fn instance(&mut self, geometry: Node<'a, 'i>) -> Result<MeshData, Diagnostic> {
        if !self.geometries.contains_key(&geometry.id()) {
            let mesh = geometry::read(geometry, &self.ids, self.file, self.warnings, &mut self.points_read)?;
            self.geometries.insert(geometry.id(), Rc::new(mesh));
        }
        let mesh = &self.geometries[&geometry.id()];
        self.elements += mesh.vertices.len() + mesh.triangles.len();
        if self.elements > MAX_ELEMENTS {
            let what = format!("the scene expands to more than {MAX_ELEMENTS} vertices and triangles");
            return Err(
                Diagnostic::new(self.file, xml::line(geometry), what).hint("a coarser mesh, or fewer instances")
            );
        }
        Ok(MeshData::clone(mesh))
    }

    fn all_geometries(
        &mut self,
        root: Node<'a, 'i>,
        to_metres: &Affine,
        out: &mut Vec<MeshData>,
    ) -> Result<(), Diagnostic> {
        let geometries = xml::children(root, "library_geometries").flat_map(|l| xml::children(l, "geometry"));
        for geometry in geometries.collect::<Vec<_>>() {
            let mut mesh = self.instance(geometry)?;
            to_metres.apply(&mut mesh);
            out.push(mesh);
        }
        if !out.is_empty() {
            let what = "the scene has no geometry; all geometries of the file are taken as they are";
            self.warnings.push_with(|| {
                Diagnostic::new(self.file, None, what).hint("<instance_geometry url=\"#ID\"/> in a <node>")
            });
        }
        Ok(())
    }

    /// The product of a node's transforms, in the order of the file.
    fn transform(&self, node: Node<'a, 'i>) -> Result<Affine, Diagnostic> {
        let mut total = Affine::IDENTITY;
        for child in node.children().filter(Node::is_element) {
            let step = match child.tag_name().name() {
                "matrix" => self.matrix(child)?,
                "translate" => Affine::translation(self.numbers(child)?),
                "scale" => Affine::scale(self.numbers(child)?),
                "rotate" => {
                    let [x, y, z, degrees] = self.numbers(child)?;
                    let axis = Vec3::new(x, y, z).try_normalize();
                    axis.map_or(Affine::IDENTITY, |axis| {
                        Affine::rotation(Rotation::from_axis_angle(axis, degrees.to_radians()).rows())
                    })
                }
                name @ ("skew" | "lookat") => {
                    return Err(Diagnostic::new(self.file, xml::line(child), format!("<{name}> is not read"))
                        .hint("the same transform as <matrix>, 16 numbers row by row"));
                }
                _ => continue,
            };
            total = total.after(&step);
        }
        Ok(total)
    }

    fn matrix(&self, node: Node<'a, 'i>) -> Result<Affine, Diagnostic> {
        let n: [f64; 16] = self.numbers(node)?;
        Ok(Affine([[n[0], n[1], n[2], n[3]], [n[4], n[5], n[6], n[7]], [n[8], n[9], n[10], n[11]]]))
    }

    fn numbers<const N: usize>(&self, node: Node<'a, 'i>) -> Result<[f64; N], Diagnostic> {
        let text = xml::text(node);
        let numbers: Vec<f64> = text.split_ascii_whitespace().take(N + 1).map_while(|w| w.parse().ok()).collect();
        <[f64; N]>::try_from(numbers).ok().filter(|n| n.iter().all(|x| x.is_finite())).ok_or_else(|| {
            let name = node.tag_name().name();
            let what = format!("<{name}> is not made of {N} finite numbers: `{}`", show(text.trim().as_bytes()));
            Diagnostic::new(self.file, xml::line(node), what).hint(format!("{N} numbers, separated by blanks"))
        })
    }
}
