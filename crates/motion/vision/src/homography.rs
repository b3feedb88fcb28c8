//! The homography between image and floor from point pairs: the normalized direct linear transform.
//!
//! Hartley and Zisserman, Multiple View Geometry, 2nd edition, algorithm 4.2.

use elbowroom_spatial::Vec3;
use elbowroom_spatial::linalg::symmetric_eigen;

use crate::{Point2, VisionError};

type Matrix = [[f64; 3]; 3];

/// Smallest ratio of the second smallest eigenvalue to the largest; below it, more than one homography fits the pairs.
const MIN_EIGENVALUE_RATIO: f64 = 1e-9;
/// Smallest determinant of a homography between normalized points; below it, the homography maps the image to a line.
const MIN_DETERMINANT: f64 = 1e-7;

/// A homography from the image to the floor (no lens distortion).
///
/// ```
/// use elbowroom_vision::{FloorHomography, Point2};
/// let p = Point2::new;
/// let points_px = [p(0.0, 0.0), p(640.0, 0.0), p(640.0, 480.0), p(0.0, 480.0)];
/// let points_m = [p(-2.0, 1.5), p(2.0, 1.5), p(2.0, -1.5), p(-2.0, -1.5)];
/// let floor = FloorHomography::from_points(640, 480, &points_px, &points_m)?;
/// assert!((floor.pixel_to_floor(p(320.0, 240.0)).unwrap() - p(0.0, 0.0)).length() < 1e-12);
/// assert!(FloorHomography::from_points(640, 480, &points_px[..3], &points_m[..3]).is_err());
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FloorHomography {
    width: usize,
    height: usize,
    to_floor: Matrix,
    to_pixel: Matrix,
    /// Sign of the denominator in front of the camera, below the horizon.
    front_sign: f64,
    max_residual_m: f64,
    eye_in_world: Option<Vec3>,
}

impl FloorHomography {
    /// Computes the homography of an image of `width` × `height` pixels from points of the floor: their pixels and
    /// their positions (metres, world x and y). Four pairs determine it; with more pairs, the algebraic error is
    /// minimized.
    ///
    /// # Errors
    /// There are fewer than four pairs, the lists have different lengths, numbers are not finite, three of four points
    /// are on one line (then the homography is not determined), or points are on both sides of the horizon.
    pub fn from_points(
        width: usize,
        height: usize,
        points_px: &[Point2],
        points_m: &[Point2],
    ) -> Result<Self, VisionError> {
        check_pairs(width, height, points_px, points_m)?;
        let (from, normalize_px) = normalized(points_px).ok_or_else(coinciding_points)?;
        let (to, normalize_m) = normalized(points_m).ok_or_else(coinciding_points)?;
        let between = direct_linear_transform(&from, &to)?;
        let denormalize_m = inverse(&normalize_m).ok_or_else(coinciding_points)?;
        let to_floor = scaled(product(&denormalize_m, &product(&between, &normalize_px)));
        let to_pixel = inverse(&to_floor).map(scaled).ok_or_else(collinear_points)?;
        let denominators = || points_px.iter().map(|&p| denominator(&to_floor, p));
        let front_sign = denominators().next().unwrap_or(1.0).signum();
        if denominators().any(|w| w * front_sign <= 0.0) {
            return Err(VisionError::Calibration(
                "its points lie on both sides of the horizon, which no picture shows; a pair is mixed up".into(),
            ));
        }
        let mut floor = Self { width, height, to_floor, to_pixel, front_sign, max_residual_m: 0.0, eye_in_world: None };
        let residual = |(&p, &q)| floor.pixel_to_floor(p).map_or(f64::INFINITY, |found| (found - q).length());
        floor.max_residual_m = points_px.iter().zip(points_m).map(residual).fold(0.0, f64::max);
        Ok(floor)
    }

    /// Adds the camera's position, metres, world frame: then the heights of templates can be used.
    #[must_use]
    pub fn with_eye(mut self, eye_in_world: Vec3) -> Self {
        self.eye_in_world = Some(eye_in_world);
        self
    }

    /// The camera's position, if it was given.
    pub fn eye_in_world(&self) -> Option<Vec3> {
        self.eye_in_world
    }

    /// Columns and rows of the image.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The largest distance of a given position from the position that the homography gives its pixel, metres. About 0
    /// with four pairs. With more pairs, a large value indicates a wrong pair or lens distortion (then use
    /// [`crate::Camera`]).
    pub fn max_residual_m(&self) -> f64 {
        self.max_residual_m
    }

    /// The point of the floor that a pixel shows; `None` on or above the horizon.
    pub fn pixel_to_floor(&self, point_px: Point2) -> Option<Point2> {
        (denominator(&self.to_floor, point_px) * self.front_sign > 0.0).then(|| apply(&self.to_floor, point_px))
    }

