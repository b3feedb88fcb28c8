//! A pinhole camera with radial distortion and a pose.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{Point2, VisionError};

/// Smallest depth of a point along the camera's axis for which it has a pixel, metres.
pub(crate) const MIN_DEPTH_M: f64 = 1e-9;
/// Slope below which a ray counts as the optical axis: it does not have a direction in the image.
const AXIS_SLOPE: f64 = 1e-12;
/// Largest slope (tangent of the angle from the optical axis) of a ray through a lens that distorts: 83°.
const MAX_SLOPE: f64 = 8.0;
/// Step of the search for the slope at which distortion stops increasing.
const SLOPE_STEP: f64 = 0.01;
/// Smallest derivative of distortion by the slope that counts as increase; beyond the last such slope, distortion is
/// continued with this derivative.
const MIN_DERIVATIVE: f64 = 0.05;
/// Largest number of Newton steps or bisections for a slope: this number of bisections alone reaches the relative error
/// below.
const MAX_UNDISTORT_STEPS: usize = 60;
/// Relative error of a distorted radius that counts as rounding.
const RADIUS_ROUNDING: f64 = 1e-15;

/// Intrinsics of a camera (Brown, 1966, radial terms): a point (x, y, z) of the camera's frame with
/// `r² = (x² + y²) / z²` appears at `(fx·d·x/z + cx, fy·d·y/z + cy)`, `d = 1 + k1·r² + k2·r⁴ + k3·r⁶`.
///
/// In the camera's frame, z is along the optical axis, x to the right of the image, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    /// Columns of the image.
    pub width: usize,
    /// Rows of the image.
    pub height: usize,
    /// Focal length along a row, pixels.
    pub fx: f64,
    /// Focal length along a column, pixels.
    pub fy: f64,
    /// Principal point, pixels from the left edge.
    pub cx: f64,
    /// Principal point, pixels from the upper edge.
    pub cy: f64,
    /// k1, k2, k3; zeros for a lens without distortion.
    pub radial: [f64; 3],
}

impl Intrinsics {
    /// Creates the intrinsics of a lens without distortion, with a horizontal field of view of `field_of_view` radians.
    pub fn pinhole(width: usize, height: usize, field_of_view: f64) -> Self {
        let (w, h) = (width as f64, height as f64);
        let focal = w / (2.0 * (field_of_view / 2.0).tan());
        Self { width, height, fx: focal, fy: focal, cx: w / 2.0, cy: h / 2.0, radial: [0.0; 3] }
    }

    /// Distorted radius of a ray with slope `r`.
    fn distort(&self, r: f64) -> f64 {
        let [k1, k2, k3] = self.radial;
        let s = r * r;
        r * (1.0 + s * (k1 + s * (k2 + s * k3)))
    }

    /// Derivative of [`Self::distort`].
    fn distortion_derivative(&self, r: f64) -> f64 {
        let [k1, k2, k3] = self.radial;
        let s = r * r;
        1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3))
    }
}

/// A calibrated camera.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::{Camera, Intrinsics, Point2};
/// let lens = Intrinsics::pinhole(640, 480, 1.2);
/// let camera = Camera::look_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?;
/// assert_eq!(camera.world_to_pixel(Vec3::ZERO), Some(Point2::new(320.0, 240.0)));
/// let right_of_middle = camera.pixel_to_plane(Point2::new(420.0, 240.0), 0.0).unwrap();
/// assert!(right_of_middle.x > 0.5 && right_of_middle.y.abs() < 1e-12);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    intrinsics: Intrinsics,
    in_world: Pose,
    /// Largest slope of a ray up to which distortion is monotonic; beyond it, distortion is extended linearly.
    max_slope: f64,
}

impl Camera {
    /// Creates a camera at `camera_in_world` (z along the optical axis, x to the right of the image, y down).
    ///
    /// # Errors
    /// Numbers are not finite, focal lengths are not positive, the image is empty, or the distortion folds the image
    /// over before its corners.
    pub fn new(intrinsics: Intrinsics, camera_in_world: Pose) -> Result<Self, VisionError> {
        let refuse = |why: &str| Err(VisionError::Calibration(why.into()));
        let i = &intrinsics;
        let numbers = [i.fx, i.fy, i.cx, i.cy, i.radial[0], i.radial[1], i.radial[2]];
        if !camera_in_world.is_finite() || numbers.iter().any(|n| !n.is_finite()) {
            return refuse("a number of it is not finite; write finite intrinsics and a finite pose");
        }
        if i.width == 0 || i.height == 0 {
            return refuse("its picture is empty; write the columns and rows that the camera sends");
        }
        if i.fx <= 0.0 || i.fy <= 0.0 {
            return refuse("its focal lengths must be positive; they are in pixels, some hundreds for most lenses");
        }
        let mut camera = Self { intrinsics, in_world: camera_in_world, max_slope: f64::INFINITY };
        camera.max_slope = camera.monotonic_limit();
        let [width, height] = [i.width as f64, i.height as f64];
        let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
        let is_monotonic =
            |&(x, y): &(f64, f64)| camera.distorted_radius(Point2::new(x, y)) < i.distort(camera.max_slope);
        if camera.max_slope.is_finite() && !corners.iter().all(is_monotonic) {
            return refuse(
                "the radial distortion folds the picture over before its corners; check the signs of k1, k2, k3 and \
                 that they belong to this picture size",
            );
        }
        Ok(camera)
    }

