//! Pixels that the arm itself covers: neither foreground nor background. What is behind them is unknown, not free.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

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
    /// A capsule or a shape's corners, placed in the world; `None` for a shape that has no end (a half-space). Round
    /// shapes other than capsules become the box around them, meshes the hull of their corners.
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
            Shape::Sphere(ball) => {
                let at = world(Vec3::ZERO);
                Some(Self::Capsule { from: at, to: at, radius_m: ball.radius })
            }
            Shape::Capsule(capsule) => {
                let end = Vec3::Z * capsule.half_length;
                Some(Self::Capsule { from: world(-end), to: world(end), radius_m: capsule.radius })
            }
            Shape::Hull(solid) => hull(solid.vertices()),
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

/// Pixels that are hidden, for one frame.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::{ArmPart, Calibration, Camera, Intrinsics, PixelMask};
/// let lens = Intrinsics::ideal(64, 48, 1.2);
/// let camera: Calibration = Camera::looking_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?.into();
/// let mut arm = PixelMask::new(64, 48);
/// let forearm = ArmPart::Capsule { from: Vec3::new(-0.5, 0.0, 1.0), to: Vec3::new(0.5, 0.0, 1.0), radius_m: 0.1 };
/// arm.hide_arm(&camera, &[forearm], 0.02)?;
/// assert!(arm.is_hidden(32, 24) && !arm.is_hidden(2, 2));
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PixelMask {
    width: usize,
    hidden: Vec<u8>,
    is_empty: bool,
    outline: Vec<Point2>,
    points: Vec<Point2>,
    spare: Vec<Point2>,
}

impl PixelMask {
    /// Nothing hidden in a picture of this size.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, hidden: vec![0; width * height], is_empty: true, ..Self::default() }
    }

    /// Hides nothing any more; for the next frame.
    pub fn clear(&mut self) {
        if !self.is_empty {
            self.hidden.fill(0);
        }
        self.is_empty = true;
    }

    /// Whether a pixel is hidden; false beside the picture.
    pub fn is_hidden(&self, x: usize, y: usize) -> bool {
        x < self.width && self.hidden.get(y * self.width + x).is_some_and(|&pixel| pixel != 0)
    }

    /// Hides one pixel; nothing beside the picture.
    pub fn hide(&mut self, x: usize, y: usize) {
        if x < self.width
            && let Some(pixel) = self.hidden.get_mut(y * self.width + x)
        {
            *pixel = 1;
            self.is_empty = false;
        }
    }

    /// Hides every pixel that the convex hull of the points, grown by a margin, touches (all in pixels).
    pub fn hide_polygon(&mut self, points_px: &[Point2], margin_px: f64) {
        polygon::grown(points_px, margin_px.max(0.0), &mut self.outline, &mut self.spare);
        raster::fill_convex(&mut self.hidden, self.width, &self.outline, 1);
        self.is_empty = false;
    }

    /// Hides where the parts of an arm appear, each grown by `margin_m` metres and then by one pixel. A part that reaches
    /// behind the camera's lens hides the whole picture; one that lies wholly behind it, nothing.
    ///
    /// # Errors
    /// [`VisionError::NotCalibrated`], [`VisionError::NeedsCamera`].
    pub fn hide_arm(&mut self, calibration: &Calibration, arm: &[ArmPart], margin_m: f64) -> Result<(), VisionError> {
        let camera = calibration.camera()?;
        let mut points = std::mem::take(&mut self.points);
        for part in arm {
            points.clear();
            match silhouette(camera, part, margin_m.max(0.0), &mut points, &mut self.outline) {
                Sight::All => self.hide_polygon(&points, 1.0),
                Sight::Part => {
                    self.hidden.fill(1);
                    self.is_empty = false;
                }
                Sight::Nothing => {}
            }
        }
        self.points = points;
        Ok(())
    }

    /// Share of the picture that is hidden, 0 to 1.
    pub fn share(&self) -> f64 {
        let hidden: usize = self.hidden.iter().map(|&pixel| usize::from(pixel)).sum();
        hidden as f64 / self.hidden.len().max(1) as f64
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.hidden.len() / self.width.max(1))
    }

    pub(crate) fn plane(&self) -> &[u8] {
        &self.hidden
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.is_empty
    }
}

/// How much of a part lies in front of the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sight {
    All,
    Part,
    Nothing,
}

/// Adds to `points_px` points whose convex hull covers the part grown by a margin, where all of it lies in front of the
/// camera; `outline` is scratch.
pub(crate) fn silhouette(
    camera: &Camera,
    part: &ArmPart,
    margin_m: f64,
    points_px: &mut Vec<Point2>,
    outline: &mut Vec<Point2>,
) -> Sight {
    let (seen, behind) = slopes(camera, part, margin_m, points_px);
    let sight = match (seen > 0, behind > 0) {
        (true, false) => Sight::All,
        (true, true) => Sight::Part,
        (false, _) => Sight::Nothing,
    };
    polygon::convex_hull(points_px, outline);
    points_px.clear();
    if sight == Sight::All {
        bend(camera, outline, points_px);
    }
    sight
}

/// Points between the corners of an outline, so that a lens that bends lines bends it too.
const PER_EDGE: u32 = 8;

/// A straight outline (x / z and y / z of the camera's frame) as the lens shows it, pixels.
fn bend(camera: &Camera, slopes: &[Point2], out: &mut Vec<Point2>) {
    for (a, b) in polygon::edges(slopes) {
        for step in 0..PER_EDGE {
            let p = a + (b - a) * (f64::from(step) / f64::from(PER_EDGE));
            out.extend(camera.camera_to_pixel(Vec3::new(p.x, p.y, 1.0)));
        }
    }
}

/// Adds slopes (x / z and y / z of the camera's frame) whose hull covers the part; counts the points in front of the
/// camera and behind it.
fn slopes(camera: &Camera, part: &ArmPart, margin_m: f64, out: &mut Vec<Point2>) -> (usize, usize) {
    match part {
        ArmPart::Capsule { from, to, radius_m } => {
            let a = ball(camera, *from, radius_m + margin_m, out);
            let b = ball(camera, *to, radius_m + margin_m, out);
            (a.0 + b.0, a.1 + b.1)
        }
        ArmPart::Hull(points) => points.iter().fold((0, 0), |sum, &p| {
            let at = ball(camera, p, margin_m, out);
            (sum.0 + at.0, sum.1 + at.1)
        }),
    }
}

/// The cone from the eye around a ball, cut across its centre: eight points around that circle.
fn ball(camera: &Camera, centre_in_world: Vec3, radius_m: f64, out: &mut Vec<Point2>) -> (usize, usize) {
    let c = camera.camera_in_world().inverse_transform_point(centre_in_world);
    let distance = c.length();
    let Some(view) = c.try_normalize().filter(|_| distance > radius_m && c.is_finite()) else { return (1, 1) };
    let across = view.any_perpendicular();
    let other = view.cross(across);
    // Where the tangent cone cuts the plane across the centre, and a little more so that the octagon's edges lie outside.
    let tangent = radius_m * distance / (distance * distance - radius_m * radius_m).sqrt();
    let r = tangent / (std::f64::consts::PI / 8.0).cos();
    let mut count = (0, 0);
    for i in 0..8 {
        let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
        let p = c + across * (r * cos) + other * (r * sin);
        if p.z > 1e-9 {
            out.push(Point2::new(p.x / p.z, p.y / p.z));
            count.0 += 1;
        } else {
            count.1 += 1;
        }
    }
    count
}
