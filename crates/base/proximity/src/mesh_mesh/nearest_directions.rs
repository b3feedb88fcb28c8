//! The directions in which a point of a surface can be the nearest of its neighbourhood.
//!
//! At a corner with the edges eᵢ these are all d with d · eᵢ ≤ 0: the cone of its extreme rays, each perpendicular to two
//! of the edges. Inside a convex edge they lie between the normals of its faces. In a valley there are none.

use elbowroom_spatial::Vec3;

use super::vertex_faces::VertexFaces;
use crate::TriMesh;

/// Angle by which the surface may rise towards a direction, radians.
const RISE: f64 = 2e-3;
/// Sine of the angle between two edges below which they have no usable perpendicular.
const PARALLEL: f64 = 1e-6;
/// Most faces around a corner for which its rays are computed; beyond it, the normals of all its faces count.
const MOST_FACES: usize = 12;

/// Per corner of a mesh, the extreme rays of its directions.
pub(super) struct NearestDirections<'m> {
    mesh: &'m TriMesh,
    faces: &'m VertexFaces,
    normals: &'m [Option<Vec3>],
    /// First position in `rays` per vertex, and the end. Corners with many vertices have them at one of these.
    first: Vec<u32>,
    rays: Vec<Vec3>,
}

impl<'m> NearestDirections<'m> {
    /// Computes the rays from the normals of the triangles.
    pub fn new(mesh: &'m TriMesh, faces: &'m VertexFaces, normals: &'m [Option<Vec3>]) -> Self {
        let mut directions = Self { mesh, faces, normals, first: vec![0], rays: Vec::new() };
        for v in 0..mesh.vertices().len() as u32 {
            if faces.representative(v) == v {
                directions.add_corner(v);
            }
            directions.first.push(directions.rays.len() as u32);
        }
        directions
    }

    /// Directions whose convex cone contains all of a triangle's points.
    pub fn of_triangle(&self, triangle: usize) -> impl Iterator<Item = Vec3> + Clone + '_ {
        let corners = self.mesh.triangles()[triangle];
        let at_corners = corners.into_iter().flat_map(|v| {
            let v = self.faces.representative(v) as usize;
            &self.rays[self.first[v] as usize..self.first[v + 1] as usize]
        });
        let across = (0..3).flat_map(move |k| self.across_edge(triangle, corners[k], corners[(k + 1) % 3]));
        self.normals[triangle].into_iter().chain(across).chain(at_corners.copied())
    }

    /// Normals of the triangles across an edge that is not a valley.
    fn across_edge(&self, triangle: usize, from: u32, to: u32) -> impl Iterator<Item = Vec3> + Clone + '_ {
        let is_other = move |t: &&u32| **t as usize != triangle && self.faces.around(to).contains(t);
        let (origin, normal) = (self.mesh.vertices()[from as usize], self.normals[triangle].unwrap_or(Vec3::ZERO));
        let falls = move |t: &&u32| {
            let recedes = |x: Vec3| normal.dot(x - origin) <= RISE * (x - origin).length();
            self.mesh.corners(**t as usize).into_iter().all(recedes)
        };
        self.faces.around(from).iter().filter(is_other).filter(falls).filter_map(|&t| self.normals[t as usize])
    }

    fn add_corner(&mut self, vertex: u32) {
        let faces = self.faces.around(vertex);
        let normals = faces.iter().filter_map(|&t| self.normals[t as usize]);
        if faces.len() > MOST_FACES {
            self.rays.extend(normals);
            return;
        }
        let place = self.mesh.vertices()[vertex as usize];
        let mut edges: Vec<Vec3> = Vec::with_capacity(2 * faces.len());
        for corner in faces.iter().flat_map(|&t| self.mesh.corners(t as usize)) {
            if let Some(edge) = (corner - place).try_normalize().filter(|edge| !edges.contains(edge)) {
                edges.push(edge);
            }
        }
        for (i, a) in edges.iter().enumerate() {
            for b in &edges[i + 1..] {
                let across = a.cross(*b);
                let Some(ray) = across.try_normalize().filter(|_| across.length() > PARALLEL) else { continue };
                let is_ray = |d: &Vec3| {
                    edges.iter().all(|edge| d.dot(*edge) <= RISE) && normals.clone().any(|normal| normal.dot(*d) > 0.0)
                };
                self.rays.extend([ray, -ray].into_iter().filter(is_ray));
            }
        }
    }
}
