//! Targets on a surface, and the points around which a shield is opened.

use elbowroom_proximity::{Shape, project_point};
use elbowroom_spatial::{Pose, Vec3};

use super::error::ShieldError;
use super::opening::Foot;

/// What the tool is to reach, in the frame of the protected mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum ShieldTarget {
    /// A line on the surface, through these points.
    Line(Vec<Vec3>),
    /// The part of the surface within this closed line.
    Area(Vec<Vec3>),
    /// The part of the surface within this distance (m) of a point of it.
    FacesWithin {
        /// The point.
        at: Vec3,
        /// The distance, metres.
        radius_m: f64,
    },
    /// A hole from a point of the surface along an axis into the solid.
    Drill {
        /// The point.
        at: Vec3,
        /// The direction into the solid, of any length.
        axis: Vec3,
    },
}

/// The surface with its triangles as area vectors: where a target is put.
pub(super) struct TargetSurface<'a> {
    shape: &'a Shape,
    /// Middle and area vector (normal times twice the area) of each triangle.
    faces: Vec<(Vec3, Vec3)>,
    corners: Vec<[Vec3; 3]>,
    /// Distance from the surface that a given point may have, metres.
    tolerance_m: f64,
}

impl<'a> TargetSurface<'a> {
    /// `shape` is the mesh.
    pub fn new(shape: &'a Shape, corners: Vec<[Vec3; 3]>, tolerance_m: f64) -> Self {
        let face = |[a, b, c]: &[Vec3; 3]| ((*a + *b + *c) / 3.0, (*b - *a).cross(*c - *a));
        Self { shape, faces: corners.iter().map(face).collect(), corners, tolerance_m }
    }

    /// The feet of a target, no farther apart than `spacing_m`; their axes are normals averaged over `radius_m`.
    pub fn feet(&self, target: &ShieldTarget, spacing_m: f64, radius_m: f64) -> Result<Vec<Foot>, ShieldError> {
        match target {
            ShieldTarget::Line(points) => {
                let points = self.line(points, spacing_m, 2)?;
                Ok(points.into_iter().map(|p| self.foot(p, radius_m)).collect())
            }
            ShieldTarget::Area(border) => {
                let border = self.line(border, spacing_m, 3)?;
                let inside = self.points_inside(&border, spacing_m);
                Ok(inside.into_iter().chain(border).map(|p| self.foot(p, radius_m)).collect())
            }
            ShieldTarget::FacesWithin { at, radius_m: reach_m } => {
                let at = self.on_surface(*at, 1)?;
                let points = self.sampled(spacing_m, |p| p.distance(at) <= *reach_m);
                if points.is_empty() {
                    return Err(ShieldError::EmptyArea);
                }
                Ok(points.into_iter().map(|p| self.foot(p, radius_m)).collect())
            }
            ShieldTarget::Drill { at, axis } => {
                let point = self.on_surface(*at, 1)?;
                let axis = (-*axis).try_normalize().unwrap_or_else(|| self.foot(point, radius_m).axis);
                Ok(vec![Foot { point, axis }])
            }
        }
    }

    fn on_surface(&self, p: Vec3, number: usize) -> Result<Vec3, ShieldError> {
        let found = project_point(self.shape, &Pose::IDENTITY, p);
        let distance_m = found.signed_distance.abs();
        if distance_m <= self.tolerance_m {
            return Ok(found.on_surface);
        }
        Err(ShieldError::OffSurface { number, point: p, distance_m, tolerance_m: self.tolerance_m })
    }

