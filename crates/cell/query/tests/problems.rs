//! Sets of planning problems: their scenes, and their solutions.

use std::path::Path;

use elbowroom_formats::Diagnostic;
use elbowroom_formats::problem_set::{self, PlanningProblem};
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_kinematics::{ChainState, TrajectoryRow};
use elbowroom_query::problems::{
    CoverRrtConnectEngine, ProblemModel, ProblemResult, ProblemSettings, ProblemSummary, RrtConnectEngine, run,
};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, SceneState};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::folder;
use serde_json::{Value, json};

/// An arm of 1 m that turns about z, and a finger at its end that slides up.
const URDF: &str = r#"<robot name="crane">
<link name="base"/>
<link name="arm"><collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
<link name="finger"><collision><origin xyz="1 0 0.1"/><geometry><box size="0.05 0.05 0.05"/></geometry></collision></link>
<joint name="waist" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="lift" type="prismatic"><parent link="arm"/><child link="finger"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.1" velocity="0.5" effort="1"/></joint>
</robot>"#;

/// A problem for the waist, with the finger at 0.02 m.
fn problem(objects: &Value, from: f64, to: f64) -> Value {
    json!({
        "scene": {"world": {"collision_objects": objects}},
        "request": {
            "start_state": {"joint_state": {"name": ["waist", "lift"], "position": [from, 0.02]}},
            "goal_constraints": [{"joint_constraints": [{"joint_name": "waist", "position": to}]}]
        }
    })
}

/// A ball of 0.1 m.
fn ball(id: &str, at: [f64; 3]) -> Value {
    let primitives = json!([{"type": "sphere", "dimensions": [0.1]}]);
    json!({"id": id, "primitives": primitives, "primitive_poses": [{"position": at}]})
}

fn parse(problems: &[Value]) -> Vec<PlanningProblem> {
    let set: serde_json::Map<String, Value> =
        problems.iter().enumerate().map(|(i, p)| (i.to_string(), p.clone())).collect();
    problem_set::parse(Path::new("p.json"), json!({"set": set}).to_string().as_bytes()).unwrap().problems
}

fn model_of(urdf: &str, problems: &[PlanningProblem]) -> Result<ProblemModel, Diagnostic> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("crane.urdf");
    std::fs::write(&path, urdf).unwrap();
    let robot = robot::load(&path, &LoadOptions::default()).unwrap().robot;
    ProblemModel::new(&path, robot, &[], Path::new("p.json"), problems)
}

/// Results with the values of the last waypoint; empty without a path.
fn solve(problems: &[Value]) -> (Vec<(ProblemResult, Vec<f64>)>, Vec<Diagnostic>) {
    let problems = parse(problems);
    let model = model_of(URDF, &problems).unwrap_or_else(|e| panic!("{e}"));
    let settings = ProblemSettings { time_limit: std::time::Duration::from_millis(300), ..ProblemSettings::default() };
    let mut ends = Vec::new();
    let results = run(&model, &problems, &settings, &mut RrtConnectEngine, &mut |result, timed| {
        let end = timed.and_then(|timed| timed.trajectory.rows().last()).map(|row| {
            assert_eq!(Some(row.t_s), result.duration_s);
            row.q.clone()
        });
        ends.push(end.unwrap_or_default());
        true
    });
    (results.unwrap().into_iter().zip(ends).collect(), model.warnings)
}

fn only(problem: Value) -> ProblemResult {
    solve(&[problem]).0.remove(0).0
}

fn reason(result: &ProblemResult) -> &str {
    result.reason.as_deref().unwrap_or_default()
}

