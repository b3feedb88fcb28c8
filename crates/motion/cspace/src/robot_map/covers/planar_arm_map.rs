//! Robots whose three joints form an arm in a plane with round links: [`PlanarMapBuilder`] fills their maps.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, PoisonError};

use elbowroom_proximity::{Shape, project_point};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::super::driven_chain::{DrivenChain, DrivingJoint};
use super::super::rigid_groups::RigidGroup;
use super::obstacle::box_of;
use crate::{ConvexObstacle, Grid, GridAxis, Layer, ObstacleModel, PlanarArm, PlanarMapBuilder};

/// Largest cosine between axes that count as perpendicular, sine between axes that count as parallel, and distance from
/// the plane of points that count as in the plane, m.
const ANGLE_TOLERANCE: f64 = 1e-9;
const PLANE_TOLERANCE_M: f64 = 1e-6;
/// Number of measured points of a circle.
const CIRCLE_POINTS: u32 = 64;

/// Fills the map of an arm in a plane.
#[derive(Debug, Clone)]
pub(super) struct PlanarArmMap {
    builder: Arc<Mutex<PlanarMapBuilder>>,
    base_in_world: Pose,
    /// Number of cells of the third axis if it has the opposite sense.
    reversed: Option<u16>,
}

/// A solid of a link with all joints of the map at 0, in the frame of the plane: z along the first axis, y along the
/// two others.
#[derive(Debug, Clone)]
struct PlacedSolid {
    shape: Shape,
    pose: Pose,
}

impl PlanarArmMap {
    /// Creates the map; `None` if the joints or the links do not form such an arm, or if capsules would protrude from
    /// the links by more than `tolerance_m`.
    pub fn new(chain: &DrivenChain, groups: &[RigidGroup], grid: &Grid, tolerance_m: f64) -> Option<Self> {
        let moved: Vec<&RigidGroup> = groups.iter().filter(|group| !group.solids.is_empty()).collect();
        let joints = &moved.iter().max_by_key(|group| group.joints.len())?.joints;
        if joints.len() != 3 || !joints.iter().enumerate().all(|(i, j)| j.axis == i && j.turns && j.multiplier == 1.0) {
            return None;
        }
        let mut state = chain.state();
        chain.set_axes(&mut state, &[0.0; 3]);
        let frame = |joint: &DrivingJoint| chain.link_in_world(&state, joint.child);
        let along = [0, 1, 2].map(|i: usize| frame(&joints[i]).transform_vector(joints[i].along));
        let is_planar =
            along[0].dot(along[1]).abs() < ANGLE_TOLERANCE && along[1].cross(along[2]).length() < ANGLE_TOLERANCE;
        let rotation = Rotation::from_columns(along[1].cross(along[0]), along[1], along[0]).filter(|_| is_planar)?;
        let base = Pose::new(rotation, frame(&joints[0]).translation);
        let mut links: [Vec<PlacedSolid>; 2] = Default::default();
        for group in moved {
            if !group.joints.iter().zip(joints).all(|(a, b)| a.child == b.child) {
                return None;
            }
            let last = group.joints.last()?;
            let link = links.get_mut(group.joints.len().checked_sub(2)?)?;
            let in_base = base.inverse() * frame(last);
            link.extend(
                group.solids.iter().map(|(shape, at)| PlacedSolid { shape: shape.clone(), pose: in_base * *at }),
            );
        }
        let [shoulder, elbow] =
            [1, 2].map(|i: usize| in_plane(base.inverse_transform_point(frame(&joints[i]).translation)));
        let fit = ArmFit::new(shoulder, elbow, &links, tolerance_m)?;
        let is_reversed = along[1].dot(along[2]) < 0.0;
        let offsets = [0.0, fit.upper_angle, fit.fore_angle - fit.upper_angle];
        let planar_grid = planar_grid(grid, offsets, is_reversed)?;
        let mut builder = PlanarMapBuilder::new(fit.arm, &planar_grid).ok()?;
        // Done once in advance, because the first layer takes twice as long as later ones.
        let reach = Vec3::X * fit.arm.reach_m();
        let cuboid = ConvexObstacle::cuboid(Pose::from_translation(reach), Vec3::new(0.2, 0.2, 0.2)).ok()?;
        builder.build_layer(&cuboid, &mut Layer::new());
        let reversed = is_reversed.then(|| grid.shape()[2] as u16);
        Some(Self { builder: Arc::new(Mutex::new(builder)), base_in_world: base, reversed })
    }

