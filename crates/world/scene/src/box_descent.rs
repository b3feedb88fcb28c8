//! Two links or objects compared by the boxes of their trees down to a depth.
//!
//! Both trees descend together. The distance of a pair of boxes counts as the largest of its own distance and the
//! distances of the boxes around it: each is a lower bound on the distance of the contents. So a deeper answer is never
//! worse than a shallower one.

use elbowroom_proximity::{DistanceSettings, Separation, Shape, Workspace};
use elbowroom_spatial::{Obb, Pose, Vec3};

use crate::local_shape::LocalShape;
use crate::nearer_separation::nearer;
use crate::obb_gap::obb_gap;
use crate::obb_tree::{ObbNode, ObbTree};

/// A tree of boxes and the pose of its link or object.
#[derive(Clone, Copy)]
pub(crate) struct PlacedTree<'t> {
    pub tree: &'t ObbTree,
    pub in_world: Pose,
}

/// The descent of one query.
pub(crate) struct BoxDescent<'w> {
    workspace: &'w mut Workspace,
    depth: usize,
}

/// The nearest pair of boxes so far.
struct Nearest {
    found: Option<Separation>,
    /// Distance (m) above which a pair no longer counts.
    limit: f64,
}

impl<'w> BoxDescent<'w> {
    pub fn new(workspace: &'w mut Workspace, depth: u8) -> Self {
        Self { workspace, depth: depth.into() }
    }

    /// True unless the boxes are proven farther apart than `limit` metres and no part is inside the other mesh.
    pub fn within(&mut self, a: &PlacedTree, b: &PlacedTree, limit: f64) -> bool {
        let mut overlap = false;
        for (x, y) in root_pairs(a, b) {
            overlap |= !(x.gap(&y) > 0.0);
            if self.nodes_within(&x, &y, limit) {
                return true;
            }
        }
        overlap && contained_point(a, b).is_some()
    }

    fn nodes_within(&mut self, x: &PlacedNode, y: &PlacedNode, limit: f64) -> bool {
        if x.gap(y) > limit {
            return false;
        }
        let (of_x, of_y) = (&x.node.shape.shape, &y.node.shape.shape);
        let within = if limit > 0.0 {
            self.workspace.within(of_x, &x.in_world, of_y, &y.in_world, limit)
        } else {
            self.workspace.collides(of_x, &x.in_world, of_y, &y.in_world)
        };
        let (below_x, below_y) = (x.below(self.depth), y.below(self.depth));
        if !within || below_x.is_none() && below_y.is_none() {
            return within;
        }
        let (below_x, below_y) = (below_x.unwrap_or([Some(*x), None]), below_y.unwrap_or([Some(*y), None]));
        below_x.iter().flatten().any(|x| below_y.iter().flatten().any(|y| self.nodes_within(x, y, limit)))
    }

    /// Separation of the nearest boxes; `None` if it is proven to be above `limit` metres.
    ///
    /// Distance 0 if a part of one is inside a mesh of the other.
    pub fn separation(&mut self, a: &PlacedTree, b: &PlacedTree, limit: f64) -> Option<Separation> {
        let mut nearest = Nearest { found: None, limit };
        let mut overlap = false;
        for (x, y) in root_pairs(a, b) {
            overlap |= !(x.gap(&y) > 0.0);
            self.descend(&x, &y, None, &mut nearest);
        }
        if overlap
            && nearest.found.is_none_or(|s| s.distance > 0.0)
            && let Some(p) = contained_point(a, b)
        {
            return Some(Separation { distance: 0.0, lower_bound: 0.0, on_a: p, on_b: p });
        }
        nearest.found
    }

    /// Measures a pair of boxes and the pairs below it. `above` is the separation of the boxes around it.
    fn descend(&mut self, x: &PlacedNode, y: &PlacedNode, above: Option<Separation>, nearest: &mut Nearest) {
        if x.gap(y) > nearest.limit {
            return;
        }
        let settings = DistanceSettings { limit: nearest.limit, ..DistanceSettings::default() };
        let (of_x, of_y) = (&x.node.shape.shape, &y.node.shape.shape);
        let Some(own) = self.workspace.separation(of_x, &x.in_world, of_y, &y.in_world, settings) else { return };
        let proven = above.map_or(own, |above| farther(above, own));
        if proven.distance > nearest.limit {
            return;
        }
        let (below_x, below_y) = (x.below(self.depth), y.below(self.depth));
        if below_x.is_none() && below_y.is_none() {
            nearest.found = Some(nearer(nearest.found, proven));
            nearest.limit = nearest.limit.min(proven.distance);
            return;
        }
        let (below_x, below_y) = (below_x.unwrap_or([Some(*x), None]), below_y.unwrap_or([Some(*y), None]));
        let mut pairs: [Option<(f64, PlacedNode, PlacedNode)>; 4] = [None; 4];
        let each = below_x.iter().flatten().flat_map(|x| below_y.iter().flatten().map(|y| (x.gap(y), *x, *y)));
        pairs.iter_mut().zip(each).for_each(|(place, pair)| *place = Some(pair));
        // Near pairs first: their distance is the limit of the others.
        pairs.sort_unstable_by(|p, q| order(p.as_ref()).total_cmp(&order(q.as_ref())));
        for (_, x, y) in pairs.iter().flatten() {
            self.descend(x, y, Some(proven), nearest);
        }
    }
}