#[test]
fn free_goals_are_reached_and_blocked_ones_are_not() {
    let post = json!([ball("post", [0.8, 0.0, 0.0])]);
    let (results, _) = solve(&[
        problem(&json!([]), -1.0, 1.0),
        problem(&post, -1.0, 1.0),
        problem(&post, 0.0, 1.0),
        problem(&post, 1.0, 0.1),
        problem(&post, 1.0, 3.5),
    ]);
    let facts: Vec<_> = results.iter().map(|(r, _)| (r.valid, r.found, r.proven, r.duration_s.is_some())).collect();
    let (solved, blocked, invalid) =
        ((true, true, true, true), (true, false, false, false), (false, false, false, false));
    assert_eq!(facts, [solved, blocked, invalid, invalid, invalid]);
    assert_eq!(results[0].1, [1.0, 0.02]);
    assert_eq!((results[0].0.cost_rad, results[0].0.cost_raw_rad), (Some(2.0), Some(2.0)));
    assert!(reason(&results[1].0).contains("proves nothing") && results[1].0.planning_us > Some(0.0));
    assert_eq!(reason(&results[2].0), "start: `arm` and `post` are in collision");
    assert_eq!(reason(&results[3].0), "goal: `arm` and `post` are in collision");
    assert!(reason(&results[4].0).contains("`waist` is 3.5, beyond its limits -3 to 3"));
    let results: Vec<ProblemResult> = results.into_iter().map(|(r, _)| r).collect();
    let summary = ProblemSummary::of(&results);
    let all = &summary.all;
    assert_eq!((all.total, all.valid, all.solved, all.proven), (5, 2, 1, 1));
    assert_eq!((all.cost_rad, all.planning_us.map(|t| t.p50)), (Some(2.0), results[0].planning_us));
    assert_eq!(summary.sets.len(), 1);
    assert_eq!(ProblemSummary::of(&results[1..]).all.planning_us, None);
}

#[test]
fn of_several_goals_a_free_one_is_reached() {
    let mut problem = problem(&json!([ball("post", [0.8, 0.0, 0.0])]), 0.5, 0.0);
    let other = json!({"joint_constraints": [{"joint_name": "waist", "position": 2.0}]});
    problem["request"]["goal_constraints"].as_array_mut().unwrap().push(other);
    let (results, _) = solve(&[problem]);
    assert_eq!((results[0].0.found, &results[0].1[..]), (true, &[2.0, 0.02][..]));
}

#[test]
fn pairs_that_the_matrix_allows_may_touch() {
    let mut allowed = problem(&json!([ball("post", [0.8, 0.0, 0.0])]), -1.0, 1.0);
    let matrix = |names: Value| json!({"entry_names": names, "entry_values": [[false, true], [true, false]]});
    allowed["scene"]["allowed_collision_matrix"] = matrix(json!(["arm", "post"]));
    // The finger is above the ball.
    assert!(only(allowed.clone()).found);
    allowed["scene"]["allowed_collision_matrix"] = matrix(json!(["finger", "post"]));
    assert!(!only(allowed.clone()).found);
    allowed["scene"]["allowed_collision_matrix"] = json!({"entry_names": [], "entry_values": [],
        "default_entry_names": ["post"], "default_entry_values": [true]});
    assert!(only(allowed).found);
}

#[test]
fn held_objects_move_along_and_may_touch_what_they_name() {
    let held =
        |touch: Value| json!([{"link_name": "arm", "touch_links": touch, "object": ball("part", [1.0, 0.0, 0.12])}]);
    // Beside the arm, in reach of the part.
    let mut carrying = problem(&json!([ball("post", [0.0, 1.15, 0.15])]), -1.0, 1.57);
    assert!(only(carrying.clone()).found);
    carrying["request"]["start_state"]["attached_collision_objects"] = held(json!(["finger"]));
    assert_eq!(reason(&only(carrying.clone())), "goal: `post` and `part` are in collision");
    carrying["request"]["start_state"]["attached_collision_objects"] = held(json!([]));
    assert!(reason(&only(carrying)).contains("`finger` and `part`"));
}

