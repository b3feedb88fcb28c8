//! Geometry of a cell, sent to each page once.

use std::io::{self, Write as _};

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;
use elbowroom_report::{PageData, cell_data};
use elbowroom_spatial::Pose;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};

/// Makes the data of the cell for the page.
fn document(cell: &Cell, mode: &str, draws: bool) -> PageData {
    let data = cell_data(cell);
    let mut json = data.json;
    json["cell"] = cell.name.as_str().into();
    json["checksum"] = cell.approval.checksum.as_str().into();
    json["mode"] = mode.into();
    json["draws"] = draws.into();
    for (robot, r) in members(&mut json["robots"]).zip(&cell.robots) {
        let absent: Vec<usize> = r.payload.tools.iter().filter(|t| !t.mounted).map(|t| t.link.0).collect();
        robot["start"] = r.start.clone().into();
        robot["absent"] = absent.into();
        robot["tcp"] = json!({ "link": r.flange.0, "pose": values(&r.tcp_in_flange) });
    }
    let states: Vec<ChainState> = cell.robots.iter().map(start_state).collect();
    let frames = elbowroom_cell::Frames::new(cell);
    for (region, r) in members(&mut json["regions"]).zip(&cell.regions) {
        let in_source = r.region.anchor * r.region.shape_in_anchor;
        let source = r.follow.map(|follow| frames.source(&follow, &states, 0.0).pose);
        region["pose"] = json!(values(&source.map_or(in_source, |source| source * in_source)));
        region["life"] = r.region.life.name().into();
        region["warning_m"] = r.region.warning_m.into();
        region["robots"] = r.robots.iter().map(|id| cell.robots[id.0].name.as_str()).collect::<Vec<_>>().into();
    }
    PageData { json, arrays: data.arrays }
}

/// Packs the geometry for the page; `draws` tells it that targets of fixtures are drawn.
pub(crate) fn packed(cell: &Cell, mode: &str, draws: bool) -> io::Result<Vec<u8>> {
    packed_data(&document(cell, mode, draws))
}

/// Packs data for the page: the length of a JSON document (32 bits, little-endian), the document, and the arrays that it
/// refers to; compressed as gzip.
pub(crate) fn packed_data(data: &PageData) -> io::Result<Vec<u8>> {
    let json = data.json.to_string();
    let mut encoder = GzEncoder::new(Vec::new(), Compression::new(6));
    encoder.write_all(&u32::try_from(json.len()).map_err(io::Error::other)?.to_le_bytes())?;
    encoder.write_all(json.as_bytes())?;
    encoder.write_all(&data.arrays)?;
    encoder.finish()
}

fn start_state(robot: &elbowroom_cell::CellRobot) -> ChainState {
    let mut state = ChainState::new(&robot.robot.chain);
    state.q.copy_from_slice(&robot.start);
    robot.robot.chain.forward_motion(&mut state);
    state
}

fn members(list: &mut Value) -> impl Iterator<Item = &mut Value> {
    list.as_array_mut().into_iter().flatten()
}

/// Converts a pose for the scripts: quaternion x y z w, then the translation.
fn values(pose: &Pose) -> [f64; 7] {
    let [x, y, z, w] = pose.rotation.to_quaternion_xyzw();
    let t = pose.translation;
    [x, y, z, w, t.x, t.y, t.z]
}
