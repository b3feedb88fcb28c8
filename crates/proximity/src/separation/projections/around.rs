//! Normals and edges of a core near one of its points.

use elbowroom_spatial::Vec3;

use crate::ConvexHull;
use crate::separation::core::Core;

/// More than meet at a corner of any usual hull; what is left out only weakens a bound.
const MOST: usize = 12;

/// Up to [`MOST`] unit vectors.
pub(super) struct Few {
    list: [Vec3; MOST],
    len: usize,
}

impl Few {
    const NONE: Self = Self { list: [Vec3::ZERO; MOST], len: 0 };

    fn push(&mut self, d: Vec3) {
        if let (Some(slot), Some(d)) = (self.list.get_mut(self.len), d.try_normalize()) {
            (*slot, self.len) = (d, self.len + 1);
        }
    }

    pub fn iter(&self) -> std::slice::Iter<'_, Vec3> {
        self.list[..self.len].iter()
    }
}

/// Directions in the core's frame; of curved surfaces the normal and the tangents at the point.
pub(super) struct Around {
    pub normals: Few,
    pub edges: Few,
}

impl Around {
    /// Faces and edges within `reach` of the point, or all where there are few.
    pub fn of(core: &Core, p: Vec3, reach: f64) -> Self {
        let mut around = Self { normals: Few::NONE, edges: Few::NONE };
        match core {
            Core::Point | Core::Points(_) => {}
            Core::Segment(_) => around.edges.push(Vec3::Z),
            Core::Cuboid(_) => {
                for e in [Vec3::X, Vec3::Y, Vec3::Z] {
                    around.normals.push(e);
                    around.edges.push(e);
                }
            }
            Core::Cylinder(_) => {
                around.normals.push(Vec3::Z);
                around.edges.push(Vec3::Z);
                around.normals.push(Vec3::new(p.x, p.y, 0.0));
                around.edges.push(Vec3::new(-p.y, p.x, 0.0));
            }
            Core::Triangle([a, b, c]) => {
                around.normals.push((*b - *a).cross(*c - *a));
                for edge in [*b - *a, *c - *b, *a - *c] {
                    around.edges.push(edge);
                }
            }
            Core::Hull(hull) => around.add_hull(hull, p, reach),
        }
        around
    }

    fn add_hull(&mut self, hull: &ConvexHull, p: Vec3, reach: f64) {
        for (normal, offset) in hull.planes() {
            if (normal.dot(p) - offset).abs() <= reach {
                self.normals.push(*normal);
            }
        }
        visit_edges(&Core::Hull(hull), p, reach, &mut |from, to| self.edges.push(to - from));
    }
}

/// The edges of a hull or a triangle that pass the point within `reach`.
pub(super) fn visit_edges(core: &Core, p: Vec3, reach: f64, found: &mut dyn FnMut(Vec3, Vec3)) {
    let mut offer = |from: Vec3, to: Vec3| {
        if (p - from).cross(to - from).length() <= reach * (to - from).length() {
            found(from, to);
        }
    };
    match core {
        Core::Hull(hull) => {
            let at = |i: u32| hull.vertices()[i as usize];
            for &[i, j, k] in hull.triangles() {
                // Each edge belongs to two faces, once in each direction.
                for (i, j) in [(i, j), (j, k), (k, i)].into_iter().filter(|(i, j)| i < j) {
                    offer(at(i), at(j));
                }
            }
        }
        Core::Triangle([a, b, c]) => [(a, b), (b, c), (c, a)].into_iter().for_each(|(p, q)| offer(*p, *q)),
        _ => {}
    }
}
