//! Distance between two placed shapes: a file per method, the choice per pair here.

mod box_box;
pub(crate) mod core;
mod flat;
pub(crate) mod gjk;
mod half_space;
mod mesh;
mod projections;
mod segment;
mod steady;

use std::cmp::Ordering;

use elbowroom_spatial::{Pose, Vec3};

use self::core::{Core, Gap, rounded, rounding};
use crate::mesh::distance_at;
use crate::{Capsule, Cuboid, Shape, Sphere};

pub(crate) use box_box::best_axis;
pub(crate) use mesh::{nearest_on_mesh, nearest_to_cylinder};

/// How far apart two shapes are, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Distance in metres. 0 on contact or overlap, and where f64 cannot tell them from a gap: where `lower_bound` is 0,
    /// and nowhere else. Exactly then [`collides`] says yes.
    pub distance: f64,
    /// Proven: the exact distance is not below this, metres. For closed forms it is `distance` less a few units in
    /// the last place of the largest coordinate involved.
    pub lower_bound: f64,
    /// Nearest point of the first shape, in the world. On contact: a point in both, or within rounding of both.
    pub on_a: Vec3,
    /// Nearest point of the second shape, in the world, `distance` from `on_a` to within 1e-15 of the largest coordinate
    /// involved. On contact: `on_a`.
    ///
    /// Where faces, edges or sides of two shapes (but spheres and half-spaces) are so nearly parallel that many pairs of points are within 2e-8 of
    /// the sizes (radii, together) of the least distance, the pair nearest to a point between the shapes' middles, near
    /// that of the smaller: it moves steadily where the nearest pair itself would jump. It is farther apart by no more than that.
    pub on_b: Vec3,
}

impl Separation {
    fn swapped(self) -> Self {
        Self { on_a: self.on_b, on_b: self.on_a, ..self }
    }

    fn unknown(a_in_world: &Pose, b_in_world: &Pose) -> Self {
        Self { distance: 0.0, lower_bound: 0.0, on_a: a_in_world.translation, on_b: b_in_world.translation }
    }
}

/// Distance between two shapes, with witness points.
///
/// A NaN or an infinity in a pose or a dimension gives distance 0: unknown is not free.
///
/// ```
/// use elbowroom_proximity::{Cuboid, Shape, Sphere, separation};
/// use elbowroom_spatial::{Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.5, 0.5, 0.1) });
/// let s = separation(&ball, &Pose::from_translation(Vec3::new(0.2, 0.0, 0.5)), &table, &Pose::IDENTITY);
/// assert!((s.distance - 0.3).abs() < 1e-15 && s.lower_bound <= s.distance);
/// assert!((s.on_b - Vec3::new(0.2, 0.0, 0.1)).length() < 1e-15);
/// ```
pub fn separation(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> Separation {
    // Without a limit nothing is too far; `unknown` is for shapes with no point at all, which cannot be made.
    separation_within(a, a_in_world, b, b_in_world, f64::INFINITY)
        .unwrap_or_else(|| Separation::unknown(a_in_world, b_in_world))
}

/// Like [`separation`], or `None` where the shapes are certainly farther apart than `limit` metres: much faster for
/// far pairs of boxes, cylinders, hulls and meshes.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere, separation_within};
/// use elbowroom_spatial::{Pose, Vec3};
/// let (ball, far) = (Shape::Sphere(Sphere { radius: 0.1 }), Pose::from_translation(Vec3::X * 3.0));
/// assert!(separation_within(&ball, &Pose::IDENTITY, &ball, &far, 1.0).is_none());
/// assert!(separation_within(&ball, &Pose::IDENTITY, &ball, &far, 2.9).is_some());
/// ```
pub fn separation_within(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose, limit: f64) -> Option<Separation> {
    nearest_within(a, a_in_world, b, b_in_world, limit, Points::Steady)
}

/// What the points of a [`Separation`] are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Points {
    /// To be told: steady where there is a choice.
    Steady,
    /// For nothing: only the distance counts.
    Any,
}

