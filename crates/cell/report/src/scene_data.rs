//! Data of the 3-D scene and of its distances for the scripts of the page: models once, joint values per frame.

use elbowroom_cell::{Cell, CellGrid, CellRegion};
use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_monitor::{GridSpace, Guards, Part, Presence, Volume};
use elbowroom_proximity::{Shape, tessellate::tessellate};
use elbowroom_robot::{Robot, RobotId};
use elbowroom_sim::{Recording, RegionTrack};
use elbowroom_spatial::Pose;
use serde_json::{Value, json};

use crate::packing::{ArrayPacker, pose_values};
use crate::page_meshes::{MeshUse, PageMeshes};
use crate::scene::{CHORD_ERROR_M, ReportMesh, ReportObject, ReportRobot, ReportScene, ReportShield};
use crate::{palette, region_surface, run_data};

/// A mesh with more triangles than this is drawn, but the page computes no distances to it.
const MAX_MEASURED_TRIANGLES: usize = 200_000;

/// Data for the scripts of the page.
#[derive(Debug, Default)]
pub struct PageData {
    /// A document that refers to arrays.
    pub json: Value,
    /// The arrays, packed.
    pub arrays: Vec<u8>,
}

/// Data of a scene and of runs in it. The regions come from the first run.
pub fn data(scene: &ReportScene, runs: &[(&str, &Recording)]) -> PageData {
    let regions = runs.first().map_or(&[][..], |(_, rec)| &rec.regions[..]);
    let (mut packer, mut meshes) = (ArrayPacker::default(), PageMeshes::default());
    let mut pack = Pack { packer: &mut packer, meshes: &mut meshes, measured: true };
    let moves = |o: &ReportObject| runs.iter().any(|(_, rec)| rec.objects.iter().any(|t| t.name == o.name));
    let json = json!({
        "robots": scene.robots.iter().map(|r| robot(r, &mut pack)).collect::<Vec<_>>(),
        "objects": scene.objects.iter().map(|o| object(o, moves(o), &mut pack)).collect::<Vec<_>>(),
        "regions": regions.iter().enumerate().map(|(i, r)| region(scene, i, &r.into(), &mut pack)).collect::<Vec<_>>(),
        "shields": shields(scene, &mut pack),
        "grids": grids(runs.first().map_or(&[][..], |(_, rec)| &rec.grids[..])),
        "runs": runs.iter().map(|(label, rec)| run_data::run(scene, label, rec, pack.packer)).collect::<Vec<_>>(),
    });
    let mut json = json;
    json["meshes"] = meshes.entries().into();
    PageData { json, arrays: packer.bytes().to_vec() }
}

/// Geometry of a cell at its start, for a page that computes no distances.
pub fn cell_data(cell: &Cell) -> PageData {
    let scene = ReportScene::of_cell(cell);
    let (mut packer, mut meshes) = (ArrayPacker::default(), PageMeshes::default());
    let mut pack = Pack { packer: &mut packer, meshes: &mut meshes, measured: false };
    let moves = |i: usize| cell.moving_objects.iter().any(|m| m.object.0 == i);
    let objects = scene.objects.iter().enumerate().map(|(i, o)| object(o, moves(i), &mut pack)).collect::<Vec<_>>();
    let mut json = json!({
        "robots": scene.robots.iter().map(|r| robot(r, &mut pack)).collect::<Vec<_>>(),
        "objects": objects,
        "regions": cell.regions.iter().enumerate().map(|(i, r)| region(&scene, i, &r.into(), &mut pack)).collect::<Vec<_>>(),
        "shields": shields(&scene, &mut pack),
        "grids": grids(&cell.monitoring.grids),
    });
    json["meshes"] = meshes.entries().into();
    PageData { json, arrays: packer.bytes().to_vec() }
}

/// Geometry of a robot alone, its root in the world's origin, for a page that computes no distances.
pub(crate) fn robot_data(model: &Robot, packer: &mut ArrayPacker) -> Value {
    let root = model.chain.root();
    let scene = ReportScene::new().robot("robot", model, Pose::IDENTITY, root, Pose::IDENTITY, &[]);
    let mut meshes = PageMeshes::default();
    let mut pack = Pack { packer, meshes: &mut meshes, measured: false };
    let robots = scene.robots.iter().map(|r| robot(r, &mut pack)).collect::<Vec<_>>();
    json!({ "robots": robots, "objects": [], "regions": [], "shields": [], "grids": [], "meshes": meshes.entries() })
}

