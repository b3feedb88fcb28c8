use elbowroom_spatial::Vec3;

/// A ball around its frame's origin. A radius of 0 is a point.
///
/// ```
/// use elbowroom_proximity::Sphere;
/// let probe = Sphere { radius: 0.05 };
/// assert!((probe.volume() - 5.235_987_755_982_988e-4).abs() < 1e-18);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Radius, metres, 0 or more.
    pub radius: f64,
}

impl Sphere {
    /// Volume in cubic metres.
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3)
    }

    /// The support point: the point farthest along `dir`, local frame.
    pub fn support(&self, dir: Vec3) -> Vec3 {
        dir.try_normalize().map_or(Vec3::ZERO, |d| d * self.radius)
    }
}
