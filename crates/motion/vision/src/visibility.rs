//! How much of an object's surface a camera sees, and how much of that other parts hide.

use elbowroom_proximity::{Shape, intersects_segment, tessellate::tessellate};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::Camera;

/// Number of points on the surface.
const POINTS: usize = 128;
/// Largest distance of a curved surface from the triangles on which the points are, as a share of its size.
const CHORD_ERROR: f64 = 1e-3;
/// Distance from the surface at which the line of sight of a point begins, as a share of the size.
const OFF_SURFACE: f64 = 1e-6;
/// Cosine of the angle between normal and line of sight up to which a point is edge-on, and not seen.
const EDGE_ON: f64 = 1e-9;
/// Fractional parts of the multiples of these numbers fill a square evenly: 1/p and 1/p² with p³ = p + 1 (Roberts, 2018).
const PLASTIC: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// What a camera sees of an object.
///
/// The surface is represented by 128 points, spread evenly over its area; the same shape always has the same points. A
/// point is in view if it is in the picture, faces the camera, and is not hidden by the object itself. The faces of an open
/// mesh have two sides. A share of the points in view is a share of the surface, not of the picture.
///
/// ```
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_spatial::{Pose, Vec3};
/// use elbowroom_vision::{Camera, Intrinsics, Visibility};
/// let camera = Camera::look_at(Intrinsics::pinhole(640, 480, 1.2), Vec3::Z * 2.0, Vec3::ZERO, Vec3::Y)?;
/// let cuboid = |x, y, z| Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) });
/// let mut plate = Visibility::new(camera, &cuboid(0.2, 0.2, 0.005));
/// // A board above the right half of the plate.
/// let (board, in_world) = (cuboid(0.5, 0.5, 0.01), Pose::from_translation(Vec3::new(0.5, 0.0, 0.1)));
/// let hidden = plate.hidden_share(&Pose::IDENTITY, [(&board, in_world)]).unwrap();
/// assert!((hidden - 0.5).abs() < 0.05, "{hidden}");
/// // Out of the picture.
/// assert_eq!(plate.hidden_share(&Pose::from_translation(Vec3::X * 9.0), [(&board, in_world)]), None);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Visibility {
    camera: Camera,
    shape: Shape,
    points: Vec<SurfacePoint>,
    /// Largest extent of the object, m.
    size_m: f64,
    /// Points in view that nothing hides yet, in the world.
    in_view: Vec<Vec3>,
}

/// A point of the surface, in the frame of the object.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SurfacePoint {
    at: Vec3,
    /// Outward unit normal.
    outward: Vec3,
}

