//! Many paths in one cell: each answer is that of a cell that was asked nothing before.

use std::time::{Duration, Instant};

use crate::common::{ARM, HEAD, parse, rail};
use crate::plan::tcp;
use elbowroom_cell::Cell;
use elbowroom_planner::{Interrupt, RrtConnectSettings};
use elbowroom_query::plan::{PathAnswer, PathGoal, PathPlanner, PathQuery, PathRequest, TcpMotion, plan};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Attachment;
use elbowroom_spatial::{Pose, Vec3};

const HERE: [f64; 6] = [-0.8, -0.9, 0.3, 0.0, 0.5, 0.0];
const THERE: [f64; 6] = [0.8, -0.9, 0.3, 0.0, 0.5, 0.0];

/// An arm, a head on a rail, a post between the ends of the path, and a map of three joints.
fn cell() -> Cell {
    let other = rail("ball", 0.0).replace("at = [0, 0, 0]", "at = [0, 0, 1050]") + "start = [-2000]\n";
    let post = "[object.post]\nshape = \"box\"\nat = [1100, 0, 500]\nsize = [100, 100, 1600]\n\
                [object.part]\nshape = \"sphere\"\nat = [0, 3000, 0]\nradius = 60\n";
    let map = "[map.arm]\njoints = [\"joint_1\", \"joint_2\", \"joint_3\"]\nstep = 5\n";
    parse(&format!("{HEAD}[robot.arm]\n{ARM}{other}{post}{map}"))
}

fn request(robot: &str, from: &[f64], to: &[f64]) -> PathRequest {
    // Only the number of configurations limits the search, so that an answer does not depend on the machine.
    let options =
        RrtConnectSettings { time_limit: Duration::from_mins(10), max_states: 40_000, ..RrtConnectSettings::default() };
    PathRequest { robot: Some(robot.into()), from: Some(from.into()), to: to.into(), options, ..PathRequest::default() }
}

/// The part at the flange, some of it beyond the tool centre point.
fn carried(cell: &Cell, beyond_m: f64) -> Vec<(ObjectId, Attachment)> {
    let robot = &cell.robots[0];
    let in_link = Pose::from_translation(Vec3::new(0.0, 0.0, beyond_m));
    let touch_links = robot.robot.links_with_colliders().collect();
    let held = Attachment { robot: RobotId(0), link: robot.flange, in_link, touch_links, visiting_links: Vec::new() };
    vec![(ObjectId(1), held)]
}

fn requests(cell: &Cell) -> Vec<PathRequest> {
    let here = tcp(cell, &HERE);
    let down = PathGoal::Tcp(Pose { translation: here.translation + Vec3::new(0.0, 0.1, -0.1), ..here }.into());
    let go = request("arm", &HERE, &THERE);
    let clear = RrtConnectSettings { clearance_m: 0.01, seed: 5, ..go.options };
    let aside = Pose::from_translation(Vec3::new(1.1, 1.6, 0.5));
    vec![
        go.clone(),
        PathRequest { options: clear, ..go.clone() },
        PathRequest { placed: vec![(ObjectId(0), aside)], ..go.clone() },
        PathRequest { planner: PathPlanner::Grid, ..go.clone() },
        PathRequest { speed: 0.5, period_s: Some(0.02), ..go.clone() },
        request("ball", &[-2.0], &[-1.6]),
        request("arm", &THERE, &HERE),
        PathRequest { to: down.clone(), ..go.clone() },
        PathRequest { to: down, tcp_motion: TcpMotion::Linear, ..go.clone() },
        PathRequest { carried: carried(cell, 0.2), ..go.clone() },
        PathRequest { carried: carried(cell, 0.5), ..go.clone() },
    ]
}

/// An answer without the times of the machine.
fn lasting(answer: PathAnswer) -> PathAnswer {
    let timed = answer.timed.map(|mut timed| {
        timed.path.planning_time = Duration::ZERO;
        timed.path.simplification_time = Duration::ZERO;
        timed
    });
    PathAnswer { timed, map_time: None, planning_us: 0, simplify_us: 0, ..answer }
}

#[test]
fn an_answer_does_not_depend_on_what_was_asked_before() {
    let cell = cell();
    let requests = requests(&cell);
    let alone: Vec<PathAnswer> = requests.iter().map(|request| lasting(plan(&cell, request).unwrap())).collect();
    let reasons: Vec<_> = alone.iter().filter_map(|answer| answer.reason.as_deref()).collect();
    assert!(reasons.is_empty(), "{reasons:?}");
    // The post is in the way, and aside it is not.
    let length = |i: usize| alone[i].timed.as_ref().unwrap().path.length_rad;
    assert!(length(0) > length(2) + 0.1 && length(1) > length(2) + 0.1);
    let mut query = PathQuery::new(&cell).unwrap();
    let order = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 9, 0, 5, 10, 1, 8, 0, 2, 3, 7, 6, 4, 10, 1, 3, 9];
    for i in order {
        assert!(lasting(query.plan(&requests[i]).unwrap()) == alone[i], "request {i}");
    }
}

#[test]
fn a_refused_request_leaves_the_query_as_it_was() {
    let (cell, go) = (cell(), request("arm", &HERE, &THERE));
    let mut query = PathQuery::new(&cell).unwrap();
    let before = lasting(query.plan(&go).unwrap());
    let mut inside = THERE;
    inside[0] = 0.0;
    for wrong in [
        request("nobody", &HERE, &THERE),
        request("arm", &HERE, &inside),
        request("arm", &HERE, &THERE[..5]),
        PathRequest {
            options: RrtConnectSettings { clearance_m: f64::NAN, ..RrtConnectSettings::default() },
            ..go.clone()
        },
    ] {
        let refused = query.plan(&wrong).unwrap_err();
        assert_eq!(refused, plan(&cell, &wrong).unwrap_err());
    }
    assert!(lasting(query.plan(&go).unwrap()) == before);
}

#[test]
fn a_search_is_interrupted_from_another_thread() {
    let (cell, mut go) = (cell(), request("arm", &HERE, &THERE));
    (go.options.max_states, go.options.time_limit) = (u64::MAX, Duration::from_mins(1));
    let mut query = PathQuery::new(&cell).unwrap();
    query.plan(&go).unwrap();
    // A search for shorter paths ends at its time limit.
    let interrupt = Interrupt::default();
    let begin = Instant::now();
    let found = std::thread::scope(|threads| {
        threads.spawn(|| {
            std::thread::sleep(Duration::from_millis(300));
            interrupt.set();
        });
        query.plan_with(&PathRequest { optimize: true, ..go.clone() }, &interrupt).unwrap()
    });
    assert!(found.found && begin.elapsed() < Duration::from_secs(20), "{:?}", begin.elapsed());
    // The next search is not interrupted.
    assert!(query.plan(&go).unwrap().found);
}
