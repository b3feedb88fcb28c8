//! The narrow phase: tests two links or objects against each other.

use elbowroom_proximity::advanced::{bvh_lower_bound, bvh_lower_bound_to_shape};
use elbowroom_proximity::contact::{ContactPoint, ContactSettings, contact_point};
use elbowroom_proximity::{DistanceSettings, Separation, Shape, WarmStart, Workspace, separation_within};
use elbowroom_spatial::{Obb, Pose, Vec3};

use crate::box_descent::{BoxDescent, PlacedTree};
use crate::geometry_model::GeometryModel;
use crate::local_shape::LocalShape;
use crate::nearer_separation::nearer;
use crate::obb_gap::obb_gap;
use crate::world_box::{WorldBox, round_up};
use crate::{CheckerStats, Level, Scene, SceneState};

/// Workspace and statistics of the narrow phase.
#[derive(Debug, Clone)]
pub(crate) struct NarrowPhase {
    /// Boxed: its 36 KB would be moved with every checker, and test threads have small stacks.
    workspace: Box<Workspace>,
    /// World boxes of the shapes of the second geometry.
    bounds: Vec<WorldBox>,
    pub stats: CheckerStats,
}

/// The models of a link or object and its pose.
#[derive(Clone, Copy)]
pub(crate) struct PlacedModel<'s> {
    pub model: &'s GeometryModel,
    pub in_world: Pose,
}

impl<'s> PlacedModel<'s> {
    pub fn new(scene: &'s Scene, state: &SceneState, model: usize) -> Self {
        Self { model: &scene.models[model], in_world: state.in_world[model] }
    }

    /// The oriented box in the world; `None` if the geometry is unbounded.
    pub fn obb(&self) -> Option<Obb> {
        self.model.obb.map(|o| Obb { pose: self.in_world * o.pose, ..o })
    }

    fn tree(&self) -> PlacedTree<'s> {
        PlacedTree { tree: self.model.tree(), in_world: self.in_world }
    }
}

/// Warm start of a pair of links or objects: the nearest pair of shapes of the last query, and where they were nearest.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PairWarmStart {
    shapes: (u32, u32),
    mesh: WarmStart,
}

impl NarrowPhase {
    pub fn new(scene: &Scene) -> Self {
        let most = scene.models.iter().map(|m| m.exact.len()).max().unwrap_or(0);
        Self { workspace: Box::default(), bounds: Vec::with_capacity(most), stats: CheckerStats::default() }
    }

    /// The coarse level that proves the pair farther apart than `limit` metres; `None` if no coarse level does.
    pub fn separated_coarsely(&mut self, a: &PlacedModel, b: &PlacedModel, limit: f64) -> Option<Level> {
        if !(a.model.complex || b.model.complex) {
            return None;
        }
        if let (Some(x), Some(y)) = (a.obb(), b.obb()) {
            self.stats.pairs_tested.l2 += 1;
            if obb_gap(&x, &y) > limit {
                return Some(Level::L2);
            }
        }
        if a.model.slim || b.model.slim {
            self.stats.pairs_tested.capsule += 1;
            let ([x], [y]) = (enclosure(a.model), enclosure(b.model)) else { return None };
            let (x_in_world, y_in_world) = (a.in_world * x.in_geometry, b.in_world * y.in_geometry);
            if separation_within(&x.shape, &x_in_world, &y.shape, &y_in_world, limit).is_none() {
                return Some(Level::Capsule);
            }
        }
        None
    }

    /// Lower bound (m) on the distance by the oriented boxes; -∞ if they are no cheaper than the exact shapes.
    pub fn obb_distance(&mut self, a: &PlacedModel, b: &PlacedModel) -> f64 {
        match (a.obb(), b.obb()) {
            (Some(x), Some(y)) if a.model.complex || b.model.complex => {
                self.stats.pairs_tested.l2 += 1;
                obb_gap(&x, &y)
            }
            _ => f64::NEG_INFINITY,
        }
    }

    /// True unless the models of a level are proven farther apart than `limit` metres.
    pub fn within(&mut self, a: &PlacedModel, b: &PlacedModel, level: Level, limit: f64) -> bool {
        self.stats.pairs_tested.add(level, 1);
        if let Level::L2Depth(depth) = level {
            return BoxDescent::new(&mut self.workspace, depth.get()).within(&a.tree(), &b.tree(), limit);
        }
        let (of_a, of_b) = (a.model.at(level), b.model.at(level));
        if let ([x], [y]) = (of_a, of_b) {
            return self.shapes_within(x, &a.in_world, y, &b.in_world, limit);
        }
        let margin = round_up(limit);
        self.fill_bounds(of_b, &b.in_world);
        for x in of_a {
            let bounds = WorldBox::of_aabb(&x.bounds.transformed(&a.in_world));
            for (j, y) in of_b.iter().enumerate() {
                let separated = bounds.separated(&self.bounds[j], margin);
                if !separated && self.shapes_within(x, &a.in_world, y, &b.in_world, limit) {
                    return true;
                }
            }
        }
        false
    }

