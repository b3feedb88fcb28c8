//! The models of one member, coarse to fine, made once.

use std::sync::OnceLock;

use elbowroom_proximity::{Capsule, Cuboid, Shape};
use elbowroom_spatial::{Aabb, Obb, Pose, Vec3};

use crate::enclose;
use crate::{Level, Member};

/// A shape in its member's frame.
#[derive(Debug, Clone)]
pub(crate) struct Solid {
    pub shape: Shape,
    pub in_member: Pose,
    /// Bounds in the member's frame, for members of many solids.
    pub bounds: Aabb,
}

impl Solid {
    pub fn new(shape: Shape, in_member: Pose) -> Self {
        let bounds = shape.aabb(&in_member);
        Self { shape, in_member, bounds }
    }
}

/// What is constant about a member with solids.
#[derive(Debug, Clone)]
pub(crate) struct Model {
    pub member: Member,
    pub exact: Vec<Solid>,
    /// Made when first asked for: of large meshes it takes longer than all the rest.
    hull: OnceLock<Vec<Solid>>,
    pub capsule: Vec<Solid>,
    pub cuboid: Vec<Solid>,
    /// `cuboid` again; `None` where the solid has no end.
    pub obb: Option<Obb>,
    /// True where a coarse model is much cheaper than the exact one.
    pub complex: bool,
    /// True where the capsule is the smaller of the two enclosures, so that it can clear what the box does not.
    pub slim: bool,
    pub padding_m: f64,
    /// Metres by which a hull may fail to hold its mesh.
    hull_slack: f64,
}

/// What [`ConvexHull::from_points`](elbowroom_proximity::ConvexHull::from_points) promises, with room, as a fraction of
/// the extent.
const HULL_TOLERANCE: f64 = 1e-12;

impl Model {
    pub fn new(member: Member, exact: Vec<Solid>, padding_m: f64) -> Self {
        let complex = exact.len() > 1 || exact.iter().any(|s| matches!(s.shape, Shape::Mesh(_) | Shape::Hull(_)));
        let endless = exact.iter().any(|s| matches!(s.shape, Shape::HalfSpace(_)));
        let boxed = if endless { None } else { cuboid(&exact) };
        let rounded = if endless { None } else { capsule(&exact) };
        let hull_slack = exact
            .iter()
            .filter(|s| matches!(s.shape, Shape::Mesh(_)))
            .map(|s| HULL_TOLERANCE * s.bounds.extent().length())
            .fold(0.0, f64::max);
        let volume = |s: &Option<Solid>| s.as_ref().map_or(f64::INFINITY, |s| s.shape.volume());
        Self {
            member,
            slim: volume(&rounded) < volume(&boxed),
            obb: boxed.as_ref().and_then(obb),
            hull: OnceLock::new(),
            capsule: rounded.map_or_else(|| exact.clone(), |s| vec![s]),
            cuboid: boxed.map_or_else(|| exact.clone(), |s| vec![s]),
            exact,
            complex,
            padding_m,
            hull_slack,
        }
    }

    /// Metres that a level's models may fail to enclose the solid by.
    pub fn slack(&self, level: Level) -> f64 {
        if level == Level::Hull { self.hull_slack } else { 0.0 }
    }

    /// The solids of a level; L1 is no model of a member.
    pub fn at(&self, level: Level) -> &[Solid] {
        match level {
            Level::L1 | Level::L2 => &self.cuboid,
            Level::Capsule => &self.capsule,
            Level::Hull => self.hull.get_or_init(|| self.exact.iter().map(hull).collect()),
            Level::L3 | Level::Auto => &self.exact,
        }
    }

    /// Distance (m) of the farthest point from the member's origin, at most; infinite or NaN where the solid has no end.
    pub fn radius(&self) -> f64 {
        let far = |b: &Aabb| b.min.abs().max(b.max.abs()).length();
        self.exact.iter().map(|s| far(&s.bounds)).fold(0.0, f64::max)
    }
}

fn obb(solid: &Solid) -> Option<Obb> {
    match solid.shape {
        Shape::Cuboid(c) => Some(Obb { pose: solid.in_member, half_extents: c.half_extents }),
        _ => None,
    }
}

fn cuboid(exact: &[Solid]) -> Option<Solid> {
    if let [only] = exact
        && let Some(half_extents) = half_extents(&only.shape)
    {
        return Some(Solid::new(Shape::Cuboid(Cuboid { half_extents }), only.in_member));
    }
    let (shape, in_member) = enclose::cuboid(&points(exact))?;
    Some(Solid::new(shape, in_member))
}

fn capsule(exact: &[Solid]) -> Option<Solid> {
    if let [only] = exact {
        let round = |half_length, radius| Shape::Capsule(Capsule { half_length, radius });
        let shape = match &only.shape {
            Shape::Sphere(s) => Some(round(0.0, s.radius)),
            Shape::Capsule(c) => Some(Shape::Capsule(*c)),
            _ => None,
        };
        if let Some(shape) = shape {
            return Some(Solid::new(shape, only.in_member));
        }
    }
    let (shape, in_member) = enclose::capsule(&points(exact))?;
    Some(Solid::new(shape, in_member))
}

/// The box around a primitive in its own frame.
fn half_extents(shape: &Shape) -> Option<Vec3> {
    match shape {
        Shape::Sphere(s) => Some(Vec3::splat(s.radius)),
        Shape::Capsule(c) => Some(Vec3::new(c.radius, c.radius, c.half_length + c.radius)),
        Shape::Cylinder(c) => Some(Vec3::new(c.radius, c.radius, c.half_length)),
        Shape::Cuboid(c) => Some(c.half_extents),
        Shape::HalfSpace(_) | Shape::Hull(_) | Shape::Mesh(_) => None,
    }
}

/// Points whose convex hull encloses the solids.
fn points(solids: &[Solid]) -> Vec<Vec3> {
    let mut points = Vec::new();
    for s in solids {
        let place = |p: Vec3| s.in_member.transform_point(p);
        match &s.shape {
            Shape::Mesh(m) => points.extend(m.vertices().iter().map(|&p| place(p))),
            Shape::Hull(h) => points.extend(h.vertices().iter().map(|&p| place(p))),
            Shape::Cylinder(c) => points.extend(prism(c.half_length, c.radius).into_iter().map(place)),
            other => points.extend(
                half_extents(other)
                    .into_iter()
                    .flat_map(|half_extents| Obb { pose: s.in_member, half_extents }.corners()),
            ),
        }
    }
    points
}

/// Corners of a 24-sided prism around a cylinder along z.
fn prism(half_length: f64, radius: f64) -> Vec<Vec3> {
    let step = std::f64::consts::TAU / 24.0;
    // Corners lie outside, so that the sides touch; a hair more for rounding.
    let out = radius / (0.5 * step).cos() * (1.0 + 1e-14);
    let corner = |i: u32| (f64::from(i) * step).sin_cos();
    (0..24).map(corner).flat_map(|(s, c)| [-1.0, 1.0].map(|z| Vec3::new(out * c, out * s, z * half_length))).collect()
}

/// The convex solid around one solid: itself, the hull of a mesh, or the box of a mesh so flat that it has no hull.
fn hull(solid: &Solid) -> Solid {
    let Shape::Mesh(mesh) = &solid.shape else { return solid.clone() };
    match mesh.hull() {
        Some(hull) => Solid::new(Shape::Hull(std::sync::Arc::new(hull.clone())), solid.in_member),
        None => cuboid(std::slice::from_ref(solid)).unwrap_or_else(|| solid.clone()),
    }
}
