//! Targets on a surface, and the points around which a shield is opened.

use std::collections::{HashMap, HashSet};

use elbowroom_proximity::{Shape, TriMesh, project_point};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::error::ShieldError;
use super::opening::Foot;
use super::settings::ShieldSettings;

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

/// A surface on which a target is put.
pub(super) struct TargetSurface<'a> {
    /// The mesh, as a shape.
    shape: &'a Shape,
    mesh: &'a TriMesh,
    /// Distance from the surface that a given point may have, metres.
    tolerance_m: f64,
    /// Largest distance of two neighbouring feet, metres.
    spacing_m: f64,
    /// Radius of the faces whose normals make the axis of a foot, metres.
    radius_m: f64,
}

/// Most feet of a target.
const MOST_FEET: usize = 20_000;
/// Most points along an edge of a triangle.
const MOST_PARTS: f64 = 1000.0;
/// Points around a foot at which normals are taken.
const AROUND: usize = 8;
/// Least cosine between the axis of a drill and the normal of the surface: 75°.
const LEAST_DRILL_COSINE: f64 = 0.258_8;

impl<'a> TargetSurface<'a> {
    /// `shape` is the mesh.
    pub fn new(shape: &'a Shape, mesh: &'a TriMesh, settings: &ShieldSettings) -> Self {
        let (tolerance_m, spacing_m, radius_m) = (settings.tolerance_m, settings.spacing_m(), settings.width_m);
        Self { shape, mesh, tolerance_m, spacing_m, radius_m }
    }

