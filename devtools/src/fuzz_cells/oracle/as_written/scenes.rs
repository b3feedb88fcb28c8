//! Places of the objects of planning scenes.

use elbowroom_cell::Cell;
use elbowroom_proximity::Shape;
use elbowroom_spatial::Vec3;

use super::compare::ROUNDING;
use crate::fuzz_cells::oracle::arm::Arm;
use crate::fuzz_cells::oracle::findings::{Finding, Findings};
use crate::fuzz_cells::oracle::frame::Frame;
use crate::fuzz_cells::spec::{CellSpec, SceneBox, SceneSpec};

/// Compares each box of a scene with the one that was written.
pub fn check(spec: &CellSpec, cell: &Cell, findings: &mut Findings) {
    for scene in &spec.extras.scenes {
        for one in &scene.boxes {
            let read = cell.objects.iter().find(|o| o.name == one.name);
            let expected = place(scene, one, cell);
            let off = match (read, read.map(|o| &o.shape)) {
                (Some(read), Some(Shape::Cuboid(cuboid))) => {
                    let at = Frame::of(&read.in_world);
                    let [x, y, z] = one.size;
                    let size_off = (cuboid.half_extents * 2.0 - Vec3::new(x, y, z)).length();
                    expected.at.distance(at.at).max(expected.turn_to(&at).length()).max(size_off)
                }
                _ => f64::INFINITY,
            };
            if !(off <= ROUNDING) {
                let table = format!("scene.{}: {}", scene.name, one.name);
                findings.list.push(Finding::Misread { table, off });
            }
        }
    }
}

/// The frame of a box in the world: it is in the frame that is placed, or at a link of the first robot at its start.
fn place(scene: &SceneSpec, one: &SceneBox, cell: &Cell) -> Frame {
    let robot = &cell.robots[0];
    let link = robot.robot.chain.link(&one.frame);
    let is_placed = scene.frame.as_deref().unwrap_or("world") == one.frame;
    let frame = if let Some(link) = link.filter(|_| !is_placed) {
        Arm::new(robot).frames(&robot.start)[link.0]
    } else {
        let [roll, pitch, yaw] = scene.rpy;
        let turn = Frame::turn(Vec3::Z, yaw).then(&Frame::turn(Vec3::Y, pitch)).then(&Frame::turn(Vec3::X, roll));
        Frame::shift(vector(scene.at)).then(&turn)
    };
    let [x, y, z, w] = one.turn;
    let axis = Vec3::new(x, y, z);
    let angle = 2.0 * axis.length().atan2(w);
    let turn = axis.try_normalize().map_or(Frame::IDENTITY, |unit| Frame::turn(unit, angle));
    frame.then(&Frame::shift(vector(one.at))).then(&turn)
}

fn vector([x, y, z]: [f64; 3]) -> Vec3 {
    Vec3::new(x, y, z)
}
