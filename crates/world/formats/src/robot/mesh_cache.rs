//! The meshes of a robot: each file is read once, in parallel.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::LengthUnit;
use rayon::prelude::*;

use crate::mesh;
use crate::mesh_data::{MeshData, UpAxis};
use crate::resolve::{Unresolved, resolve};
use crate::urdf::{Geometry, LinkGeometry};
use crate::{Diagnostic, input};

/// The meshes of one file at one scale, with the names of its objects.
pub(super) type TriMeshes = Arc<Vec<(String, Arc<TriMesh>)>>;

type Scale = [u64; 3];
type Loaded = Result<(HashMap<Scale, TriMeshes>, Vec<Diagnostic>), Diagnostic>;

pub(super) struct MeshCache {
    /// Per reference as written: its file.
    paths: HashMap<String, Result<PathBuf, Unresolved>>,
    files: HashMap<PathBuf, Loaded>,
}

impl MeshCache {
    /// Loads all meshes of the geometries. The result does not depend on the number of threads.
    pub(super) fn load<'a>(
        meshes: impl Iterator<Item = &'a LinkGeometry>,
        base: &Path,
        unit: Option<LengthUnit>,
    ) -> Self {
        let mut paths = HashMap::new();
        let mut scales_of: HashMap<PathBuf, Vec<Vec3>> = HashMap::new();
        for tri_mesh in meshes {
            let Geometry::Mesh { filename, scale } = &tri_mesh.geometry else { continue };
            let path = paths.entry(filename.clone()).or_insert_with(|| resolve(filename, base));
            if let Ok(path) = path {
                let scales = scales_of.entry(path.clone()).or_default();
                if !scales.contains(scale) {
                    scales.push(*scale);
                }
            }
        }
        Self { paths, files: load_files(scales_of, unit) }
    }

    /// The file of a reference in one of the geometries.
    pub(super) fn path(&self, filename: &str) -> Result<&Path, Unresolved> {
        let path = self.paths.get(filename).map(|path| path.as_deref().map_err(Clone::clone));
        path.unwrap_or(Err(Unresolved::NotLoaded))
    }

    /// The meshes of a file, and on the first call its warnings.
    pub(super) fn meshes(&mut self, path: &Path, scale: Vec3) -> Result<(TriMeshes, Vec<Diagnostic>), Diagnostic> {
        let missing = || Diagnostic::new(path, None, "was not loaded");
        match self.files.get_mut(path) {
            Some(Ok((by_scale, warnings))) => {
                let meshes = by_scale.get(&key(scale)).ok_or_else(missing)?;
                Ok((Arc::clone(meshes), std::mem::take(warnings)))
            }
            Some(Err(e)) => Err(e.clone()),
            None => Err(missing()),
        }
    }
}

fn key(scale: Vec3) -> Scale {
    scale.to_array().map(f64::to_bits)
}

fn load_files(scales_of: HashMap<PathBuf, Vec<Vec3>>, unit: Option<LengthUnit>) -> HashMap<PathBuf, Loaded> {
    let mut jobs: Vec<_> = scales_of.into_iter().collect();
    // A hash map has no order. Sorting by size spreads large files over the threads.
    jobs.sort_by_cached_key(|(path, _)| std::cmp::Reverse(std::fs::metadata(path).map_or(0, |m| m.len())));
    let load = |(path, scales): (PathBuf, Vec<Vec3>)| {
        let loaded = load_file(&path, &scales, unit);
        (path, loaded)
    };
    jobs.into_par_iter().with_max_len(1).map(load).collect()
}

fn load_file(path: &Path, scales: &[Vec3], unit: Option<LengthUnit>) -> Loaded {
    let loaded = mesh::parse(&input::read(path)?, path, unit, UpAxis::Ignore)?;
    let mut by_scale = HashMap::new();
    for scale in scales {
        let meshes = loaded.meshes.iter().map(|mesh| tri_mesh(mesh.clone(), *scale, path)).collect::<Result<_, _>>()?;
        by_scale.insert(key(*scale), Arc::new(meshes));
    }
    Ok((by_scale, loaded.warnings))
}

fn tri_mesh(mut mesh: MeshData, scale: Vec3, path: &Path) -> Result<(String, Arc<TriMesh>), Diagnostic> {
    if scale != Vec3::splat(1.0) {
        mesh.scale(scale);
    }
    Ok((mesh.name.clone(), Arc::new(mesh.into_trimesh(path)?)))
}