fn nearest_within(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    points: Points,
) -> Option<Separation> {
    if !(usable(a, a_in_world) && usable(b, b_in_world)) {
        return Some(Separation::unknown(a_in_world, b_in_world));
    }
    let found = if comes_first(a, a_in_world, b, b_in_world) {
        ordered(a, a_in_world, b, b_in_world, limit, points)?
    } else {
        ordered(b, b_in_world, a, a_in_world, limit, points)?.swapped()
    };
    // Numbers so large that their products overflow end here.
    let (p, q) = (found.on_a, found.on_b);
    if !(found.distance + (p.x + p.y + p.z) + (q.x + q.y + q.z)).is_finite() {
        return Some(Separation::unknown(a_in_world, b_in_world));
    }
    (!(found.lower_bound > limit)).then_some(found)
}

/// True where the shapes touch or overlap, or are too close for f64 to tell: exactly where [`separation`] says 0, in
/// either order of the shapes.
///
/// ```
/// use elbowroom_proximity::{Cuboid, HalfSpace, Shape, collides};
/// use elbowroom_spatial::{Pose, Vec3};
/// let (floor, gun) = (Shape::HalfSpace(HalfSpace), Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) }));
/// assert!(collides(&gun, &Pose::from_translation(Vec3::Z * 0.1), &floor, &Pose::IDENTITY));
/// assert!(!collides(&gun, &Pose::from_translation(Vec3::Z * 0.11), &floor, &Pose::IDENTITY));
/// ```
pub fn collides(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
    match (a, b) {
        (Shape::Mesh(m), Shape::Mesh(n)) => {
            crate::mesh::with_scratch(|s| crate::mesh::collide(m, a_in_world, n, b_in_world, s)).is_some()
        }
        _ => within(a, a_in_world, b, b_in_world, 0.0),
    }
}

/// True where the shapes are not proven to be farther apart than `tolerance` metres.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere, within};
/// use elbowroom_spatial::{Pose, Vec3};
/// let (ball, there) = (Shape::Sphere(Sphere { radius: 0.1 }), Pose::from_translation(Vec3::X));
/// assert!(within(&ball, &Pose::IDENTITY, &ball, &there, 0.81));
/// assert!(!within(&ball, &Pose::IDENTITY, &ball, &there, 0.79));
/// ```
pub fn within(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose, tolerance: f64) -> bool {
    match (a, b) {
        (Shape::Mesh(m), Shape::Mesh(n)) => {
            let query = |s: &mut _| crate::mesh::within(m, a_in_world, n, b_in_world, tolerance, s);
            crate::mesh::with_scratch(query).is_some()
        }
        _ => nearest_within(a, a_in_world, b, b_in_world, tolerance, Points::Any).is_some(),
    }
}

/// Simple before complex, so that each pair is written once.
#[inline]
fn rank(s: &Shape) -> u8 {
    match s {
        Shape::Sphere(_) => 0,
        Shape::Capsule(_) => 1,
        Shape::Cylinder(_) => 2,
        Shape::Cuboid(_) => 3,
        Shape::Hull(_) => 4,
        Shape::Mesh(_) => 5,
        Shape::HalfSpace(_) => 6,
    }
}

/// The order in which a pair is computed, whichever way round it was asked for: so both ways get the same answer.
#[inline]
fn comes_first(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
    let (of_a, of_b) = (rank(a), rank(b));
    // The pair of meshes has an order of its own.
    if of_a != of_b || matches!(a, Shape::Mesh(_)) {
        return of_a <= of_b;
    }
    let (p, q) = (a_in_world.translation, b_in_world.translation);
    if p.x == q.x { comes_first_by_rest(a, a_in_world, b, b_in_world) } else { p.x < q.x }
}

#[cold]
fn comes_first_by_rest(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
    let size = |s: &Shape| {
        let reach = |d| s.support(d).dot(d);
        [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].map(reach)
    };
    let by_pose = a_in_world.to_rows().partial_cmp(&b_in_world.to_rows());
    let order = by_pose.filter(|o| o.is_ne()).or_else(|| size(a).partial_cmp(&size(b)));
    !order.is_some_and(Ordering::is_gt)
}

/// Lengths from here on are as good as infinite: their squares would overflow.
const TOO_LARGE: f64 = 1e150;

