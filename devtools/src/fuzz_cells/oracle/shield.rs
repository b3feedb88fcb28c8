//! Generated shields around boxes: how far a tool is inside one.

use elbowroom_cell::shared_control::{ShieldSettings, ShieldTarget};
use elbowroom_cell::{Cell, CellFixture, ShieldSource};
use elbowroom_proximity::Shape;
use elbowroom_robot::RobotId;
use elbowroom_spatial::Vec3;

use super::findings::TOLERANCE_M;
use super::frame::Frame;

/// Points along an edge of a tool's box that are tried against a shield.
const POINTS: i32 = 8;

/// How far a point of the tool's box is inside the shield of a box, beyond its tolerance; `None` if none is.
pub fn inside_shield(cell: &Cell, fixture: &CellFixture, frames: &[Frame], object_at: &Frame) -> Option<f64> {
    let robot = &cell.robots[fixture.tool.map_or(RobotId(0), |t| t.robot).0];
    let ShieldSource::Generated { target, settings } = &fixture.shield else { return None };
    let (Shape::Cuboid(object), tool) = (&cell.objects[fixture.protects.0].shape, robot.payload.tool.as_ref()?) else {
        return None;
    };
    let Shape::Cuboid(tool_box) = &tool.shape else { return None };
    let tool_in_world = frames[robot.flange.0].then(&Frame::of(&tool.in_link));
    let depth_m = |p: Vec3| {
        let p = object_at.vector_back(tool_in_world.point(p) - object_at.at);
        let outside = p.abs() - object.half_extents;
        let distance_m =
            if outside.max_element() <= 0.0 { outside.max_element() } else { outside.max(Vec3::ZERO).length() };
        let below_offset = settings.offset_m - distance_m;
        below_offset.min(outside_opening(p, target, object.half_extents, settings)) - settings.tolerance_m
    };
    let deepest = surface_points(tool_box.half_extents).map(depth_m).fold(f64::NEG_INFINITY, f64::max);
    (deepest > TOLERANCE_M).then_some(deepest)
}

/// Distance of a point of the object's frame from the opening, or less, m; negative inside.
fn outside_opening(p: Vec3, target: &ShieldTarget, half: Vec3, s: &ShieldSettings) -> f64 {
    let (at, out) = match target {
        ShieldTarget::Drill { at, axis } => (*at, axis.try_normalize().map_or(Vec3::Z, |a| -a)),
        ShieldTarget::Line(points) | ShieldTarget::Area(points) => (points[0], side(points[0], half)),
        ShieldTarget::FacesWithin { at, .. } => (*at, side(*at, half)),
    };
    let height = out.dot(p - at);
    let foot = p - out * height;
    let aside = match target {
        ShieldTarget::Drill { .. } => foot.distance(at),
        ShieldTarget::Line(points) => from_line(foot, points),
        ShieldTarget::Area(points) if is_within(foot, points, out) => 0.0,
        ShieldTarget::Area(points) => {
            from_line(foot, points).min(from_line(foot, &[points[0], points[points.len() - 1]]))
        }
        ShieldTarget::FacesWithin { radius_m, .. } => (foot.distance(at) - radius_m).max(0.0),
    };
    let wall = (aside - 0.5 * s.width_m) * s.flare_rad.cos() - (height + s.depth_m) * s.flare_rad.sin();
    wall.max(-(height + s.depth_m))
}

/// The outward normal of the side of a box that a point is on.
fn side(p: Vec3, half: Vec3) -> Vec3 {
    let depth = (half - p.abs()).abs();
    let axis = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().min_by(|a, b| a.dot(depth).total_cmp(&b.dot(depth)));
    axis.map_or(Vec3::Z, |axis| axis * axis.dot(p).signum())
}

/// Distance from a line through points, m.
fn from_line(p: Vec3, points: &[Vec3]) -> f64 {
    let from_part = |ends: &[Vec3]| {
        let along = ends[1] - ends[0];
        let share = ((p - ends[0]).dot(along) / along.length_squared().max(1e-18)).clamp(0.0, 1.0);
        p.distance(ends[0] + along * share)
    };
    points.windows(2).map(from_part).fold(f64::INFINITY, f64::min)
}

/// Whether a point of the plane is within a convex border.
fn is_within(p: Vec3, border: &[Vec3], out: Vec3) -> bool {
    let next = border.iter().cycle().skip(1);
    let sides: Vec<f64> = border.iter().zip(next).map(|(a, b)| (*b - *a).cross(p - *a).dot(out)).collect();
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

/// Points all over the surface of a box.
fn surface_points(half: Vec3) -> impl Iterator<Item = Vec3> {
    let share = |i: i32| 2.0 * f64::from(i) / f64::from(POINTS) - 1.0;
    let side = move |(axis, sign): (usize, f64)| {
        (0..=POINTS).flat_map(move |i| {
            (0..=POINTS).map(move |j| {
                let mut p = [sign, share(i), share(j)];
                p.rotate_right(axis);
                Vec3::new(p[0] * half.x, p[1] * half.y, p[2] * half.z)
            })
        })
    };
    (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]).flat_map(side)
}
