//! Queries of the same pairs of the same triangles by Pinocchio and Coal, in a separate Python.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use elbowroom_proximity::Shape;
use elbowroom_robot::GeometryId;
use elbowroom_scene::Scene;
use elbowroom_spatial::Pose;

use super::world;

/// Answers of the reference.
pub struct Answers {
    /// Least distance over all pairs, per state, m.
    pub least: Vec<f64>,
    /// Whether anything collides, per state.
    pub collides: Vec<bool>,
    /// Number of pairs of colliders.
    pub pairs: usize,
    /// Time per state of `computeDistances`, µs, over the first [`WHOLE`] states.
    pub distance_us: f64,
    /// Time per state of `computeCollisions`, µs, over the first [`WHOLE`] states.
    pub collide_us: f64,
    /// Time per state of the least distance with a bound passed from pair to pair, in a loop in Python, µs, over all
    /// states.
    pub bounded_us: f64,
}

/// Number of states in which `computeDistances` also measures every pair completely: for its time, and to compare the
/// least distance with a bound against the least of all.
pub const WHOLE: usize = 200;

/// The script.
pub const SCRIPT: &[u8] = include_bytes!("pin_coal.py");

/// Largest relative change of a least distance by the bound: only rounding.
const BOUNDED: f64 = 1e-12;

/// Queries every pair of colliders of the `pairs` of geometries. If `known` gives the least distance of the pairs
/// without an object per state, only the other pairs are measured.
pub fn query_reference(
    python: &Path,
    folder: &Path,
    urdf: &Path,
    scene: &Scene,
    states: &[Vec<f64>],
    pairs: &[(GeometryId, GeometryId)],
    known: Option<&[f64]>,
) -> Result<Answers, String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (text, binary, pairs) = job(urdf, scene, states, pairs, known.is_some())?;
    let path = |name: &str| folder.join(name);
    let write = |name, bytes: &[u8]| std::fs::write(path(name), bytes).map_err(|e| format!("{name}: {e}"));
    write("job.txt", text.as_bytes())?;
    write("job.bin", &binary)?;
    write("pin_coal.py", SCRIPT)?;
    let known: Option<Vec<u8>> = known.map(|gaps| gaps.iter().flat_map(|gap| gap.to_le_bytes()).collect());
    match known {
        Some(bytes) => write("known.bin", &bytes)?,
        None => drop(std::fs::remove_file(path("known.bin"))),
    }
    let output = Command::new(python).arg(path("pin_coal.py")).arg(folder).output();
    let output = output.map_err(|e| format!("cannot start {}: {e}", python.display()))?;
    if !output.status.success() {
        return Err(format!("the reference failed: {}", String::from_utf8_lossy(&output.stderr)));
    }
    let times: Vec<f64> =
        String::from_utf8_lossy(&output.stdout).split_whitespace().filter_map(|w| w.parse().ok()).collect();
    let [distance_us, collide_us, bounded_us] = times[..] else { return Err("the reference printed no times".into()) };
    let read = |name: &str| std::fs::read(path(name)).map_err(|e| format!("{name}: {e}"));
    let numbers = |name: &str| -> Result<Vec<f64>, String> {
        Ok(read(name)?.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
    };
    let (least, whole) = (numbers("least.bin")?, numbers("whole.bin")?);
    let collides: Vec<bool> = read("collides.bin")?.iter().map(|b| *b != 0).collect();
    if [least.len(), collides.len()] != [states.len(); 2] || whole.len() != states.len().min(WHOLE) {
        return Err("the reference printed fewer answers than were requested".into());
    }
    same(&least, &whole)?;
    Ok(Answers { least, collides, pairs, distance_us, collide_us, bounded_us })
}

/// Returns an error if the least distance with a bound is not the least of all.
fn same(least: &[f64], whole: &[f64]) -> Result<(), String> {
    let apart = |(bounded, all): (&f64, &f64)| (bounded.max(0.0) - all.max(0.0)).abs() > BOUNDED * all.abs();
    match least.iter().zip(whole).position(apart) {
        None => Ok(()),
        Some(i) => {
            Err(format!("state {i}: the reference says {:e} m by a bound and {:e} m without", least[i], whole[i]))
        }
    }
}

/// Text, numbers, and number of pairs of colliders.
pub type Job = (String, Vec<u8>, usize);

pub fn job(
    urdf: &Path,
    scene: &Scene,
    states: &[Vec<f64>],
    pairs: &[(GeometryId, GeometryId)],
    objects_only: bool,
) -> Result<Job, String> {
    let chain = &scene.robots()[0].robot.chain;
    let joints: Vec<&str> = chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str()).collect();
    let (urdf, joints) = (urdf.display(), joints.join("\t"));
    let mut text = format!("urdf\t{urdf}\njoints\t{joints}\nstates\t{}\nwhole\t{WHOLE}\n", states.len());
    let mut binary: Vec<u8> = states.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let mut first = Vec::new();
    let mut count = 0;
    for id in scene.geometries() {
        let colliders = world::colliders(scene, id);
        first.push((id, count..count + colliders.len()));
        count += colliders.len();
        for collider in colliders {
            let pose = if let GeometryId::Object(o) = id { scene.objects()[o.0].in_world } else { collider.in_link };
            geometry(&mut text, &mut binary, &world::link_name(scene, id), &collider.shape, &pose)?;
        }
    }
    let of = |id| first.iter().find(|(m, _)| *m == id).map_or(0..0, |(_, range)| range.clone());
    let mut collider_pairs = 0;
    for &(a, b) in pairs {
        let requested = !objects_only || [a, b].iter().any(|m| matches!(m, GeometryId::Object(_)));
        for (i, j) in of(a).flat_map(|i| of(b).map(move |j| (i, j))) {
            let _ = writeln!(text, "pair\t{i}\t{j}\t{}", u8::from(requested));
            collider_pairs += 1;
        }
    }
    Ok((text, binary, collider_pairs))
}

fn geometry(text: &mut String, binary: &mut Vec<u8>, link: &str, shape: &Shape, pose: &Pose) -> Result<(), String> {
    let what = match shape {
        Shape::Cuboid(c) => {
            let [x, y, z] = (c.half_extents * 2.0).to_array();
            format!("box\t{x:?}\t{y:?}\t{z:?}")
        }
        Shape::Sphere(s) => format!("sphere\t{:?}", s.radius),
        Shape::Capsule(c) => format!("capsule\t{:?}\t{:?}", c.radius, c.half_length * 2.0),
        Shape::Cylinder(c) => format!("cylinder\t{:?}\t{:?}", c.radius, c.half_length * 2.0),
        Shape::Mesh(mesh) => {
            binary.extend(mesh.vertices().iter().flat_map(|v| v.to_array()).flat_map(f64::to_le_bytes));
            binary.extend(mesh.triangles().iter().flatten().flat_map(|i| i.to_le_bytes()));
            format!("mesh\t{}\t{}", mesh.vertices().len(), mesh.triangles().len())
        }
        other => return Err(format!("no counterpart of a {} in the reference", other.kind())),
    };
    let _ = write!(text, "geometry\t{link}\t{what}");
    for number in pose.to_rows().as_flattened() {
        let _ = write!(text, "\t{number:?}");
    }
    text.push('\n');
    Ok(())
}
