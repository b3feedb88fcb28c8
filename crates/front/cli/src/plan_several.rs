//! `elbowroom plan` for several robots that move at the same time.

use std::fmt::Write;

use elbowroom::cell::Cell;
use elbowroom::kinematics::{JointTrajectory, TrajectoryRow};
use elbowroom::query::plan::{
    RobotPath, RobotPathRequest, SeveralPathsAnswer, SeveralPathsRequest, plan_several, select_robot,
};
use elbowroom::robot::RobotId;

use crate::output::{ExitStatus, Failure, print, print_json};
use crate::output_file::write_file;
use crate::plan_args::{PlanArgs, Planner};
use crate::plan_report;
use crate::plan_request::{configuration, settings};

pub(crate) fn plan(cell: &Cell, args: &PlanArgs) -> Result<ExitStatus, Failure> {
    let request = SeveralPathsRequest { robots: robots(cell, args)?, options: settings(args), period_s: args.period };
    let answer = plan_several(cell, &request)?;
    if let Some(path) = args.out.as_ref().filter(|_| answer.found) {
        write_file(path, |out| answer.write_csv(out))?;
    }
    if let Some(path) = args.report.as_ref().filter(|_| answer.found) {
        plan_report::write(path, cell, played(cell, &answer)?)?;
    }
    if args.json {
        print_json(&answer)?;
    } else {
        print(&text(&answer))?;
        if let Some(path) = args.out.as_ref().filter(|_| answer.found) {
            print(&format!("\n{} rows in {}\n", answer.trajectory.rows().len(), path.display()))?;
        }
    }
    Ok(if answer.found { ExitStatus::Success } else { ExitStatus::NegativeResult })
}

/// Splits the rows into the columns of each robot.
fn played(cell: &Cell, answer: &SeveralPathsAnswer) -> Result<Vec<(RobotId, JointTrajectory)>, Failure> {
    let mut first = 0;
    let of_robot = |path: &RobotPath| {
        let (id, _) = select_robot(cell, Some(&path.robot))?;
        let columns = first..first + path.joints.len();
        first = columns.end;
        let row = |row: &TrajectoryRow| TrajectoryRow { t_s: row.t_s, q: row.q[columns.clone()].to_vec() };
        Ok((id, JointTrajectory::new(answer.trajectory.rows().iter().map(row).collect())))
    };
    answer.robots.iter().map(of_robot).collect()
}

/// Collects the options of each robot, in the order of the command line.
fn robots(cell: &Cell, args: &PlanArgs) -> Result<Vec<RobotPathRequest>, Failure> {
    let count = args.robot.len();
    let wrong = |what: String| {
        let example = "--robot a --from start --to q,… --robot b --from q,… --to NAME";
        Err(Failure::Wrong(format!("{what}\n  write: {example}")))
    };
    let for_one = [
        (args.goal.to_pose.is_some(), "--to-pose"),
        (args.goal.to_point.is_some(), "--to-point"),
        (args.tcp.keep.is_some(), "--keep"),
        (args.search.optimize, "--optimize"),
        (args.search.planner == Planner::Grid, "--planner grid"),
    ];
    if let Some((_, option)) = for_one.iter().find(|(is_given, _)| *is_given) {
        return wrong(format!("{option} is for one robot, and there are {count}"));
    }
    if args.goal.to.len() != count {
        return wrong(format!("--to is given {} times for {count} robots: each needs a goal", args.goal.to.len()));
    }
    if !args.from.is_empty() && args.from.len() != count {
        return wrong(format!(
            "--from is given {} times for {count} robots: for all of them, or for none",
            args.from.len()
        ));
    }
    let one = |(i, robot): (usize, &String)| {
        let of_robot = |given| configuration(args, cell, Some(robot), given);
        let from = args.from.get(i).map(of_robot).transpose()?;
        Ok(RobotPathRequest { robot: robot.clone(), from, to: of_robot(&args.goal.to[i])? })
    };
    args.robot.iter().enumerate().map(one).collect()
}

/// Formats the table for the terminal. Writing to a String cannot fail.
fn text(answer: &SeveralPathsAnswer) -> String {
    let Some(duration_s) = answer.duration_s else {
        return format!("{}\n", answer.reason.as_deref().unwrap_or("no paths found"));
    };
    let width = answer.robots.iter().map(|r| r.robot.chars().count()).max().unwrap_or(0).max(5);
    let milliseconds = answer.planning_us as f64 / 1000.0;
    let mut out = format!(
        "{} robots at the same time, {duration_s:.3} s, planned in {milliseconds:.1} ms\n\n",
        answer.robots.len()
    );
    let _ = write!(out, "  {:<width$} {:>9} {:>9} {:>11} {:>12}", "robot", "starts", "ends", "stretches", "length");
    for r in &answer.robots {
        let legs = r.waypoints.len().saturating_sub(1);
        let _ = write!(
            out,
            "\n  {:<width$} {:>7.3} s {:>7.3} s {legs:>11} {:>8.4} rad",
            r.robot, r.start_s, r.end_s, r.cost_rad
        );
        if !r.regions.is_empty() {
            let _ = write!(out, "   stays out of {}", r.regions.join(", "));
        }
    }
    out.push('\n');
    out
}