struct Pack<'a> {
    packer: &'a mut ArrayPacker,
    meshes: &'a mut PageMeshes,
    /// True if the page computes distances, for which it needs the shapes.
    measured: bool,
}

/// A region of a recording or of a cell.
struct PageRegion<'a> {
    name: &'a str,
    kind: &'static str,
    shape: &'a Shape,
    warning_m: f64,
    guards: Guards,
    robots: &'a [RobotId],
}

impl<'a> From<&'a RegionTrack> for PageRegion<'a> {
    fn from(r: &'a RegionTrack) -> Self {
        let (warning_m, guards) = (r.warning_m, r.guards);
        Self { name: &r.name, kind: r.kind.name(), shape: &r.shape, warning_m, guards, robots: &r.robots }
    }
}

impl<'a> From<&'a CellRegion> for PageRegion<'a> {
    fn from(r: &'a CellRegion) -> Self {
        let CellRegion { region, robots, .. } = r;
        let (name, kind, shape) = (&region.name, region.kind.name(), &region.shape);
        Self { name, kind, shape, warning_m: region.warning_m, guards: region.guards, robots }
    }
}

impl Pack<'_> {
    fn mesh(&mut self, surface: &region_surface::SurfaceMesh, used: MeshUse) -> usize {
        self.meshes.add(self.packer, surface, used)
    }

    /// A solid as the page measures it; null if its mesh is too large for that.
    fn shape(&mut self, shape: &Shape) -> Value {
        if !self.measured {
            return Value::Null;
        }
        match shape {
            Shape::Sphere(s) => json!({ "kind": "sphere", "radius": s.radius }),
            Shape::Capsule(c) => json!({ "kind": "capsule", "half": c.half_length, "radius": c.radius }),
            Shape::Cylinder(c) => json!({ "kind": "cylinder", "half": c.half_length, "radius": c.radius }),
            Shape::Cuboid(c) => json!({ "kind": "box", "half": c.half_extents.to_array() }),
            Shape::HalfSpace(_) => json!({ "kind": "plane" }),
            Shape::Hull(h) => {
                let mesh = self.mesh(&(h.vertices().to_vec(), h.triangles().to_vec()), MeshUse::Measured);
                json!({ "kind": "hull", "mesh": mesh })
            }
            Shape::Mesh(m) if m.triangles().len() > MAX_MEASURED_TRIANGLES => Value::Null,
            Shape::Mesh(m) => {
                let mesh = self.mesh(&(m.vertices().to_vec(), m.triangles().to_vec()), MeshUse::Measured);
                json!({ "kind": "mesh", "mesh": mesh, "solid": m.has_interior() })
            }
        }
    }
}

fn robot(robot: &ReportRobot, pack: &mut Pack<'_>) -> Value {
    let mut solids = Vec::new();
    for (link, meshes) in robot.link_meshes.iter().enumerate() {
        solids.extend(meshes.iter().map(|m| solid(link, m, pack)));
    }
    solids.extend(robot.tool.iter().map(|m| solid(robot.flange.0, m, pack)));
    let volume = |v: &Volume, pack: &mut Pack<'_>| {
        json!({
            "name": v.name, "link": v.link.0, "pose": pose_values(&v.in_link), "shape": pack.shape(&v.shape),
            // Whether the volume belongs to an exchanged tool, and so is present while its link is.
            "exchanged": v.presence != Presence::Always,
        })
    };
    json!({
        "name": robot.name, "base": pose_values(&robot.base_in_world), "links": robot.chain.links().len(),
        "joints": joints(&robot.chain), "sliders": sliders(&robot.chain), "solids": solids,
        "volumes": robot.volumes.iter().map(|v| volume(v, pack)).collect::<Vec<_>>(),
        // Volumes of objects while the robot holds them, at their poses in the objects.
        "gripped": robot.gripped.iter().map(|(o, v)| json!({ "object": o.0, "volume": volume(v, pack) })).collect::<Vec<_>>(),
        // Volumes that count for an object: the links with tool and load, as for a region with default guards.
        "measured": volumes_for(robot, Guards::default()),
    })
}

fn solid(link: usize, m: &ReportMesh, pack: &mut Pack<'_>) -> Value {
    let [r, g, b] = m.color;
    let mesh = pack.mesh(&(m.vertices.clone(), m.triangles.clone()), MeshUse::Drawn);
    json!({ "link": link, "mesh": mesh, "pose": pose_values(&m.in_link), "color": format!("#{r:02x}{g:02x}{b:02x}") })
}

