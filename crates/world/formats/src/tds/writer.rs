//! Writer of trees as 3DS files.

use std::path::Path;

use elbowroom_spatial::{Pose, Vec3};

use super::track::FRAMES_PER_SECOND;
use crate::Diagnostic;
use crate::mesh_data::MeshData;
use crate::names::UniqueNames;
use crate::nodetree::{Keyframe, NodeTree};

/// Largest count in the format, which has 16 bits.
const MAX_COUNT: usize = 65_535;

/// Writes a tree as a 3DS file: objects with their axes, and a keyframer with hierarchy, pivots and tracks.
///
/// Numbers are metres, rounded to single precision as the format requires; times are rounded to frames of 1/30 s. A node
/// with one mesh becomes one object. Several meshes, and meshes with more than 65 535 vertices or faces, become objects
/// below the node. Repeated names are numbered. Names may be longer than the ten characters of 3D Studio; other programs
/// can read them. `file` is named in messages. For an example see [`parse`](super::parse).
///
/// # Errors
/// [`Diagnostic`] for a parent that is not before its child, a triangle with a missing vertex, more than 65 535 nodes,
/// or numbers beyond single precision.
pub fn write(tree: &NodeTree, file: &Path) -> Result<Vec<u8>, Diagnostic> {
    let records = records(tree, file)?;
    let last_frame = records.iter().flat_map(|p| &p.track).map(|k| frame(k.time_s)).max().unwrap_or(0);
    let mut main = Writer::default();
    main.chunk(0x0002, |w| w.u32(3));
    main.chunk(0x3d3d, |w| {
        w.chunk(0x3d3e, |w| w.u32(3));
        w.chunk(0x0100, |w| w.f32(1.0));
        records.iter().filter(|p| p.mesh.is_some()).for_each(|p| object(w, p));
    });
    main.chunk(0xb000, |w| {
        w.chunk(0xb00a, |w| {
            w.u16(5);
            w.text("MAXSCENE");
            w.u32(last_frame);
        });
        w.chunk(0xb008, |w| {
            w.u32(0);
            w.u32(last_frame);
        });
        w.chunk(0xb009, |w| w.u32(0));
        records.iter().enumerate().for_each(|(number, record)| node(w, number, record));
    });
    let mut whole = Writer::default();
    whole.chunk(0x4d4d, |w| w.bytes.extend_from_slice(&main.bytes));
    if whole.overflow || main.overflow {
        return Err(Diagnostic::new(file, None, "has numbers or lengths that a 3DS file cannot hold")
            .hint("coordinates below 1e38 and less than 4 GB; or export as URDF with STL meshes"));
    }
    Ok(whole.bytes)
}

/// A node of the file, with at most one object.
struct NodeRecord {
    name: String,
    parent: Option<usize>,
    in_parent: Pose,
    in_world: Pose,
    mesh: Option<MeshData>,
    track: Vec<Keyframe>,
}

fn records(tree: &NodeTree, file: &Path) -> Result<Vec<NodeRecord>, Diagnostic> {
    let frames = tree.in_world();
    let mut names = UniqueNames::default();
    let mut records: Vec<NodeRecord> = Vec::new();
    let mut of_node = Vec::with_capacity(tree.nodes.len());
    for (i, (node, in_world)) in tree.nodes.iter().zip(frames).enumerate() {
        if node.parent.is_some_and(|p| p >= i) {
            let what = format!("the node `{}` comes before its parent", node.name);
            return Err(Diagnostic::new(file, None, what).hint("parents before their children"));
        }
        let parent = node.parent.map(|p| of_node[p]);
        let (name, in_parent, track) = (names.unique(&plain(&node.name)), node.in_parent, node.track.clone());
        of_node.push(records.len());
        records.push(NodeRecord { name, parent, in_parent, in_world, mesh: None, track });
        let mut meshes = Vec::new();
        for mesh in &node.meshes {
            check(mesh, file)?;
            meshes.extend(split(mesh));
        }
        let holder = records.len() - 1;
        if meshes.len() == 1 {
            records[holder].mesh = meshes.pop();
        }
        records.extend(meshes.into_iter().map(|mesh| NodeRecord {
            name: names.unique(&plain(&mesh.name)),
            parent: Some(holder),
            in_parent: Pose::IDENTITY,
            in_world,
            mesh: Some(mesh),
            track: Vec::new(),
        }));
    }
    if records.len() > MAX_COUNT {
        return Err(Diagnostic::new(
            file,
            None,
            format!("has {} nodes; a 3DS file numbers {MAX_COUNT}", records.len()),
        )
        .hint("fewer nodes, or export as URDF with STL meshes"));
    }
    Ok(records)
}

fn check(mesh: &MeshData, file: &Path) -> Result<(), Diagnostic> {
    if mesh.triangles.iter().flatten().any(|&i| i as usize >= mesh.vertices.len()) {
        let what = format!("a triangle of `{}` has a corner that does not exist", mesh.name);
        return Err(Diagnostic::new(file, None, what).hint("indices below the number of vertices"));
    }
    Ok(())
}

/// Converts a name to the characters of the format.
fn plain(name: &str) -> String {
    let plain = |c: char| if u32::from(c) < 256 && !c.is_control() { c } else { '_' };
    let plain: String = name.chars().map(plain).take(200).collect();
    if plain.is_empty() { "node".to_owned() } else { plain }
}

