//! `elbowroom plan`: a collision-free, timed path.

use std::fmt::Write;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::Duration;

use elbowroom::analysis::plan::{self, PathAnswer, PathRequest, TimedPath};
use elbowroom::cell::Cell;
use elbowroom::planner::RrtConnectSettings;

use crate::args::PlanArgs;
use crate::output::{ExitStatus, Failure, cannot_write, note, print, print_json};
use crate::plan_problems;

pub(crate) fn plan(args: &PlanArgs) -> Result<ExitStatus, Failure> {
    if let (Some(urdf), Some(file)) = (&args.problems.urdf, &args.problems.problems) {
        return plan_problems::run(urdf, file, args);
    }
    // clap requires a cell and a goal where there are no problems.
    let cell = Cell::load(args.cell.as_deref().unwrap_or(Path::new("")))?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let request = PathRequest {
        robot: args.robot.clone(),
        from: args.from.as_ref().map(|q| q.0.clone()),
        to: args.to.as_ref().map(|q| q.0.clone()).unwrap_or_default(),
        options: RrtConnectSettings {
            time_limit: Duration::from_secs_f64(args.time_limit),
            clearance_m: args.clearance,
            seed: args.seed,
            ..RrtConnectSettings::default()
        },
        period_s: args.period,
        optimize: args.optimize,
    };
    let answer = plan::plan(&cell, &request)?;
    if let (Some(path), Some(motion)) = (&args.out, &answer.motion) {
        let file = File::create(path).map(BufWriter::new).map_err(cannot_write(path))?;
        motion.write_csv(&answer.joints, file).map_err(cannot_write(path))?;
    }
    if args.json {
        print_json(&answer)?;
    } else {
        print(&text(&answer))?;
        if let (Some(path), Some(motion)) = (&args.out, &answer.motion) {
            print(&format!("\n{} rows in {}\n", motion.rows.len(), path.display()))?;
        }
    }
    Ok(if answer.found { ExitStatus::Success } else { ExitStatus::NegativeResult })
}

/// The table for the terminal. Writing to a String cannot fail.
fn text(answer: &PathAnswer) -> String {
    let milliseconds = |us: u64| us as f64 / 1000.0;
    let Some(motion) = &answer.motion else {
        let reason = answer.reason.as_deref().unwrap_or("no path found");
        return format!("{}: {reason}\n", answer.robot);
    };
    let TimedPath { waypoints, cost_rad, duration_s, stops, .. } = motion;
    let stops = match stops {
        0 => "without a stop".into(),
        1 => "one stop on the way".into(),
        n => format!("{n} stops on the way"),
    };
    let legs = waypoints.len().saturating_sub(1);
    let legs = if legs == 1 { "straight".into() } else { format!("{legs} straight stretches") };
    let mut out = format!("{}: {legs}, {cost_rad:.4} rad in joint space, {duration_s:.3} s, {stops}\n", answer.robot);
    let (searched, shortened) = (milliseconds(answer.planning_us), milliseconds(answer.simplify_us));
    if !answer.regions.is_empty() {
        let _ = writeln!(out, "stays out of {}", answer.regions.join(", "));
    }
    let _ = write!(out, "searched for {searched:.1} ms, made short in {shortened:.1} ms\n\n     ");
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
