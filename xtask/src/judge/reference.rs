//! The same pairs of the same triangles by Pinocchio and Coal, in a Python of their own.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use elbowroom_proximity::Shape;
use elbowroom_scene::{Member, Scene};
use elbowroom_spatial::Pose;

use super::world;

/// What they say.
pub struct Answers {
    /// States by pairs of bodies, metres.
    pub distances: Vec<f64>,
    /// Per state.
    pub collides: Vec<bool>,
    /// µs per state.
    pub distance_us: f64,
    /// µs per state.
    pub collide_us: f64,
    /// The members that each pair of bodies belongs to.
    pub pairs: Vec<(Member, Member)>,
}

/// Asks for every pair of bodies of the `pairs` of members.
pub fn ask(
    python: &Path,
    folder: &Path,
    urdf: &Path,
    scene: &Scene,
    states: &[Vec<f64>],
    pairs: &[(Member, Member)],
) -> Result<Answers, String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (text, binary, pairs) = job(urdf, scene, states, pairs)?;
    let path = |name: &str| folder.join(name);
    let write = |name, bytes: &[u8]| std::fs::write(path(name), bytes).map_err(|e| format!("{name}: {e}"));
    write("job.txt", text.as_bytes())?;
    write("job.bin", &binary)?;
    write("pin_coal.py", include_bytes!("pin_coal.py"))?;
    let output = Command::new(python).arg(path("pin_coal.py")).arg(folder).output();
    let output = output.map_err(|e| format!("cannot start {}: {e}", python.display()))?;
    if !output.status.success() {
        return Err(format!("the reference failed: {}", String::from_utf8_lossy(&output.stderr)));
    }
    let times: Vec<f64> =
        String::from_utf8_lossy(&output.stdout).split_whitespace().filter_map(|w| w.parse().ok()).collect();
    let [distance_us, collide_us] = times[..] else { return Err("the reference told no times".into()) };
    let read = |name: &str| std::fs::read(path(name)).map_err(|e| format!("{name}: {e}"));
    let distances: Vec<f64> =
        read("distances.bin")?.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let collides: Vec<bool> = read("collides.bin")?.iter().map(|b| *b != 0).collect();
    if distances.len() != states.len() * pairs.len() || collides.len() != states.len() {
        return Err("the reference told fewer answers than were asked for".into());
    }
    Ok(Answers { distances, collides, distance_us, collide_us, pairs })
}

type Job = (String, Vec<u8>, Vec<(Member, Member)>);

fn job(urdf: &Path, scene: &Scene, states: &[Vec<f64>], pairs: &[(Member, Member)]) -> Result<Job, String> {
    let chain = &scene.robots()[0].robot.chain;
    let joints: Vec<&str> = chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str()).collect();
    let mut text = format!("urdf\t{}\njoints\t{}\nstates\t{}\n", urdf.display(), joints.join("\t"), states.len());
    let mut binary: Vec<u8> = states.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let mut first = Vec::new();
    let mut count = 0;
    for member in scene.members() {
        let bodies = world::bodies(scene, member);
        first.push((member, count..count + bodies.len()));
        count += bodies.len();
        for body in bodies {
            let pose = if let Member::Object(o) = member { scene.objects()[o].in_world } else { body.in_link };
            geometry(&mut text, &mut binary, &world::link_name(scene, member), &body.shape, &pose)?;
        }
    }
    let of = |member| first.iter().find(|(m, _)| *m == member).map_or(0..0, |(_, range)| range.clone());
    let mut of_bodies = Vec::new();
    for &(a, b) in pairs {
        for (i, j) in of(a).flat_map(|i| of(b).map(move |j| (i, j))) {
            let _ = writeln!(text, "pair\t{i}\t{j}");
            of_bodies.push((a, b));
        }
    }
    Ok((text, binary, of_bodies))
}

fn geometry(text: &mut String, binary: &mut Vec<u8>, link: &str, shape: &Shape, pose: &Pose) -> Result<(), String> {
    let what = match shape {
        Shape::Cuboid(c) => {
            let [x, y, z] = (c.half_extents * 2.0).to_array();
            format!("box\t{x:?}\t{y:?}\t{z:?}")
        }
        Shape::Sphere(s) => format!("sphere\t{:?}", s.radius),
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
