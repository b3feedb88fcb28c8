//! Normals and edges of a core near a point.

use elbowroom_spatial::Vec3;

use crate::ConvexHull;
use crate::separation::core::Core;

/// Largest number of vectors: more than meet at a corner of any usual hull. Omitting some only weakens a bound.
const CAPACITY: usize = 12;

/// Up to [`CAPACITY`] unit vectors.
pub(super) struct UnitVectors {
    list: [Vec3; CAPACITY],
    len: usize,
}

impl UnitVectors {
    const EMPTY: Self = Self { list: [Vec3::ZERO; CAPACITY], len: 0 };

    fn push(&mut self, d: Vec3) {
        if let (Some(slot), Some(d)) = (self.list.get_mut(self.len), d.try_normalize()) {
            (*slot, self.len) = (d, self.len + 1);
        }
    }

    pub fn iter(&self) -> std::slice::Iter<'_, Vec3> {
        self.list[..self.len].iter()
    }
}

/// Directions in the core's frame; for curved surfaces the normal and the tangents at the point.
pub(super) struct LocalFeatures {
    pub normals: UnitVectors,
    pub edges: UnitVectors,
}

impl LocalFeatures {
    /// Faces and edges within `reach` of the point, or all of them if they are few.
    pub fn of(core: &Core, p: Vec3, reach: f64) -> Self {
        let mut found = Self { normals: UnitVectors::EMPTY, edges: UnitVectors::EMPTY };
        match core {
            Core::Point | Core::Points(_) => {}
            Core::Segment(_) => found.edges.push(Vec3::Z),
            Core::Cuboid(_) => {
                for e in [Vec3::X, Vec3::Y, Vec3::Z] {
                    found.normals.push(e);
                    found.edges.push(e);
                }
            }
            Core::Cylinder(_) => {
                found.normals.push(Vec3::Z);
                found.edges.push(Vec3::Z);
                found.normals.push(Vec3::new(p.x, p.y, 0.0));
                found.edges.push(Vec3::new(-p.y, p.x, 0.0));
            }
            Core::Triangle([a, b, c]) => {
                found.normals.push((*b - *a).cross(*c - *a));
                for edge in [*b - *a, *c - *b, *a - *c] {
                    found.edges.push(edge);
                }
            }
            Core::Hull(hull) => found.add_hull(hull, p, reach),
        }
        found
    }

    fn add_hull(&mut self, hull: &ConvexHull, p: Vec3, reach: f64) {
        for (normal, offset) in hull.planes() {
            if (normal.dot(p) - offset).abs() <= reach {
                self.normals.push(*normal);
            }
        }
        for_each_edge(&Core::Hull(hull), p, reach, &mut |from, to| self.edges.push(to - from));
    }
}

/// Calls `found` with the edges of a hull or a triangle that pass the point within `reach`.
pub(super) fn for_each_edge(core: &Core, p: Vec3, reach: f64, found: &mut dyn FnMut(Vec3, Vec3)) {
    let mut offer = |from: Vec3, to: Vec3| {
        if (p - from).cross(to - from).length() <= reach * (to - from).length() {
            found(from, to);
        }
    };
    match core {
        Core::Hull(hull) => {
            let at = |i: u32| hull.vertices()[i as usize];
            for &[i, j, k] in hull.triangles() {
                // Each edge belongs to two faces, with one direction in each.
                for (i, j) in [(i, j), (j, k), (k, i)].into_iter().filter(|(i, j)| i < j) {
                    offer(at(i), at(j));
                }
            }
        }
        Core::Triangle([a, b, c]) => [(a, b), (b, c), (c, a)].into_iter().for_each(|(p, q)| offer(*p, *q)),
        _ => {}
    }
}
