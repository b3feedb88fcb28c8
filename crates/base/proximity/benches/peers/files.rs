//! The shared file format: binary STL, and poses as little-endian matrices. `xtask/peers/README.md` defines it.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::surfaces::Surface;

pub type Outcome<T> = Result<T, String>;

/// Adds the file to an error.
fn in_file<T, E: std::fmt::Display>(path: &Path, result: Result<T, E>) -> Outcome<T> {
    result.map_err(|e| format!("{}: {e}", path.display()))
}

/// Poses of several bodies, record after record.
pub struct Poses {
    pub bodies: usize,
    pub poses: Vec<Pose>,
}

impl Poses {
    pub fn len(&self) -> usize {
        self.poses.len() / self.bodies
    }

    /// All bodies of one record.
    pub fn record(&self, i: usize) -> &[Pose] {
        &self.poses[i * self.bodies..][..self.bodies]
    }
}

/// A surface with its coordinates rounded to single precision, as in a file.
pub fn rounded(surface: &Surface) -> Outcome<TriMesh> {
    let single = |x: f64| f64::from(x as f32);
    let vertices = surface.0.iter().map(|v| Vec3::new(single(v.x), single(v.y), single(v.z))).collect();
    TriMesh::new(vertices, surface.1.clone()).map_err(|e| e.to_string())
}

pub fn write_mesh(path: &Path, mesh: &TriMesh) -> Outcome<()> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|i| mesh.vertices()[i as usize]);
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or_default();
        let numbers = [normal, a, b, c].map(|p| p.to_array().map(|x| (x as f32).to_le_bytes()));
        bytes.extend(numbers.as_flattened().as_flattened());
        bytes.extend([0, 0]);
    }
    in_file(path, fs::write(path, bytes))
}

/// Reads a mesh. Vertices with equal bits become one, as in all other runners.
pub fn read_mesh(path: &Path) -> Outcome<TriMesh> {
    let bytes = in_file(path, fs::read(path))?;
    let records = bytes.get(84..).unwrap_or_default().chunks_exact(50);
    let (mut vertices, mut triangles, mut known) = (Vec::new(), Vec::with_capacity(records.len()), HashMap::new());
    for record in records {
        triangles.push(std::array::from_fn(|corner| {
            let at = |k: usize| {
                let from = 12 + 12 * corner + 4 * k;
                f32::from_le_bytes([record[from], record[from + 1], record[from + 2], record[from + 3]])
            };
            let point = [at(0), at(1), at(2)];
            *known.entry(point.map(f32::to_bits)).or_insert_with(|| {
                vertices.push(Vec3::from(point.map(f64::from)));
                vertices.len() as u32 - 1
            })
        }));
    }
    in_file(path, TriMesh::new(vertices, triangles))
}

pub fn write_poses(path: &Path, bodies: usize, poses: &[Pose]) -> Outcome<()> {
    let mut bytes = b"POSE".to_vec();
    bytes.extend(((poses.len() / bodies) as u32).to_le_bytes());
    bytes.extend((bodies as u32).to_le_bytes());
    for pose in poses {
        let rows = pose.rotation.rows();
        let numbers = rows.as_flattened().iter().copied().chain(pose.translation.to_array());
        bytes.extend(numbers.flat_map(f64::to_le_bytes));
    }
    in_file(path, fs::write(path, bytes))
}

pub fn read_poses(path: &Path) -> Outcome<Poses> {
    let bytes = in_file(path, fs::read(path))?;
    let word = |at: usize| bytes.get(at..at + 4).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let (records, bodies) = (word(4), word(8));
    let data = bytes.get(12..).unwrap_or_default();
    if !bytes.starts_with(b"POSE") || bodies == 0 || Some(data.len()) != records.checked_mul(bodies * 96) {
        return Err(format!("{}: not POSE, two counts n and k, and n·k·12 numbers", path.display()));
    }
    let numbers: Vec<f64> = data.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let pose = |m: &[f64]| {
        let column = |k: usize| Vec3::new(m[k], m[3 + k], m[6 + k]);
        let rotation = Rotation::from_columns(column(0), column(1), column(2));
        rotation.map(|r| Pose::new(r, Vec3::new(m[9], m[10], m[11])))
    };
    let poses: Option<Vec<Pose>> = numbers.chunks_exact(12).map(pose).collect();
    Ok(Poses { bodies, poses: poses.ok_or_else(|| format!("{}: a matrix is no rotation", path.display()))? })
}

/// Writes size and tolerance of a pair of meshes, metres.
pub fn write_meta(path: &Path, size: f64, tolerance: f64) -> Outcome<()> {
    in_file(path, fs::write(path, format!("{size:?} {tolerance:?}\n")))
}

pub fn read_meta(path: &Path) -> Outcome<[f64; 2]> {
    let text = in_file(path, fs::read_to_string(path))?;
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    numbers.try_into().map_err(|_| format!("{}: not two numbers, size and tolerance", path.display()))
}