fn order(pair: Option<&(f64, PlacedNode, PlacedNode)>) -> f64 {
    pair.map_or(f64::INFINITY, |(gap, ..)| *gap)
}

/// The larger of two lower bounds on one distance, which proves more.
fn farther(above: Separation, own: Separation) -> Separation {
    let lower_bound = above.lower_bound.max(own.lower_bound);
    // A NaN must not hide that the boxes may touch.
    let larger = if own.distance <= above.distance { above } else { own };
    Separation { lower_bound, ..larger }
}

/// A box of a placed tree.
#[derive(Clone, Copy)]
struct PlacedNode<'t> {
    of: PlacedTree<'t>,
    node: &'t ObbNode,
    level: usize,
    /// Pose of the node's shape.
    in_world: Pose,
}

impl<'t> PlacedNode<'t> {
    fn new(of: PlacedTree<'t>, node: &'t ObbNode, level: usize) -> Self {
        Self { of, node, level, in_world: of.in_world * node.shape.in_geometry }
    }

    /// Lower bound (m) on the distance; -∞ or NaN if nothing is known.
    fn gap(&self, other: &Self) -> f64 {
        let obb = |n: &Self| n.node.obb.map(|o| Obb { pose: n.in_world, ..o });
        obb(self).zip(obb(other)).map_or(f64::NEG_INFINITY, |(a, b)| obb_gap(&a, &b))
    }

    /// The two boxes below; `None` at the depth and at leaves.
    fn below(&self, depth: usize) -> Option<[Option<Self>; 2]> {
        let first = self.node.first_child.filter(|_| self.level < depth)? as usize;
        let nodes = self.of.tree.level(self.level + 1);
        Some([first, first + 1].map(|i| Some(Self::new(self.of, &nodes[i], self.level + 1))))
    }
}

fn root_pairs<'t>(
    a: &PlacedTree<'t>,
    b: &PlacedTree<'t>,
) -> impl Iterator<Item = (PlacedNode<'t>, PlacedNode<'t>)> + use<'t> {
    let (a, b) = (*a, *b);
    let roots = |of: PlacedTree<'t>| of.tree.level(0).iter().map(move |node| PlacedNode::new(of, node, 0));
    roots(a).flat_map(move |x| roots(b).map(move |y| (x, y)))
}

/// A point (world) of one that is inside a mesh of the other; the surfaces are known not to touch.
///
/// Smaller boxes enclose the surface of a mesh only. A connected surface that touches nothing is inside as a whole or
/// not at all, so one point of it decides.
fn contained_point(a: &PlacedTree, b: &PlacedTree) -> Option<Vec3> {
    point_inside(a, b).or_else(|| point_inside(b, a))
}

/// A point of `inner` inside a mesh of `outer`.
fn point_inside(outer: &PlacedTree, inner: &PlacedTree) -> Option<Vec3> {
    let inner_in_outer = outer.in_world.inverse_mul(&inner.in_world);
    outer.tree.shapes().iter().find_map(|o| {
        let Shape::Mesh(mesh) = &o.shape else { return None };
        let inside =
            |p: &Vec3| mesh.contains(o.in_geometry.inverse_transform_point(inner_in_outer.transform_point(*p)));
        let found = inner.tree.shapes().iter().find_map(|i| points_of_parts(i).find(inside))?;
        Some(inner.in_world.transform_point(found))
    })
}

/// A point of every connected part of a shape, in the frame of its link or object; none for a half-space.
fn points_of_parts(local: &LocalShape) -> impl Iterator<Item = Vec3> {
    let points: &[Vec3] = match &local.shape {
        Shape::Mesh(m) => m.component_vertices(),
        Shape::Hull(h) => &h.vertices()[..1],
        Shape::HalfSpace(_) => &[],
        Shape::Sphere(_) | Shape::Capsule(_) | Shape::Cylinder(_) | Shape::Cuboid(_) => &[Vec3::ZERO],
    };
    points.iter().map(|p| local.in_geometry.transform_point(*p))
}
