//! `elbowroom control`: changes of a running cell.

pub(crate) mod args;
mod client;
mod teach;
mod transport;

use std::fmt::Write as _;
use std::path::Path;

use elbowroom::cell::access::{
    AccessTokens, ControlEntry, ControlHistory, NetworkKey, control_history, control_log_of,
};
use serde_json::{Value, json};

use crate::output::{ExitStatus, Failure, cannot_read, cannot_write, note, print, print_json};
use args::{ControlCommand, NetworkKeyArgs, State, TokenArgs};
use client::Client;

pub(crate) fn control(command: &ControlCommand) -> Result<ExitStatus, Failure> {
    match command {
        ControlCommand::Token(args) => return token(args),
        ControlCommand::NetworkKey(args) => return network_key(args),
        ControlCommand::Log(args) => return log(&args.cell, args.json),
        ControlCommand::Regions(args) => {
            let document = Client::new(&args.service)?.regions()?;
            if args.json { print_json(&document)? } else { print(&regions(&document))? }
        }
        ControlCommand::Switch(args) => {
            let active = matches!(args.state, State::On);
            let request = json!({ "region": args.region, "active": active, "note": args.note });
            done(&Client::new(&args.service)?.change("/switch", &request)?)?;
        }
        ControlCommand::Move(args) => {
            let request = json!({ "region": args.region, "toml": keys(&args.to)?, "note": args.note });
            done(&Client::new(&args.service)?.change("/move", &request)?)?;
        }
        ControlCommand::Add(args) => {
            let toml = read(&args.file)?;
            let request = json!({ "region": args.region, "toml": toml, "active": !args.off, "note": args.note });
            done(&Client::new(&args.service)?.change("/add", &request)?)?;
        }
        ControlCommand::Teach(args) => {
            let client = Client::new(&args.service)?;
            let toml = teach::Teacher::new(args, &client)?.teach()?;
            // Printed first: what was taught is not lost if the service refuses it.
            print(&format!("\n{toml}"))?;
            if args.add {
                let request = json!({ "region": args.region, "toml": toml, "active": !args.off, "note": args.note });
                done(&client.change("/add", &request)?)?;
            }
        }
        ControlCommand::Remove(args) => {
            let request = json!({ "region": args.region, "note": args.note });
            done(&Client::new(&args.service)?.change("/remove", &request)?)?;
        }
        ControlCommand::Clear(args) => {
            let (robot, regions, repeat) = (&args.robot, &args.outside, &args.repeat);
            let request = json!({ "robot": robot, "regions": regions, "repeat_robot": repeat, "note": args.note });
            done(&Client::new(&args.service)?.change("/clear", &request)?)?;
        }
    }
    Ok(ExitStatus::Success)
}

/// Converts `KEY=VALUE` texts to lines of TOML.
fn keys(written: &[String]) -> Result<String, Failure> {
    let line = |text: &String| match text.split_once('=') {
        Some((key, value)) => Ok(format!("{} = {}\n", key.trim(), value.trim())),
        None => Err(Failure::Wrong(format!("`{text}` is not KEY=VALUE\n  write: 'centre=[0, 0, 900]'"))),
    };
    written.iter().map(line).collect()
}

fn read(file: &Path) -> Result<String, Failure> {
    let is_standard_input = file == Path::new("-");
    let text = if is_standard_input {
        std::io::read_to_string(std::io::stdin().lock())
    } else {
        std::fs::read_to_string(file)
    };
    text.map_err(cannot_read(file))
}

fn token(args: &TokenArgs) -> Result<ExitStatus, Failure> {
    let secret = AccessTokens::add(&args.file, args.role.into(), &args.name)?;
    note(format_args!(
        "{}: has the hash of a token of \"{}\". Its secret is on standard output, and nowhere else.",
        args.file.display(),
        args.name
    ));
    print(&format!("{secret}\n"))?;
    Ok(ExitStatus::Success)
}

fn network_key(args: &NetworkKeyArgs) -> Result<ExitStatus, Failure> {
    let wrong = cannot_write(&args.out);
    NetworkKey::generate().and_then(|key| key.write(&args.out)).map_err(wrong)?;
    note(format_args!(
        "{}: the key of the cell's network; copy it to the computer of each process, and to nobody else",
        args.out.display()
    ));
    Ok(ExitStatus::Success)
}

fn regions(document: &Value) -> String {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let list = |value: &Value| {
        value.as_array().map(|all| all.iter().map(text).collect::<Vec<_>>().join(", ")).unwrap_or_default()
    };
    let mut lines = String::new();
    for region in document["regions"].as_array().into_iter().flatten() {
        let state = if region["active"] == true { "on" } else { "off" };
        // Writing to a String cannot fail.
        let _ = write!(
            lines,
            "{:<20} {:<10} {:<10} {state:<4}",
            text(&region["name"]),
            text(&region["kind"]),
            text(&region["life"])
        );
        if let Some(holder) = region["holder"].as_str() {
            let _ = write!(lines, " held by {holder}");
        }
        if region["queue"].is_array() {
            let _ = write!(lines, " waiting: {}", list(&region["queue"]));
        }
        lines = lines.trim_end().to_owned() + "\n";
    }
    let is_silent = |robot: &&Value| robot["heard"] == false;
    for robot in document["robots"].as_array().into_iter().flatten().filter(is_silent) {
        let _ = writeln!(lines, "{}: its controller is not heard", text(&robot["name"]));
    }
    lines
}

fn done(document: &Value) -> Result<(), Failure> {
    for robot in document["not_heard"].as_array().into_iter().flatten() {
        note(format_args!("{}: is not heard, so it may be inside", robot.as_str().unwrap_or_default()));
    }
    for robot in document["stopped"].as_array().into_iter().flatten() {
        let robot = robot.as_str().unwrap_or_default();
        note(format_args!("{robot}: its node has not taken the regions over, so it stops"));
    }
    match serde_json::from_value::<ControlEntry>(document["entry"].clone()) {
        Ok(logged) => print(&entry(&logged)),
        Err(e) => Err(Failure::Wrong(format!("the service answers what this program does not know: {e}"))),
    }
}

fn entry(e: &ControlEntry) -> String {
    let mut text = format!("{:>4}  {}  {} ({}): {}", e.sequence, e.time, e.name, e.class, e.action);
    if let Some(note) = &e.note {
        let _ = write!(text, " - {note}");
    }
    text.push('\n');
    for change in &e.changes {
        let after = change.after.as_deref().unwrap_or("none");
        let before = change.before.as_deref().unwrap_or("none");
        let _ = writeln!(text, "      {}: {} {before} -> {after}", change.item, change.field);
    }
    text
}

fn log(cell: &Path, as_json: bool) -> Result<ExitStatus, Failure> {
    let ControlHistory { entries, signed_by } = control_history(&control_log_of(cell))?;
    note(format_args!("{} entries, signed by the key {signed_by}", entries.len()));
    if as_json {
        print_json(&entries)?;
    } else {
        print(&entries.iter().map(entry).collect::<String>())?;
    }
    Ok(ExitStatus::Success)
}
