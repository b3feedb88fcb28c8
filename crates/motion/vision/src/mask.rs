//! Self-filter of the camera: pixels that the arm covers are neither foreground nor background. The space behind them
//! is unknown, not free.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

use crate::camera::MIN_DEPTH_M;
use crate::{Calibration, Camera, Point2, VisionError, polygon, raster};

/// A convex solid of the arm in the world.
#[derive(Debug, Clone, PartialEq)]
pub enum ArmPart {
    /// All points within `radius_m` of the segment from `from` to `to` (world frame, metres).
    Capsule {
        /// One end of the axis.
        from: Vec3,
        /// The other end.
        to: Vec3,
        /// Radius, metres.
        radius_m: f64,
    },
    /// The convex hull of points (world frame, metres).
    Hull(Vec<Vec3>),
}

impl ArmPart {
    /// Converts a shape in the world to a capsule or to the hull of its corners; `None` for an unbounded shape (a
    /// half-space). A cylinder becomes the box around it, a mesh the hull of its vertices.
    ///
    /// ```
    /// use elbowroom_proximity::{Capsule, Shape};
    /// use elbowroom_spatial::{Pose, Vec3};
    /// use elbowroom_vision::ArmPart;
    /// let forearm = Shape::Capsule(Capsule { half_length: 0.2, radius: 0.06 });
    /// let forearm_in_world = Pose::from_translation(Vec3::new(0.5, 0.0, 1.0));
    /// let part = ArmPart::from_shape(&forearm, &forearm_in_world);
    /// assert!(matches!(part, Some(ArmPart::Capsule { radius_m: 0.06, .. })));
    /// ```
    pub fn from_shape(shape: &Shape, shape_in_world: &Pose) -> Option<Self> {
        let world = |p: Vec3| shape_in_world.transform_point(p);
        let hull = |points: &[Vec3]| Some(Self::Hull(points.iter().map(|&p| world(p)).collect()));
        match shape {
            Shape::Sphere(sphere) => {
                let centre = world(Vec3::ZERO);
                Some(Self::Capsule { from: centre, to: centre, radius_m: sphere.radius })
            }
            Shape::Capsule(capsule) => {
                let end = Vec3::Z * capsule.half_length;
                Some(Self::Capsule { from: world(-end), to: world(end), radius_m: capsule.radius })
            }
            Shape::Hull(convex) => hull(convex.vertices()),
            Shape::Mesh(mesh) => hull(mesh.vertices()),
            Shape::HalfSpace(_) => None,
            Shape::Cylinder(_) | Shape::Cuboid(_) => {
                let bounds = shape.aabb(&Pose::IDENTITY);
                hull(&corners(bounds.min, bounds.max))
            }
        }
    }
}

fn corners(min: Vec3, max: Vec3) -> [Vec3; 8] {
    std::array::from_fn(|i| {
        let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
        Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
    })
}

/// The masked pixels of one frame.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::{ArmPart, Calibration, Camera, Intrinsics, PixelMask};
/// let lens = Intrinsics::pinhole(64, 48, 1.2);
/// let camera: Calibration = Camera::look_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?.into();
/// let mut arm = PixelMask::new(64, 48);
/// let forearm = ArmPart::Capsule { from: Vec3::new(-0.5, 0.0, 1.0), to: Vec3::new(0.5, 0.0, 1.0), radius_m: 0.1 };
/// arm.mask_arm(&camera, &[forearm], 0.02)?;
/// assert!(arm.is_masked(32, 24) && !arm.is_masked(2, 2));
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PixelMask {
    width: usize,
    plane: Vec<u8>,
    is_empty: bool,
    outline: Vec<Point2>,
    points: Vec<Point2>,
    workspace: Vec<Point2>,
}

