//! Points in a plane: pixels of an image, or metres on the floor.

use std::ops::{Add, Mul, Sub};

/// A point in a plane. In an image: pixels, x to the right, y down, the centre of the first pixel at (0.5, 0.5). On the
/// floor: metres along the world's x and y axes. The name of a variable states the unit (`corner_px`, `centre_m`).
///
/// ```
/// use elbowroom_vision::Point2;
/// assert_eq!((Point2::new(3.0, 0.0) - Point2::new(0.0, 4.0)).length(), 5.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point2 {
    /// First coordinate.
    pub x: f64,
    /// Second coordinate.
    pub y: f64,
}

impl Point2 {
    /// Creates the point (x, y).
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Distance from the origin.
    pub fn length(self) -> f64 {
        self.x.hypot(self.y)
    }

    /// Two-dimensional cross product; positive if `o` is to the left of `self`.
    pub fn cross(self, o: Self) -> f64 {
        self.x * o.y - self.y * o.x
    }

    /// Scalar product.
    pub fn dot(self, o: Self) -> f64 {
        self.x * o.x + self.y * o.y
    }

    /// Whether both coordinates are neither NaN nor infinite.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

impl Add for Point2 {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y)
    }
}

impl Sub for Point2 {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y)
    }
}

impl Mul<f64> for Point2 {
    type Output = Self;
    fn mul(self, k: f64) -> Self {
        Self::new(self.x * k, self.y * k)
    }
}
