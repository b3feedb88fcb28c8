//! Trees of oriented boxes (Gottschalk, Lin, Manocha, "`OBBTree`", 1996) around links and objects.

use std::sync::OnceLock;

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Obb, Vec3};

use crate::bounding_volume::Enclosed;
use crate::enclosing_cuboid::{cuboid, points};
use crate::level::MAX_DEPTH;
use crate::local_shape::LocalShape;

/// The boxes of one link or object: level 0 is the box of [`Level::L2`](crate::Level::L2), each further level halves
/// the boxes of the level above.
///
/// The boxes of a depth enclose the surface of every mesh and all of every other shape. The inside of a mesh is not
/// covered from depth 1 on.
#[derive(Debug, Clone)]
pub(crate) struct ObbTree {
    shapes: Vec<LocalShape>,
    /// Built at first use: deeper levels take longer.
    levels: [OnceLock<Vec<ObbNode>>; MAX_DEPTH as usize + 1],
}

/// A box of a tree, or an exact shape of unbounded geometry.
#[derive(Debug, Clone)]
pub(crate) struct ObbNode {
    pub shape: LocalShape,
    /// The shape as an oriented box; `None` for a shape of unbounded geometry.
    pub obb: Option<Obb>,
    /// Index of the first of two children in the next level; `None` for a leaf.
    pub first_child: Option<u32>,
    /// The contents of the children.
    halves: Option<[Vec<TreeItem>; 2]>,
}

/// What a box encloses at least: a triangle of a mesh, or all of any other shape.
#[derive(Debug, Clone, Copy)]
struct TreeItem {
    shape: u32,
    triangle: u32,
}

impl ObbTree {
    /// The tree below the box of L2, or without children for the shapes of unbounded geometry.
    pub fn new(shapes: Vec<LocalShape>, of_l2: &[LocalShape]) -> Self {
        let items = (0..).zip(&shapes).flat_map(|(shape, s)| {
            let triangles = if let Shape::Mesh(m) = &s.shape { m.triangles().len() as u32 } else { 1 };
            (0..triangles).map(move |triangle| TreeItem { shape, triangle })
        });
        let roots = if let [LocalShape { shape: Shape::Cuboid(_), .. }] = of_l2 {
            let items: Vec<TreeItem> = items.collect();
            numbered(vec![ObbNode::new(of_l2[0].clone(), &items, &shapes)])
        } else {
            of_l2.iter().map(|s| ObbNode::new(s.clone(), &[], &shapes)).collect()
        };
        let levels = [const { OnceLock::new() }; MAX_DEPTH as usize + 1];
        // The lock is new, so it is empty.
        _ = levels[0].set(roots);
        Self { shapes, levels }
    }

    /// Builds all levels down to a depth.
    pub fn build(&self, depth: u8) {
        for level in 0..=usize::from(depth.min(MAX_DEPTH)) {
            self.level(level);
        }
    }

    /// The nodes of one level. Leaves of the levels above are not repeated.
    pub fn level(&self, level: usize) -> &[ObbNode] {
        let level = level.min(MAX_DEPTH.into());
        if let Some(nodes) = self.levels[level].get() {
            return nodes;
        }
        // Level 0 always exists.
        let above = self.level(level.saturating_sub(1));
        self.levels[level].get_or_init(|| numbered(above.iter().flat_map(|node| self.children(node)).collect()))
    }

    /// The shapes of a depth: those of its level, and the leaves above it.
    pub fn at_depth(&self, depth: u8) -> impl Iterator<Item = &ObbNode> {
        let last = usize::from(depth.min(MAX_DEPTH));
        (0..=last).flat_map(move |level| {
            self.level(level).iter().filter(move |node| level == last || node.first_child.is_none())
        })
    }

    /// The exact shapes.
    pub fn shapes(&self) -> &[LocalShape] {
        &self.shapes
    }

    fn children(&self, node: &ObbNode) -> Vec<ObbNode> {
        let child = |items: &Vec<TreeItem>| {
            let shape = enclosing(items, &self.shapes).unwrap_or_else(|| node.shape.clone());
            ObbNode::new(shape, items, &self.shapes)
        };
        node.halves.iter().flatten().map(child).collect()
    }
}

/// Tells every node where its children are.
fn numbered(mut nodes: Vec<ObbNode>) -> Vec<ObbNode> {
    for (i, node) in (0..).zip(nodes.iter_mut().filter(|node| node.halves.is_some())) {
        node.first_child = Some(2 * i);
    }
    nodes
}

impl ObbNode {
    fn new(shape: LocalShape, items: &[TreeItem], shapes: &[LocalShape]) -> Self {
        let obb = match &shape.shape {
            Shape::Cuboid(c) => Some(Obb { pose: shape.in_geometry, half_extents: c.half_extents }),
            _ => None,
        };
        let halves = obb.and_then(|obb| halves(&obb, items, shapes));
        Self { shape, obb, first_child: None, halves }
    }
}

/// Divides the items at the mean of their centres along the longest axis of the box that divides them.
fn halves(obb: &Obb, items: &[TreeItem], shapes: &[LocalShape]) -> Option<[Vec<TreeItem>; 2]> {
    if items.len() < 2 {
        return None;
    }
    let mut axes = [Vec3::X, Vec3::Y, Vec3::Z];
    axes.sort_by(|a, b| obb.half_extents.dot(*b).total_cmp(&obb.half_extents.dot(*a)));
    let centres: Vec<Vec3> = items.iter().map(|item| obb.pose.inverse_transform_point(centre(*item, shapes))).collect();
    axes.into_iter().find_map(|axis| {
        let mean = centres.iter().map(|c| c.dot(axis) / centres.len() as f64).sum::<f64>();
        let (low, high): (Vec<_>, Vec<_>) = items.iter().zip(&centres).partition(|(_, c)| c.dot(axis) < mean);
        let items = |half: Vec<(&TreeItem, &Vec3)>| half.into_iter().map(|(item, _)| *item).collect::<Vec<_>>();
        (!low.is_empty() && !high.is_empty()).then(|| [items(low), items(high)])
    })
}

/// Mean of the points of an item.
fn centre(item: TreeItem, shapes: &[LocalShape]) -> Vec3 {
    let local = &shapes[item.shape as usize];
    if let Shape::Mesh(m) = &local.shape {
        let [a, b, c] = m.triangles()[item.triangle as usize].map(|i| m.vertices()[i as usize]);
        return local.in_geometry.transform_point((a + b + c) / 3.0);
    }
    local.bounds.center()
}

/// The box around items. `None` if there are none.
fn enclosing(items: &[TreeItem], shapes: &[LocalShape]) -> Option<LocalShape> {
    if let [only] = items
        && !matches!(shapes[only.shape as usize].shape, Shape::Mesh(_))
    {
        return cuboid(std::slice::from_ref(&shapes[only.shape as usize]));
    }
    let mut vertices: Vec<(u32, u32)> = Vec::new();
    let mut corners: Vec<Vec3> = Vec::new();
    for item in items {
        let local = &shapes[item.shape as usize];
        match &local.shape {
            Shape::Mesh(m) => vertices.extend(m.triangles()[item.triangle as usize].map(|i| (item.shape, i))),
            _ => corners.extend(points(std::slice::from_ref(local))),
        }
    }
    vertices.sort_unstable();
    vertices.dedup();
    for (shape, vertex) in vertices {
        let local = &shapes[shape as usize];
        if let Shape::Mesh(m) = &local.shape {
            corners.push(local.in_geometry.transform_point(m.vertices()[vertex as usize]));
        }
    }
    Enclosed::new(corners).cuboid()
}
