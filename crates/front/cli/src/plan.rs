//! `elbowroom plan`: a collision-free, timed path.

use std::fmt::Write;
use std::path::Path;

use elbowroom::cell::Cell;
use elbowroom::query::plan::{self, PathAnswer, PathPlanner, PathRequest, PointPath};

use crate::carry;
use crate::output::{ExitStatus, Failure, note, print, print_json};
use crate::output_file::write_file;
use crate::plan_args::{PlanArgs, Planner};
use crate::plan_goal::{at_most_one, goal, tcp_motion};
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
        tcp_motion: tcp_motion(args, &cell),
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
    if let Some(point) = &answer.point {
        let _ = writeln!(out, "{}", point_text(point));
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

fn point_text(point: &PointPath) -> String {
    let place = |at: Option<&[f64; 3]>| at.map(|at| at.map(|v| format!("{v:.4}")).join(", ")).unwrap_or_default();
    let (from, to) = (place(point.waypoints_m.first()), place(point.waypoints_m.last()));
    format!("the point of {} goes {:.3} m from {from} to {to} m", point.link, point.length_m)
}