/// True where no number of shape or pose is NaN, infinite or too large, and no dimension is negative.
#[inline]
pub(crate) fn usable(s: &Shape, pose: &Pose) -> bool {
    let (t, r) = (pose.translation.abs(), pose.rotation);
    let axes = r.x_axis() + r.y_axis() + r.z_axis();
    let dimensions = match s {
        Shape::Sphere(s) => s.radius >= 0.0 && s.radius < TOO_LARGE,
        Shape::Capsule(Capsule { half_length: h, radius: r }) => *h >= 0.0 && *r >= 0.0 && h + r < TOO_LARGE,
        Shape::Cylinder(c) => c.half_length >= 0.0 && c.radius >= 0.0 && c.half_length + c.radius < TOO_LARGE,
        Shape::Cuboid(c) => {
            let h = c.half_extents;
            h.x >= 0.0 && h.y >= 0.0 && h.z >= 0.0 && h.x + h.y + h.z < TOO_LARGE
        }
        Shape::HalfSpace(_) | Shape::Hull(_) | Shape::Mesh(_) => true,
    };
    // A NaN or an infinity in any term makes the sum one.
    dimensions && t.x + t.y + t.z < TOO_LARGE && (axes.x + axes.y + axes.z).is_finite()
}

#[inline]
fn ordered(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    points: Points,
) -> Option<Separation> {
    match a {
        Shape::Sphere(s) => point(*s, a_in_world, b, b_in_world, limit),
        _ => extended(a, a_in_world, b, b_in_world, limit, points),
    }
}

/// All but spheres, whose few steps would be slowed down by what these need of registers.
#[inline(never)]
fn extended(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    points: Points,
) -> Option<Separation> {
    match (a, b) {
        (Shape::Capsule(c), Shape::Capsule(_) | Shape::Cylinder(_) | Shape::Cuboid(_)) => {
            capsule(c, a_in_world, b, b_in_world, limit, points)
        }
        (Shape::HalfSpace(_), _) => {
            Some(world(half_space::both(&b_in_world.inverse_mul(a_in_world)), [0.0; 2], b_in_world))
        }
        (Shape::Capsule(_) | Shape::Cylinder(_) | Shape::Cuboid(_) | Shape::Hull(_), Shape::HalfSpace(_)) => {
            let (core, radius) = rounded(a)?;
            Some(world(half_space::distance(&core, &b_in_world.inverse_mul(a_in_world)), [radius, 0.0], b_in_world))
        }
        (Shape::Mesh(m), Shape::HalfSpace(_)) => {
            Some(world(mesh::mesh_half_space(m, &b_in_world.inverse_mul(a_in_world)), [0.0; 2], b_in_world))
        }
        (Shape::Mesh(m), Shape::Mesh(n)) => {
            let found = crate::mesh::with_scratch(|s| distance_at(m, a_in_world, n, b_in_world, limit, None, s))?;
            let (on_a, on_b) = (found.on_a, found.on_b);
            Some(Separation { distance: found.distance, lower_bound: found.lower_bound, on_a, on_b })
        }
        (_, Shape::Mesh(m)) => {
            let (core, radius) = rounded(a)?;
            let gap = mesh::mesh_core(m, &core, &b_in_world.inverse_mul(a_in_world), limit, radius, points)?;
            Some(world(gap, [0.0, radius], b_in_world).swapped())
        }
        _ => {
            let a_in_b = b_in_world.inverse_mul(a_in_world);
            let (gap, radii) = convex(a, b, &a_in_b, limit)?;
            let apart = gap.is_beyond(radii[0] + radii[1]);
            let gap = if points == Points::Steady && apart { steady_points(a, b, &a_in_b, gap) } else { gap };
            Some(world(gap, radii, b_in_world))
        }
    }
}

/// The steady ones of several nearest points.
fn steady_points(a: &Shape, b: &Shape, a_in_b: &Pose, gap: Gap) -> Gap {
    match (rounded(a), rounded(b)) {
        (Some((a, _)), Some((b, _))) => steady::steady(&a, &b, a_in_b, gap),
        _ => gap,
    }
}

/// A sphere is its centre with a radius, and the centre's distance has a closed form.
#[inline]
fn point(s: Sphere, a_in_world: &Pose, b: &Shape, b_in_world: &Pose, limit: f64) -> Option<Separation> {
    let p = b_in_world.inverse_transform_point(a_in_world.translation);
    let size = (a_in_world.translation.abs() + b_in_world.translation.abs()).max_element();
    let (q, radius) = match b {
        Shape::Sphere(o) => (Vec3::ZERO, o.radius),
        Shape::Capsule(c) => (c.axis_point(p), c.radius),
        Shape::Cylinder(c) => (c.nearest(p), 0.0),
        Shape::Cuboid(c) => (c.nearest(p), 0.0),
        Shape::HalfSpace(_) => (Vec3::new(p.x, p.y, p.z.min(0.0)), 0.0),
        Shape::Hull(h) => (h.nearest(p), 0.0),
        Shape::Mesh(m) => {
            let gap = mesh::mesh_core(m, &Core::Point, &Pose::from_translation(p), limit, s.radius, Points::Any)?;
            return Some(world(gap, [0.0, s.radius], b_in_world).swapped());
        }
    };
    closed(p, q, size + q.abs().max_element(), [s.radius, radius], limit, b_in_world)
}