/// Divides a mesh into pieces with 16-bit counts.
fn split(mesh: &MeshData) -> Vec<MeshData> {
    if mesh.vertices.len() <= MAX_COUNT && mesh.triangles.len() <= MAX_COUNT {
        return vec![mesh.clone()];
    }
    let mut pieces = Vec::new();
    let mut index = vec![u32::MAX; mesh.vertices.len()];
    let empty = || MeshData { name: mesh.name.clone(), ..MeshData::default() };
    let mut piece = empty();
    let mut used: Vec<u32> = Vec::new();
    for triangle in &mesh.triangles {
        if piece.vertices.len() + 3 > MAX_COUNT || piece.triangles.len() == MAX_COUNT {
            used.drain(..).for_each(|v| index[v as usize] = u32::MAX);
            pieces.push(std::mem::replace(&mut piece, empty()));
        }
        let corner = |v: u32| {
            if index[v as usize] == u32::MAX {
                index[v as usize] = piece.vertices.len() as u32;
                piece.vertices.push(mesh.vertices[v as usize]);
                used.push(v);
            }
            index[v as usize]
        };
        let corners = triangle.map(corner);
        piece.triangles.push(corners);
    }
    pieces.push(piece);
    pieces
}

fn object(w: &mut Writer, record: &NodeRecord) {
    let Some(mesh) = &record.mesh else { return };
    w.chunk(0x4000, |w| {
        w.text(&record.name);
        w.chunk(0x4100, |w| {
            w.chunk(0x4110, |w| {
                w.u16(mesh.vertices.len() as u16);
                mesh.vertices.iter().for_each(|v| w.vector(record.in_world.transform_point(*v)));
            });
            w.chunk(0x4160, |w| {
                (0..3).for_each(|axis| w.vector(record.in_world.rotation.axis(axis)));
                w.vector(record.in_world.translation);
            });
            w.chunk(0x4120, |w| {
                w.u16(mesh.triangles.len() as u16);
                for triangle in &mesh.triangles {
                    for &i in triangle {
                        w.u16(i as u16);
                    }
                    // All three edges are visible.
                    w.u16(7);
                }
            });
        });
    });
}

fn node(w: &mut Writer, number: usize, record: &NodeRecord) {
    let has_mesh = record.mesh.is_some();
    let keys = keys(record);
    w.chunk(0xb002, |w| {
        w.chunk(0xb030, |w| w.u16(number as u16));
        w.chunk(0xb010, |w| {
            w.text(if has_mesh { &record.name } else { "$$$DUMMY" });
            w.u16(0x4000);
            w.u16(0);
            w.u16(record.parent.map_or(u16::MAX, |p| p as u16));
        });
        if !has_mesh {
            w.chunk(0xb011, |w| w.text(&record.name));
        }
        w.chunk(0xb013, |w| w.vector(Vec3::ZERO));
        let moves = keys.iter().any(|k| k.1.translation != record.in_parent.translation);
        let positions = if moves { &keys[..] } else { &keys[..1] };
        track(w, 0xb020, positions, |w, _, pose| w.vector(pose.translation));
        let turns = keys.iter().any(|k| k.1.rotation != record.in_parent.rotation);
        track(w, 0xb021, if turns { &keys[..] } else { &keys[..1] }, |w, before, pose| {
            let turn = before.map_or(pose.rotation, |b| pose.rotation * b.rotation.inverse());
            let vector = turn.to_rotation_vector();
            let (angle, axis) = (vector.length(), vector.try_normalize().unwrap_or(Vec3::Z));
            // Angles of the format are left-handed.
            w.f32(angle);
            w.vector(-axis);
        });
        track(w, 0xb022, &keys[..1], |w, _, _| w.vector(Vec3::splat(1.0)));
    });
}

/// Poses at frames, beginning with the rest frame. Never empty; frames are unique.
fn keys(record: &NodeRecord) -> Vec<(u32, Pose)> {
    let mut keys: Vec<(u32, Pose)> = vec![(0, record.in_parent)];
    for key in &record.track {
        let (frame, last) = (frame(key.time_s), keys[keys.len() - 1].0);
        if frame == 0 && keys.len() == 1 {
            keys[0].1 = key.in_parent;
        } else {
            keys.push((frame.max(last.saturating_add(1)), key.in_parent));
        }
    }
    keys
}

fn frame(time_s: f64) -> u32 {
    (time_s * FRAMES_PER_SECOND).round() as u32
}

fn track(w: &mut Writer, id: u16, keys: &[(u32, Pose)], value: impl Fn(&mut Writer, Option<Pose>, Pose)) {
    w.chunk(id, |w| {
        w.u16(0);
        w.u32(0);
        w.u32(0);
        w.u32(keys.len() as u32);
        for (i, (frame, pose)) in keys.iter().enumerate() {
            w.u32(*frame);
            w.u16(0);
            value(w, i.checked_sub(1).map(|i| keys[i].1), *pose);
        }
    });
}

#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    /// True if a number did not fit into its bits.
    overflow: bool,
}

impl Writer {
    fn chunk(&mut self, id: u16, body: impl FnOnce(&mut Self)) {
        let start = self.bytes.len();
        self.u16(id);
        self.u32(0);
        body(self);
        let length = u32::try_from(self.bytes.len() - start).unwrap_or_else(|_| {
            self.overflow = true;
            0
        });
        self.bytes[start + 2..start + 6].copy_from_slice(&length.to_le_bytes());
    }

    fn u16(&mut self, n: u16) {
        self.bytes.extend_from_slice(&n.to_le_bytes());
    }

    fn u32(&mut self, n: u32) {
        self.bytes.extend_from_slice(&n.to_le_bytes());
    }

    fn f32(&mut self, n: f64) {
        let single = n as f32;
        self.overflow |= !single.is_finite();
        self.bytes.extend_from_slice(&single.to_le_bytes());
    }

    fn vector(&mut self, v: Vec3) {
        v.to_array().into_iter().for_each(|n| self.f32(n));
    }

    /// Writes one byte per character, and a zero byte.
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.chars().map(|c| u32::from(c) as u8));
        self.bytes.push(0);
    }
}