#[test]
fn frames_are_links_at_the_start_fixed_frames_and_the_world() {
    let in_frame = |frame: &str| {
        let mut object = ball(frame, [0.5, 0.2, 0.0]);
        object["header"] = json!({"frame_id": frame});
        object
    };
    let mut placed =
        problem(&json!([in_frame("arm"), in_frame("rack"), in_frame("world")]), std::f64::consts::FRAC_PI_2, 2.0);
    placed["scene"]["fixed_frame_transforms"] = json!([
        {"child_frame_id": "rack", "header": {"frame_id": "world"}, "transform": {"translation": [0, 0, 2]}},
        {"child_frame_id": "world", "transform": {}}]);
    placed["request"]["start_state"]["multi_dof_joint_state"] =
        json!({"joint_names": ["cart"], "transforms": [{"translation": [3, 0, 0]}]});
    let problems = parse(&[placed.clone()]);
    let model = model_of(URDF, &problems).unwrap();
    let scene = model.problem_scene(&problems[0]).unwrap();
    let at: Vec<Vec3> = scene.scene().objects().iter().map(|o| o.in_world.translation).collect();
    let expected = [Vec3::new(-0.2, 0.5, 0.0), Vec3::new(-2.5, 0.2, 2.0), Vec3::new(-2.5, 0.2, 0.0)];
    assert!(at.iter().zip(expected).all(|(a, e)| a.distance(e) < 1e-12), "{at:?}");

    placed["scene"]["world"]["collision_objects"][0]["header"]["frame_id"] = json!("arms");
    let message = model_of(URDF, &parse(&[placed.clone()])).unwrap_err().to_string();
    let expected = ["p.json: set `set`, problem `0`: the frame `arms`", "write: arm"];
    assert!(expected.iter().all(|e| message.contains(e)), "{message}");
    // Frames that refer to each other.
    placed["scene"]["fixed_frame_transforms"] = json!([
        {"child_frame_id": "arms", "header": {"frame_id": "b"}}, {"child_frame_id": "b", "header": {"frame_id": "arms"}}]);
    assert!(model_of(URDF, &parse(&[placed])).is_err());
}

#[test]
fn joints_that_are_not_planned_are_held_even_beyond_their_limits() {
    let mut wide = problem(&json!([]), -1.0, 1.0);
    wide["request"]["start_state"]["joint_state"] =
        json!({"name": ["lift", "waist", "wheel"], "position": [0.15, -1, 0]});
    let mut unknown_start = wide.clone();
    unknown_start["request"]["start_state"]["joint_state"] = json!({"name": ["waist"], "position": [-1]});
    let (results, warnings) = solve(&[wide, unknown_start]);
    assert_eq!(results.iter().map(|(_, end)| end.clone()).collect::<Vec<_>>(), [[1.0, 0.15], [1.0, 0.0]]);
    let warnings: Vec<&str> = warnings.iter().map(|w| w.message.as_str()).collect();
    for (warning, expected) in warnings.iter().zip(["`wheel`", "`lift` is held at 0.15", "no value for `lift`"]) {
        assert!(warning.contains(expected), "{warnings:?}");
    }
    // A joint that another problem plans has the limits of that problem there.
    let mut planned = problem(&json!([]), -1.0, 1.0);
    planned["request"]["goal_constraints"][0]["joint_constraints"]
        .as_array_mut()
        .unwrap()
        .push(json!({"joint_name": "lift", "position": 0.12}));
    let mut held = problem(&json!([]), -1.0, 1.0);
    held["request"]["start_state"]["joint_state"]["position"] = json!([-1, 0.15]);
    let (results, _) = solve(&[planned, held]);
    assert!(reason(&results[0].0).contains("`lift` is 0.12, beyond its limits 0 to 0.1") && results[1].0.found);
}

#[test]
fn an_end_beyond_a_limit_by_rounding_is_reached_exactly() {
    let (results, _) = solve(&[problem(&json!([]), -1.0, 3.000_002), problem(&json!([]), -1.0, 3.001)]);
    assert_eq!((results[0].0.found, &results[0].1[..]), (true, &[3.000_002, 0.02][..]));
    assert!(!results[1].0.valid);
}

#[test]
fn joints_without_speed_are_named_and_their_paths_not_timed() {
    let problems = parse(&[problem(&json!([]), -1.0, 1.0)]);
    let model = model_of(&URDF.replace(" velocity=\"1\"", ""), &problems).unwrap();
    assert_eq!(model.joints_without_speed, ["waist"]);
    let results = run(&model, &problems, &ProblemSettings::default(), &mut RrtConnectEngine, &mut |_, motion| {
        assert!(motion.is_none());
        true
    });
    let result = &results.unwrap()[0];
    assert!(result.found && result.duration_s.is_none() && reason(result).contains("not timed"));
    // A joint that is held needs no speed.
    let model = model_of(&URDF.replace(" velocity=\"0.5\"", ""), &problems).unwrap();
    assert_eq!(model.joints_without_speed, [] as [&str; 0]);
}

