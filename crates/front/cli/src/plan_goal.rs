//! The goal of `elbowroom plan`: joint values, a pose of the TCP, or a place of a point.

use elbowroom::cell::{Cell, QUATERNION_TOLERANCE, TcpTarget};
use elbowroom::formats::suggest;
use elbowroom::kinematics::inverse::ConfigurationChoice;
use elbowroom::planner::PointGoal;
use elbowroom::query::plan::{self, KeptAxis, PathGoal, TcpMotion};
use elbowroom::spatial::{Pose, Rotation, Vec3};

use crate::arg_values::{Configuration, KeptAxisArg, LinkPoint, Numbers};
use crate::output::Failure;
use crate::plan_args::PlanArgs;
use crate::plan_request::configuration;

/// Returns the value of an option that takes one value per robot; an error if there are several.
pub(crate) fn at_most_one<'a, T>(args: &PlanArgs, option: &str, given: &'a [T]) -> Result<Option<&'a T>, Failure> {
    if given.len() > 1 {
        let (count, robots) = (given.len(), args.robot.len());
        let what =
            format!("{option} is given {count} times, --robot {robots} times: for several robots name each of them");
        return Err(Failure::Wrong(format!("{what}\n  write: --robot a --to q,… --robot b --to q,…")));
    }
    Ok(given.first())
}

pub(crate) fn goal(args: &PlanArgs, cell: &Cell) -> Result<PathGoal, Failure> {
    if let Some(Numbers(numbers)) = &args.goal.to_pose {
        return tcp_target(args, cell, numbers).map(PathGoal::Tcp);
    }
    if let (Some(point), Some(to)) = (&args.goal.point, &args.goal.to_point) {
        return point_goal(args, cell, point, to).map(PathGoal::Point);
    }
    // clap requires a goal.
    let none = Configuration::Values(Vec::new());
    let to = at_most_one(args, "--to", &args.goal.to)?.unwrap_or(&none);
    configuration(args, cell, None, to).map(PathGoal::Joints)
}

/// Reads how the TCP moves.
pub(crate) fn tcp_motion(args: &PlanArgs, cell: &Cell) -> TcpMotion {
    match args.tcp.keep {
        Some(KeptAxisArg { axis, angle }) => TcpMotion::KeptAxis(KeptAxis {
            axis_in_tcp: Vec3::from(axis),
            tolerance_rad: cell.units.angle.to_radians(angle),
        }),
        None if args.tcp.linear => TcpMotion::Linear,
        None => TcpMotion::Free,
    }
}

/// Reads a point of a link and its place.
fn point_goal(args: &PlanArgs, cell: &Cell, point: &LinkPoint, to: &Numbers) -> Result<PointGoal, Failure> {
    let (_, robot) = plan::select_robot(cell, args.robot.first().map(String::as_str))?;
    // `query` writes robot/link.
    let in_query = || point.link.strip_prefix(&robot.name)?.strip_prefix('/');
    let chain = &robot.robot.chain;
    let Some(link) = chain.link(&point.link).or_else(|| chain.link(in_query()?)) else {
        let hint = suggest::hint(&point.link, chain.links().iter().map(String::as_str));
        let what = format!("--point: robot \"{}\" has no link \"{}\"\n  write: {hint}", robot.name, point.link);
        return Err(Failure::Wrong(what));
    };
    let Ok(to) = <[f64; 3]>::try_from(&to.0[..]) else {
        return Err(Failure::Wrong(format!("--to-point has {} numbers\n  write: x,y,z", to.0.len())));
    };
    let metres = |numbers: [f64; 3]| Vec3::from(numbers) * cell.units.length.to_metres(1.0);
    Ok(PointGoal { link, point_in_link: metres(point.point), in_world: metres(to) })
}

/// Reads the pose and the wanted solution of inverse kinematics.
fn tcp_target(args: &PlanArgs, cell: &Cell, numbers: &[f64]) -> Result<TcpTarget, Failure> {
    let in_world = pose(cell, numbers)?;
    let near = args.goal.near.as_ref().map(|near| near_values(args, cell, near)).transpose()?;
    let words = args.goal.configuration.iter().map(String::as_str);
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
