//! The poses of all links at given states.

use std::fmt::Write;
use std::path::Path;

use elbowroom::cell::QueryModel;
use elbowroom::inspect::Inspection;
use elbowroom::kinematics::{ChainState, LinkId};
use elbowroom::spatial::Pose;

use crate::output::{ExitStatus, Failure, print};

const CSV_HEAD: &str = "index,link,r11,r12,r13,r21,r22,r23,r31,r32,r33,x_m,y_m,z_m\n";

/// Prints the pose of every link in the frame of the root link, one row per state and link: as CSV, or as a table.
pub(super) fn link_poses(inspection: &Inspection, states: &Path, as_table: bool) -> Result<ExitStatus, Failure> {
    let Some(robot) = inspection.robot() else {
        return Err(Failure::Wrong(format!(
            "{}: is a mesh; it has no joints for --states",
            inspection.model.display()
        )));
    };
    let chain = &robot.chain;
    let states = crate::states::read(states, &QueryModel::of_robot(&inspection.model, robot.clone()))?;
    let mut state = ChainState::new(chain);
    let width = chain.links().iter().map(|name| name.chars().count()).max().unwrap_or(0).max("link".len());
    let mut text = if as_table { table_head(width) } else { CSV_HEAD.to_owned() };
    for index in 0..states.len() {
        states.of(index).for_each(|(_, q)| state.q.copy_from_slice(q));
        chain.forward(&mut state);
        for (link, name) in chain.links().iter().enumerate() {
            let pose = state.link_in_root(LinkId(link));
            // Writing to a String cannot fail.
            let _ = if as_table { write!(text, "{index:>5}  {name:width$}") } else { write!(text, "{index},{name}") };
            if as_table { table_row(&mut text, &pose) } else { csv_row(&mut text, &pose) }
        }
        if text.len() > 1 << 20 {
            print(&text)?;
            text.clear();
        }
    }
    print(&text)?;
    Ok(ExitStatus::Success)
}

fn csv_row(text: &mut String, pose: &Pose) {
    let rotation = pose.rotation.rows().into_iter().flatten();
    for v in rotation.chain(pose.translation.to_array()) {
        // Formatted with Debug: Display would write 6e-17 with twenty digits.
        let _ = write!(text, ",{v:?}");
    }
    text.push('\n');
}

fn table_head(width: usize) -> String {
    let columns = ["x (mm)", "y (mm)", "z (mm)", "roll (deg)", "pitch (deg)", "yaw (deg)"];
    let mut text = format!("state  {:width$}", "link");
    for column in columns {
        // Writing to a String cannot fail.
        let _ = write!(text, "{column:>12}");
    }
    text + "\n"
}

fn table_row(text: &mut String, pose: &Pose) {
    let lengths = pose.translation.to_array().map(|v| 1e3 * v);
    for v in lengths.into_iter().chain(pose.rotation.to_rpy().map(f64::to_degrees)) {
        // Adding 0 removes the sign of -0.00.
        let _ = write!(text, "{:>12.2}", (v * 100.0).round() / 100.0 + 0.0);
    }
    text.push('\n');
}
