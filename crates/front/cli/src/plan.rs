//! `elbowroom plan`: a collision-free, timed path.

use std::fmt::Write;
use std::path::Path;

use elbowroom::cell::{Cell, QUATERNION_TOLERANCE, TcpTarget};
use elbowroom::kinematics::inverse::ConfigurationChoice;
use elbowroom::query::plan::{self, PathAnswer, PathGoal, PathPlanner, PathRequest};
use elbowroom::spatial::{Pose, Rotation, Vec3};

use crate::arg_values::{Configuration, Numbers};
use crate::carry;
use crate::output::{ExitStatus, Failure, note, print, print_json};
use crate::output_file::write_file;
use crate::plan_args::{PlanArgs, Planner};
use crate::plan_request::{configuration, settings};
use crate::{plan_problems, plan_report, plan_several};

pub(crate) fn plan(args: &PlanArgs) -> Result<ExitStatus, Failure> {
    if let (Some(urdf), Some(file)) = (&args.problems.urdf, &args.problems.problems) {
        return plan_problems::run(urdf, file, args);
    }
    // clap requires a cell and a goal if there are no problems.
    let cell = Cell::load(args.cell.as_deref().unwrap_or(Path::new("")))?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    if args.robot.len() > 1 {
        return plan_several::plan(&cell, args);
    }
    let request = PathRequest {
        planner: planner(args)?,
        robot: args.robot.first().cloned(),
        from: at_most_one(args, "--from", &args.from)?
            .map(|from| configuration(args, &cell, None, from))
            .transpose()?,
        to: goal(args, &cell)?,
        speed: 1.0,
        options: settings(args),
        period_s: args.period,
        optimize: args.search.optimize,
        carried: carry::attachments(&cell, &args.carry)?,
        ..PathRequest::default()
    };
    let answer = plan::plan(&cell, &request)?;
    if let (Some(path), Some(timed)) = (&args.out, &answer.timed) {
        write_file(path, |out| plan::write_csv(&answer.joints, &timed.trajectory, out))?;
    }
    if let (Some(path), Some(timed)) = (&args.report, &answer.timed) {
        let (id, _) = plan::select_robot(&cell, request.robot.as_deref())?;
        plan_report::write(path, &cell, vec![(id, timed.trajectory.clone())])?;
    }
    if args.json {
        print_json(&answer)?;
    } else {
        print(&text(&answer))?;
        if let (Some(path), Some(timed)) = (&args.out, &answer.timed) {
            print(&format!("\n{} rows in {}\n", timed.trajectory.rows().len(), path.display()))?;
        }
    }
    Ok(if answer.found { ExitStatus::Success } else { ExitStatus::NegativeResult })
}

fn planner(args: &PlanArgs) -> Result<PathPlanner, Failure> {
    match args.search.planner {
        Planner::RrtConnect => Ok(PathPlanner::RrtConnect),
        Planner::Grid if args.search.optimize => {
            let what = "--optimize is for --planner rrt-connect: a path on a map is made short at once";
            Err(Failure::Wrong(format!("{what}\n  write: --planner rrt-connect --optimize")))
        }
        Planner::Grid => Ok(PathPlanner::Grid),
    }
}

/// Returns the value of an option that takes one value per robot; an error if there are several.
fn at_most_one<'a, T>(args: &PlanArgs, option: &str, given: &'a [T]) -> Result<Option<&'a T>, Failure> {
    if given.len() > 1 {
        let (count, robots) = (given.len(), args.robot.len());
        let what =
            format!("{option} is given {count} times, --robot {robots} times: for several robots name each of them");
        return Err(Failure::Wrong(format!("{what}\n  write: --robot a --to q,… --robot b --to q,…")));
    }
    Ok(given.first())
}

fn goal(args: &PlanArgs, cell: &Cell) -> Result<PathGoal, Failure> {
    if let Some(Numbers(numbers)) = &args.to_pose {
        return tcp_target(args, cell, numbers).map(PathGoal::Tcp);
    }
    // clap requires a goal.
    let none = Configuration::Values(Vec::new());
    let to = at_most_one(args, "--to", &args.to)?.unwrap_or(&none);
    configuration(args, cell, None, to).map(PathGoal::Joints)
}