fn capsule(
    c: &Capsule,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    points: Points,
) -> Option<Separation> {
    let axis = segment::Segment {
        middle: b_in_world.inverse_transform_point(a_in_world.translation),
        direction: b_in_world.inverse_transform_vector(a_in_world.rotation.z_axis()),
        half: c.half_length,
    };
    let size = (a_in_world.translation.abs() + b_in_world.translation.abs()).max_element() + c.half_length;
    // What a bounding box misses by must not be worth rounding.
    let outer = if let Shape::Capsule(o) = b { o.radius } else { 0.0 };
    let reach = limit + c.radius + 2.0 * rounding(2.0 * size + c.radius + outer);
    let (p, q, radius) = match b {
        Shape::Capsule(o) => {
            let solid = Cuboid { half_extents: Vec3::Z * o.half_length };
            if axis.misses(solid.half_extents, reach + outer) {
                return None;
            }
            let p = segment::nearest_to_box(&axis, &solid);
            (p, o.axis_point(p), o.radius)
        }
        Shape::Cuboid(o) => {
            if axis.misses(o.half_extents, reach) {
                return None;
            }
            let p = segment::nearest_to_box(&axis, o);
            (p, o.nearest(p), 0.0)
        }
        Shape::Cylinder(o) => {
            if axis.misses(Vec3::new(o.radius, o.radius, o.half_length), reach) {
                return None;
            }
            let p = segment::nearest_to_cylinder(&axis, o);
            (p, o.nearest(p), 0.0)
        }
        _ => (axis.middle, axis.middle, 0.0),
    };
    let scale = size + q.abs().max_element();
    if c.radius + radius <= projections::CLOSE * scale
        && (p - q).length_squared() <= (projections::CLOSE * scale).powi(2)
    {
        let points = Gap { lower: 0.0, ..Gap::closed(p, q, scale) };
        let proven = axis.box_gap(core_box(b)) - rounding(2.0 * size);
        return needle(c, b, a_in_world, b_in_world, points, proven);
    }
    if points == Points::Steady && steady::may_have_choice(axis.direction, b, q - p) {
        return steady_capsule(c, a_in_world, b, b_in_world, limit, Gap::closed(p, q, scale));
    }
    closed(p, q, scale, [c.radius, radius], limit, b_in_world)
}

/// A capsule with an axis across the way to the other shape.
#[cold]
fn steady_capsule(
    c: &Capsule,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    gap: Gap,
) -> Option<Separation> {
    let (core, radius) = rounded(b)?;
    if gap.lower > limit + c.radius + radius + 2.0 * rounding(c.radius + radius) {
        return None;
    }
    let apart = gap.is_beyond(c.radius + radius);
    let steady = || steady::steady(&Core::Segment(c.half_length), &core, &b_in_world.inverse_mul(a_in_world), gap);
    Some(world(if apart { steady() } else { gap }, [c.radius, radius], b_in_world))
}

/// Half the box around what is left of a shape without its rounding.
#[cold]
fn core_box(shape: &Shape) -> Vec3 {
    match shape {
        Shape::Capsule(c) => Vec3::Z * c.half_length,
        Shape::Cylinder(c) => Vec3::new(c.radius, c.radius, c.half_length),
        Shape::Cuboid(c) => c.half_extents,
        _ => Vec3::splat(f64::INFINITY),
    }
}