    /// Creates a camera at `eye` whose optical axis points to `target`; `up` points upward in the image.
    ///
    /// # Errors
    /// The errors of [`Camera::new`]; or eye and target coincide, or `up` is parallel to the optical axis.
    pub fn look_at(intrinsics: Intrinsics, eye: Vec3, target: Vec3, up: Vec3) -> Result<Self, VisionError> {
        let no_view = || VisionError::Calibration("eye, target and up do not make a view; choose another up".into());
        let z = (target - eye).try_normalize().ok_or_else(no_view)?;
        let x = z.cross(up).try_normalize().ok_or_else(no_view)?;
        let rotation = Rotation::from_columns(x, z.cross(x), z).ok_or_else(no_view)?;
        Self::new(intrinsics, Pose::new(rotation, eye))
    }

    /// The intrinsics.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    /// The pose.
    pub fn camera_in_world(&self) -> &Pose {
        &self.in_world
    }

    /// The centre of projection, world frame, metres.
    pub fn eye_in_world(&self) -> Vec3 {
        self.in_world.translation
    }

    /// The pixel that shows a point of the world, also outside the image; `None` for a point that is behind the camera
    /// or not finite.
    pub fn world_to_pixel(&self, p_in_world: Vec3) -> Option<Point2> {
        self.camera_to_pixel(self.in_world.inverse_transform_point(p_in_world))
    }

    /// Whether a point of the world is in the image, if nothing is in the way.
    pub fn shows(&self, p_in_world: Vec3) -> bool {
        let (width, height) = (self.intrinsics.width as f64, self.intrinsics.height as f64);
        let is_inside = |p: Point2| p.x >= 0.0 && p.y >= 0.0 && p.x <= width && p.y <= height;
        self.world_to_pixel(p_in_world).is_some_and(is_inside)
    }

    /// Like [`Camera::world_to_pixel`], for a point in the camera's frame.
    pub fn camera_to_pixel(&self, p_in_camera: Vec3) -> Option<Point2> {
        if !(p_in_camera.z > MIN_DEPTH_M) || !p_in_camera.is_finite() {
            return None;
        }
        let (x, y) = (p_in_camera.x / p_in_camera.z, p_in_camera.y / p_in_camera.z);
        let r = x.hypot(y);
        let factor = if r > AXIS_SLOPE { self.distort_extended(r) / r } else { 1.0 };
        let i = &self.intrinsics;
        Some(Point2::new(i.fx * factor * x + i.cx, i.fy * factor * y + i.cy))
    }

    /// The ray through a pixel in the camera's frame, with z = 1.
    pub fn pixel_to_ray(&self, point_px: Point2) -> Vec3 {
        let i = &self.intrinsics;
        let (x, y) = ((point_px.x - i.cx) / i.fx, (point_px.y - i.cy) / i.fy);
        let radius = x.hypot(y);
        let factor = if i.radial == [0.0; 3] || radius < AXIS_SLOPE { 1.0 } else { self.undistort(radius) / radius };
        Vec3::new(x * factor, y * factor, 1.0)
    }

    /// The intersection of the ray through a pixel with the horizontal plane at height `z_m`.
    pub fn pixel_to_plane(&self, point_px: Point2, z_m: f64) -> Option<Point2> {
        let eye = self.eye_in_world();
        let along = self.in_world.transform_vector(self.pixel_to_ray(point_px));
        let t = (z_m - eye.z) / along.z;
        let p = eye + along * t;
        (t > 0.0 && p.is_finite()).then_some(Point2::new(p.x, p.y))
    }

    fn distorted_radius(&self, point_px: Point2) -> f64 {
        let i = &self.intrinsics;
        ((point_px.x - i.cx) / i.fx).hypot((point_px.y - i.cy) / i.fy)
    }

    /// The largest slope up to which distortion increases with the slope; infinite without distortion, otherwise at
    /// most 8 (83°).
    fn monotonic_limit(&self) -> f64 {
        if self.intrinsics.radial == [0.0; 3] {
            return f64::INFINITY;
        }
        let steps = (MAX_SLOPE / SLOPE_STEP).round() as u32;
        let slopes = (0..=steps).map(|step| f64::from(step) * SLOPE_STEP);
        slopes
            .into_iter()
            .find(|&r| self.intrinsics.distortion_derivative(r) < MIN_DERIVATIVE)
            .map_or(MAX_SLOPE, |r| (r - SLOPE_STEP).max(0.0))
    }

    /// Distorted radius, extended linearly beyond the largest slope, where the polynomial would fold back.
    fn distort_extended(&self, r: f64) -> f64 {
        let last = self.max_slope;
        if r <= last {
            return self.intrinsics.distort(r);
        }
        self.intrinsics.distort(last) + (r - last) * self.intrinsics.distortion_derivative(last).max(MIN_DERIVATIVE)
    }

    /// The slope whose distorted radius is `radius`: Newton iteration, safeguarded by bisection.
    fn undistort(&self, radius: f64) -> f64 {
        let last = self.max_slope.min(MAX_SLOPE);
        let end = self.intrinsics.distort(last);
        if radius >= end {
            return last + (radius - end) / self.intrinsics.distortion_derivative(last).max(MIN_DERIVATIVE);
        }
        let (mut low, mut high) = (0.0, last);
        let mut r = radius.min(last);
        for _ in 0..MAX_UNDISTORT_STEPS {
            let error = self.intrinsics.distort(r) - radius;
            if error.abs() <= RADIUS_ROUNDING * radius {
                break;
            }
            if error > 0.0 {
                high = r;
            } else {
                low = r;
            }
            let newton = r - error / self.intrinsics.distortion_derivative(r);
            r = if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
        }
        r
    }
}
