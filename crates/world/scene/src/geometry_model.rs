//! The models of one link or object, from coarse to exact.

use std::cell::LazyCell;
use std::sync::OnceLock;

use elbowroom_proximity::{Capsule, Shape};
use elbowroom_robot::GeometryId;
use elbowroom_spatial::{Obb, Vec3};

use crate::Level;
use crate::bounding_volume::Enclosed;
use crate::enclosing_cuboid::{cuboid, of_primitive, points};
use crate::local_shape::LocalShape;
use crate::obb_tree::ObbTree;

/// The constant models of a link or object that has shapes.
#[derive(Debug, Clone)]
pub(crate) struct GeometryModel {
    pub id: GeometryId,
    pub exact: Vec<LocalShape>,
    /// Built at first use: for large meshes it takes longer than all other models.
    hull: OnceLock<Vec<LocalShape>>,
    pub capsule: Vec<LocalShape>,
    pub cuboid: Vec<LocalShape>,
    /// Smaller boxes below `cuboid`, built at first use: most queries need none.
    tree: OnceLock<ObbTree>,
    /// `cuboid` as an oriented box; `None` if the geometry is unbounded.
    pub obb: Option<Obb>,
    /// True if a coarse model is much cheaper to test than the exact one.
    pub complex: bool,
    /// True if the capsule has the smaller volume of the two enclosures: it can separate pairs that the box cannot.
    pub slim: bool,
    pub padding_m: f64,
    /// Length (m) by which a hull may fail to enclose its mesh.
    hull_slack_m: f64,
}

/// The error bound of [`ConvexHull::from_points`](elbowroom_proximity::ConvexHull::from_points) per extent, rounded up.
const HULL_TOLERANCE: f64 = 1e-12;

impl GeometryModel {
    pub fn new(id: GeometryId, exact: Vec<LocalShape>, padding_m: f64) -> Self {
        let complex = exact.len() > 1 || exact.iter().any(|s| matches!(s.shape, Shape::Mesh(_) | Shape::Hull(_)));
        let unbounded = exact.iter().any(|s| matches!(s.shape, Shape::HalfSpace(_)));
        let enclosed = LazyCell::new(|| Enclosed::new(points(&exact)));
        let boxed = if unbounded { None } else { of_primitive(&exact).or_else(|| enclosed.cuboid()) };
        let rounded = if unbounded { None } else { capsule_of_primitive(&exact).or_else(|| enclosed.capsule()) };
        let hull_slack_m = exact
            .iter()
            .filter(|s| matches!(s.shape, Shape::Mesh(_)))
            .map(|s| HULL_TOLERANCE * s.bounds.extent().length())
            .fold(0.0, f64::max);
        let volume = |s: &Option<LocalShape>| s.as_ref().map_or(f64::INFINITY, |s| s.shape.volume());
        Self {
            id,
            slim: volume(&rounded) < volume(&boxed),
            obb: boxed.as_ref().and_then(obb),
            hull: OnceLock::new(),
            tree: OnceLock::new(),
            capsule: rounded.map_or_else(|| exact.clone(), |s| vec![s]),
            cuboid: boxed.map_or_else(|| exact.clone(), |s| vec![s]),
            exact,
            complex,
            padding_m,
            hull_slack_m,
        }
    }

    /// True for a single mesh.
    pub fn is_mesh(&self) -> bool {
        matches!(self.exact[..], [LocalShape { shape: Shape::Mesh(_), .. }])
    }

    /// Length (m) by which the models of a level may fail to enclose the geometry.
    pub fn slack_m(&self, level: Level) -> f64 {
        if level == Level::Hull { self.hull_slack_m } else { 0.0 }
    }

    /// The shapes of a level. L1 has no model of a single link or object, and gets the shapes of L2; so do the depths of
    /// the box tree, whose boxes are in [`GeometryModel::tree`].
    pub fn at(&self, level: Level) -> &[LocalShape] {
        match level {
            Level::L1 | Level::L2 | Level::L2Depth(_) => &self.cuboid,
            Level::Capsule => &self.capsule,
            Level::Hull => self.hull.get_or_init(|| self.exact.iter().map(hull).collect()),
            Level::L3 | Level::Auto => &self.exact,
        }
    }

    /// The boxes of [`Level::L2`] and of the depths below it.
    pub fn tree(&self) -> &ObbTree {
        self.tree.get_or_init(|| ObbTree::new(self.exact.clone(), &self.cuboid))
    }

    /// Builds the models of a level, if they are built at first use.
    pub fn prepare(&self, level: Level) {
        self.at(level);
        if let Level::L2Depth(depth) = level {
            self.tree().build(depth.get());
        }
    }

    /// Upper bound (m) on the distance of any point from the origin; infinite or NaN if the geometry is unbounded.
    pub fn radius(&self) -> f64 {
        self.exact.iter().map(|s| s.bounds.max_distance(Vec3::ZERO)).fold(0.0, f64::max)
    }
}

fn obb(local: &LocalShape) -> Option<Obb> {
    match local.shape {
        Shape::Cuboid(c) => Some(Obb { pose: local.in_geometry, half_extents: c.half_extents }),
        _ => None,
    }
}

/// The capsule that a sphere or a capsule is; `None` for other shapes.
fn capsule_of_primitive(exact: &[LocalShape]) -> Option<LocalShape> {
    let [only] = exact else { return None };
    let capsule = match &only.shape {
        Shape::Sphere(s) => Capsule { half_length: 0.0, radius: s.radius },
        Shape::Capsule(c) => *c,
        _ => return None,
    };
    Some(LocalShape::new(Shape::Capsule(capsule), only.in_geometry))
}

/// The convex shape around one shape: the shape itself, the hull of a mesh, or the box of a mesh too flat to have a hull.
fn hull(local: &LocalShape) -> LocalShape {
    let Shape::Mesh(mesh) = &local.shape else { return local.clone() };
    match mesh.hull() {
        Some(hull) => LocalShape::new(Shape::Hull(std::sync::Arc::new(hull.clone())), local.in_geometry),
        None => cuboid(std::slice::from_ref(local)).unwrap_or_else(|| local.clone()),
    }
}