#[test]
fn goals_of_other_robots_are_refused() {
    let mut other = problem(&json!([]), -1.0, 1.0);
    other["request"]["goal_constraints"][0]["joint_constraints"][0]["joint_name"] = json!("wrist");
    let message = model_of(URDF, &parse(&[other])).unwrap_err().to_string();
    assert!(
        message.contains("problem `0`: the goal names `wrist`") && message.contains("write: waist   (did you mean it?")
    );
}

/// A problem of the crane with a kind of motion.
fn requested(planner: &str, objects: &Value, from: f64, to: f64) -> Value {
    let mut problem = problem(objects, from, to);
    problem["request"]["planner_id"] = json!(planner);
    problem
}

#[test]
fn a_joint_motion_is_straight_or_says_what_is_in_its_way() {
    let post = json!([ball("post", [0.8, 0.0, 0.0])]);
    // A goal beyond the post, then a free one.
    let mut several = requested("PTP", &post, -1.0, 1.0);
    let other = json!({"joint_constraints": [{"joint_name": "waist", "position": -2.0}]});
    several["request"]["goal_constraints"].as_array_mut().unwrap().push(other);
    let (results, _) = solve(&[requested("PTP", &json!([]), -1.0, 1.0), requested("PTP", &post, -1.0, 1.0), several]);
    let facts: Vec<_> = results.iter().map(|(r, _)| (r.motion, r.found, r.proven, r.cost_rad)).collect();
    let ptp = Some("PTP");
    assert_eq!(facts, [(ptp, true, true, Some(2.0)), (ptp, false, false, None), (ptp, true, true, Some(1.0))]);
    assert_eq!((&results[0].1[..], &results[2].1[..]), (&[1.0, 0.02][..], &[-2.0, 0.02][..]));
    // The side of the arm, 0.05 from its middle, meets the ball of 0.1 at 0.8 where 0.8 sin q = 0.15.
    let percent = 100.0 * (1.0 - f64::asin(0.15 / 0.8)) / 2.0;
    let words = format!("is free for {percent:.1} % only, there `arm` and `post` meet");
    assert!(reason(&results[1].0).contains(&words), "{words}: {}", reason(&results[1].0));
    assert!(results.iter().all(|(r, _)| r.line_deviation_m.is_none()));
    // The engine without covers has no lines, and says so.
    let line = only(requested("LIN", &json!([]), -1.0, 1.0));
    assert!(line.motion == Some("LIN") && !line.found && reason(&line).contains("enclosed in spheres"), "{line:?}");
}

/// Solves the first problems of each set; a separate checker finds the rows of the paths free.
fn first_of_each_set(urdf: &Path, srdf: &Path, file: &Path, per_set: usize, seed: u64) {
    let all = problem_set::read(file).unwrap_or_else(|e| panic!("{e}")).problems;
    let mut problems: Vec<PlanningProblem> = Vec::new();
    for problem in all {
        if problems.iter().filter(|p| p.set == problem.set).count() < per_set {
            problems.push(problem);
        }
    }
    let options = LoadOptions { srdf: Some(srdf.to_owned()), ..LoadOptions::default() };
    let robot = robot::load(urdf, &options).unwrap_or_else(|e| panic!("{e}")).robot;
    let model = ProblemModel::new(urdf, robot, &[], file, &problems).unwrap_or_else(|e| panic!("{e}"));
    let settings =
        ProblemSettings { time_limit: std::time::Duration::from_mins(1), seed, ..ProblemSettings::default() };
    let mut n = 0;
    let results = run(&model, &problems, &settings, &mut RrtConnectEngine, &mut |_, timed| {
        let (problem, timed) = (model.problem_scene(&problems[n]).unwrap(), timed.expect("a timed path"));
        let scene = problem.scene();
        let mut checker = Checker::new(scene, CheckerOptions::default());
        let mut state: SceneState = problem.start().clone();
        assert_eq!(timed.trajectory.first(), Some(state.q(RobotId(0))));
        assert_eq!(timed.trajectory.last(), Some(&problem.goals()[0][..]));
        for TrajectoryRow { q, .. } in timed.trajectory.rows().iter().step_by(10) {
            state.set_q(scene, RobotId(0), q).unwrap();
            assert_eq!(checker.collides(&state), None);
        }
        n += 1;
        true
    });
    let summary = ProblemSummary::of(&results.unwrap());
    eprintln!("{}", serde_json::to_string(&summary.all).unwrap());
    assert_eq!((summary.sets.len(), summary.all.proven), (7, 7 * per_set));
}

