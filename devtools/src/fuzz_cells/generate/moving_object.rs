//! Random objects that turn and travel.

use elbowroom_spatial::Vec3;

use crate::fuzz_cells::oracle::Frame;
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{MotionSpec, ObjectSpec, Vector};

/// Makes an object beside or at a place; most of them only turn.
pub fn moving_object(random: &mut Random, name: String, place: Vec3, meets_s: f64) -> ObjectSpec {
    let near = random.scaled(0.05, 1.5);
    let away = vector(random.vector(1.0)) * if random.percent(60) { random.between(0.5, 1.5) } else { near };
    let turns = random.percent(85);
    let axis = if random.percent(60) { Vec3::Z } else { vector(random.vector(1.0)) };
    let rate = random.scaled(0.2, 5.0) * if random.percent(50) { 1.0 } else { -1.0 };
    let turn = axis.try_normalize().filter(|_| turns).map_or([0.0; 3], |axis| text(axis * rate));
    let start = if random.percent(85) { 0.0 } else { random.between(0.1, 1.5) };
    let origin = place + away;
    let (mut at, mut via, mut repeat) = (origin, Vec::new(), "no");
    let speed = random.scaled(0.05, 1.0);
    if turn == [0.0; 3] || random.percent(35) {
        let direction = vector(random.vector(1.0)).try_normalize().unwrap_or(Vec3::X);
        at = origin - direction * speed * (meets_s - start).max(0.0);
        let long = random.percent(75);
        via.push(text(at + direction * speed * if long { 20.0 } else { random.between(0.3, 3.0) }));
        if !long {
            repeat = random.one(&["no", "loop", "ping-pong"]);
        }
        if repeat == "loop" {
            via.push(text(at + vector(random.vector(1.0))));
        }
    }
    let shape = match random.whole(0, 5) {
        0 => "shape = \"mesh\"\nmesh = \"corner.obj\"\n".to_owned(),
        1 => "shape = \"box\"\nsize = [0.1, 0.2, 0.05]\n".to_owned(),
        _ => "shape = \"sphere\"\nradius = 0.01\n".to_owned(),
    };
    let rpy = if random.percent(50) { random.vector(3.0) } else { [0.0; 3] };
    ObjectSpec {
        name,
        shape,
        at: text(at),
        rpy,
        motion: Some(MotionSpec { via, speed, start, repeat, turn }),
        belt: None,
    }
}

/// Returns the frame of the object while it moves in a straight line.
pub fn object_frame(object: &ObjectSpec, t_s: f64) -> Frame {
    let rest = rpy_frame(object.rpy);
    let Some(motion) = &object.motion else { return Frame::shift(vector(object.at)).then(&rest) };
    let moving_s = (t_s - motion.start).max(0.0);
    let turn = vector(motion.turn);
    let turned = turn.try_normalize().map_or(rest, |axis| Frame::turn(axis, turn.length() * moving_s).then(&rest));
    let ahead = motion.via.first().and_then(|via| (vector(*via) - vector(object.at)).try_normalize());
    let moved = ahead.unwrap_or(Vec3::ZERO) * motion.speed * moving_s;
    Frame::shift(vector(object.at) + moved).then(&turned)
}

fn rpy_frame([roll, pitch, yaw]: Vector) -> Frame {
    Frame::turn(Vec3::Z, yaw).then(&Frame::turn(Vec3::Y, pitch)).then(&Frame::turn(Vec3::X, roll))
}

/// Converts a place to the coordinates of a frame.
pub fn local(frame: &Frame, place: Vec3) -> Vector {
    text(frame.vector_back(place - frame.at))
}

pub fn vector([x, y, z]: Vector) -> Vec3 {
    Vec3::new(x, y, z)
}

pub fn text(v: Vec3) -> Vector {
    [v.x, v.y, v.z].map(rounded)
}
