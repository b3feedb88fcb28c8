//! `elbowroom replay`.

use std::fmt::Write as _;
use std::fs::File;
use std::io::BufReader;

use elbowroom::Diagnostic;
use elbowroom::recording::{self, Replay, RobotReplay};

use super::ReplayArgs;
use crate::output::{ExitStatus, Failure, cannot_read, note, print, print_json};

pub(crate) fn replay(args: &ReplayArgs) -> Result<ExitStatus, Failure> {
    let file = &args.recording;
    let bytes = File::open(file).map_err(cannot_read(file))?;
    let replay = recording::replay(BufReader::new(bytes)).map_err(|e| Diagnostic::new(file, None, e))?;
    warn(&replay);
    if args.json {
        print_json(&replay)?;
    } else {
        print(&text(&replay))?;
    }
    Ok(if replay.differences > 0 { ExitStatus::NegativeResult } else { ExitStatus::Success })
}

fn warn(replay: &Replay) {
    if replay.cut_off {
        note("warning: the recording was cut off: it is read up to its last complete chunk");
    }
    if replay.lost_ticks > 0 {
        note(format_args!("warning: the recorder had to leave out {} ticks", replay.lost_ticks));
    }
    for robot in replay.robots.iter().filter(|r| r.skipped > 0) {
        note(format_args!(
            "warning: {}: {} ticks are not compared, as one before them is missing",
            robot.name, robot.skipped
        ));
    }
}

fn text(replay: &Replay) -> String {
    let mut text = format!("{}, checksum {}\n", replay.cell, replay.checksum);
    for robot in &replay.robots {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", of_robot(robot));
    }
    let _ = match replay.differences {
        0 => writeln!(text, "{} ticks in {} messages: every answer the same to the bit", replay.ticks, replay.messages),
        n => writeln!(
            text,
            "{n} of {} ticks have another answer: was the recording made by another build?",
            replay.ticks
        ),
    };
    text
}

fn of_robot(robot: &RobotReplay) -> String {
    let RobotReplay { name, ticks, until_s, differences, .. } = robot;
    let mut text = format!("  {name}: {ticks} ticks until {until_s:.3} s, {differences} differences");
    if let Some(first) = &robot.first {
        let _ = write!(
            text,
            "; the first at {:.3} s (tick {}): {} differs, override {} recorded, {} now",
            first.t_s, first.sequence, first.what, first.recorded, first.replayed
        );
    }
    text
}