#[test]
fn panda_with_meshes_solves_the_first_of_each_set() {
    let Some(data) = folder::data_part("problems") else { return };
    let model = data.join("../urdf/panda");
    let file = data.join("mbm_panda/problems_first100.json");
    first_of_each_set(&model.join("panda.urdf"), &model.join("panda.srdf"), &file, 2, 1);
}

/// The flange of the Panda moves straight, in every row, to the pose of the goal; the finger joints stay.
#[test]
fn panda_moves_its_flange_straight() {
    let Some(data) = folder::data_part("problems") else { return };
    let model = data.join("../urdf/panda");
    let (urdf, srdf) = (model.join("panda.urdf"), model.join("panda.srdf"));
    let names: Vec<String> = (1..=7).map(|i| format!("panda_joint{i}")).collect();
    let ready = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let near = [0.25, -0.6, 0.1, -2.2, 0.1, 1.7, 0.6];
    let goal: Vec<Value> = names.iter().zip(near).map(|(name, q)| json!({"joint_name": name, "position": q})).collect();
    let request = |planner: &str| {
        json!({"scene": {}, "request": {"group_name": "panda_arm", "planner_id": planner,
            "pipeline_id": "pilz_industrial_motion_planner",
            "start_state": {"joint_state": {"name": names, "position": ready}},
            "goal_constraints": [{"joint_constraints": goal}]}})
    };
    let problems = parse(&[request("LIN"), request("PTP")]);
    let loaded = robot::load(&urdf, &LoadOptions { srdf: Some(srdf), ..LoadOptions::default() }).unwrap();
    let (chain, groups) = (loaded.robot.chain.clone(), loaded.srdf.unwrap().groups);
    let [[_, tip]] = &groups.iter().find(|g| g.name == "panda_arm").unwrap().chains[..] else { panic!("a chain") };
    let tip = chain.link(tip).unwrap();
    let model = ProblemModel::new(&urdf, loaded.robot, &groups, Path::new("p.json"), &problems).unwrap();
    let position = |q: &[f64]| {
        let mut state = ChainState::new(&chain);
        state.q.copy_from_slice(q);
        chain.forward(&mut state);
        state.link_in_root(tip).translation
    };
    let mut off_m = Vec::new();
    let settings = ProblemSettings::default();
    let mut engine = CoverRrtConnectEngine::default();
    let results = run(&model, &problems, &settings, &mut engine, &mut |_, timed| {
        let (goal, rows) =
            (model.problem_scene(&problems[0]).unwrap().goals()[0].clone(), timed.unwrap().trajectory.rows());
        let (from, to) = (position(&rows[0].q), position(&goal));
        assert!(position(&rows.last().unwrap().q).distance(to) < 1e-6);
        assert!(rows.iter().all(|row| row.q[7..] == rows[0].q[7..]));
        let way = to - from;
        let distance = |q: &[f64]| (position(q) - from).cross(way).length() / way.length();
        off_m.push(rows.iter().map(|row| distance(&row.q)).fold(0.0, f64::max));
        true
    });
    let results = results.unwrap();
    eprintln!("LIN {:.3} mm, PTP {:.1} mm off the line: {results:?}", 1e3 * off_m[0], 1e3 * off_m[1]);
    let told = (results[0].line_deviation_m.unwrap(), results[0].line_deviation_rad.unwrap());
    assert!(off_m[0] <= told.0 + 1e-12 && told.0 < 1e-3 && told.1 < 3e-3, "{off_m:?} {told:?}");
    assert!(off_m[1] > 5e-3 && results[1].line_deviation_m.is_none(), "{off_m:?}");
}

#[test]
fn fetch_of_spheres_solves_the_first_of_each_set() {
    let Some(data) = folder::data_part("problems") else { return };
    let folder = data.join("mbm_fetch");
    // A seed with which the searches are short.
    let (urdf, srdf) = (folder.join("fetch_spherized.urdf"), folder.join("fetch.srdf"));
    first_of_each_set(&urdf, &srdf, &folder.join("problems_first50.json"), 1, 7);
}