impl Visibility {
    /// An object before a camera. An object whose surface has no area is never in view.
    pub fn new(camera: Camera, shape: &Shape) -> Self {
        let size_m = shape.aabb(&Pose::IDENTITY).extent().max_element();
        let points = surface_points(shape, CHORD_ERROR * size_m);
        let in_view = Vec::with_capacity(points.len());
        Self { camera, shape: shape.clone(), points, size_m, in_view }
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Whether the camera sees some of the object at this pose if nothing is in the way.
    pub fn is_in_view(&mut self, object_in_world: &Pose) -> bool {
        self.find_in_view(object_in_world);
        !self.in_view.is_empty()
    }

    /// The share of the points in view that these parts hide from the camera, 0 to 1; `None` if none is in view.
    ///
    /// A part is a solid and its pose in the world. Allocates nothing.
    pub fn hidden_share<'a>(
        &mut self,
        object_in_world: &Pose,
        parts: impl IntoIterator<Item = (&'a Shape, Pose)>,
    ) -> Option<f64> {
        self.find_in_view(object_in_world);
        let all = self.in_view.len();
        let near = self.surroundings();
        for part in parts {
            self.hide(part, &near);
        }
        (all > 0).then(|| (all - self.in_view.len()) as f64 / all as f64)
    }

    /// Whether these parts hide more than a share of the points in view; like [`hidden_share`](Self::hidden_share), but
    /// stops as soon as that is known. False if none is in view.
    pub fn hides_more_than<'a>(
        &mut self,
        share: f64,
        object_in_world: &Pose,
        parts: impl IntoIterator<Item = (&'a Shape, Pose)>,
    ) -> bool {
        self.find_in_view(object_in_world);
        let all = self.in_view.len();
        let near = self.surroundings();
        parts.into_iter().any(|part| {
            self.hide(part, &near);
            // Of no points, NaN: not more.
            (all - self.in_view.len()) as f64 / all as f64 > share
        })
    }

    /// Finds the points in view.
    fn find_in_view(&mut self, object_in_world: &Pose) {
        self.in_view.clear();
        if !object_in_world.is_finite() {
            return;
        }
        let Self { camera, shape, points, size_m, in_view } = self;
        let eye = object_in_world.inverse_transform_point(camera.eye_in_world());
        let (is_two_sided, hides_itself) = match &*shape {
            Shape::Mesh(mesh) => (!mesh.has_interior(), true),
            _ => (false, false),
        };
        for point in points.iter() {
            let to_eye = eye - point.at;
            let height = to_eye.dot(point.outward);
            let side = if is_two_sided { height.signum() } else { 1.0 };
            let is_facing = height * side > EDGE_ON * to_eye.length();
            let in_world = object_in_world.transform_point(point.at);
            if !is_facing || !camera.shows(in_world) {
                continue;
            }
            let off_surface = point.at + point.outward * (side * OFF_SURFACE * *size_m);
            if !(hides_itself && intersects_segment(shape, &Pose::IDENTITY, off_surface, eye)) {
                in_view.push(in_world);
            }
        }
    }

    /// The lines of sight are within this distance (m) from the straight line between these points: the camera, and the
    /// middle of the points in view.
    fn surroundings(&self) -> (Vec3, Vec3, f64) {
        let middle = Aabb::from_points(self.in_view.iter().copied()).center();
        let radius_m = self.in_view.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
        (self.camera.eye_in_world(), middle, radius_m)
    }

    /// Removes the points that a part hides.
    fn hide(&mut self, (shape, in_world): (&Shape, Pose), &(eye, middle, radius_m): &(Vec3, Vec3, f64)) {
        let bounds = shape.aabb(&in_world);
        let (center, reach_m) = (bounds.center(), 0.5 * bounds.extent().length());
        let along = middle - eye;
        let share = ((center - eye).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let apart_m = center.distance(eye + along * share);
        // A NaN is not apart.
        if apart_m > reach_m + radius_m + 1e-9 * (1.0 + along.length()) {
            return;
        }
        self.in_view.retain(|p| !intersects_segment(shape, &in_world, *p, eye));
    }
}

/// Points at equal parts of the area, along the list of triangles.
fn surface_points(shape: &Shape, chord_error_m: f64) -> Vec<SurfacePoint> {
    let (vertices, triangles) = tessellate(shape, chord_error_m);
    let turn = match shape {
        Shape::Mesh(mesh) if mesh.report().inside_out => -1.0,
        _ => 1.0,
    };
    let corners = |t: &[u32; 3]| t.map(|v| vertices[v as usize]);
    let double_area = |t: &[u32; 3]| {
        let [a, b, c] = corners(t);
        (b - a).cross(c - a).length()
    };
    let total: f64 = triangles.iter().map(double_area).sum();
    let mut points = Vec::with_capacity(POINTS);
    let mut before = 0.0;
    for t in &triangles {
        let [a, b, c] = corners(t);
        let (e1, e2) = (b - a, c - a);
        before += double_area(t);
        let Some(normal) = e1.cross(e2).try_normalize() else { continue };
        while points.len() < POINTS && (points.len() as f64 + 0.5) * total <= before * POINTS as f64 {
            let k = points.len() as f64 + 1.0;
            let [u, v] = PLASTIC.map(|p| (k * p).fract());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            points.push(SurfacePoint { at: a + e1 * u + e2 * v, outward: normal * turn });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use elbowroom_proximity::{Cuboid, Sphere, TriMesh, project_point};
    use elbowroom_spatial::Rotation;
    use elbowroom_testkit::random::SplitMix;

    use super::*;
    use crate::{Intrinsics, Point2};

    fn cuboid(x: f64, y: f64, z: f64) -> Shape {
        Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) })
    }

    /// A ball of triangles with bumps and dents.
    fn lump(random: &mut SplitMix, radius: f64, rough: f64) -> Shape {
        let (mut vertices, triangles) = tessellate(&Shape::Sphere(Sphere { radius }), 0.1 * radius);
        for v in &mut vertices {
            *v = *v * random.between(1.0 - rough, 1.0);
        }
        Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()))
    }

    fn vector(random: &mut SplitMix, most: f64) -> Vec3 {
        Vec3::from(random.within(most))
    }

    fn pose(random: &mut SplitMix, most: f64) -> Pose {
        Pose::new(Rotation::from_rotation_vector(vector(random, 3.0)), vector(random, most))
    }

    fn camera(random: &mut SplitMix, distortion: f64) -> Camera {
        let lens = Intrinsics { radial: [distortion, 0.0, 0.0], ..Intrinsics::pinhole(640, 480, 0.7) };
        let (eye, target) = (Vec3::new(0.3, 0.2, 1.0) + vector(random, 0.3), vector(random, 0.2));
        Camera::look_at(lens, eye, target, Vec3::Y).unwrap()
    }

    fn corners((vertices, triangles): &(Vec<Vec3>, Vec<[u32; 3]>), in_world: &Pose) -> Vec<[Vec3; 3]> {
        triangles.iter().map(|t| t.map(|v| in_world.transform_point(vertices[v as usize]))).collect()
    }

    /// Whether a line meets a triangle, by the signs of volumes; `Err` if rounding decides.
    fn meets(from: Vec3, to: Vec3, [a, b, c]: [Vec3; 3]) -> Result<bool, ()> {
        let volume = |p: Vec3, q: Vec3, r: Vec3, s: Vec3| (q - p).cross(r - p).dot(s - p);
        let sides = [volume(from, to, a, b), volume(from, to, b, c), volume(from, to, c, a)];
        let ends = [volume(a, b, c, from), volume(a, b, c, to)];
        let is_apart = ends[0] * ends[1] > 0.0 || sides.iter().any(|v| *v > 1e-12) && sides.iter().any(|v| *v < -1e-12);
        let is_sure = sides.iter().chain(&ends).all(|v| v.abs() > 1e-12);
        if is_apart || is_sure { Ok(!is_apart) } else { Err(()) }
    }

    /// The numbers of points in view and of hidden ones, from all triangles; `Err` if rounding decides.
    fn oracle(seen: &Visibility, at: &Pose, parts: &[(Shape, Pose)]) -> Result<(usize, usize), ()> {
        let (eye, size) = (seen.camera.eye_in_world(), seen.size_m);
        let own = corners(&tessellate(&seen.shape, 1.0), at);
        let others: Vec<[Vec3; 3]> = parts.iter().flat_map(|(s, at)| corners(&tessellate(s, 1.0), at)).collect();
        let (mut in_view, mut hidden) = (0, 0);
        for point in &seen.points {
            let (p, normal) = (at.transform_point(point.at), at.transform_vector(point.outward));
            let height = (eye - p).dot(normal);
            if height.abs() < 1e-6 {
                return Err(());
            }
            let pixel = seen.camera.world_to_pixel(p);
            let is_shown =
                pixel.is_some_and(|Point2 { x, y }| (0.0..=640.0).contains(&x) && (0.0..=480.0).contains(&y));
            if height < 0.0 || !is_shown {
                continue;
            }
            let off = p + normal * (1e-4 * size);
            let mut crossings = 0;
            for triangle in &own {
                crossings += usize::from(meets(off, eye, *triangle)?);
            }
            if crossings > 0 {
                continue;
            }
            in_view += 1;
            for triangle in &others {
                if meets(p, eye, *triangle)? {
                    hidden += 1;
                    break;
                }
            }
        }
        Ok((in_view, hidden))
    }

    #[test]
    fn random_views_are_those_of_all_triangles() {
        let mut random = SplitMix(81);
        let (mut compared, mut partly, mut out) = (0, 0, 0);
        for k in 0..600 {
            let object = if k % 2 == 0 { cuboid(0.05, 0.02, 0.15) } else { lump(&mut random, 0.15, 0.5) };
            let mut seen = Visibility::new(camera(&mut random, [0.0, -0.1][k % 2]), &object);
            let at = pose(&mut random, if k % 10 == 0 { 0.8 } else { 0.2 });
            let parts: Vec<(Shape, Pose)> = (0..k % 4)
                .map(|n| {
                    let shape = if n % 2 == 0 { lump(&mut random, 0.12, 0.2) } else { cuboid(0.2, 0.03, 0.03) };
                    (shape, pose(&mut random, 0.5))
                })
                .collect();
            let Ok((in_view, hidden)) = oracle(&seen, &at, &parts) else { continue };
            compared += 1;
            let of = || parts.iter().map(|(shape, pose)| (shape, *pose));
            let share = seen.hidden_share(&at, of());
            assert_eq!(share, (in_view > 0).then(|| hidden as f64 / in_view as f64), "{k}: {hidden} of {in_view}");
            assert_eq!(seen.is_in_view(&at), in_view > 0);
            for limit in [0.0, random.unit(), 1.0].into_iter().chain(share) {
                assert_eq!(seen.hides_more_than(limit, &at, of()), share.is_some_and(|share| share > limit), "{k}");
            }
            partly += usize::from(hidden > 0 && hidden < in_view);
            out += usize::from(in_view == 0);
        }
        assert!(
            compared > 500 && partly > 40 && out > 3,
            "{compared} compared, {partly} partly hidden, {out} out of view"
        );
    }

    #[test]
    fn points_are_on_the_surface_in_proportion_to_its_area() {
        let mut random = SplitMix(82);
        let lens = Intrinsics::pinhole(640, 480, 1.0);
        let camera = Camera::look_at(lens, Vec3::Z * 3.0, Vec3::ZERO, Vec3::Y).unwrap();
        let plate = Visibility::new(camera.clone(), &cuboid(0.2, 0.1, 0.05));
        let faces = [(Vec3::X, 0.1 * 0.05), (Vec3::Y, 0.2 * 0.05), (Vec3::Z, 0.2 * 0.1)];
        let area: f64 = faces.iter().map(|(_, area)| 2.0 * area).sum();
        for (axis, face) in faces {
            for side in [axis, -axis] {
                let count = plate.points.iter().filter(|p| p.outward.dot(side) > 0.9).count() as f64;
                let wanted = POINTS as f64 * face / area;
                assert!((count - wanted).abs() <= 1.5, "{count} points on the face {side:?}, {wanted} by its area");
            }
        }
        // Each half and each quarter of the largest face has its part.
        let top: Vec<Vec3> = plate.points.iter().filter(|p| p.outward.z > 0.9).map(|p| p.at).collect();
        for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let count = top.iter().filter(|p| p.x * a > 0.0 && p.y * b > 0.0).count();
            assert!((top.len() / 4).abs_diff(count) <= 3, "{count} of {} in a quarter", top.len());
        }
        for shape in [cuboid(0.2, 0.1, 0.05), Shape::Sphere(Sphere { radius: 0.1 }), lump(&mut random, 0.2, 0.4)] {
            let seen = Visibility::new(camera.clone(), &shape);
            assert_eq!(seen.points.len(), POINTS);
            assert_eq!(seen.points, Visibility::new(camera.clone(), &shape).points, "the same points every time");
            for p in &seen.points {
                let off = |by: f64| project_point(&shape, &Pose::IDENTITY, p.at + p.outward * by).signed_distance;
                assert!(off(0.0).abs() <= CHORD_ERROR * seen.size_m && off(1e-3) > off(0.0), "{p:?}");
            }
        }
    }

    #[test]
    fn degenerate_views_have_an_answer() {
        let lens = Intrinsics::pinhole(640, 480, 1.0);
        let above = Camera::look_at(lens, Vec3::Z, Vec3::ZERO, Vec3::Y).unwrap();
        let at = Pose::from_translation;
        let mut bar = Visibility::new(above.clone(), &cuboid(0.02, 0.02, 0.15));
        let lid = cuboid(0.5, 0.5, 0.01);
        // Around the camera, behind it, beside its picture, nowhere.
        for place in [Vec3::Z, Vec3::Z * 1.5, Vec3::X * 2.0, Vec3::splat(f64::NAN)] {
            assert_eq!(bar.hidden_share(&at(place), [(&lid, Pose::IDENTITY)]), None, "{place:?}");
            assert!(!bar.is_in_view(&at(place)) && !bar.hides_more_than(0.0, &at(place), [(&lid, at(Vec3::Z * 0.5))]));
        }
        // The camera in a part; a part behind it, below the bar, and at an unknown place.
        for (place, share) in [(1.0, 1.0), (1.2, 0.0), (-0.5, 0.0), (f64::NAN, 1.0)] {
            assert_eq!(bar.hidden_share(&Pose::IDENTITY, [(&lid, at(Vec3::Z * place))]), Some(share), "{place}");
        }
        // A sheet has two sides; edge-on it has none. A point has no surface.
        let square = vec![Vec3::ZERO, Vec3::X * 0.1, Vec3::new(0.1, 0.1, 0.0), Vec3::Y * 0.1];
        let sheet = Shape::Mesh(Arc::new(TriMesh::new(square, vec![[0, 1, 2], [0, 2, 3]]).unwrap()));
        let mut sheet = Visibility::new(above.clone(), &sheet);
        for (turn, share) in [(0.0, Some(0.0)), (3.0, Some(0.0)), (std::f64::consts::FRAC_PI_2, None)] {
            let turned = Pose::new(Rotation::from_rpy(0.0, turn, 0.0), Vec3::ZERO);
            assert_eq!(sheet.hidden_share(&turned, []), share, "turned by {turn}");
        }
        let mut dot = Visibility::new(above, &Shape::Sphere(Sphere { radius: 0.0 }));
        assert_eq!(dot.hidden_share(&Pose::IDENTITY, []), None);
    }
}
