//! `trace.csv`, `events.csv` and `states.csv`. Numbers are written so that reading them gives the same bits.

use std::io::{self, Write};
use std::path::Path;

use elbowroom_formats::FormatError;
use elbowroom_kinematics::Chain;

use crate::{NumberTable, Recording};

/// Writes `t_s,robot,q1..qn,tcp_x_m,tcp_y_m,tcp_z_m,tcp_speed_m_s,override,region,distance_m`: one row per robot and tick,
/// ordered by time, then robot.
///
/// # Errors
/// Whatever the writer says.
pub fn write_trace(recording: &Recording, mut out: impl Write) -> io::Result<()> {
    let joints = recording.robots.iter().map(|r| r.joints.len()).max().unwrap_or(0);
    write!(out, "t_s,robot,")?;
    for j in 1..=joints {
        write!(out, "q{j},")?;
    }
    writeln!(out, "tcp_x_m,tcp_y_m,tcp_z_m,tcp_speed_m_s,override,region,distance_m")?;
    let ticks = recording.robots.iter().map(|r| r.samples.len()).max().unwrap_or(0);
    for tick in 0..ticks {
        for robot in &recording.robots {
            let Some(s) = robot.samples.get(tick) else { continue };
            write!(out, "{},{},", s.t_s, robot.name)?;
            for j in 0..joints {
                match s.q.get(j) {
                    Some(q) => write!(out, "{q},")?,
                    None => write!(out, ",")?,
                }
            }
            write!(out, "{},{},{},{},{},", s.tcp.x, s.tcp.y, s.tcp.z, s.tcp_speed, s.speed_override)?;
            let region = s.region.and_then(|r| recording.regions.get(r)).map_or("", |r| &r.name);
            match s.distance_m {
                Some(d) => writeln!(out, "{region},{d}")?,
                None => writeln!(out, "{region},")?,
            }
        }
    }
    out.flush()
}

/// Writes `t_s,robot,region,event`.
///
/// # Errors
/// Whatever the writer says.
pub fn write_events(recording: &Recording, mut out: impl Write) -> io::Result<()> {
    writeln!(out, "t_s,robot,region,event")?;
    for e in &recording.events {
        writeln!(out, "{},{},{},{}", e.t_s, e.robot, e.region, e.event)?;
    }
    out.flush()
}

/// Reads `states.csv` for some robots: per row and robot the values of `q`.
///
/// Columns are joint names in any order; with several robots they are prefixed, `robot.joint`, and with one they may be.
/// Columns that are no joint are an error, except `t_s` and `index`, which are ignored.
///
/// # Errors
/// [`FormatError`] names the column or the line.
///
/// ```
/// use elbowroom_cell::{Cell, csv};
/// let cell = Cell::parse("c.toml", "version = 1\nunits = { length = \"m\", angle = \"rad\" }\n\
///     [robot.r]\ndh = [{ min = -1, max = 1 }, { kind = \"prismatic\", min = 0, max = 1 }]")?;
/// let chain = &cell.robots[0].robot.chain;
/// let states = csv::parse_states("s.csv".as_ref(), "joint_2,joint_1\n0.5,0.25\n", &[("r", chain)])?;
/// assert_eq!(states[0][0], [0.25, 0.5]);
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub fn parse_states(path: &Path, text: &str, robots: &[(&str, &Chain)]) -> Result<Vec<Vec<Vec<f64>>>, FormatError> {
    states(&NumberTable::parse(path, text)?, robots)
}

/// [`parse_states`] of a file.
///
/// # Errors
/// As there.
pub fn read_states(path: &Path, robots: &[(&str, &Chain)]) -> Result<Vec<Vec<Vec<f64>>>, FormatError> {
    states(&NumberTable::read(path)?, robots)
}

fn states(table: &NumberTable, robots: &[(&str, &Chain)]) -> Result<Vec<Vec<Vec<f64>>>, FormatError> {
    let mut used = vec![false; table.columns.len()];
    let mut columns: Vec<Vec<usize>> = Vec::new();
    for (name, chain) in robots {
        let mut own = Vec::new();
        for id in chain.active_joints() {
            let joint = &chain.joints()[id.0].name;
            let prefixed = format!("{name}.{joint}");
            let bare = || table.columns.iter().position(|c| robots.len() == 1 && c == joint);
            let column = table.columns.iter().position(|c| *c == prefixed).or_else(bare);
            let Some(column) = column else {
                let wanted = if robots.len() == 1 { joint } else { &prefixed };
                return Err(table
                    .column(wanted)
                    .err()
                    .unwrap_or_else(|| FormatError::new(&table.file, 1, "bad header")));
            };
            used[column] = true;
            own.push(column);
        }
        columns.push(own);
    }
    let stray = |(i, c): &(usize, &String)| !used[*i] && !["t_s", "index"].contains(&c.as_str());
    if let Some((_, stray)) = table.columns.iter().enumerate().find(stray) {
        let what = format!("column `{stray}` is no joint that moves by itself");
        return Err(FormatError::new(&table.file, 1, what).hint("only independent joints; mimic joints follow theirs"));
    }
    let row = |r: &(usize, Vec<f64>)| columns.iter().map(|own| own.iter().map(|c| r.1[*c]).collect()).collect();
    Ok(table.rows.iter().map(row).collect())
}