    /// The cells that a model of a convex obstacle blocks; `None` for other obstacles.
    pub fn layer(&self, model: ObstacleModel, shape: &Shape, in_world: &Pose) -> Option<Layer> {
        let in_base = self.base_in_world.inverse() * *in_world;
        let obstacle = match shape {
            Shape::Sphere(s) => ConvexObstacle::sphere(in_base.translation, s.radius),
            Shape::Cuboid(c) => ConvexObstacle::cuboid(in_base, c.half_extents),
            Shape::Hull(hull) => ConvexObstacle::hull(in_base, Arc::clone(hull)),
            Shape::Mesh(mesh) => {
                let (half, frame) = box_of(mesh)?;
                ConvexObstacle::cuboid(in_base * frame, half)
            }
            Shape::Capsule(_) | Shape::Cylinder(_) | Shape::HalfSpace(_) => return None,
        };
        let mut layer = Layer::new();
        let mut builder = self.builder.lock().unwrap_or_else(PoisonError::into_inner);
        model.build_layer(&mut builder, &obstacle.ok()?, &mut layer);
        if let Some(count) = self.reversed {
            for span in &mut layer.spans {
                (span.first, span.last) = (count - 1 - span.last.min(count - 1), count - 1 - span.first);
            }
        }
        Some(layer)
    }
}

/// The grid in the angles of the planar arm: planar value = value + offset; the third value has the opposite sign if
/// reversed.
fn planar_grid(grid: &Grid, offsets: [f64; 3], is_reversed: bool) -> Option<Grid> {
    let axis = |i: usize| {
        let axis = &grid.axes()[i];
        let end = axis.border(axis.count());
        if i == 2 && is_reversed {
            // The last cell becomes the first, so it must be a whole cell.
            let is_whole = (end - axis.max()).abs() <= 1e-9 * axis.step();
            return GridAxis::new(axis.joint(), offsets[i] - end, offsets[i] - axis.min(), axis.step())
                .ok()
                .filter(|_| is_whole);
        }
        GridAxis::new(axis.joint(), axis.min() + offsets[i], end + offsets[i], axis.step()).ok()
    };
    let planar = Grid::new([axis(0)?, axis(1)?, axis(2)?]).ok()?;
    (planar.shape() == grid.shape()).then_some(planar)
}

/// An arm of capsules and a sphere that encloses round links.
struct ArmFit {
    arm: PlanarArm,
    /// Angle of the upper arm from the first axis, and of the forearm from the perpendicular to it, with all joints at
    /// 0.
    upper_angle: f64,
    fore_angle: f64,
}

impl ArmFit {
    fn new(shoulder: Vec3, elbow: Vec3, links: &[Vec<PlacedSolid>; 2], tolerance_m: f64) -> Option<Self> {
        if links.iter().flatten().any(|solid| !solid.is_round_in_plane()) {
            return None;
        }
        let ends = links[1].iter().flat_map(PlacedSolid::ends);
        let wrist = ends.max_by(|a, b| a.distance(elbow).total_cmp(&b.distance(elbow))).map(in_plane)?;
        let is_wrist = |solid: &&PlacedSolid| {
            matches!(solid.shape, Shape::Sphere(_)) && solid.pose.translation.distance(wrist) <= PLANE_TOLERANCE_M
        };
        let radius = |solids: &mut dyn Iterator<Item = &PlacedSolid>, a: Vec3, b: Vec3| {
            solids.map(|solid| solid.reach_from(a, b)).fold(0.0, f64::max) * (1.0 + 1e-9)
        };
        let (upper, fore) = (elbow - shoulder, wrist - elbow);
        let arm = PlanarArm {
            offset_m: shoulder.x,
            height_m: shoulder.z,
            upper_length_m: upper.length(),
            upper_radius_m: radius(&mut links[0].iter(), shoulder, elbow),
            fore_length_m: fore.length(),
            fore_radius_m: radius(&mut links[1].iter().filter(|s| !is_wrist(s)), elbow, wrist),
            wrist_radius_m: radius(&mut links[1].iter().filter(is_wrist), wrist, wrist),
        };
        arm.validate().ok()?;
        let all: Vec<&PlacedSolid> = links.iter().flatten().collect();
        let is_close = protrusion(&all, shoulder, elbow, arm.upper_radius_m) <= tolerance_m
            && protrusion(&all, elbow, wrist, arm.fore_radius_m) <= tolerance_m;
        let (upper_angle, fore_angle) = (upper.x.atan2(upper.z), (-fore.z).atan2(fore.x));
        is_close.then_some(Self { arm, upper_angle, fore_angle })
    }
}

