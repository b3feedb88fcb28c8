//! Boxes that sensors see, as solids of the oracle.

use elbowroom_cell::Cell;
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::frame::Frame;
use super::guarded::Guarded;
use super::solid::OracleSolid;
use super::start::start;
use crate::fuzz_cells::spec::SeenBox;

/// Distances beyond this are not computed, m.
const FAR_M: f64 = 1.0;

/// A box that stands, and the frame of its middle.
pub fn solid(one: &SeenBox) -> (OracleSolid, Frame) {
    let half_extents = Vec3::new(one.size[0], one.size[1], one.size[2]) * 0.5;
    let middle = Vec3::new(one.at[0], one.at[1], one.at[2] + half_extents.z);
    let shape = Shape::Cuboid(Cuboid { half_extents });
    (OracleSolid::eroded(&shape, 0.0), Frame::shift(middle).then(&Frame::turn(Vec3::Z, one.yaw)))
}

/// The middle of a box and its corners.
pub fn corners(one: &SeenBox) -> impl Iterator<Item = Vec3> {
    let (_, at) = solid(one);
    let half = Vec3::new(one.size[0], one.size[1], one.size[2]) * 0.5;
    let side = |corner: u32, bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let corner = move |c| at.point(Vec3::new(half.x * side(c, 0), half.y * side(c, 1), half.z * side(c, 2)));
    std::iter::once(at.at).chain((0..8).map(corner))
}

/// Least distance of two solids, m.
pub fn apart_m((a, at): &(OracleSolid, Frame), (b, other_at): &(OracleSolid, Frame)) -> f64 {
    a.distance(at, b, other_at, FAR_M).lower
}

/// Whether all robots are at least so far (m) from a box at the start.
pub fn is_clear_of_box(cell: &Cell, one: &SeenBox, least_m: f64) -> bool {
    let (solid, at) = solid(one);
    cell.robots.iter().enumerate().all(|(index, robot)| {
        let frames = Arm::new(robot).frames(start(cell, index));
        Guarded::all(robot).iter().all(|part| part.distance(&frames, &solid, &at, FAR_M).lower > least_m)
    })
}
