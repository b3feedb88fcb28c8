//! The page of a watched run: the scene that plays, tracks, distances, times, pictures of frames and of the map.

use std::fmt::Write as _;
use std::io::{self, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::{Guards, Reason, RegionId};
use elbowroom_spatial::Vec3;

use super::html::{Parts, write_page};
use super::tables::escape;
use super::{ReportScene, plots, view};
use crate::recording::{Recording, RegionPoses, RegionTrack, RobotTrack, Sample, TickTimes};
use crate::watch::{Doing, WatchLog, WatchedArm, share_of};

/// Writes one file that opens offline.
///
/// # Errors
///
/// Whatever `out` answers.
pub fn write_watch_html(out: impl Write, arm: &WatchedArm, log: &WatchLog) -> io::Result<()> {
    let flange = arm.robot.chain.tip();
    let tcp = elbowroom_spatial::Pose::IDENTITY;
    let scene = ReportScene::new().robot("arm", &arm.robot, arm.base_in_world, flange, tcp, &[]);
    let recording = recording(arm, log, flange);
    let parts = Parts {
        title: &log.title,
        facts: facts(log),
        options: "<option value=\"0\">run</option>".into(),
        figures: &plots::watched(&scene, log, &recording),
        tables: stages(log) + &troubles(log) + &pictures(log),
        scene: view::data(&scene, &[("", &recording)]),
    };
    write_page(out, &parts)
}

/// Time per stage as text: median, 99th percentile and largest, milliseconds, and in how many frames it took any.
pub fn stage_table(log: &WatchLog) -> String {
    let mut out = format!("{:22} {:>9} {:>9} {:>9} {:>7}\n", "stage (ms)", "median", "p99", "max", "frames");
    for (name, times) in log.stages_ms() {
        let at = |share| share_of(&times, share).unwrap_or(0.0);
        let _ = writeln!(out, "{name:22} {:9.3} {:9.3} {:9.3} {:7}", at(0.5), at(0.99), at(1.0), times.len());
    }
    out
}

/// The run as the scene and the plots of other runs know it; things are regions that move.
fn recording(arm: &WatchedArm, log: &WatchLog, flange: LinkId) -> Recording {
    let mut chain = ChainState::new(&arm.robot.chain);
    let mut before: Option<Vec3> = None;
    let mut samples = Vec::with_capacity(log.ticks.len());
    for (n, tick) in log.ticks.iter().enumerate() {
        let known = tick.step.q.len().min(chain.q.len());
        chain.q[..known].copy_from_slice(&tick.step.q[..known]);
        arm.robot.chain.forward(&mut chain);
        let tcp = (arm.base_in_world * chain.link_in_root(flange)).translation;
        let speed = before.map_or(0.0, |last| last.distance(tcp) / log.tick_s);
        before = Some(tcp);
        let near = log.truth.iter().enumerate().min_by(|(_, a), (_, b)| {
            let far =
                |poses: &[elbowroom_spatial::Pose]| poses.get(n).map_or(f64::INFINITY, |p| p.translation.distance(tcp));
            far(&a.poses).total_cmp(&far(&b.poses))
        });
        let held_back = tick.step.doing.reason().is_some();
        let reason = near.filter(|_| held_back).map_or(Reason::Free, |(i, _)| Reason::Region(RegionId(i)));
        samples.push(Sample {
            t_s: tick.t_s,
            q: tick.step.q.clone(),
            tcp,
            tcp_speed: speed,
            programmed_speed: speed,
            speed_override: if matches!(tick.step.doing, Doing::Waiting(_)) { 0.0 } else { tick.step.rate },
            region: near.map(|(i, _)| i),
            distance_m: tick.distance_m,
            reason,
        });
    }
    let stood = log.ticks.iter().filter(|t| matches!(t.step.doing, Doing::Waiting(_))).count();
    let chain = &arm.robot.chain;
    let robot = RobotTrack {
        name: "arm".into(),
        joints: chain.active_joints().iter().map(|id| chain.joints()[id.0].name.clone()).collect(),
        min_override: log.ticks.iter().map(|t| t.step.rate).fold(1.0, f64::min),
        samples,
        finished: true,
        stopped_s: stood as f64 * log.tick_s,
        collisions: Vec::new(),
        avoidance: None,
        ending: crate::RobotEnding::default(),
    };
    Recording {
        cell: log.title.clone(),
        checksum: String::new(),
        tick_s: log.tick_s,
        duration_s: log.ticks.last().map_or(0.0, |t| t.t_s),
        monitored: true,
        robots: vec![robot],
        regions: log.truth.iter().map(region).collect(),
        objects: Vec::new(),
        deadlocks: Vec::new(),
        events: Vec::new(),
        tick_ns: TickTimes::default(),
    }
}

fn region(truth: &crate::watch::Truth) -> RegionTrack {
    RegionTrack {
        name: truth.name.clone(),
        kind: "thing",
        life: "permanent",
        guards: Guards::default(),
        warning_m: 0.0,
        shape: truth.shape.clone(),
        poses: RegionPoses::Moving(truth.poses.clone()),
        active: vec![(0.0, true)],
        min_distance_m: None,
        entered: false,
        warned_s: 0.0,
        warning_spans: Vec::new(),
        inside_spans: Vec::new(),
    }
}

fn facts(log: &WatchLog) -> String {
    let lines = log.facts.iter().map(|line| format!("<li>{}</li>", escape(line)));
    format!("<ul class=\"facts\">{}</ul>", lines.collect::<String>())
}

fn card(heading: &str, body: &str) -> String {
    format!("<section class=\"card wide\"><h3>{}</h3>{body}</section>\n", escape(heading))
}

fn stages(log: &WatchLog) -> String {
    let mut rows = String::new();
    for (name, times) in log.stages_ms() {
        let at = |share| share_of(&times, share).map_or_else(|| "–".into(), |ms| format!("{ms:.3}"));
        let _ = write!(
            rows,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            escape(name),
            at(0.5),
            at(0.99),
            at(1.0),
            times.len()
        );
    }
    let head =
        "<thead><tr><th>stage</th><th>median (ms)</th><th>p99 (ms)</th><th>max (ms)</th><th>frames</th></tr></thead>";
    card("Time per stage", &format!("<div class=\"scroll\"><table>{head}<tbody>{rows}</tbody></table></div>"))
}

/// Frames that could not be used.
fn troubles(log: &WatchLog) -> String {
    let mut rows = String::new();
    for (t, why) in log.frames.iter().filter_map(|f| Some((f.t_s, f.told.as_ref().err()?))) {
        let _ = write!(rows, "<tr class=\"bad\"><td>{t:.3}</td><td>{}</td></tr>", escape(why));
    }
    if rows.is_empty() {
        return String::new();
    }
    let head = "<thead><tr><th>frame at (s)</th><th>why it was refused</th></tr></thead>";
    card("Frames that were refused", &format!("<div class=\"scroll\"><table>{head}<tbody>{rows}</tbody></table></div>"))
}

fn pictures(log: &WatchLog) -> String {
    let one = |p: &crate::watch::Picture| {
        format!(
            "<section class=\"card\"><h3>{}</h3><p class=\"note\">{}</p><img alt=\"{}\" style=\"width:100%;\
             image-rendering:auto;border-radius:6px\" src=\"data:image/png;base64,{}\"></section>\n",
            escape(&p.title),
            escape(&p.note),
            escape(&p.title),
            STANDARD.encode(&p.png)
        )
    };
    log.pictures.iter().map(one).collect()
}
