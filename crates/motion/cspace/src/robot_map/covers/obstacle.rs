//! An obstacle prepared for maps on covers.

use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_validity::{Ball, SphereCover};

use super::super::error::RobotMapError;
use super::ball_tree::split;
use super::solid_core::SolidCore;
use crate::ConvexObstacle;

/// Smallest extent of a mesh that counts as a box, m.
const LEAST_EXTENT_M: f64 = 1e-9;

/// Number of children of an inner node of a tree of balls.
const FAN_OUT: usize = 4;

/// A solid of an obstacle, or a node of a tree of balls.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    /// Centre in the frame of the obstacle's core, m.
    pub centre: [f32; 3],
    pub core: SolidCore,
    /// Radius, m.
    pub radius: f32,
    /// Index of the element after all elements below this one.
    pub end: u32,
    pub is_leaf: bool,
}

/// An obstacle prepared for maps on covers, for any placement: shapes without flat sides and boxes (including meshes
/// that are boxes) unchanged, other meshes and hulls as the spheres of a cover.
#[derive(Debug, Clone)]
pub struct CoverObstacle {
    pub(super) elements: Vec<Element>,
    /// Frame of the elements, in the frame of the shape.
    pub(super) frame: Pose,
    /// Largest distance of a point from the origin of the elements' frame, m; 0 for a half space.
    pub(super) reach_m: f64,
    pub(super) shape: Shape,
}

impl CoverObstacle {
    /// Prepares an obstacle; spheres of a cover protrude by at most `slack_m`.
    ///
    /// # Errors
    /// The shape contains NaN or infinite numbers.
    pub fn new(shape: &Shape, slack_m: f64) -> Result<Self, RobotMapError> {
        if shape.validate().is_err() {
            return Err(RobotMapError::InvalidPlacement("an obstacle".into()));
        }
        let solid = |core, radius: f64| Self::solid(shape, core, radius, Pose::IDENTITY);
        match shape {
            Shape::Sphere(s) => Ok(solid(SolidCore::Point, s.radius)),
            Shape::Capsule(c) => Ok(solid(SolidCore::Box([0.0, 0.0, c.half_length as f32]), c.radius)),
            Shape::Cylinder(c) => {
                let (radius, half_length) = (c.radius as f32, c.half_length as f32);
                Ok(solid(SolidCore::Cylinder { radius, half_length }, 0.0))
            }
            Shape::Cuboid(c) => Ok(solid(box_core(c.half_extents), 0.0)),
            Shape::HalfSpace(_) => Ok(solid(SolidCore::HalfSpace, 0.0)),
            Shape::Mesh(mesh) => match box_of(mesh) {
                Some((half, pose)) => Ok(Self::solid(shape, box_core(half), 0.0, pose)),
                None => Self::covered(shape, slack_m),
            },
            Shape::Hull(_) => Self::covered(shape, slack_m),
        }
    }

    /// Rejects a pose that is not finite or too far away.
    pub(super) fn validate_place(&self, in_world: &Pose) -> Result<(), RobotMapError> {
        let farthest = in_world.translation.abs().max_element() + self.reach_m + self.frame.translation.length();
        if in_world.is_finite() && farthest <= ConvexObstacle::MAX_COORDINATE_M {
            return Ok(());
        }
        Err(RobotMapError::InvalidPlacement("an obstacle".into()))
    }

    fn solid(shape: &Shape, core: SolidCore, radius: f64, frame: Pose) -> Self {
        let reach_m = match shape {
            Shape::HalfSpace(_) => 0.0,
            _ => shape.aabb(&frame.inverse()).max_distance(Vec3::ZERO),
        };
        let element = Element { centre: [0.0; 3], core, radius: radius as f32, end: 1, is_leaf: true };
        Self { elements: vec![element], frame, reach_m, shape: shape.clone() }
    }

    fn covered(shape: &Shape, slack_m: f64) -> Result<Self, RobotMapError> {
        let invalid = || RobotMapError::InvalidPlacement("an obstacle".into());
        let cover = SphereCover::new(&[(shape, Pose::IDENTITY)], slack_m).ok_or_else(invalid)?;
        let reach = |b: &Ball| b.centre.length() + b.radius;
        let reach_m = cover.outer.iter().map(reach).fold(0.0, f64::max);
        let mut elements = Vec::new();
        push_balls(&mut elements, &mut cover.outer.clone());
        Ok(Self { elements, frame: Pose::IDENTITY, reach_m, shape: shape.clone() })
    }
}

/// Adds the tree of some balls, in depth-first order.
fn push_balls(elements: &mut Vec<Element>, balls: &mut [Ball]) {
    if balls.is_empty() {
        return;
    }
    let is_leaf = balls.len() == 1;
    let ball = if is_leaf { balls[0] } else { Ball::enclosing(balls) };
    let at = elements.len();
    let centre = [ball.centre.x as f32, ball.centre.y as f32, ball.centre.z as f32];
    elements.push(Element { centre, core: SolidCore::Point, radius: ball.radius as f32, end: 0, is_leaf });
    if !is_leaf {
        for part in split(balls, FAN_OUT) {
            push_balls(elements, part);
        }
    }
    elements[at].end = elements.len() as u32;
}

fn box_core(half: Vec3) -> SolidCore {
    SolidCore::Box([half.x as f32, half.y as f32, half.z as f32])
}

/// The box whose eight corners are the vertices of a mesh: its half extents and its frame.
pub(super) fn box_of(mesh: &TriMesh) -> Option<(Vec3, Pose)> {
    let corners = mesh.vertices();
    if corners.len() != 8 {
        return None;
    }
    let centre = corners.iter().fold(Vec3::ZERO, |sum, p| sum + *p) * 0.125;
    let size = corners[0].distance(centre);
    let tolerance = 1e-9 * size;
    let edges: Vec<Vec3> = corners[1..].iter().map(|p| *p - corners[0]).collect();
    for (i, &a) in edges.iter().enumerate() {
        for &b in &edges[i + 1..] {
            let c = (centre - corners[0]) * 2.0 - a - b;
            let half = Vec3::new(a.length(), b.length(), c.length()) * 0.5;
            if half.min_element() <= LEAST_EXTENT_M.max(tolerance) {
                continue;
            }
            let (x, y) = (a * (0.5 / half.x), b * (0.5 / half.y));
            let Some(rotation) = Rotation::from_columns(x, y, x.cross(y)) else { continue };
            let frame = Pose::new(rotation, centre);
            let is_corner = |p: &Vec3| (frame.inverse_transform_point(*p).abs() - half).length() <= tolerance;
            if corners.iter().all(is_corner) && are_distinct(corners, tolerance) {
                return Some((half + Vec3::new(tolerance, tolerance, tolerance), frame));
            }
        }
    }
    None
}

fn are_distinct(points: &[Vec3], tolerance: f64) -> bool {
    points.iter().enumerate().all(|(i, p)| points[..i].iter().all(|q| p.distance(*q) > 4.0 * tolerance))
}
