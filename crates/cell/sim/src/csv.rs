//! Writers of `trace.csv`, `events.csv`, `operator.csv` and `work_piece.csv`. Every number reads back to the same bits.

use std::io::{self, Write};

use elbowroom_robot::RobotId;

use crate::recording::Recording;

/// Columns that describe the governing point and obstacle.
const GOVERNING: &str = "part,object,point_x_m,point_y_m,point_z_m";

/// Writes `t_s,robot,q1..qn,tcp_x_m,tcp_y_m,tcp_z_m,tcp_speed_m_s,override,region,distance_m,part,object,point_x_m,
/// point_y_m,point_z_m`: one row per robot and tick, ordered by time, then robot.
///
/// `part` is the link, tool or load closest to the governing region; `point_…` is the point of that part closest to the
/// region; `object` is the obstacle that the robot evades or waits for. A column `grid.NAME` per grid of the cell follows: the
/// number of the cell that the robot occupies, 0 outside, empty for a robot without this grid.
///
/// # Errors
/// Errors of the writer.
pub fn write_trace(recording: &Recording, mut out: impl Write) -> io::Result<()> {
    let joints = recording.robots.iter().map(|r| r.joints.len()).max().unwrap_or(0);
    write!(out, "t_s,robot,")?;
    for j in 1..=joints {
        write!(out, "q{j},")?;
    }
    write!(out, "tcp_x_m,tcp_y_m,tcp_z_m,tcp_speed_m_s,override,region,distance_m,{GOVERNING}")?;
    let grids = grid_names(recording);
    for name in &grids {
        write!(out, ",grid.{name}")?;
    }
    writeln!(out)?;
    let ticks = recording.robots.iter().map(|r| r.samples.len()).max().unwrap_or(0);
    for tick in 0..ticks {
        for (robot, id) in recording.robots.iter().zip((0..).map(RobotId)) {
            let Some(s) = robot.samples.get(tick) else { continue };
            write!(out, "{},{},", s.t_s, robot.name)?;
            for j in 0..joints {
                match s.q.get(j) {
                    Some(q) => write!(out, "{q},")?,
                    None => write!(out, ",")?,
                }
            }
            write!(out, "{},{},{},{},{},", s.tcp.x, s.tcp.y, s.tcp.z, s.tcp_speed, s.speed_override)?;
            let region = s.region.and_then(|r| recording.regions.get(r.0)).map_or("", |r| &r.name);
            write!(out, "{region},")?;
            if let Some(d) = s.distance_m {
                write!(out, "{d}")?;
            }
            let object = robot.governing_obstacle(tick).unwrap_or("");
            write!(out, ",{},{object},", robot.governing_part(s).unwrap_or(""))?;
            match s.governing {
                Some(g) => write!(out, "{},{},{}", g.point.x, g.point.y, g.point.z)?,
                None => write!(out, ",,")?,
            }
            for name in &grids {
                let of_robot = recording.grids.iter().find(|g| g.robot == id && g.grid.name == *name);
                match of_robot.map(|g| g.grid.number_in(s.outputs)) {
                    Some(number) => write!(out, ",{number}")?,
                    None => write!(out, ",")?,
                }
            }
            writeln!(out)?;
        }
    }
    out.flush()
}

/// The names of the grids, each once, in file order.
fn grid_names(recording: &Recording) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for grid in &recording.grids {
        if !names.contains(&&*grid.grid.name) {
            names.push(&grid.grid.name);
        }
    }
    names
}

/// Writes `t_s,robot,region,event`.
///
/// # Errors
/// Errors of the writer.
pub fn write_events(recording: &Recording, mut out: impl Write) -> io::Result<()> {
    writeln!(out, "t_s,robot,region,event")?;
    for e in &recording.events {
        writeln!(out, "{},{},{},{}", e.t_s, e.robot, e.region, e.event.name())?;
    }
    out.flush()
}

/// Writes `t_s,operator,wanted_x_m,wanted_y_m,wanted_z_m,x_m,y_m,z_m,qx,qy,qz,qw,gap_m,active_rows`: one row per tick and
/// guided robot, by robot. Poses are those of the tool point, in the world. If a tool has forces, `fx_n,fy_n,fz_n,energy_j`
/// follow: the force on the hand, and the energy that was put in and not given back.
///
/// # Errors
/// Errors of the writer.
pub fn write_operators(recording: &Recording, mut out: impl Write) -> io::Result<()> {
    write!(out, "t_s,operator,wanted_x_m,wanted_y_m,wanted_z_m,x_m,y_m,z_m,qx,qy,qz,qw,gap_m,active_rows")?;
    let tracks = || recording.robots.iter().filter_map(|robot| robot.guidance.as_ref());
    let has_forces = tracks().any(|track| track.samples.iter().any(|s| s.force.is_some()));
    writeln!(out, "{}", if has_forces { ",fx_n,fy_n,fz_n,energy_j" } else { "" })?;
    for track in tracks() {
        for s in &track.samples {
            write!(out, "{},{},", s.t_s, track.operator)?;
            match s.wanted.map(|pose| pose.translation) {
                Some(p) => write!(out, "{},{},{},", p.x, p.y, p.z)?,
                None => write!(out, ",,,")?,
            }
            let (p, [qx, qy, qz, qw]) = (s.tool_in_world.translation, s.tool_in_world.rotation.to_quaternion_xyzw());
            write!(out, "{},{},{},{qx},{qy},{qz},{qw},", p.x, p.y, p.z)?;
            if let Some(gap_m) = s.gap_m {
                write!(out, "{gap_m}")?;
            }
            write!(out, ",{}", s.active)?;
            match s.force.map(|f| (f.on_hand_n, f.energy_j)) {
                Some((f, energy_j)) => writeln!(out, ",{},{},{},{energy_j}", f.x, f.y, f.z)?,
                None => writeln!(out, "{}", if has_forces { ",,,," } else { "" })?,
            }
        }
    }
    out.flush()
}

/// Writes `t_s,name,holder,x_m,y_m,z_m,qx,qy,qz,qw`: one row per tick and virtual robot, by virtual robot. Poses are those of
/// the work-piece, in the world.
///
/// If a camera looks at a work-piece, a column `hidden` follows: the share of its surface in view that the robots hide, 0 to
/// 1; empty while nothing is in view.
///
/// # Errors
/// Errors of the writer.
pub fn write_work_pieces(recording: &Recording, mut out: impl Write) -> io::Result<()> {
    let has_camera = recording.virtual_robots.iter().any(|track| track.view.is_some());
    writeln!(out, "t_s,name,holder,x_m,y_m,z_m,qx,qy,qz,qw{}", if has_camera { ",hidden" } else { "" })?;
    for track in &recording.virtual_robots {
        for s in &track.samples {
            let holder = track.robots.get(s.holder).map_or("", String::as_str);
            let (p, [qx, qy, qz, qw]) = (s.part_in_world.translation, s.part_in_world.rotation.to_quaternion_xyzw());
            write!(out, "{},{},{holder},{},{},{},{qx},{qy},{qz},{qw}", s.t_s, track.name, p.x, p.y, p.z)?;
            match s.hidden_share {
                Some(share) => writeln!(out, ",{share}")?,
                None => writeln!(out, "{}", if has_camera { "," } else { "" })?,
            }
        }
    }
    out.flush()
}
