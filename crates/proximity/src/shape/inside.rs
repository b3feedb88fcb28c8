//! Is a point inside a mesh? Rays that pass an edge too closely are thrown away, not trusted.

use elbowroom_spatial::Vec3;

use super::TriMesh;
use super::topology::is_degenerate;
use crate::mesh::Ray;

/// Directions without a pattern that a drawn model could share.
const RAYS: [Vec3; 6] = [
    Vec3::new(0.577_126_1, 0.612_370_9, 0.540_303_7),
    Vec3::new(-0.739_085_1, 0.297_311_3, 0.604_898_6),
    Vec3::new(0.124_739_4, -0.915_965_6, 0.381_380_2),
    Vec3::new(0.345_372_9, 0.412_454_0, -0.842_976_8),
    Vec3::new(-0.661_707_1, -0.561_459_5, -0.496_917_3),
    Vec3::new(0.893_189_2, -0.261_497_2, -0.365_873_1),
];

struct Crossings {
    count: usize,
    /// Leaving minus entering, by the orientation of the triangles.
    signed: i64,
    unsure: bool,
}

impl TriMesh {
    /// True where the point (local frame) is inside a closed part of the surface; always false for an open mesh. Hairline
    /// seams count as closed ([`MeshReport::welded`](super::MeshReport::welded)).
    ///
    /// An odd number of crossings or a winding number other than zero counts as inside: parts that overlap stay solid,
    /// a cavity of the opposite orientation is free, and triangles that face both ways are judged by parity.
    ///
    /// ```
    /// # use elbowroom_proximity::TriMesh;
    /// # use elbowroom_spatial::Vec3;
    /// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    /// assert!(mesh.contains(Vec3::splat(0.2)) && !mesh.contains(Vec3::splat(0.4)));
    /// ```
    pub fn contains(&self, p: Vec3) -> bool {
        if !self.has_inside() || !self.aabb().contains(p) {
            return false;
        }
        for direction in RAYS {
            let crossings = self.cast(p, direction);
            if !crossings.unsure {
                return crossings.count % 2 == 1 || crossings.signed != 0;
            }
        }
        self.winding_number(p).abs() > 0.5
    }

    fn cast(&self, p: Vec3, direction: Vec3) -> Crossings {
        let mut found = Crossings { count: 0, signed: 0, unsure: false };
        self.tree.visit(&Ray::new(&self.tree, p, direction), 0.0, &mut |triangle| {
            if self.in_closed_part[triangle] {
                cross(self.closed_corners(triangle), p, direction, &mut found);
            }
            if found.unsure { f32::NEG_INFINITY } else { 0.0 }
        });
        found
    }

    /// Sum of the solid angles of all closed parts over 4π (Van Oosterom and Strackee, 1983).
    fn winding_number(&self, p: Vec3) -> f64 {
        let angle = |[a, b, c]: [Vec3; 3]| {
            let (a, b, c) = (a - p, b - p, c - p);
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            let across = a.dot(b.cross(c));
            2.0 * across.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
        };
        let closed = (0..self.triangles().len()).filter(|&t| self.in_closed_part[t]);
        closed.map(|t| angle(self.closed_corners(t))).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }
}

/// Möller and Trumbore (1997), with a band of doubt around the border.
fn cross(t: [Vec3; 3], p: Vec3, direction: Vec3, found: &mut Crossings) {
    const DOUBT: f64 = 1e-9;
    let (e1, e2) = (t[1] - t[0], t[2] - t[0]);
    let q = direction.cross(e2);
    let det = e1.dot(q);
    if det.abs() <= 1e-10 * e1.length() * e2.length() {
        found.unsure |= !is_degenerate(t);
        return;
    }
    let from = p - t[0];
    let u = from.dot(q) / det;
    let r = from.cross(e1);
    let v = direction.dot(r) / det;
    let along = e2.dot(r) / det;
    let border = u.min(v).min(1.0 - u - v);
    if border < -DOUBT || along < 0.0 {
        return;
    }
    found.unsure |= border < DOUBT;
    found.count += 1;
    found.signed += if det > 0.0 { 1 } else { -1 };
}