/// The joints from the root outwards; `index` is the index of the value in q, null for a fixed joint.
fn joints(chain: &Chain) -> Vec<Value> {
    let joint = |id: &elbowroom_kinematics::JointId| {
        let joint = &chain.joints()[id.0];
        let coupling = chain.coupling(*id);
        json!({
            "parent": joint.parent.0, "child": joint.child.0, "origin": pose_values(&joint.origin),
            "axis": joint.axis.to_array(), "slides": joint.kind == JointKind::Prismatic,
            "index": coupling.map(|c| c.index), "factor": coupling.map(|c| c.multiplier), "offset": coupling.map(|c| c.offset),
        })
    };
    chain.topological_order().iter().map(joint).collect()
}

/// The joints that a user can move, in the order of q; without limits by half a turn, or 2 m, to either side.
fn sliders(chain: &Chain) -> Vec<Value> {
    let slider = |id: &elbowroom_kinematics::JointId| {
        let joint = &chain.joints()[id.0];
        let slides = joint.kind == JointKind::Prismatic;
        let unlimited = if slides { 2.0 } else { std::f64::consts::PI };
        let bound = |limit: f64, other: f64| if limit.is_finite() { limit } else { other };
        let (lower, upper) = (bound(joint.limits.lower, -unlimited), bound(joint.limits.upper, unlimited));
        json!({ "name": joint.name, "slides": slides, "lower": lower, "upper": upper })
    };
    chain.active_joints().iter().map(slider).collect()
}

fn object(object: &ReportObject, moves: bool, pack: &mut Pack<'_>) -> Value {
    let color = if moves { palette::MOVING } else { palette::OBJECT };
    let shape = pack.shape(&object.shape);
    let mesh = match &shape["mesh"] {
        Value::Null => pack.mesh(&tessellate(&object.shape, CHORD_ERROR_M), MeshUse::Drawn).into(),
        measured => measured.clone(),
    };
    json!({
        "name": object.name, "mesh": mesh, "color": color, "pose": pose_values(&object.in_world), "shape": shape,
    })
}

fn region(scene: &ReportScene, index: usize, region: &PageRegion<'_>, pack: &mut Pack<'_>) -> Value {
    let of_robot = |(i, robot): (usize, &ReportRobot)| {
        let applies = region.robots.contains(&RobotId(i));
        if applies { volumes_for(robot, region.guards) } else { Vec::new() }
    };
    let shell = region_surface::warning(region.shape, region.warning_m);
    json!({
        "name": region.name, "kind": region.kind, "color": palette::of_region(index),
        "solid": pack.mesh(&region_surface::solid(region.shape), MeshUse::Drawn),
        "shell": shell.map(|s| pack.mesh(&s, MeshUse::Drawn)),
        "shape": pack.shape(region.shape),
        "measured": scene.robots.iter().enumerate().map(of_robot).collect::<Vec<_>>(),
        "guards_load": Part::Load.counts_for(region.guards),
    })
}

fn shields(scene: &ReportScene, pack: &mut Pack<'_>) -> Vec<Value> {
    let shield = |shield: &ReportShield| {
        let mesh = pack.mesh(&(shield.vertices.clone(), shield.triangles.clone()), MeshUse::Drawn);
        json!({
            "name": shield.name, "mesh": mesh, "color": palette::SHIELD, "pose": pose_values(&shield.in_world),
            "active": shield.active,
        })
    };
    scene.shields.iter().map(shield).collect()
}

/// The grids of boxes, each once, as frames and ends with divisions of their axes.
fn grids(grids: &[CellGrid]) -> Vec<Value> {
    let is_first = |(i, g): &(usize, &CellGrid)| grids[..*i].iter().all(|other| other.grid.name != g.grid.name);
    let drawn = |(_, g): (usize, &CellGrid)| match &g.grid.space {
        GridSpace::Tcp { frame_in_world } => {
            let axes: Vec<_> = g.grid.axes.iter().map(|a| json!([a.from, a.to, a.count])).collect();
            Some(json!({
                "name": g.grid.name, "pose": pose_values(frame_in_world), "axes": axes, "color": palette::GRID,
            }))
        }
        GridSpace::Joints(_) => None,
    };
    grids.iter().enumerate().filter(is_first).filter_map(drawn).collect()
}

/// Indices of the volumes that count for a region with these guards.
fn volumes_for(robot: &ReportRobot, guards: Guards) -> Vec<usize> {
    let each = robot.volumes.iter().enumerate();
    each.filter(|(_, v)| v.part.counts_for(guards)).map(|(i, _)| i).collect()
}
