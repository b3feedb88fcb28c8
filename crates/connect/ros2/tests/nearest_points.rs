//! Nearest points of a status as markers: places in metres, the label in millimetres and percent.

use elbowroom_cell::Cell;
use elbowroom_ros2::{CellMessages, msgs::builtin_interfaces::Time, msgs::visualization_msgs::Marker};
use elbowroom_status::{CellStatus, PointStatus, RobotStatus};

const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
"#;

fn point(region: &str, distance_m: f64) -> PointStatus {
    let (part, region) = ("carriage".to_owned(), region.to_owned());
    PointStatus { part, region, distance_m, point_m: [1.0, 2.0, 3.0], on_region_m: [1.0, 2.0 + distance_m, 3.0] }
}

#[test]
fn the_label_says_millimetres_and_percent_beside_the_point_of_the_robot() {
    let messages = CellMessages::new(&Cell::parse("rail.toml", CELL).unwrap());
    let (post, wall) = (point("post", 0.345), point("wall", 1.5));
    let rail = RobotStatus {
        robot: "rail".into(),
        speed_override: 0.25,
        governing: Some(post.clone()),
        virtual_tcps: vec![post, wall],
        ..RobotStatus::default()
    };
    let status = |robot: RobotStatus| CellStatus { robots: vec![robot], ..CellStatus::default() };
    let markers = messages.nearest_points(&status(rail), &Time::from_nanoseconds(0)).markers;
    let [lines, text] = &markers[..] else { panic!("{} markers", markers.len()) };
    assert_eq!(text.text, "post: 345 mm, 25 %");
    assert_eq!([text.pose.position.x, text.pose.position.y], [1.0, 2.0]);
    let y: Vec<f64> = lines.points.iter().map(|p| p.y).collect();
    assert_eq!(y, [2.0, 2.0 + 0.345, 2.0, 3.5]);
    // The governing point has its own colour.
    assert!(
        lines.colors[0] == lines.colors[1] && lines.colors[2] == lines.colors[3] && lines.colors[0] != lines.colors[2]
    );

    let free = RobotStatus { robot: "rail".into(), ..RobotStatus::default() };
    let markers = messages.nearest_points(&status(free), &Time::from_nanoseconds(0)).markers;
    assert!(markers.iter().all(|marker| marker.action == Marker::DELETE));
}
