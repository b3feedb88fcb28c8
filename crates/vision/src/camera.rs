//! A pinhole camera with radial distortion and a place in the world.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{Point2, VisionError};

/// What a lens and its sensor do (Brown, 1966, radial terms): a point (x, y, z) of the camera's frame with
/// `r² = (x² + y²) / z²` appears at `(fx·d·x/z + cx, fy·d·y/z + cy)`, `d = 1 + k1·r² + k2·r⁴ + k3·r⁶`.
///
/// The camera's frame: z looks out of the lens, x to the right of the picture, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    /// Columns of the picture.
    pub width: usize,
    /// Rows of the picture.
    pub height: usize,
    /// Focal length along a row, pixels.
    pub fx: f64,
    /// Focal length along a column, pixels.
    pub fy: f64,
    /// Where the optical axis meets the picture, pixels from its left edge.
    pub cx: f64,
    /// The same, pixels from its upper edge.
    pub cy: f64,
    /// k1, k2, k3; zeros for a lens without distortion.
    pub radial: [f64; 3],
}

impl Intrinsics {
    /// A lens without distortion whose picture is `field_of_view` radians wide.
    pub fn ideal(width: usize, height: usize, field_of_view: f64) -> Self {
        let (w, h) = (width as f64, height as f64);
        let focal = w / (2.0 * (field_of_view / 2.0).tan());
        Self { width, height, fx: focal, fy: focal, cx: w / 2.0, cy: h / 2.0, radial: [0.0; 3] }
    }

    /// Distorted radius of a straight ray with slope `r`.
    fn bent(&self, r: f64) -> f64 {
        let [k1, k2, k3] = self.radial;
        let s = r * r;
        r * (1.0 + s * (k1 + s * (k2 + s * k3)))
    }

    /// Derivative of [`Self::bent`].
    fn bent_slope(&self, r: f64) -> f64 {
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
/// let lens = Intrinsics::ideal(640, 480, 1.2);
/// let camera = Camera::looking_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?;
/// assert_eq!(camera.world_to_pixel(Vec3::ZERO), Some(Point2::new(320.0, 240.0)));
/// let right_of_middle = camera.pixel_to_plane(Point2::new(420.0, 240.0), 0.0).unwrap();
/// assert!(right_of_middle.x > 0.5 && right_of_middle.y.abs() < 1e-12);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    intrinsics: Intrinsics,
    /// Its pose.
    in_world: Pose,
    /// Largest slope of a ray up to which distortion is one to one; beyond it goes on straight.
    straight_from: f64,
}

impl Camera {
    /// A camera at `camera_in_world` (its z axis looks, its x axis is the picture's right).
    ///
    /// # Errors
    /// Numbers that are not finite, focal lengths that are not positive, an empty picture, or distortion that folds the
    /// picture over before its corners.
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
        let mut camera = Self { intrinsics, in_world: camera_in_world, straight_from: f64::INFINITY };
        camera.straight_from = camera.limit_of_distortion();
        let [width, height] = [i.width as f64, i.height as f64];
        let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
        let seen = |&(x, y): &(f64, f64)| camera.bent_radius(Point2::new(x, y)) < i.bent(camera.straight_from);
        if camera.straight_from.is_finite() && !corners.iter().all(seen) {
            return refuse(
                "the radial distortion folds the picture over before its corners; check the signs of k1, k2, k3 and \
                 that they belong to this picture size",
            );
        }
        Ok(camera)
    }

    /// A camera at `eye` that looks at `target`; `up` is upward in the picture.
    ///
    /// # Errors
    /// As [`Camera::new`]; and where eye and target coincide, or `up` is along the view.
    pub fn looking_at(intrinsics: Intrinsics, eye: Vec3, target: Vec3, up: Vec3) -> Result<Self, VisionError> {
        let no_view = || VisionError::Calibration("eye, target and up do not make a view; choose another up".into());
        let z = (target - eye).try_normalize().ok_or_else(no_view)?;
        let x = z.cross(up).try_normalize().ok_or_else(no_view)?;
        let rotation = Rotation::from_columns(x, z.cross(x), z).ok_or_else(no_view)?;
        Self::new(intrinsics, Pose::new(rotation, eye))
    }