    fn shapes_within(
        &mut self,
        x: &LocalShape,
        a_in_world: &Pose,
        y: &LocalShape,
        b_in_world: &Pose,
        limit: f64,
    ) -> bool {
        let (x_in_world, y_in_world) = (*a_in_world * x.in_geometry, *b_in_world * y.in_geometry);
        let within = if limit > 0.0 {
            self.workspace.within(&x.shape, &x_in_world, &y.shape, &y_in_world, limit)
        } else {
            self.workspace.collides(&x.shape, &x_in_world, &y.shape, &y_in_world)
        };
        self.count_mesh_query(x, y);
        within
    }

    /// Adds the statistics of the last query, whose shapes are given.
    fn count_mesh_query(&mut self, x: &LocalShape, y: &LocalShape) {
        if matches!(x.shape, Shape::Mesh(_)) || matches!(y.shape, Shape::Mesh(_)) {
            self.stats.add_mesh_query(self.workspace.stats());
        }
    }

    /// Separation of the models of a level; `None` if it is proven to be above `limit` metres.
    pub fn separation(
        &mut self,
        a: &PlacedModel,
        b: &PlacedModel,
        level: Level,
        limit: f64,
        warm_start: &mut PairWarmStart,
    ) -> Option<Separation> {
        self.stats.pairs_tested.add(level, 1);
        if let Level::L2Depth(depth) = level {
            return BoxDescent::new(&mut self.workspace, depth.get()).separation(&a.tree(), &b.tree(), limit);
        }
        let (of_a, of_b) = (a.model.at(level), b.model.at(level));
        if let ([x], [y]) = (of_a, of_b) {
            let (x_in_world, y_in_world) = (a.in_world * x.in_geometry, b.in_world * y.in_geometry);
            let settings = distance_settings(limit, &mut warm_start.mesh);
            let found = self.shape_separation((x, &x_in_world), (y, &y_in_world), settings);
            let are_meshes = matches!((&x.shape, &y.shape), (Shape::Mesh(_), Shape::Mesh(_)));
            if are_meshes && found.is_some_and(|s| s.distance == 0.0) {
                // The point of overlapping meshes must not depend on earlier queries, nor on the limit that they left.
                return self.shape_separation((x, &x_in_world), (y, &y_in_world), DistanceSettings::default());
            }
            return found;
        }
        // The nearest pair of shapes of the last query gives a limit for the other pairs.
        let (first, mut best, mut limit) = ((warm_start.shapes.0 as usize, warm_start.shapes.1 as usize), None, limit);
        if let (Some(x), Some(y)) = (of_a.get(first.0), of_b.get(first.1)) {
            let (x_in_world, y_in_world) = (a.in_world * x.in_geometry, b.in_world * y.in_geometry);
            let settings = distance_settings(limit, &mut warm_start.mesh);
            best = self.shape_separation((x, &x_in_world), (y, &y_in_world), settings);
            limit = best.map_or(limit, |s: Separation| s.distance);
        }
        self.fill_bounds(of_b, &b.in_world);
        for (i, x) in of_a.iter().enumerate() {
            let bounds = WorldBox::of_aabb(&x.bounds.transformed(&a.in_world));
            for (j, y) in of_b.iter().enumerate() {
                if (i, j) == first || f64::from(bounds.gap(&self.bounds[j])) > limit {
                    continue;
                }
                let (x_in_world, y_in_world) = (a.in_world * x.in_geometry, b.in_world * y.in_geometry);
                let mut mesh = WarmStart::default();
                let settings = distance_settings(limit, &mut mesh);
                let found = self.shape_separation((x, &x_in_world), (y, &y_in_world), settings);
                let Some(s) = found else { continue };
                best = Some(nearer(best, s));
                if best == Some(s) {
                    *warm_start = PairWarmStart { shapes: (i as u32, j as u32), mesh };
                }
                limit = limit.min(s.distance);
            }
        }
        best
    }

    fn shape_separation(
        &mut self,
        (x, x_in_world): (&LocalShape, &Pose),
        (y, y_in_world): (&LocalShape, &Pose),
        settings: DistanceSettings,
    ) -> Option<Separation> {
        let found = self.workspace.separation(&x.shape, x_in_world, &y.shape, y_in_world, settings);
        self.count_mesh_query(x, y);
        found
    }