    /// The pixel that shows a point of the floor; `None` behind the camera.
    pub fn floor_to_pixel(&self, point_m: Point2) -> Option<Point2> {
        let point_px = apply(&self.to_pixel, point_m);
        self.pixel_to_floor(point_px).is_some().then_some(point_px).filter(|p| p.is_finite())
    }
}

fn coinciding_points() -> VisionError {
    VisionError::Calibration("its points coincide; spread four or more over the floor".into())
}

fn collinear_points() -> VisionError {
    VisionError::Calibration(
        "its points do not determine the map: three or more of them lie on one line; spread them over the floor".into(),
    )
}

fn check_pairs(width: usize, height: usize, points_px: &[Point2], points_m: &[Point2]) -> Result<(), VisionError> {
    let refuse = |why: String| Err(VisionError::Calibration(why));
    if width == 0 || height == 0 {
        return refuse("its picture is empty; write the columns and rows that the camera sends".into());
    }
    if points_px.len() != points_m.len() {
        let (a, b) = (points_px.len(), points_m.len());
        return refuse(format!("{a} pixels but {b} places; write one place for each pixel"));
    }
    if points_px.len() < 4 {
        return refuse(format!("a floor needs at least 4 points with their pixels, not {}", points_px.len()));
    }
    match points_px.iter().zip(points_m).position(|(p, q)| !p.is_finite() || !q.is_finite()) {
        Some(i) => refuse(format!("pair {i} (from 0) has a number that is not finite; write it again")),
        None => Ok(()),
    }
}

/// Points translated to their mean and scaled to a mean distance of √2, and the matrix of this transformation.
fn normalized(points: &[Point2]) -> Option<(Vec<Point2>, Matrix)> {
    let n = points.len() as f64;
    let mean = points.iter().fold(Point2::default(), |s, &p| s + p) * (1.0 / n);
    let distance = points.iter().map(|&p| (p - mean).length()).sum::<f64>() / n;
    let k = std::f64::consts::SQRT_2 / distance;
    if !k.is_finite() {
        return None;
    }
    let points = points.iter().map(|&p| (p - mean) * k).collect();
    Some((points, [[k, 0.0, -k * mean.x], [0.0, k, -k * mean.y], [0.0, 0.0, 1.0]]))
}

fn direct_linear_transform(from: &[Point2], to: &[Point2]) -> Result<Matrix, VisionError> {
    let mut normal = [[0.0; 9]; 9];
    for (&p, &q) in from.iter().zip(to) {
        let rows = [
            [-p.x, -p.y, -1.0, 0.0, 0.0, 0.0, q.x * p.x, q.x * p.y, q.x],
            [0.0, 0.0, 0.0, -p.x, -p.y, -1.0, q.y * p.x, q.y * p.y, q.y],
        ];
        for row in rows {
            for (i, &a) in row.iter().enumerate() {
                for (j, &b) in row.iter().enumerate() {
                    normal[i][j] += a * b;
                }
            }
        }
    }
    let (values, vectors) = symmetric_eigen(normal);
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    if values[order[1]] < MIN_EIGENVALUE_RATIO * values[order[8]] {
        return Err(collinear_points());
    }
    let h: [f64; 9] = std::array::from_fn(|i| vectors[i][order[0]]);
    let matrix = [[h[0], h[1], h[2]], [h[3], h[4], h[5]], [h[6], h[7], h[8]]];
    if determinant(&matrix).abs() < MIN_DETERMINANT {
        return Err(collinear_points());
    }
    Ok(matrix)
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn determinant(m: &Matrix) -> f64 {
    let [a, b, c] = m.map(Vec3::from);
    a.dot(b.cross(c))
}

fn inverse(m: &Matrix) -> Option<Matrix> {
    let [a, b, c] = m.map(Vec3::from);
    let columns = [b.cross(c), c.cross(a), a.cross(b)].map(|v| (v * (1.0 / a.dot(b.cross(c)))).to_array());
    let transposed: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
    transposed.iter().flatten().all(|x| x.is_finite()).then_some(transposed)
}

/// The homography scaled to a largest entry of 1.
fn scaled(m: Matrix) -> Matrix {
    let largest = m.iter().flatten().fold(0.0_f64, |s, x| s.max(x.abs()));
    m.map(|row| row.map(|x| x / largest))
}

fn denominator(m: &Matrix, p: Point2) -> f64 {
    m[2][0] * p.x + m[2][1] * p.y + m[2][2]
}

fn apply(m: &Matrix, p: Point2) -> Point2 {
    let w = denominator(m, p);
    Point2::new((m[0][0] * p.x + m[0][1] * p.y + m[0][2]) / w, (m[1][0] * p.x + m[1][1] * p.y + m[1][2]) / w)
}
