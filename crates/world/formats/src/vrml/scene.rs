//! The nodes of a scene, visited from the top, with the files that they inline.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use elbowroom_spatial::{Rotation, Vec3};

use super::document::{Document, Node};
use super::node_kinds::{NodeKind, field_names, is_known_anywhere, kind};
use super::values::Fields;
use super::{encoding, inline, parser, shapes};
use crate::affine::Affine;
use crate::mesh_data::MeshData;
use crate::tokens::show;
use crate::warning_list::WarningList;
use crate::{Diagnostic, input};

type Result<T> = std::result::Result<T, Diagnostic>;

const MAX_DEPTH: usize = 200;
const MAX_VISITS: usize = 100_000;
/// Largest number of files that inline each other in a row.
const MAX_INLINE_DEPTH: usize = 16;

/// A frame of the scene.
#[derive(Debug, Clone)]
pub(super) struct SceneNode {
    /// Name after `DEF`, or a number.
    pub(super) name: String,
    /// Index of the parent.
    pub(super) parent: Option<usize>,
    /// Frame in the scene, with scale, shear and mirror.
    pub(super) to_scene: Affine,
    /// Triangles in the node's own frame; `None` if it has none.
    pub(super) mesh: Option<MeshData>,
}

/// Reads a file and the files that it inlines.
pub(super) struct SceneReader {
    pub(super) warnings: WarningList,
    /// Files that are being read, outermost first.
    reading: Vec<PathBuf>,
    inlined: HashMap<PathBuf, Rc<Vec<SceneNode>>>,
    visits: usize,
    limits: shapes::Limits,
}

impl SceneReader {
    pub(super) fn new() -> Self {
        Self {
            warnings: WarningList::default(),
            reading: Vec::new(),
            inlined: HashMap::new(),
            visits: 0,
            limits: shapes::Limits::default(),
        }
    }

    /// The frames of a file, parents before their children.
    pub(super) fn read(&mut self, bytes: &[u8], file: &Path) -> Result<Vec<SceneNode>> {
        let text = encoding::text(bytes, file)?;
        let document = parser::parse(&text, file, &mut self.warnings)?;
        if let Some(line) = document.first_route {
            self.warnings.push(
                Diagnostic::new(file, line, "ROUTEs and animations are not followed: every node stays at rest")
                    .hint("the joints in a file of joints beside the model"),
            );
        }
        self.reading.push(std::fs::canonicalize(file).unwrap_or_else(|_| file.to_owned()));
        let shapes = shapes::ShapeReader::new(&document, file);
        let checked = vec![false; document.nodes.len()];
        let mut walk =
            Walk { reader: self, document: &document, file, shapes, checked, file_frame: None, out: Vec::new() };
        walk.run()?;
        let nodes = walk.out;
        self.reading.pop();
        Ok(nodes)
    }
}

/// A node to be visited.
struct Visit {
    node: usize,
    /// Index of the frame that it belongs to.
    frame: Option<usize>,
    to_scene: Affine,
    depth: usize,
}

/// Visits the nodes of one document.
struct Walk<'a, 'w> {
    reader: &'w mut SceneReader,
    document: &'a Document<'a>,
    file: &'a Path,
    shapes: shapes::ShapeReader<'a>,
    /// Nodes whose fields have been checked.
    checked: Vec<bool>,
    /// The frame of shapes that are in no other frame.
    file_frame: Option<usize>,
    out: Vec<SceneNode>,
}

impl Walk<'_, '_> {
    fn run(&mut self) -> Result<()> {
        let visit = |&node| Visit { node, frame: None, to_scene: Affine::IDENTITY, depth: 0 };
        let mut stack: Vec<Visit> = self.document.top.iter().rev().map(visit).collect();
        while let Some(visit) = stack.pop() {
            let node = &self.document.nodes[visit.node];
            self.count(1, visit.depth, node)?;
            if !std::mem::replace(&mut self.checked[visit.node], true) {
                self.check_fields(node)?;
            }
            self.visit(node, &visit, &mut stack)?;
        }
        Ok(())
    }

    fn count(&mut self, visits: usize, depth: usize, node: &Node<'_>) -> Result<()> {
        self.reader.visits += visits;
        if depth <= MAX_DEPTH && self.reader.visits <= MAX_VISITS {
            return Ok(());
        }
        let what = "nodes contain, USE or inline each other too deeply or too often";
        let hint = format!("at most {MAX_VISITS} nodes, with every USE counted, and {MAX_DEPTH} inside each other");
        Err(Diagnostic::new(self.file, node.line, what).hint(hint))
    }