impl PlacedSolid {
    /// Whether the solid is a sphere, or a capsule or cylinder with its axis in the plane.
    fn is_round_in_plane(&self) -> bool {
        let is_round = matches!(self.shape, Shape::Sphere(_) | Shape::Capsule(_) | Shape::Cylinder(_));
        is_round && self.ends().iter().all(|end| end.y.abs() <= PLANE_TOLERANCE_M)
    }

    /// Ends of the solid's axis.
    fn ends(&self) -> [Vec3; 2] {
        let half = match &self.shape {
            Shape::Capsule(c) => c.half_length,
            Shape::Cylinder(c) => c.half_length,
            _ => 0.0,
        };
        [half, -half].map(|z| self.pose.transform_point(Vec3::Z * z))
    }

    /// Largest distance of the solid's points from a segment, m.
    fn reach_from(&self, a: Vec3, b: Vec3) -> f64 {
        let from = |p: Vec3| distance_from_segment(p, a, b);
        match &self.shape {
            Shape::Cylinder(c) => {
                let step = TAU / f64::from(CIRCLE_POINTS);
                let rim = (0..CIRCLE_POINTS).flat_map(|i| {
                    let (sin, cos) = (f64::from(i) * step).sin_cos();
                    [1.0, -1.0].map(|side| Vec3::new(c.radius * cos, c.radius * sin, side * c.half_length))
                });
                // Between two points, the circle is at most this far from their chord.
                let between = c.radius * (1.0 - (0.5 * step).cos());
                rim.map(|p| from(self.pose.transform_point(p))).fold(0.0, f64::max) + between
            }
            Shape::Capsule(c) => self.ends().map(from).into_iter().fold(0.0, f64::max) + c.radius,
            Shape::Sphere(s) => from(self.pose.translation) + s.radius,
            _ => f64::INFINITY,
        }
    }
}

/// Largest distance of points of a capsule's surface from the nearest of some solids, m.
fn protrusion(solids: &[&PlacedSolid], a: Vec3, b: Vec3, radius: f64) -> f64 {
    let along = (b - a).try_normalize().unwrap_or(Vec3::Z);
    let (u, v) = (Vec3::Y, along.cross(Vec3::Y));
    let mut worst: f64 = 0.0;
    for i in 0..=24 {
        // Caps at both ends, and the cylinder in between.
        let (centre, lean) = match i {
            0..4 => (a, -1.5 + 0.375 * f64::from(i)),
            21.. => (b, 0.375 * f64::from(i - 20)),
            _ => (a + (b - a) * (f64::from(i - 4) / 16.0), 0.0),
        };
        for k in 0..16 {
            let (sin, cos) = (TAU * f64::from(k) / 16.0).sin_cos();
            let p = centre + (along * lean.sin() + (u * cos + v * sin) * lean.cos()) * radius;
            let gap = |solid: &&PlacedSolid| project_point(&solid.shape, &solid.pose, p).signed_distance;
            worst = worst.max(solids.iter().map(gap).fold(f64::INFINITY, f64::min));
        }
    }
    worst
}

fn distance_from_segment(p: Vec3, a: Vec3, b: Vec3) -> f64 {
    let along = b - a;
    let share = if along.length_squared() > 0.0 { (p - a).dot(along) / along.length_squared() } else { 0.0 };
    p.distance(a + along * share.clamp(0.0, 1.0))
}

/// The nearest point of the plane.
fn in_plane(p: Vec3) -> Vec3 {
    Vec3::new(p.x, 0.0, p.z)
}
