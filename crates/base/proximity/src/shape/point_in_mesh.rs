//! Point containment of a mesh by ray casting.
//!
//! A ray that passes too close to an edge is discarded, and another direction is tried.

use elbowroom_spatial::Vec3;

use super::TriMesh;
use super::topology::is_degenerate;
use crate::bvh::Ray;

/// Directions unlikely to be parallel to the faces of a modelled part.
const RAYS: [Vec3; 6] = [
    Vec3::new(0.577_126_1, 0.612_370_9, 0.540_303_7),
    Vec3::new(-0.739_085_1, 0.297_311_3, 0.604_898_6),
    Vec3::new(0.124_739_4, -0.915_965_6, 0.381_380_2),
    Vec3::new(0.345_372_9, 0.412_454_0, -0.842_976_8),
    Vec3::new(-0.661_707_1, -0.561_459_5, -0.496_917_3),
    Vec3::new(0.893_189_2, -0.261_497_2, -0.365_873_1),
];

#[derive(Default)]
struct Crossings {
    /// Number of crossings of components whose triangles are not oriented alike.
    unoriented: usize,
    /// Leaving minus entering crossings of all other components.
    signed: i64,
    uncertain: bool,
}

impl Crossings {
    fn is_inside(&self) -> bool {
        self.unoriented % 2 == 1 || self.signed != 0
    }
}

impl TriMesh {
    /// True if the point (local frame) is inside a closed component of the surface; always false for an open mesh. Hairline
    /// seams count as closed ([`MeshReport::welded`](super::MeshReport::welded)).
    ///
    /// A winding number other than zero counts as inside: components that overlap stay solid, and a cavity of the
    /// opposite orientation is free. For components whose triangles are not oriented alike, the parity of the crossings
    /// decides.
    ///
    /// ```
    /// # use elbowroom_proximity::TriMesh;
    /// # use elbowroom_spatial::Vec3;
    /// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    /// assert!(mesh.contains(Vec3::splat(0.2)) && !mesh.contains(Vec3::splat(0.4)));
    /// ```
    pub fn contains(&self, p: Vec3) -> bool {
        if !self.has_interior() || !self.aabb().contains(p) {
            return false;
        }
        let mut crossings = Crossings::default();
        for direction in RAYS {
            crossings = self.cast(p, direction);
            if !crossings.uncertain {
                return crossings.is_inside();
            }
        }
        // For components that are not oriented alike, the last ray is the best available answer.
        crossings.unoriented % 2 == 1 || self.winding_number(p).abs() > 0.5
    }

    fn cast(&self, p: Vec3, direction: Vec3) -> Crossings {
        let mut found = Crossings::default();
        self.bvh.traverse(&Ray::new(&self.bvh, p, direction), 0.0, &mut |triangle| {
            if self.in_closed_component[triangle] {
                let is_oriented = self.in_oriented_component[triangle];
                cross(self.closed_corners(triangle), p, direction, is_oriented, &mut found);
            }
            if found.uncertain { f32::NEG_INFINITY } else { 0.0 }
        });
        found
    }

    /// The sum over 4π of the solid angles of all closed components that are oriented alike (Van Oosterom and Strackee,
    /// 1983).
    fn winding_number(&self, p: Vec3) -> f64 {
        let angle = |[a, b, c]: [Vec3; 3]| {
            let (a, b, c) = (a - p, b - p, c - p);
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            let across = a.dot(b.cross(c));
            2.0 * across.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
        };
        let closed =
            (0..self.triangles().len()).filter(|&t| self.in_closed_component[t] && self.in_oriented_component[t]);
        closed.map(|t| angle(self.closed_corners(t))).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }
}

/// Ray–triangle intersection after Möller and Trumbore (1997), with a band of uncertainty around the border.
fn cross(t: [Vec3; 3], p: Vec3, direction: Vec3, is_oriented: bool, found: &mut Crossings) {
    const BAND: f64 = 1e-9;
    let (e1, e2) = (t[1] - t[0], t[2] - t[0]);
    let q = direction.cross(e2);
    let det = e1.dot(q);
    if det.abs() <= 1e-10 * e1.length() * e2.length() {
        found.uncertain |= !is_degenerate(t);
        return;
    }
    let from = p - t[0];
    let u = from.dot(q) / det;
    let r = from.cross(e1);
    let v = direction.dot(r) / det;
    let along = e2.dot(r) / det;
    let border = u.min(v).min(1.0 - u - v);
    if border < -BAND || along < 0.0 {
        return;
    }
    found.uncertain |= border < BAND;
    if is_oriented {
        found.signed += if det > 0.0 { 1 } else { -1 };
    } else {
        found.unoriented += 1;
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_testkit::random::{split_mix, unit};

    use crate::tessellate::tessellate;
    use crate::{Cuboid, Shape, TriMesh};
    use elbowroom_spatial::Vec3;

    /// A cube with a cubic cavity and some reversed triangles.
    fn hollow(flipped: &[usize]) -> TriMesh {
        let cube = |half: f64| tessellate(&Shape::Cuboid(Cuboid { half_extents: Vec3::splat(half) }), 1e-3);
        let ((mut vertices, mut triangles), (inner, faces)) = (cube(0.5), cube(0.4));
        let first = vertices.len() as u32;
        vertices.extend(inner);
        triangles.extend(faces.iter().map(|&[a, b, c]| [first + a, first + c, first + b]));
        for &t in flipped {
            triangles[t].swap(1, 2);
        }
        TriMesh::new(vertices, triangles).unwrap()
    }

    /// Any ray direction gives the same answer for all points of a region without a surface in it.
    #[test]
    fn turned_triangles_divide_no_region() {
        let mut seed = 3;
        for flipped in [&[][..], &[14], &[20], &[13, 19], &[2], &[2, 14], &[5, 7, 22]] {
            let mesh = hollow(flipped);
            let in_cavity = mesh.contains(Vec3::ZERO);
            assert!(!flipped.is_empty() || !in_cavity);
            for _ in 0..3000 {
                let mut within = || 2.0 * unit(split_mix(&mut seed)) - 1.0;
                let p = Vec3::new(within(), within(), within());
                let size = p.abs().max_element();
                if (size - 0.4).abs() > 1e-6 && (size - 0.5).abs() > 1e-6 {
                    let expected = if size < 0.4 { in_cavity } else { size < 0.5 };
                    assert_eq!(mesh.contains(p), expected, "{flipped:?} {p:?}");
                }
            }
        }
    }
}
