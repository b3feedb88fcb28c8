use elbowroom_spatial::Vec3;

/// A box around its frame's origin, with its edges along the axes.
///
/// ```
/// use elbowroom_proximity::Cuboid;
/// use elbowroom_spatial::Vec3;
/// let table = Cuboid { half_extents: Vec3::new(0.3, 0.2, 0.35) };
/// assert!((table.volume() - 0.168).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    /// Half edge lengths, metres.
    pub half_extents: Vec3,
}

impl Cuboid {
    /// Volume in cubic metres.
    pub fn volume(&self) -> f64 {
        8.0 * self.half_extents.x * self.half_extents.y * self.half_extents.z
    }

    /// The support point: the corner farthest along `dir`, local frame.
    #[inline]
    pub fn support(&self, dir: Vec3) -> Vec3 {
        let h = self.half_extents;
        Vec3::new(h.x.copysign(dir.x), h.y.copysign(dir.y), h.z.copysign(dir.z))
    }

    /// The point of the solid nearest to `p` (`p` itself if it is inside), local frame. This is algorithm 1 of Romanelli
    /// 2011, axis by axis.
    #[inline]
    pub fn nearest(&self, p: Vec3) -> Vec3 {
        p.max(-self.half_extents).min(self.half_extents)
    }
}