    fn visit(&mut self, node: &Node<'_>, visit: &Visit, stack: &mut Vec<Visit>) -> Result<()> {
        let fields = Fields { node, file: self.file };
        let Visit { mut frame, mut to_scene, depth, .. } = *visit;
        let kind = kind(node.kind);
        match kind {
            NodeKind::Transform => to_scene = to_scene.after(&self.transform(fields)?),
            NodeKind::Group | NodeKind::Switch | NodeKind::Lod => {}
            NodeKind::Inline => return self.inline(fields, frame, &to_scene),
            NodeKind::Shape => return self.shape(visit.node, fields, frame, &to_scene),
            NodeKind::WithoutSurface if node.holds_surface => {
                let what = "has no place for a surface, and the one in it would be missing";
                return Err(fields.error(what).hint("Shape { geometry … } in a Transform or Group"));
            }
            NodeKind::WithoutSurface => return Ok(()),
            NodeKind::Script => {
                self.warn(fields.error("is not run").hint("the scene as it is at rest"));
                return Ok(());
            }
            NodeKind::Unknown => return self.unknown(fields),
        }
        if kind == NodeKind::Transform || node.name.is_some() {
            frame = Some(self.push(frame, name(node), to_scene));
        }
        let children = self.children(kind, fields)?;
        stack.extend(children.iter().rev().map(|&node| Visit { node, frame, to_scene, depth: depth + 1 }));
        Ok(())
    }

    fn warn(&mut self, warning: Diagnostic) {
        self.reader.warnings.push(warning);
    }

    fn push(&mut self, parent: Option<usize>, name: Option<String>, to_scene: Affine) -> usize {
        let index = self.out.len();
        let name = name.unwrap_or_else(|| format!("node_{index}"));
        self.out.push(SceneNode { name, parent, to_scene, mesh: None });
        index
    }

    /// The frame of shapes that are in no other frame, which is named after the file.
    fn file_frame(&mut self) -> usize {
        if let Some(frame) = self.file_frame {
            return frame;
        }
        let frame = self.push(None, Some(input::stem(self.file)), Affine::IDENTITY);
        self.file_frame = Some(frame);
        frame
    }

    /// The children of a group that are read.
    fn children<'n>(&mut self, kind: NodeKind, fields: Fields<'n, '_>) -> Result<&'n [usize]> {
        let node = fields.node;
        let list = |names: [&str; 2]| {
            let first = node.nodes(names[0]);
            if first.is_empty() { node.nodes(names[1]) } else { first }
        };
        match kind {
            NodeKind::Switch => {
                let choices = list(["choice", "children"]);
                let which = fields.integer("whichChoice", -1)?;
                let chosen = usize::try_from(which).ok().filter(|i| *i < choices.len());
                if chosen.is_none() && node.holds_surface {
                    let what = format!("whichChoice is {which}: none of its {} choices is read", choices.len());
                    self.warn(fields.error(what).hint("whichChoice 0 for the first one"));
                }
                Ok(chosen.map_or(&[], |i| &choices[i..=i]))
            }
            NodeKind::Lod => {
                let levels = list(["level", "children"]);
                Ok(&levels[..levels.len().min(1)])
            }
            // A collision without children has an invisible surface.
            _ => Ok(list(["children", "proxy"])),
        }
    }

    /// Refuses or warns of a node that the standard does not have.
    fn unknown(&mut self, fields: Fields<'_, '_>) -> Result<()> {
        let node = fields.node;
        if let Some(line) = self.document.prototypes.get(node.kind) {
            let what = format!("is a node of the prototype of line {line}, whose surface would be missing");
            return Err(fields.error(what).hint("the model exported without prototypes"));
        }
        if node.holds_surface {
            let what = "this node is not read here, and its surface would be missing";
            return Err(fields.error(what).hint("Shape { geometry … } in a Transform or Group"));
        }
        self.warn(fields.error("is no node of VRML 2; it is skipped").hint("a node of VRML 2, or remove it"));
        Ok(())
    }

    /// Refuses repeated fields and unknown fields with a surface; warns of other unknown fields.
    fn check_fields(&mut self, node: &Node<'_>) -> Result<()> {
        let Some(known) = field_names(node) else { return Ok(()) };
        let mut seen = [false; 32];
        for field in &node.fields {
            let at = |what: String| Diagnostic::new(self.file, field.line, what);
            let (name, of) = (show(field.name), show(node.kind));
            match known.iter().position(|k| k.as_bytes() == field.name) {
                Some(i) if std::mem::replace(&mut seen[i], true) => {
                    return Err(at(format!("{of} has a second {name}")).hint(format!("one {name} with everything")));
                }
                Some(_) => {}
                None if is_known_anywhere(field.name) => {}
                None => {
                    let holds = self.document.holds_surface(field);
                    let hint = format!("one of {}", known.join(", "));
                    if holds {
                        let what = format!("{of} has no field {name}, and the surface in it would be missing");
                        return Err(at(what).hint(hint));
                    }
                    let warning = at(format!("{of} has no field {name}; it is skipped")).hint(hint);
                    self.reader.warnings.push(warning);
                }
            }
        }
        Ok(())
    }

