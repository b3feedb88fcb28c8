use elbowroom_spatial::Vec3;

/// All points within `radius` of the segment from `-half_length` to `half_length` on its frame's z axis.
///
/// ```
/// use elbowroom_proximity::Capsule;
/// let forearm = Capsule { half_length: 0.2, radius: 0.06 };
/// assert!(forearm.volume() > std::f64::consts::PI * 0.06 * 0.06 * 0.4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// Half the length of the axis without the caps, metres.
    pub half_length: f64,
    /// Radius of the body and of the caps, metres.
    pub radius: f64,
}

impl Capsule {
    /// Volume in cubic metres: a cylinder and a ball.
    pub fn volume(&self) -> f64 {
        std::f64::consts::PI * self.radius.powi(2) * (2.0 * self.half_length + 4.0 / 3.0 * self.radius)
    }

    /// The support point: the point farthest along `dir`, local frame.
    pub fn support(&self, dir: Vec3) -> Vec3 {
        let end = Vec3::Z * self.half_length.copysign(dir.z);
        dir.try_normalize().map_or(end, |d| end + d * self.radius)
    }

    /// The point of the axis nearest to `p`, local frame.
    #[inline]
    pub fn axis_point(&self, p: Vec3) -> Vec3 {
        Vec3::Z * p.z.max(-self.half_length).min(self.half_length)
    }
}