impl PixelMask {
    /// Creates an empty mask of this size.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, plane: vec![0; width * height], is_empty: true, ..Self::default() }
    }

    /// Empties the mask, for the next frame.
    pub fn clear(&mut self) {
        if !self.is_empty {
            self.plane.fill(0);
        }
        self.is_empty = true;
    }

    /// Whether a pixel is masked; false outside the image.
    pub fn is_masked(&self, x: usize, y: usize) -> bool {
        x < self.width && self.plane.get(y * self.width + x).is_some_and(|&pixel| pixel != 0)
    }

    /// Masks every pixel touched by the convex hull of the points, inflated by a margin (all in pixels).
    pub fn mask_polygon(&mut self, points_px: &[Point2], margin_px: f64) {
        polygon::inflate(points_px, margin_px.max(0.0), &mut self.outline, &mut self.workspace);
        raster::fill_convex(&mut self.plane, self.width, &self.outline, 1);
        self.is_empty = false;
    }

    /// Masks the silhouettes of the parts of an arm, each inflated by `margin_m` metres and then by one pixel. A part
    /// that is partly behind the camera masks the whole image; a part that is entirely behind it masks nothing.
    ///
    /// # Errors
    /// [`VisionError::NotCalibrated`] or [`VisionError::NeedsCamera`].
    pub fn mask_arm(&mut self, calibration: &Calibration, arm: &[ArmPart], margin_m: f64) -> Result<(), VisionError> {
        let camera = calibration.camera()?;
        let mut points = std::mem::take(&mut self.points);
        for part in arm {
            points.clear();
            match silhouette(camera, part, margin_m.max(0.0), &mut points, &mut self.outline) {
                Visibility::Full => self.mask_polygon(&points, 1.0),
                Visibility::Partial => {
                    self.plane.fill(1);
                    self.is_empty = false;
                }
                Visibility::None => {}
            }
        }
        self.points = points;
        Ok(())
    }

    /// Masked fraction of the image, 0 to 1.
    pub fn coverage(&self) -> f64 {
        let masked: usize = self.plane.iter().map(|&pixel| usize::from(pixel)).sum();
        masked as f64 / self.plane.len().max(1) as f64
    }

    /// Number of columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.plane.len() / self.width.max(1))
    }

    pub(crate) fn plane(&self) -> &[u8] {
        &self.plane
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.is_empty
    }
}

/// Visibility of a part: fully, partly or not in front of the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Visibility {
    Full,
    Partial,
    None,
}

/// Adds points to `points_px` whose convex hull contains the image of the part, inflated by a margin, if the whole part
/// is in front of the camera. `outline` is scratch memory.
pub(crate) fn silhouette(
    camera: &Camera,
    part: &ArmPart,
    margin_m: f64,
    points_px: &mut Vec<Point2>,
    outline: &mut Vec<Point2>,
) -> Visibility {
    let (in_front, behind) = project_part(camera, part, margin_m, points_px);
    let visibility = match (in_front > 0, behind > 0) {
        (true, false) => Visibility::Full,
        (true, true) => Visibility::Partial,
        (false, _) => Visibility::None,
    };
    polygon::convex_hull(points_px, outline);
    points_px.clear();
    if visibility == Visibility::Full {
        distort_outline(camera, outline, points_px);
    }
    visibility
}

/// Number of points per edge of an outline: with lens distortion, edges are curves.
const POINTS_PER_EDGE: u32 = 8;

/// The pixels of an outline in normalized image coordinates (x / z and y / z of the camera's frame).
fn distort_outline(camera: &Camera, outline: &[Point2], out: &mut Vec<Point2>) {
    for (a, b) in polygon::edges(outline) {
        for step in 0..POINTS_PER_EDGE {
            let p = a + (b - a) * (f64::from(step) / f64::from(POINTS_PER_EDGE));
            out.extend(camera.camera_to_pixel(Vec3::new(p.x, p.y, 1.0)));
        }
    }
}

/// Adds points in normalized image coordinates whose hull contains the image of the part. Returns the numbers of points
/// in front of the camera and behind it.
fn project_part(camera: &Camera, part: &ArmPart, margin_m: f64, out: &mut Vec<Point2>) -> (usize, usize) {
    match part {
        ArmPart::Capsule { from, to, radius_m } => {
            let a = project_sphere(camera, *from, radius_m + margin_m, out);
            let b = project_sphere(camera, *to, radius_m + margin_m, out);
            (a.0 + b.0, a.1 + b.1)
        }
        ArmPart::Hull(points) => points.iter().fold((0, 0), |sum, &p| {
            let counts = project_sphere(camera, p, margin_m, out);
            (sum.0 + counts.0, sum.1 + counts.1)
        }),
    }
}

/// Projects the tangent cone from the camera to a sphere, cut in the plane through the sphere's centre: an octagon
/// around the resulting circle.
fn project_sphere(camera: &Camera, centre_in_world: Vec3, radius_m: f64, out: &mut Vec<Point2>) -> (usize, usize) {
    let c = camera.camera_in_world().inverse_transform_point(centre_in_world);
    let distance = c.length();
    let Some(view) = c.try_normalize().filter(|_| distance > radius_m && c.is_finite()) else { return (1, 1) };
    let across = view.any_perpendicular();
    let other = view.cross(across);
    // The radius of the tangent cone in that plane, enlarged so that the octagon's edges are outside the circle.
    let tangent = radius_m * distance / (distance * distance - radius_m * radius_m).sqrt();
    let r = tangent / (std::f64::consts::PI / 8.0).cos();
    let mut counts = (0, 0);
    for i in 0..8 {
        let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
        let p = c + across * (r * cos) + other * (r * sin);
        if p.z > MIN_DEPTH_M {
            out.push(Point2::new(p.x / p.z, p.y / p.z));
            counts.0 += 1;
        } else {
            counts.1 += 1;
        }
    }
    counts
}