    /// Lower bound (m) on the distance from the meshes' box trees down to a depth, with points of the nearest boxes.
    ///
    /// Slightly more than `limit` if the bound is proven to be above it. `None` if the shapes have no box trees.
    pub fn box_tree_bound(
        &mut self,
        a: &PlacedModel,
        b: &PlacedModel,
        depth: u8,
        limit: f64,
    ) -> Option<(f64, [Vec3; 2])> {
        let ([x], [y]) = (&a.model.exact[..], &b.model.exact[..]) else { return None };
        let (x_in_world, y_in_world) = (a.in_world * x.in_geometry, b.in_world * y.in_geometry);
        let beyond = (limit + 1e-9 * (1.0 + limit), [x_in_world.translation, y_in_world.translation]);
        let coarse = match (&x.shape, &y.shape) {
            (Shape::Mesh(m), Shape::Mesh(n)) => {
                let coarse = bvh_lower_bound(m, &x_in_world, n, &y_in_world, depth, limit, &mut self.workspace);
                self.count_mesh_query(x, y);
                coarse
            }
            (Shape::Mesh(m), other) => Some(bvh_lower_bound_to_shape(m, &x_in_world, other, &y_in_world, depth)?),
            (other, Shape::Mesh(m)) => {
                let coarse = bvh_lower_bound_to_shape(m, &y_in_world, other, &x_in_world, depth)?;
                return Some((coarse.lower_bound, [coarse.on_b, coarse.on_a]));
            }
            _ => return None,
        };
        Some(coarse.map_or(beyond, |c| (c.lower_bound, [c.on_a, c.on_b])))
    }

    /// Contact point of the exact models, if they touch or are within the limit, with the indices of the two shapes.
    ///
    /// The result is the first pair of shapes that touches, else the first pair within the limit.
    pub fn contact_point(
        &mut self,
        a: &PlacedModel,
        b: &PlacedModel,
        settings: ContactSettings,
    ) -> Option<((usize, usize), ContactPoint)> {
        self.stats.pairs_tested.add(Level::L3, 1);
        let (of_a, of_b) = (&a.model.exact, &b.model.exact);
        let margin = round_up(settings.limit);
        let mut near = None;
        self.fill_bounds(of_b, &b.in_world);
        for (i, x) in of_a.iter().enumerate() {
            let bounds = WorldBox::of_aabb(&x.bounds.transformed(&a.in_world));
            for (j, y) in of_b.iter().enumerate() {
                if bounds.separated(&self.bounds[j], margin) {
                    continue;
                }
                let (x_in_world, y_in_world) = (a.in_world * x.in_geometry, b.in_world * y.in_geometry);
                let found = contact_point(&x.shape, &x_in_world, &y.shape, &y_in_world, settings, &mut self.workspace);
                self.count_mesh_query(x, y);
                match found {
                    Some(c) if c.touching => return Some(((i, j), c)),
                    Some(c) => near = near.or(Some(((i, j), c))),
                    None => {}
                }
            }
        }
        near
    }

    /// Upper bound (m) on the distance of the exact models; `None` if computing it is not cheap.
    pub fn upper_bound(&mut self, a: &PlacedModel, b: &PlacedModel, warm_start: &mut PairWarmStart) -> Option<f64> {
        let ([x], [y]) = (&a.model.exact[..], &b.model.exact[..]) else { return None };
        let (x_in_world, y_in_world) = (a.in_world * x.in_geometry, b.in_world * y.in_geometry);
        self.workspace.distance_upper_bound(&x.shape, &x_in_world, &y.shape, &y_in_world, &mut warm_start.mesh)
    }

    fn fill_bounds(&mut self, shapes: &[LocalShape], in_world: &Pose) {
        self.bounds.clear();
        self.bounds.extend(shapes.iter().map(|s| WorldBox::of_aabb(&s.bounds.transformed(in_world))));
    }
}

fn distance_settings(limit: f64, warm_start: &mut WarmStart) -> DistanceSettings<'_> {
    DistanceSettings { limit, warm_start: Some(warm_start), ..DistanceSettings::default() }
}

/// The tighter one of capsule and box, if the model has one.
fn enclosure(model: &GeometryModel) -> &[LocalShape] {
    let shapes = if model.slim { &model.capsule } else { &model.cuboid };
    if matches!(shapes[..], [LocalShape { shape: Shape::Capsule(_) | Shape::Cuboid(_), .. }]) { shapes } else { &[] }
}
