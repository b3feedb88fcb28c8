//! Regions as path constraints: planned paths lead around permanent forbidden regions, at their poses.

use crate::common::{GANTRY, HEAD, WALL, parse};
use elbowroom_kinematics::{JointTrajectory, TrajectoryRow};
use elbowroom_planner::RrtConnectSettings;
use elbowroom_query::plan::{PathRequest, plan};

fn request(from: [f64; 2], to: [f64; 2]) -> PathRequest {
    PathRequest { from: Some(from.to_vec()), to: to.to_vec().into(), ..PathRequest::default() }
}

/// Smallest distance of the ball to the wall, m, at many points of the rows.
fn nearest(trajectory: &JointTrajectory) -> f64 {
    let distance = |x: f64, y: f64| {
        let off = |v: f64, low: f64, high: f64| (low - v).max(v - high).max(0.0);
        off(x, 0.5, 0.52).hypot(off(y, 0.08, 1.5)) - 0.05
    };
    let between = |w: &[TrajectoryRow], t: f64| {
        let at = |i: usize| w[0].q[i] + (w[1].q[i] - w[0].q[i]) * t;
        distance(at(0), -at(1))
    };
    let points = trajectory.rows().windows(2).flat_map(|w| (0..=4).map(move |n| between(w, f64::from(n) / 4.0)));
    points.fold(f64::INFINITY, f64::min)
}

#[test]
fn paths_lead_around_permanent_forbidden_regions_and_through_others() {
    let request = request([0.2, -0.4], [0.9, -0.4]);
    let planned = |region: &str| plan(&parse(&format!("{HEAD}{GANTRY}{region}")), &request).unwrap();
    let answer = planned(WALL);
    let timed = answer.timed.unwrap();
    assert!(timed.path.waypoints.len() > 2 && answer.regions == ["wall"]);
    let distance = nearest(&timed.trajectory);
    assert!(distance > 0.005 && distance < 0.03, "{distance}");
    // A clearance applies to regions as well.
    let wide = RrtConnectSettings { clearance_m: 0.1, ..RrtConnectSettings::default() };
    let cell = parse(&format!("{HEAD}{GANTRY}{WALL}"));
    let wide = plan(&cell, &PathRequest { options: wide, ..request.clone() }).unwrap().timed.unwrap();
    assert!(nearest(&wide.trajectory) > 0.1);
    // Temporary regions are not active yet; monitored regions do not forbid entry.
    for line in ["life = \"temporary\"", "kind = \"monitored\""] {
        let answer = planned(&format!("{WALL}{line}\n"));
        assert!(answer.timed.unwrap().path.waypoints.len() == 2 && answer.regions.is_empty(), "{line}");
    }
}

#[test]
fn regions_have_the_poses_of_the_robots_they_follow() {
    let carrier = |start: f64| {
        format!(
            "[robot.carrier]\nbase = {{ at = [0, 0, 900], rpy = [0, 90, 0] }}\n\
             dh = [{{ kind = \"prismatic\", min = -2000, max = 2000, speed = 500 }}]\nstart = [{start}]\n"
        )
    };
    let carried = "[region.carried]\nshape = \"sphere\"\ncentre = [900, 0, 0]\nradius = 100\nwarning = 50\n\
                 robots = [\"gantry\"]\nfollow = { robot = \"carrier\" }\n";
    let request = PathRequest { robot: Some("gantry".into()), ..request([0.0, 0.0], [1.0, 0.0]) };
    for (start, around) in [(500.0, true), (-1500.0, false)] {
        let cell = parse(&format!("{HEAD}{GANTRY}{}{carried}", carrier(start)));
        let timed = plan(&cell, &request).unwrap().timed.unwrap();
        assert_eq!(timed.path.waypoints.len() > 2, around, "{start}");
    }
}

#[test]
fn a_goal_inside_is_refused_with_the_regions_name_and_a_start_inside_is_left() {
    let cell = parse(&format!("{HEAD}{GANTRY}{WALL}"));
    let error = plan(&cell, &request([0.2, -0.4], [0.51, -0.4])).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("region `wall`") && text.contains("goal") && error.hint.is_some(), "{text}");
    let answer = plan(&cell, &request([0.46, -0.4], [0.9, -0.4])).unwrap();
    let timed = answer.timed.unwrap();
    assert!(timed.path.waypoints.len() > 2 && timed.trajectory.first() == Some(&[0.46, -0.4]));
}