    /// The feet of a target.
    pub fn feet(&self, target: &ShieldTarget) -> Result<Vec<Foot>, ShieldError> {
        let feet = |points: Vec<Vec3>| points.into_iter().map(|p| self.foot(p)).collect();
        match target {
            ShieldTarget::Line(points) => self.line(points, 2).map(feet),
            ShieldTarget::Area(border) => {
                let border = self.line(border, 3)?;
                let inside = self.points_inside(&border)?;
                Ok(feet(inside.into_iter().chain(border).collect()))
            }
            ShieldTarget::FacesWithin { at, radius_m } => {
                let at = self.on_surface(*at, 1)?;
                let outward = self.outward(at);
                self.sampled(&[at], (at, *radius_m), outward, |_| true).map(feet)
            }
            ShieldTarget::Drill { at, axis } => {
                let point = self.on_surface(*at, 1)?;
                let outward = self.outward(point);
                let axis = (-*axis).try_normalize().unwrap_or(outward);
                let cosine = axis.dot(outward);
                if cosine < LEAST_DRILL_COSINE {
                    return Err(ShieldError::DrillAxis { angle_rad: cosine.clamp(-1.0, 1.0).acos() });
                }
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

    fn outward(&self, on_surface: Vec3) -> Vec3 {
        project_point(self.shape, &Pose::IDENTITY, on_surface).outward
    }

    /// Cosine of the angle between the axis of a foot and the surface's normal.
    pub fn cosine(&self, foot: &Foot) -> f64 {
        self.outward(foot.point).dot(foot.axis).max(LEAST_DRILL_COSINE)
    }

    /// The given points and points between them, all on the surface and no farther apart than the spacing.
    pub fn line(&self, points: &[Vec3], needed: usize) -> Result<Vec<Vec3>, ShieldError> {
        if points.len() < needed {
            return Err(ShieldError::TooFewPoints { needed });
        }
        let given: Vec<Vec3> =
            points.iter().enumerate().map(|(i, &p)| self.on_surface(p, i + 1)).collect::<Result<_, _>>()?;
        let is_closed = needed > 2;
        let mut line = vec![given[0]];
        let last = if is_closed { given.len() } else { given.len() - 1 };
        for i in 0..last {
            let (from, to) = (given[i], given[(i + 1) % given.len()]);
            let parts = (from.distance(to) / self.spacing_m).ceil().max(1.0);
            if parts + line.len() as f64 > MOST_FEET as f64 {
                return Err(ShieldError::TooManyFeet);
            }
            for k in 1..=parts as usize {
                let chord = |k: usize| from.lerp(to, k as f64 / parts);
                let before = *line.last().unwrap_or(&from);
                self.join(&mut line, before, (chord(k - 1), chord(k)), i + 1)?;
            }
        }
        Ok(line)
    }

    /// Adds the projection of the end of a piece of the chord, and points before it until neighbours are near enough.
    fn join(
        &self,
        line: &mut Vec<Vec3>,
        before: Vec3,
        (from, to): (Vec3, Vec3),
        number: usize,
    ) -> Result<(), ShieldError> {
        let next = project_point(self.shape, &Pose::IDENTITY, to).on_surface;
        // The other side of a thin part is near too.
        let turns_over = self.outward(before).dot(self.outward(next)) < -0.2;
        let is_near = before.distance(next) <= self.spacing_m * (1.0 + 1e-9);
        if is_near && !turns_over {
            line.push(next);
            return Ok(());
        }
        if turns_over || from.distance(to) < 1e-3 * self.spacing_m || line.len() > MOST_FEET {
            return Err(ShieldError::LeavesSurface { number, place: before });
        }
        let middle = from.lerp(to, 0.5);
        self.join(line, before, (from, middle), number)?;
        let before = *line.last().unwrap_or(&before);
        self.join(line, before, (middle, to), number)
    }

    /// Points of the surface inside a closed line, seen along its mean normal, on the side of the line.
    fn points_inside(&self, border: &[Vec3]) -> Result<Vec<Vec3>, ShieldError> {
        let center = border.iter().fold(Vec3::ZERO, |sum, p| sum + *p) / border.len() as f64;
        let outward = border.iter().fold(Vec3::ZERO, |sum, p| sum + self.outward(*p));
        let next = |i: usize| border[(i + 1) % border.len()] - center;
        let area = (0..border.len()).fold(Vec3::ZERO, |sum, i| sum + (border[i] - center).cross(next(i)));
        let Some(normal) = area.try_normalize() else { return Err(ShieldError::EmptyArea) };
        let normal = if normal.dot(outward) < 0.0 { -normal } else { normal };
        let u = normal.any_perpendicular();
        let v = normal.cross(u);
        let reach = border.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
        let flat: Vec<(f64, f64)> = border.iter().map(|p| (u.dot(*p - center), v.dot(*p - center))).collect();
        self.sampled(border, (center, 1.5 * reach), normal, |p| {
            is_inside((u.dot(p - center), v.dot(p - center)), &flat)
        })
    }

    /// Points of the surface, no farther apart than the spacing, in a ball and where `keep` accepts them, on faces that
    /// look to the side of `outward` and are connected with a seed.
    fn sampled(
        &self,
        seeds: &[Vec3],
        (center, radius_m): (Vec3, f64),
        outward: Vec3,
        keep: impl Fn(Vec3) -> bool,
    ) -> Result<Vec<Vec3>, ShieldError> {
        let mut on_face: HashMap<usize, Vec<Vec3>> = HashMap::new();
        let mut count = 0;
        for (t, corners) in self.mesh.triangles().iter().enumerate() {
            let corners = corners.map(|v| self.mesh.vertices()[v as usize]);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let bounds = Aabb::from_points(corners);
            if normal.dot(outward) <= 0.0 || center.clamp(bounds.min, bounds.max).distance(center) > radius_m {
                continue;
            }
            let mut points = triangle_points(corners, self.spacing_m).ok_or(ShieldError::TooManyFeet)?;
            points.retain(|p| p.distance(center) <= radius_m && keep(*p));
            count += points.len();
            if count > 16 * MOST_FEET {
                return Err(ShieldError::TooManyFeet);
            }
            if !points.is_empty() {
                on_face.insert(t, points);
            }
        }
        let points = thinned(self.connected(on_face, seeds), self.spacing_m);
        match points.len() {
            0 => Err(ShieldError::EmptyArea),
            n if n > MOST_FEET => Err(ShieldError::TooManyFeet),
            _ => Ok(points),
        }
    }

    /// The points of the faces that are connected, through faces with points, with a face near a seed.
    fn connected(&self, mut on_face: HashMap<usize, Vec<Vec3>>, seeds: &[Vec3]) -> Vec<Vec3> {
        let welded = self.mesh.welded_vertices();
        let corners = |t: usize| self.mesh.triangles()[t].map(|v| welded[v as usize]);
        let mut around: HashMap<u32, Vec<usize>> = HashMap::new();
        let mut faces: Vec<usize> = on_face.keys().copied().collect();
        faces.sort_unstable();
        for &t in &faces {
            for v in corners(t) {
                around.entry(v).or_default().push(t);
            }
        }
        let near = |t: &usize| on_face[t].iter().any(|p| seeds.iter().any(|s| s.distance(*p) <= self.spacing_m));
        let mut waiting: Vec<usize> = faces.iter().copied().filter(near).collect();
        let mut points = Vec::new();
        while let Some(t) = waiting.pop() {
            let Some(of_face) = on_face.remove(&t) else { continue };
            points.extend(of_face);
            waiting.extend(corners(t).iter().flat_map(|v| &around[v]).copied());
        }
        points
    }

    /// The foot at a point: its axis is the mean of the normals around it that look to the same side.
    fn foot(&self, point: Vec3) -> Foot {
        let own = self.outward(point);
        let u = own.any_perpendicular();
        let v = own.cross(u);
        let mut sum = own;
        for (ring, k) in [0.5, 1.0].into_iter().flat_map(|ring| (0..AROUND).map(move |k| (ring, k))) {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / AROUND as f64).sin_cos();
            let reach = ring * self.radius_m;
            let beside = project_point(self.shape, &Pose::IDENTITY, point + (u * cos + v * sin) * reach);
            let outward = self.outward(beside.on_surface);
            if beside.on_surface.distance(point) <= 1.5 * reach && outward.dot(own) > 0.0 {
                sum += outward;
            }
        }
        Foot { point, axis: sum.try_normalize().unwrap_or(own) }
    }
}

/// Points of a triangle, no farther apart than the spacing; `None` if there are too many.
fn triangle_points([a, b, c]: [Vec3; 3], spacing_m: f64) -> Option<Vec<Vec3>> {
    let parts = |edge: f64| (edge / spacing_m).ceil().max(1.0);
    // Rows along the shortest edge, so that a needle has few points.
    let turned = [[a, b, c], [b, c, a], [c, a, b]];
    let base = |t: &[Vec3; 3]| t[1].distance(t[2]);
    let [a, b, c] = turned.into_iter().min_by(|s, t| base(s).total_cmp(&base(t))).unwrap_or([a, b, c]);
    let rows = parts(a.distance(b).max(a.distance(c)));
    let most = parts(b.distance(c));
    if rows > MOST_PARTS * 16.0 || most > MOST_PARTS || rows * most > 16.0 * MOST_FEET as f64 {
        return None;
    }
    let mut points = Vec::new();
    for i in 0..=rows as usize {
        let (left, right) = (a.lerp(b, i as f64 / rows), a.lerp(c, i as f64 / rows));
        let columns = parts(left.distance(right));
        points.extend((0..=columns as usize).map(|j| left.lerp(right, j as f64 / columns)));
    }
    Some(points)
}

/// One point of each cube of half the spacing.
fn thinned(points: Vec<Vec3>, spacing_m: f64) -> Vec<Vec3> {
    let mut taken = HashSet::new();
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
