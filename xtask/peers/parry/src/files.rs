//! Readers of the shared file format. A file that cannot be read ends the program; the calling program reports it.

use std::collections::HashMap;
use std::path::Path;

use parry3d_f64::math::{Matrix, Pose, Rotation, Vector};
use parry3d_f64::shape::TriMesh;

pub struct Poses {
    bodies: usize,
    poses: Vec<Pose>,
}

impl Poses {
    pub fn records(&self) -> usize {
        self.poses.len() / self.bodies
    }

    pub fn record(&self, i: usize) -> &[Pose] {
        &self.poses[i * self.bodies..][..self.bodies]
    }

    pub fn one(&self, i: usize) -> &Pose {
        &self.poses[i]
    }

    /// Pose of the second body in the frame of the first.
    pub fn between(&self, i: usize) -> Pose {
        self.poses[2 * i].inv_mul(&self.poses[2 * i + 1])
    }
}

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Reads a mesh. Vertices with equal bits are merged.
pub fn read_mesh(path: &Path) -> TriMesh {
    let bytes = read(path);
    let (mut vertices, mut triangles, mut known) = (Vec::new(), Vec::new(), HashMap::new());
    for record in bytes[84..].chunks_exact(50) {
        let floats: Vec<f32> = record[12..48].as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        triangles.push(std::array::from_fn(|corner| {
            let p = [floats[3 * corner], floats[3 * corner + 1], floats[3 * corner + 2]];
            *known.entry(p.map(f32::to_bits)).or_insert_with(|| {
                vertices.push(Vector::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2])));
                vertices.len() as u32 - 1
            })
        }));
    }
    TriMesh::new(vertices, triangles).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

pub fn read_poses(path: &Path) -> Poses {
    let bytes = read(path);
    let bodies = u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]) as usize;
    let numbers: Vec<f64> = bytes[12..].as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let pose = |m: &[f64]| {
        let column = |k: usize| Vector::new(m[k], m[3 + k], m[6 + k]);
        let rotation = Rotation::from_mat3(&Matrix::from_cols(column(0), column(1), column(2)));
        Pose::from_parts(Vector::new(m[9], m[10], m[11]), rotation)
    };
    Poses { bodies, poses: numbers.chunks_exact(12).map(pose).collect() }
}

/// Reads size and tolerance, m.
pub fn read_meta(path: &Path) -> [f64; 2] {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut numbers = text.split_whitespace().filter_map(|word| word.parse().ok());
    [(); 2].map(|()| numbers.next().unwrap_or_else(|| panic!("{}: not two numbers", path.display())))
}
