//! All meshes of a robot, each file read once, on all cores.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::LengthUnit;

use crate::mesh::{self, MeshData, UpAxis};
use crate::urdf::{Geometry, Solid};
use crate::{FormatError, Warning, resolve, source};

/// Solids of one mesh file at one scale, with the names of its objects.
pub(super) type Solids = Arc<Vec<(String, Arc<TriMesh>)>>;

type Scale = [u64; 3];
type Loaded = Result<(HashMap<Scale, Solids>, Vec<Warning>), FormatError>;

pub(super) struct Meshes {
    /// By the reference as written: its file, or where it was looked for.
    paths: HashMap<String, Result<PathBuf, String>>,
    files: HashMap<PathBuf, Loaded>,
}

impl Meshes {
    /// Loads everything that the solids name. Which thread reads which file changes nothing in the result.
    pub(super) fn load<'a>(solids: impl Iterator<Item = &'a Solid>, base: &Path, unit: Option<LengthUnit>) -> Self {
        let mut paths: HashMap<String, Result<PathBuf, String>> = HashMap::new();
        let mut wanted: HashMap<PathBuf, Vec<Vec3>> = HashMap::new();
        for solid in solids {
            let Geometry::Mesh { filename, scale } = &solid.geometry else { continue };
            let path = paths.entry(filename.clone()).or_insert_with(|| resolve::resolve(filename, base));
            if let Ok(path) = path {
                let scales = wanted.entry(path.clone()).or_default();
                if !scales.contains(scale) {
                    scales.push(*scale);
                }
            }
        }
        Self { paths, files: load_files(wanted, unit) }
    }

    pub(super) fn path(&self, filename: &str) -> Result<&Path, String> {
        match self.paths.get(filename) {
            Some(Ok(path)) => Ok(path),
            Some(Err(why)) => Err(why.clone()),
            None => Err("it was not asked for".into()),
        }
    }

    /// The solids of a file, and its warnings the first time.
    pub(super) fn solids(&mut self, path: &Path, scale: Vec3) -> Result<(Solids, Vec<Warning>), FormatError> {
        let missing = || FormatError::new(path, None, "was not loaded");
        match self.files.get_mut(path) {
            Some(Ok((by_scale, warnings))) => {
                let solids = by_scale.get(&key(scale)).ok_or_else(missing)?;
                Ok((Arc::clone(solids), std::mem::take(warnings)))
            }
            Some(Err(e)) => Err(e.clone()),
            None => Err(missing()),
        }
    }
}

fn key(scale: Vec3) -> Scale {
    scale.to_array().map(f64::to_bits)
}

fn load_files(wanted: HashMap<PathBuf, Vec<Vec3>>, unit: Option<LengthUnit>) -> HashMap<PathBuf, Loaded> {
    let mut jobs: Vec<_> = wanted.into_iter().collect();
    // The largest is taken first, so that no thread is left alone with it at the end.
    jobs.sort_by_cached_key(|(path, _)| std::fs::metadata(path).map_or(0, |m| m.len()));
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(jobs.len()).min(8);
    let (jobs, files) = (Mutex::new(jobs), Mutex::new(HashMap::new()));
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((path, scales)) = jobs.lock().ok().and_then(|mut jobs| jobs.pop()) {
                    let loaded = load_file(&path, &scales, unit);
                    if let Ok(mut files) = files.lock() {
                        files.insert(path, loaded);
                    }
                }
            });
        }
    });
    files.into_inner().unwrap_or_default()
}

fn load_file(path: &Path, scales: &[Vec3], unit: Option<LengthUnit>) -> Loaded {
    let loaded = mesh::parse(&source::read(path)?, path, unit, UpAxis::Ignore)?;
    let mut by_scale = HashMap::new();
    for scale in scales {
        let solids = loaded.meshes.iter().map(|mesh| solid(mesh.clone(), *scale, path)).collect::<Result<_, _>>()?;
        by_scale.insert(key(*scale), Arc::new(solids));
    }
    Ok((by_scale, loaded.warnings))
}

fn solid(mut mesh: MeshData, scale: Vec3, path: &Path) -> Result<(String, Arc<TriMesh>), FormatError> {
    if scale != Vec3::splat(1.0) {
        mesh.scale(scale);
    }
    Ok((mesh.name.clone(), Arc::new(mesh.into_trimesh(path)?)))
}