/// A capsule with hardly any radius, closer than the closed form tells: its root is lost in the rounding of the excess.
#[cold]
fn needle(
    c: &Capsule,
    b: &Shape,
    a_in_world: &Pose,
    b_in_world: &Pose,
    points: Gap,
    proven: f64,
) -> Option<Separation> {
    // Whatever the limit, so that it changes nothing; the points of the closed form are as good as any others.
    let (gap, radii) = convex(&Shape::Capsule(*c), b, &b_in_world.inverse_mul(a_in_world), f64::INFINITY)?;
    let better = gap.lower > 0.0 && points.distance < gap.distance;
    let gap = if better { points.at_least(gap.lower) } else { gap };
    Some(world(gap.at_least(proven), radii, b_in_world))
}

/// From exact witness points of the cores; `None`, without a root, where they are farther apart than the limit.
#[inline]
fn closed(p: Vec3, q: Vec3, scale: f64, radii: [f64; 2], limit: f64, b_in_world: &Pose) -> Option<Separation> {
    let reach = limit + radii[0] + radii[1] + 2.0 * rounding(scale + radii[0] + radii[1]);
    if (p - q).length_squared() > reach * reach && reach >= 0.0 {
        return None;
    }
    Some(world(Gap::closed(p, q, scale), radii, b_in_world))
}

/// Two convex shapes of which the second may be a half-space: gap of the cores in the frame of the second, and radii.
#[inline]
pub(crate) fn convex(a: &Shape, b: &Shape, a_in_b: &Pose, limit: f64) -> Option<(Gap, [f64; 2])> {
    let (core_a, ra) = rounded(a)?;
    if matches!(b, Shape::HalfSpace(_)) {
        return Some((half_space::distance(&core_a, a_in_b), [ra, 0.0]));
    }
    let (core_b, rb) = rounded(b)?;
    // Later than where the bound in `world` passes the limit, so that it alone decides.
    let limit = limit + ra + rb + 2.0 * rounding(ra + rb);
    let proven = bounds_gap(&core_a, &core_b, a_in_b);
    if proven > limit {
        return None;
    }
    let gap = projections::distance(&core_a, &core_b, a_in_b, limit)?.at_least(proven);
    Some((gap, [ra, rb]))
}

/// Along the axes of the second's frame: never above the exact distance. 0 where nothing is known.
#[allow(clippy::inline_always, reason = "of two boxes it is most of the time")]
#[inline(always)]
fn bounds_gap(a: &Core, b: &Core, a_in_b: &Pose) -> f64 {
    let half_b = match b {
        Core::Cuboid(c) => c.half_extents,
        Core::Cylinder(c) => Vec3::new(c.radius, c.radius, c.half_length),
        _ => return 0.0,
    };
    let z = a_in_b.rotation.z_axis().abs();
    let half_a = match a {
        Core::Cuboid(c) => a_in_b.rotation.abs_mul(c.half_extents),
        Core::Cylinder(c) => z * c.half_length + Vec3::splat(c.radius),
        _ => return 0.0,
    };
    let t = a_in_b.translation.abs();
    let excess = (t - half_a - half_b).max_element();
    excess - rounding(t.x + t.y + t.z + half_a.max_element() + half_b.max_element())
}

/// One point for both: the middle of what both radii cover of the way from core to core.
fn contact(gap: &Gap, radii: [f64; 2], frame_in_world: &Pose) -> Separation {
    let along = (0.5 * (gap.distance + radii[0] - radii[1])).max(0.0).min(gap.distance);
    let share = if gap.distance > 0.0 { along / gap.distance } else { 0.0 };
    let shared = frame_in_world.transform_point(gap.on_a + (gap.on_b - gap.on_a) * share);
    Separation { distance: 0.0, lower_bound: 0.0, on_a: shared, on_b: shared }
}

/// From the cores' gap in some frame to the shapes' separation in the world.
#[inline]
fn world(gap: Gap, radii: [f64; 2], frame_in_world: &Pose) -> Separation {
    let radius = radii[0] + radii[1];
    let distance = (gap.distance - radius).max(0.0);
    let lower_bound = (gap.lower - radius - rounding(radius)).max(0.0).min(distance);
    let (mut p, mut q) = (gap.on_a, gap.on_b);
    if !(lower_bound > 0.0) {
        return contact(&gap, radii, frame_in_world);
    }
    if radius > 0.0 {
        let toward_b = (q - p) / gap.apart;
        p += toward_b * radii[0].min(gap.distance);
        q -= toward_b * radii[1].min(gap.distance);
    }
    Separation {
        distance,
        lower_bound,
        on_a: frame_in_world.transform_point(p),
        on_b: frame_in_world.transform_point(q),
    }
}