/// Reads the pose and the wanted solution of inverse kinematics.
fn tcp_target(args: &PlanArgs, cell: &Cell, numbers: &[f64]) -> Result<TcpTarget, Failure> {
    let in_world = pose(cell, numbers)?;
    let near = args.near.as_ref().map(|near| near_values(args, cell, near)).transpose()?;
    let words = args.configuration.iter().map(String::as_str);
    let configuration = ConfigurationChoice::from_words(words)
        .map_err(|e| Failure::Wrong(format!("--configuration: {e}\n  write: --configuration front,up,no_flip")))?;
    let (_, robot) = plan::select_robot(cell, args.robot.first().map(String::as_str))?;
    if !configuration.is_open() && robot.ik_solver().configuration(&robot.start).is_none() {
        let what = format!("--configuration: robot \"{}\" has not six axes with a spherical wrist", robot.name);
        return Err(Failure::Wrong(format!("{what}\n  write: --near q,…   (the nearest solution to them is taken)")));
    }
    Ok(TcpTarget { in_world, configuration, near })
}

fn near_values(args: &PlanArgs, cell: &Cell, near: &Configuration) -> Result<Vec<f64>, Failure> {
    let q = configuration(args, cell, None, near)?;
    let (_, robot) = plan::select_robot(cell, args.robot.first().map(String::as_str))?;
    let joints = robot.joint_names();
    if q.len() == joints.len() {
        return Ok(q);
    }
    let what = format!("--near has {} values for {} joints", q.len(), joints.len());
    Err(Failure::Wrong(format!("{what}\n  write: one value per joint, in this order: {}", joints.join(", "))))
}

/// Reads a pose: x, y, z and roll, pitch, yaw, or a quaternion x, y, z, w.
fn pose(cell: &Cell, numbers: &[f64]) -> Result<Pose, Failure> {
    let wrong =
        |what: &str| Failure::Wrong(format!("--to-pose: {what}\n  write: x,y,z,roll,pitch,yaw or x,y,z,qx,qy,qz,qw"));
    let (Some(&[x, y, z]), turn) = (numbers.first_chunk::<3>(), &numbers[numbers.len().min(3)..]) else {
        return Err(wrong("fewer than six numbers"));
    };
    let at = Vec3::new(x, y, z) * cell.units.length.to_metres(1.0);
    let rotation = match *turn {
        [roll, pitch, yaw] => {
            let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle| cell.units.angle.to_radians(angle));
            Rotation::from_rpy(roll, pitch, yaw)
        }
        [qx, qy, qz, qw] => {
            let length = (qx * qx + qy * qy + qz * qz + qw * qw).sqrt();
            // As in a cell file.
            let is_unit = (length - 1.0).abs() <= QUATERNION_TOLERANCE;
            let rotation = Rotation::from_quaternion_xyzw([qx, qy, qz, qw]).filter(|_| is_unit);
            rotation.ok_or_else(|| wrong(&format!("a quaternion of length {length}, and a rotation has 1")))?
        }
        _ => return Err(wrong(&format!("{} numbers", numbers.len()))),
    };
    Ok(Pose::new(rotation, at))
}

/// Formats the table for the terminal. Writing to a String cannot fail.
fn text(answer: &PathAnswer) -> String {
    let milliseconds = |us: u64| us as f64 / 1000.0;
    let Some(timed) = &answer.timed else {
        let reason = answer.reason.as_deref().unwrap_or("no path found");
        return format!("{}: {reason}\n", answer.robot);
    };
    let (waypoints, cost_rad, duration_s) =
        (&timed.path.waypoints, timed.path.length_rad, timed.trajectory.duration_s());
    let stops = match timed.stops {
        0 => "without a stop".into(),
        1 => "one stop on the way".into(),
        n => format!("{n} stops on the way"),
    };
    let legs = waypoints.len().saturating_sub(1);
    let legs = if legs == 1 { "straight".into() } else { format!("{legs} straight stretches") };
    let mut out = format!("{}: {legs}, {cost_rad:.4} rad in joint space, {duration_s:.3} s, {stops}\n", answer.robot);
    if let Some(configuration) = answer.configuration {
        let _ = writeln!(out, "ends in the configuration {configuration}");
    }
    let (searched, shortened) = (milliseconds(answer.planning_us), milliseconds(answer.simplify_us));
    if !answer.regions.is_empty() {
        let _ = writeln!(out, "stays out of {}", answer.regions.join(", "));
    }
    let _ = match answer.map_time {
        Some(map) => write!(out, "made the map in {:.1} ms, searched it for {searched:.1} ms", 1e3 * map.as_secs_f64()),
        None => write!(out, "searched for {searched:.1} ms, made short in {shortened:.1} ms"),
    };
    out += "\n\n     ";
    let width = |joint: &str| joint.chars().count().max(9) + 2;
    for joint in &answer.joints {
        let _ = write!(out, "{joint:>0$}", width(joint));
    }
    for (n, q) in waypoints.iter().enumerate() {
        let _ = write!(out, "\n{n:>5}");
        for (joint, v) in answer.joints.iter().zip(q) {
            let _ = write!(out, "{v:>0$.4}", width(joint));
        }
    }
    out.push('\n');
    out
}