    /// The given points and points between them, all on the surface.
    fn line(&self, points: &[Vec3], spacing_m: f64, needed: usize) -> Result<Vec<Vec3>, ShieldError> {
        if points.len() < needed {
            return Err(ShieldError::TooFewPoints { needed });
        }
        let given: Vec<Vec3> =
            points.iter().enumerate().map(|(i, &p)| self.on_surface(p, i + 1)).collect::<Result<_, _>>()?;
        let closed = needed > 2;
        let mut line = vec![given[0]];
        let last = if closed { given.len() } else { given.len() - 1 };
        for i in 0..last {
            let (from, to) = (given[i], given[(i + 1) % given.len()]);
            let parts = (from.distance(to) / spacing_m).ceil().max(1.0) as usize;
            for k in 1..=parts {
                let chord = from.lerp(to, k as f64 / parts as f64);
                let next = project_point(self.shape, &Pose::IDENTITY, chord).on_surface;
                let before = *line.last().unwrap_or(&from);
                // A smooth surface is as long as its chord up to a factor; a jump is a gap or another side.
                if next.distance(before) > 3.0 * spacing_m {
                    return Err(ShieldError::LeavesSurface { number: i + 1, place: before });
                }
                line.push(next);
            }
        }
        Ok(line)
    }

    /// Points of the surface inside a closed line, seen along its mean normal.
    fn points_inside(&self, border: &[Vec3], spacing_m: f64) -> Vec<Vec3> {
        let center = border.iter().fold(Vec3::ZERO, |sum, p| sum + *p) / border.len() as f64;
        let next = |i: usize| border[(i + 1) % border.len()] - center;
        let area = (0..border.len()).fold(Vec3::ZERO, |sum, i| sum + (border[i] - center).cross(next(i)));
        let Some(normal) = area.try_normalize() else { return Vec::new() };
        let u = normal.any_perpendicular();
        let v = normal.cross(u);
        let reach = border.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
        let flat: Vec<(f64, f64)> = border.iter().map(|p| (u.dot(*p - center), v.dot(*p - center))).collect();
        self.sampled(spacing_m, |p| {
            let offset = p - center;
            offset.length() <= 1.5 * reach && is_inside((u.dot(offset), v.dot(offset)), &flat)
        })
    }

    /// Points of the surface, no farther apart than `spacing_m`, that `keep` accepts.
    fn sampled(&self, spacing_m: f64, keep: impl Fn(Vec3) -> bool) -> Vec<Vec3> {
        let mut points = Vec::new();
        for [a, b, c] in &self.corners {
            let longest = a.distance(*b).max(b.distance(*c)).max(c.distance(*a));
            let parts = (longest / spacing_m).ceil().max(1.0) as usize;
            for i in 0..=parts {
                for j in 0..=parts - i {
                    let (s, t) = (i as f64 / parts as f64, j as f64 / parts as f64);
                    points.push(*a + (*b - *a) * s + (*c - *a) * t);
                }
            }
        }
        points.retain(|p| keep(*p));
        thinned(points, spacing_m)
    }

    /// The foot at a point: its axis is the mean normal of the faces around it that look to the same side.
    fn foot(&self, point: Vec3, radius_m: f64) -> Foot {
        let own = project_point(self.shape, &Pose::IDENTITY, point).outward;
        let around =
            self.faces.iter().filter(|(middle, area)| middle.distance(point) <= radius_m && area.dot(own) > 0.0);
        let mean = around.fold(Vec3::ZERO, |sum, (_, area)| sum + *area);
        Foot { point, axis: mean.try_normalize().unwrap_or(own) }
    }
}

/// One point of each cube of half the spacing.
fn thinned(points: Vec<Vec3>, spacing_m: f64) -> Vec<Vec3> {
    let mut taken = std::collections::HashSet::new();
    let cube = |p: &Vec3| p.to_array().map(|x| (x / (0.5 * spacing_m)).floor() as i64);
    points.into_iter().filter(|p| taken.insert(cube(p))).collect()
}

/// True if a point is inside a polygon (crossings of a ray).
fn is_inside((x, y): (f64, f64), polygon: &[(f64, f64)]) -> bool {
    let mut inside = false;
    for (i, &(x0, y0)) in polygon.iter().enumerate() {
        let (x1, y1) = polygon[(i + 1) % polygon.len()];
        if (y0 > y) != (y1 > y) && x < x0 + (x1 - x0) * (y - y0) / (y1 - y0) {
            inside = !inside;
        }
    }
    inside
}
