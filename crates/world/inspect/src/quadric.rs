//! Quadric error metrics: weighted sums of squared distances to planes.

use elbowroom_spatial::Vec3;

/// The quadric `xᵀ A x + 2 bᵀ x + c` with a symmetric `A`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Quadric {
    /// Entries of `A`: xx, xy, xz, yy, yz, zz.
    a: [f64; 6],
    b: Vec3,
    c: f64,
}

impl Quadric {
    /// `weight` times the squared distance to the plane through `point`; zero for a zero normal.
    pub fn plane(normal: Vec3, point: Vec3, weight: f64) -> Self {
        let Some(n) = normal.try_normalize() else { return Self::default() };
        let d = -n.dot(point);
        let a = [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z].map(|v| v * weight);
        Self { a, b: n * (d * weight), c: d * d * weight }
    }

    pub fn add(&mut self, other: &Self) {
        self.a.iter_mut().zip(other.a).for_each(|(to, v)| *to += v);
        self.b += other.b;
        self.c += other.c;
    }

    pub fn sum(&self, other: &Self) -> Self {
        let mut sum = *self;
        sum.add(other);
        sum
    }

    fn times(&self, x: Vec3) -> Vec3 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        Vec3::new(xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z, xz * x.x + yz * x.y + zz * x.z)
    }

    pub fn at(&self, x: Vec3) -> f64 {
        x.dot(self.times(x)) + 2.0 * self.b.dot(x) + self.c
    }

    /// The point of the minimum; `None` if the minimum is a line or a plane, or nearly so.
    pub fn lowest(&self) -> Option<Vec3> {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        let (u, v, w) = (Vec3::new(xx, xy, xz), Vec3::new(xy, yy, yz), Vec3::new(xz, yz, zz));
        let cross = v.cross(w);
        let det = u.dot(cross);
        let trace = xx + yy + zz;
        if !(det > 1e-6 * trace * trace * trace) {
            return None;
        }
        // The columns of the inverse of a symmetric matrix are the cross products of its rows.
        Some((cross * self.b.x + w.cross(u) * self.b.y + u.cross(v) * self.b.z) / -det)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_where_their_quadric_is_lowest() {
        let corner = Vec3::new(0.3, -0.2, 0.7);
        let mut q = Quadric::plane(Vec3::new(1.0, 0.2, 0.0), corner, 2.0);
        q.add(&Quadric::plane(Vec3::new(0.0, 1.0, 0.3), corner, 1.0));
        assert!(q.lowest().is_none(), "two planes meet in a line");
        q.add(&Quadric::plane(Vec3::Z, corner, 0.5));
        assert!(q.lowest().unwrap().distance(corner) < 1e-12);
        assert!((q.at(corner + Vec3::X) - 2.0 / 1.04).abs() < 1e-9);
    }
}
