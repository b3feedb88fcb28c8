use elbowroom_spatial::Vec3;

/// A solid with flat ends around its frame's z axis, from `-half_length` to `half_length`.
///
/// ```
/// use elbowroom_proximity::Cylinder;
/// let column = Cylinder { half_length: 0.6, radius: 0.15 };
/// assert!((column.volume() - 0.084_823).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Half the height, metres.
    pub half_length: f64,
    /// Radius, metres.
    pub radius: f64,
}

impl Cylinder {
    /// Volume in cubic metres.
    pub fn volume(&self) -> f64 {
        2.0 * std::f64::consts::PI * self.radius.powi(2) * self.half_length
    }

    /// The support point: the point farthest along `dir`, local frame.
    #[inline]
    pub fn support(&self, dir: Vec3) -> Vec3 {
        let z = self.half_length.copysign(dir.z);
        let rho2 = dir.x * dir.x + dir.y * dir.y;
        if rho2 > 1e-280 {
            let k = self.radius / rho2.sqrt();
            return Vec3::new(dir.x * k, dir.y * k, z);
        }
        match Vec3::new(dir.x, dir.y, 0.0).try_normalize() {
            Some(d) => Vec3::new(d.x * self.radius, d.y * self.radius, z),
            None => Vec3::new(0.0, 0.0, z),
        }
    }

    /// The point of the solid nearest to `p` (`p` itself if it is inside), local frame.
    #[inline]
    pub fn nearest(&self, p: Vec3) -> Vec3 {
        let rho = (p.x * p.x + p.y * p.y).sqrt();
        let k = if rho > self.radius { self.radius / rho } else { 1.0 };
        Vec3::new(p.x * k, p.y * k, p.z.max(-self.half_length).min(self.half_length))
    }
}