    /// The transform of a group to its parent: T · C · R · SR · S · SR⁻¹ · C⁻¹ (ISO/IEC 14772-1, 6.52).
    fn transform(&mut self, fields: Fields<'_, '_>) -> Result<Affine> {
        let translation = fields.tuple("translation", [0.0; 3])?;
        let center = fields.tuple("center", [0.0; 3])?;
        let scale = fields.tuple("scale", [1.0; 3])?;
        if scale.contains(&0.0) {
            self.warn(fields.error("scale has a 0: the surfaces in it are flat").hint("factors above 0"));
        }
        let rotation = self.rotation(fields, "rotation")?;
        let orientation = self.rotation(fields, "scaleOrientation")?;
        let mut total = Affine::translation(translation).after(&Affine::translation(center));
        total = total.after(&Affine::rotation(rotation.rows()));
        if scale != [1.0; 3] {
            total = total.after(&Affine::rotation(orientation.rows()));
            total = total.after(&Affine::scale(scale)).after(&Affine::rotation(orientation.inverse().rows()));
        }
        Ok(total.after(&Affine::translation(center.map(|c| -c))))
    }

    fn rotation(&mut self, fields: Fields<'_, '_>, name: &str) -> Result<Rotation> {
        let [x, y, z, angle] = fields.tuple(name, [0.0, 0.0, 1.0, 0.0])?;
        if angle == 0.0 {
            return Ok(Rotation::IDENTITY);
        }
        let axis = Vec3::new(x, y, z).try_normalize();
        if axis.is_none() {
            let what = format!("{name} has no axis; the angle {angle} is not applied");
            self.warn(fields.error(what).hint(format!("{name} x y z ANGLE, with an axis and radians")));
        }
        Ok(axis.map_or(Rotation::IDENTITY, |axis| Rotation::from_axis_angle(axis, angle)))
    }

    fn inline(&mut self, fields: Fields<'_, '_>, frame: Option<usize>, to_scene: &Affine) -> Result<()> {
        let (path, bytes) = inline::load(fields)?;
        let key = std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
        if self.reader.reading.contains(&key) || self.reader.reading.len() > MAX_INLINE_DEPTH {
            let what = format!("{} inlines itself, or too many files in a row", path.display());
            return Err(fields.error(what).hint("files that inline each other without a cycle"));
        }
        let nodes = match self.reader.inlined.get(&key) {
            Some(nodes) => Rc::clone(nodes),
            None => Rc::new(self.reader.read(&bytes, &path)?),
        };
        self.reader.inlined.insert(key, Rc::clone(&nodes));
        let name = name(fields.node).unwrap_or_else(|| input::stem(&path));
        let top = self.push(frame, Some(name), *to_scene);
        self.count(nodes.len(), 0, fields.node)?;
        let offset = self.out.len();
        for node in nodes.iter() {
            if let Some(mesh) = &node.mesh {
                self.reader.limits.charge(mesh, fields)?;
            }
            let parent = node.parent.map_or(top, |p| p + offset);
            let to_scene = to_scene.after(&node.to_scene);
            self.out.push(SceneNode {
                name: node.name.clone(),
                parent: Some(parent),
                to_scene,
                mesh: node.mesh.clone(),
            });
        }
        Ok(())
    }

    /// Adds the triangles of a shape to its frame.
    fn shape(&mut self, index: usize, fields: Fields<'_, '_>, frame: Option<usize>, to_scene: &Affine) -> Result<()> {
        let scale = (0..3).map(|c| to_scene.column(c).length()).fold(f64::MIN_POSITIVE, f64::max);
        let SceneReader { warnings, limits, .. } = &mut *self.reader;
        let Some(mut mesh) = self.shapes.read(index, scale, limits, warnings)? else { return Ok(()) };
        let frame = frame.unwrap_or_else(|| self.file_frame());
        let node = &mut self.out[frame];
        if let Some(whole) = &mut node.mesh {
            whole.append(mesh);
        } else {
            mesh.name = name(fields.node).unwrap_or_else(|| node.name.clone());
            node.mesh = Some(mesh);
        }
        Ok(())
    }
}

/// The name after `DEF`.
fn name(node: &Node<'_>) -> Option<String> {
    node.name.map(|name| String::from_utf8_lossy(name).into_owned())
}
