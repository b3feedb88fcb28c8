//! Triangles of several solids, divided into groups of limited size.

use std::collections::HashMap;
use std::sync::Arc;

use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::solid_pieces::{MAX_PIECES, SolidPiece};

/// Largest number of triangles after long ones are split.
const MAX_TRIANGLES: usize = 1 << 20;

/// Surfaces of flat-sided solids.
#[derive(Debug, Default)]
pub(super) struct TriangleSoup {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl TriangleSoup {
    pub fn add(&mut self, mesh: &TriMesh, placed: &Pose) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(mesh.vertices().iter().map(|v| placed.transform_point(*v)));
        self.triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + first)));
    }

    /// Distance of the farthest vertex from the origin, m.
    pub fn reach(&self) -> f64 {
        self.vertices.iter().map(|v| v.length()).fold(0.0, f64::max)
    }

    /// Splits the soup into pieces of about this radius; `None` if a coordinate is not finite.
    pub fn split(mut self, size: f64) -> Option<Vec<SolidPiece>> {
        if self.triangles.is_empty() {
            return Some(Vec::new());
        }
        self.split_long_triangles(1.5 * size);
        let mut groups = vec![TriangleGroup::new(&self, (0..self.triangles.len() as u32).collect())];
        while groups.len() < MAX_PIECES {
            let largest = (0..groups.len()).max_by(|&a, &b| groups[a].size.total_cmp(&groups[b].size))?;
            if groups[largest].size <= 2.0 * size {
                break;
            }
            match groups.swap_remove(largest).halves(&self) {
                Ok(halves) => groups.extend(halves),
                // Size 0: a group that cannot be divided is not tried again.
                Err(group) => groups.push(TriangleGroup { size: 0.0, ..group }),
            }
        }
        groups.iter().map(|group| group.piece(&self)).collect()
    }

    /// Bisects triangles across edges that are too long.
    fn split_long_triangles(&mut self, longest: f64) {
        let mut open = std::mem::take(&mut self.triangles);
        while let Some(t) = open.pop() {
            let edge = |i: usize| self.vertices[t[i] as usize].distance(self.vertices[t[(i + 1) % 3] as usize]);
            let long = (0..3).max_by(|&a, &b| edge(a).total_cmp(&edge(b))).unwrap_or(0);
            // A comparison with NaN is false.
            if edge(long) > longest && self.triangles.len() + open.len() < MAX_TRIANGLES {
                let [a, b, c] = [t[long], t[(long + 1) % 3], t[(long + 2) % 3]];
                let middle = self.vertices.len() as u32;
                self.vertices.push((self.vertices[a as usize] + self.vertices[b as usize]) * 0.5);
                open.extend([[a, middle, c], [middle, b, c]]);
            } else {
                self.triangles.push(t);
            }
        }
    }

    fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.vertices[v as usize])
    }
}

/// Some triangles of a soup.
struct TriangleGroup {
    triangles: Vec<u32>,
    bounds: Aabb,
    /// Length of the bounds' diagonal.
    size: f64,
}

impl TriangleGroup {
    fn new(soup: &TriangleSoup, triangles: Vec<u32>) -> Self {
        let bounds = Aabb::from_points(triangles.iter().flat_map(|&t| soup.corners(t)));
        Self { triangles, size: bounds.extent().length(), bounds }
    }

    /// Bisects the group across the longest side of its bounds; unchanged if all triangles are on one side.
    fn halves(self, soup: &TriangleSoup) -> Result<[Self; 2], Self> {
        let extent = self.bounds.extent().to_array();
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        let middle = 3.0 * self.bounds.center()[axis];
        let is_low = |t: &u32| soup.corners(*t).iter().map(|p| p[axis]).sum::<f64>() < middle;
        let (low, high): (Vec<u32>, Vec<u32>) = self.triangles.iter().partition(|t| is_low(t));
        if low.is_empty() || high.is_empty() {
            return Err(self);
        }
        Ok([Self::new(soup, low), Self::new(soup, high)])
    }

    fn piece(&self, soup: &TriangleSoup) -> Option<SolidPiece> {
        let mut known = HashMap::new();
        let mut vertices = Vec::new();
        let mut number = |v: u32| {
            *known.entry(v).or_insert_with(|| {
                vertices.push(soup.vertices[v as usize]);
                vertices.len() as u32 - 1
            })
        };
        let triangles = self.triangles.iter().map(|&t| soup.triangles[t as usize].map(&mut number)).collect();
        let mesh = TriMesh::new(vertices, triangles).ok()?;
        Some(SolidPiece::new(Shape::Mesh(Arc::new(mesh))))
    }
}