    /// The lens and the sensor.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    /// Where the camera is and looks.
    pub fn camera_in_world(&self) -> &Pose {
        &self.in_world
    }

    /// The centre of projection, world frame, metres.
    pub fn eye_in_world(&self) -> Vec3 {
        self.in_world.translation
    }

    /// Where a point of the world appears, also beside the picture; `None` behind the camera or for a point that is none.
    pub fn world_to_pixel(&self, p_in_world: Vec3) -> Option<Point2> {
        self.camera_to_pixel(self.in_world.inverse_transform_point(p_in_world))
    }

    /// As [`Camera::world_to_pixel`], for a point in the camera's frame.
    pub fn camera_to_pixel(&self, p_in_camera: Vec3) -> Option<Point2> {
        if !(p_in_camera.z > 1e-9) || !p_in_camera.is_finite() {
            return None;
        }
        let (x, y) = (p_in_camera.x / p_in_camera.z, p_in_camera.y / p_in_camera.z);
        let r = x.hypot(y);
        let factor = if r > 1e-12 { self.distorted(r) / r } else { 1.0 };
        let i = &self.intrinsics;
        Some(Point2::new(i.fx * factor * x + i.cx, i.fy * factor * y + i.cy))
    }

    /// The ray through a pixel in the camera's frame, with z = 1.
    pub fn pixel_to_ray(&self, seen_px: Point2) -> Vec3 {
        let i = &self.intrinsics;
        let (x, y) = ((seen_px.x - i.cx) / i.fx, (seen_px.y - i.cy) / i.fy);
        let bent = x.hypot(y);
        let factor = if i.radial == [0.0; 3] || bent < 1e-12 { 1.0 } else { self.straightened(bent) / bent };
        Vec3::new(x * factor, y * factor, 1.0)
    }

    /// Where the ray through a pixel meets the horizontal plane at height `z_m`; `None` where it does not.
    pub fn pixel_to_plane(&self, seen_px: Point2, z_m: f64) -> Option<Point2> {
        let eye = self.eye_in_world();
        let along = self.in_world.transform_vector(self.pixel_to_ray(seen_px));
        let t = (z_m - eye.z) / along.z;
        let p = eye + along * t;
        (t > 0.0 && p.is_finite()).then_some(Point2::new(p.x, p.y))
    }

    fn bent_radius(&self, seen_px: Point2) -> f64 {
        let i = &self.intrinsics;
        ((seen_px.x - i.cx) / i.fx).hypot((seen_px.y - i.cy) / i.fy)
    }

    /// Where distortion stops growing with the ray's slope; infinite where it never does (up to a slope of 8, 83°).
    fn limit_of_distortion(&self) -> f64 {
        if self.intrinsics.radial == [0.0; 3] {
            return f64::INFINITY;
        }
        let slopes = (0..=800).map(|step| f64::from(step) * 0.01);
        slopes.into_iter().find(|&r| self.intrinsics.bent_slope(r) < 0.05).map_or(8.0, |r| (r - 0.01).max(0.0))
    }

    /// Distorted radius, going on straight where the formula would fold back.
    fn distorted(&self, r: f64) -> f64 {
        let last = self.straight_from;
        if r <= last {
            return self.intrinsics.bent(r);
        }
        self.intrinsics.bent(last) + (r - last) * self.intrinsics.bent_slope(last).max(0.05)
    }

    /// The slope whose distorted radius is `bent`: Newton, kept in bounds by bisection.
    fn straightened(&self, bent: f64) -> f64 {
        let last = self.straight_from.min(8.0);
        let end = self.intrinsics.bent(last);
        if bent >= end {
            return last + (bent - end) / self.intrinsics.bent_slope(last).max(0.05);
        }
        let (mut low, mut high) = (0.0, last);
        let mut r = bent.min(last);
        for _ in 0..60 {
            let error = self.intrinsics.bent(r) - bent;
            if error.abs() <= 1e-15 * bent {
                break;
            }
            if error > 0.0 {
                high = r;
            } else {
                low = r;
            }
            let newton = r - error / self.intrinsics.bent_slope(r);
            r = if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
        }
        r
    }
}
