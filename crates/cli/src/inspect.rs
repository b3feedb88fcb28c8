//! `elbowroom inspect`: what is in a model.

use std::fmt::Write;

use elbowroom::cell::csv::read_states;
use elbowroom::cell::inspect::{InspectOptions, Inspection};
use elbowroom::kinematics::{ChainState, LinkId};
use elbowroom::spatial::units::LengthUnit;

use crate::args::{InspectArgs, Unit};
use crate::output::{Failure, Verdict, note, print, print_json};

pub(crate) fn inspect(args: &InspectArgs) -> Result<Verdict, Failure> {
    let options =
        InspectOptions { srdf: args.srdf.clone(), unit: args.unit.map(LengthUnit::from), tip: args.tip.clone() };
    let inspection = Inspection::of(&args.model, &options)?;
    if let Some(states) = &args.states {
        inspection.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
        return poses(&inspection, states);
    }
    if args.json {
        inspection.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
        print_json(&inspection)?;
    } else {
        print(&inspection.to_string())?;
    }
    Ok(Verdict::Good)
}

/// The pose of every link in the root link, a row per state and link.
fn poses(inspection: &Inspection, states: &std::path::Path) -> Result<Verdict, Failure> {
    let Some(robot) = inspection.robot() else {
        return Err(Failure::Wrong(format!(
            "{}: is a mesh; it has no joints for --states",
            inspection.model.display()
        )));
    };
    let chain = &robot.chain;
    let states = read_states(states, &[("", chain)])?;
    let mut state = ChainState::new(chain);
    let mut text = String::from("index,link,r11,r12,r13,r21,r22,r23,r31,r32,r33,x_m,y_m,z_m\n");
    for (index, q) in states.iter().enumerate() {
        state.q.copy_from_slice(&q[0]);
        chain.forward(&mut state);
        for (link, name) in chain.links().iter().enumerate() {
            let pose = state.link_in_root(LinkId(link));
            let rotation = pose.rotation.rows().into_iter().flatten();
            // Writing to a String cannot fail.
            let _ = write!(text, "{index},{name}");
            // As Debug, so that 6e-17 does not become twenty digits.
            rotation.chain(pose.translation.to_array()).for_each(|v| {
                let _ = write!(text, ",{v:?}");
            });
            text.push('\n');
        }
        if text.len() > 1 << 20 {
            print(&text)?;
            text.clear();
        }
    }
    print(&text)?;
    Ok(Verdict::Good)
}

impl From<Unit> for LengthUnit {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::M => Self::Metre,
            Unit::Cm => Self::Centimetre,
            Unit::Mm => Self::Millimetre,
            Unit::In => Self::Inch,
        }
    }
}
