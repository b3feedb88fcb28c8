//! Triangles around each vertex, and the test that a point of the surface is the nearest of its neighbourhood.

use elbowroom_spatial::Vec3;

use crate::TriMesh;
use crate::shape::topology::components;
use crate::triangle::nearest_on_segment;

/// The triangles around each vertex. Vertices that represent the same corner count as one.
#[derive(Debug, Clone)]
pub(super) struct VertexFaces {
    /// The representative of each vertex.
    welded: Vec<u32>,
    /// First position in `faces` per representative, and the end.
    first: Vec<u32>,
    faces: Vec<u32>,
}

impl VertexFaces {
    pub fn new(mesh: &TriMesh) -> Self {
        let welded = mesh.welded_vertices();
        let mut first = vec![0_u32; mesh.vertices().len() + 1];
        let corners = || mesh.triangles().iter().enumerate().flat_map(|(t, corners)| corners.map(|v| (t, v)));
        for (_, v) in corners() {
            first[welded[v as usize] as usize + 1] += 1;
        }
        for v in 1..first.len() {
            first[v] += first[v - 1];
        }
        let (mut next, mut faces) = (first.clone(), vec![0; 3 * mesh.triangles().len()]);
        for (t, v) in corners() {
            let slot = &mut next[welded[v as usize] as usize];
            faces[*slot as usize] = t as u32;
            *slot += 1;
        }
        Self { welded, first, faces }
    }

    /// The vertex that represents this one.
    pub fn representative(&self, vertex: u32) -> u32 {
        self.welded[vertex as usize]
    }

    /// The triangles around the vertex that represents this one.
    pub fn around(&self, vertex: u32) -> &[u32] {
        let v = self.welded[vertex as usize] as usize;
        &self.faces[self.first[v] as usize..self.first[v + 1] as usize]
    }

    /// True if a corner of a triangle is represented by a vertex at another place.
    pub fn is_welded(&self, mesh: &TriMesh, triangle: usize) -> bool {
        let place = |v: u32| mesh.vertices()[v as usize];
        mesh.triangles()[triangle].iter().any(|&v| place(self.welded[v as usize]) != place(v))
    }

    /// The root vertex of the connected part of each triangle.
    pub fn parts(&self, mesh: &TriMesh) -> Vec<u32> {
        let faces: Vec<[u32; 3]> = mesh.triangles().iter().map(|t| t.map(|v| self.welded[v as usize])).collect();
        let part_of = components(self.welded.len(), &faces);
        faces.iter().map(|face| part_of[face[0] as usize]).collect()
    }

    /// The triangles that share a corner with one, some of them twice.
    pub fn neighbours<'a>(&'a self, mesh: &'a TriMesh, triangle: usize) -> impl Iterator<Item = usize> + Clone + 'a {
        mesh.triangles()[triangle].iter().flat_map(|&v| self.around(v)).map(|&t| t as usize)
    }

    /// True if the surface goes nowhere from this point of a triangle towards `direction` (unit vector), up to
    /// `tolerance` (rad): the point is the nearest of its neighbourhood for whatever lies in that direction.
    ///
    /// Inside a face that is so for the nearest point of the face; on an edge and at a corner the triangles around it
    /// decide. `size` is the largest distance (m) that counts as none.
    pub fn is_nearest_around(
        &self,
        mesh: &TriMesh,
        triangle: u32,
        (point, direction): (Vec3, Vec3),
        tolerance: f64,
        size: f64,
    ) -> bool {
        let vertices = mesh.triangles()[triangle as usize];
        let corners = mesh.corners(triangle as usize);
        let recedes = |x: Vec3| {
            let offset = x - point;
            offset.dot(direction) <= tolerance * offset.length() + size
        };
        let all_recede = |t: u32| mesh.corners(t as usize).into_iter().all(recedes);
        if let Some(k) = (0..3).find(|&k| corners[k].distance(point) <= size) {
            return self.around(vertices[k]).iter().all(|&t| all_recede(t));
        }
        let on_edge = |k: usize| {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            nearest_on_segment(point, from, to).distance(point) <= size
        };
        let Some(k) = (0..3).find(|&k| on_edge(k)) else { return true };
        let (from, to) = (vertices[k], vertices[(k + 1) % 3]);
        let at_both = |t: &&u32| self.around(to).contains(t);
        self.around(from).iter().filter(at_both).all(|&t| all_recede(t))
    }
}
