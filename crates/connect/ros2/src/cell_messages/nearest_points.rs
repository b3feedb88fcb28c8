//! Nearest points as markers.

use elbowroom_status::{CellStatus, PointStatus, RobotStatus};

use super::frames;
use crate::msgs::builtin_interfaces::Time;
use crate::msgs::geometry_msgs::{Point, Quaternion};
use crate::msgs::std_msgs::{ColorRGBA, Header};
use crate::msgs::visualization_msgs::{Marker, MarkerArray};

const LINE_M: f64 = 0.004;
const TEXT_M: f64 = 0.06;
const POINT: ColorRGBA = ColorRGBA { r: 0.25, g: 0.55, b: 0.95, a: 1.0 };
const GOVERNING: ColorRGBA = ColorRGBA { r: 0.9, g: 0.15, b: 0.1, a: 1.0 };

/// Makes, per robot, a line to each region near it, and the distance of the governing point.
pub(super) fn markers(status: &CellStatus, stamp: &Time) -> MarkerArray {
    let of_robot = |robot: &RobotStatus| [lines(robot, stamp), text(robot, stamp)];
    MarkerArray { markers: status.robots.iter().flat_map(of_robot).collect() }
}

fn marker(robot: &RobotStatus, stamp: &Time, id: i32, kind: i32) -> Marker {
    let mut marker = Marker {
        header: Header { stamp: stamp.clone(), frame_id: frames::WORLD.to_owned() },
        ns: format!("{}/nearest", robot.robot),
        id,
        r#type: kind,
        ..Marker::default()
    };
    marker.pose.orientation = Quaternion { w: 1.0, ..Quaternion::default() };
    marker
}

fn lines(robot: &RobotStatus, stamp: &Time) -> Marker {
    let mut marker = marker(robot, stamp, 0, Marker::LINE_LIST);
    marker.scale.x = LINE_M;
    marker.color = POINT;
    let governs = |p: &PointStatus| robot.governing.as_ref().is_some_and(|g| g.region == p.region && g.part == p.part);
    for point in &robot.virtual_tcps {
        let color = if governs(point) { GOVERNING } else { POINT };
        marker.points.extend([Point::from(point.point_m), Point::from(point.on_region_m)]);
        marker.colors.extend([color.clone(), color]);
    }
    // Viewers report an error for a list without points.
    marker.action = if marker.points.is_empty() { Marker::DELETE } else { Marker::ADD };
    marker
}

fn text(robot: &RobotStatus, stamp: &Time) -> Marker {
    let mut marker = marker(robot, stamp, 1, Marker::TEXT_VIEW_FACING);
    let Some(point) = &robot.governing else { return Marker { action: Marker::DELETE, ..marker } };
    marker.pose.position = point.point_m.into();
    marker.pose.position.z += 2.0 * TEXT_M;
    marker.scale.z = TEXT_M;
    marker.color = GOVERNING;
    marker.text = format!("{}: {:.0} mm, {:.0} %", point.region, 1e3 * point.distance_m, 1e2 * robot.speed_override);
    marker
}
