//! The page of a perception run: animated scene, tracks, distances, stage times, images of frames and of the map.

use std::fmt::Write as _;
use std::io::{self, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use elbowroom_cell::CellRegionId;
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::Life;
use elbowroom_monitor::{Guards, OverrideReason, RegionId};
use elbowroom_perception::{ExecutorState, MappedArm, PerceptionLog};
use elbowroom_robot::RobotId;
use elbowroom_sim::{RecordedRegionKind, Recording, RegionPoses, RegionTrack, RobotTrack, Sample, TickTimes};
use elbowroom_spatial::Vec3;

use crate::html::{PageContent, write_page};
use crate::tables::{Table, escape};
use crate::{ReportScene, plots, scene_data};

/// Writes the page as one self-contained file.
///
/// # Errors
///
/// Errors of `out`.
pub fn write_perception_html(out: impl Write, arm: &MappedArm, log: &PerceptionLog) -> io::Result<()> {
    let flange = arm.robot.chain.tip();
    let tcp = elbowroom_spatial::Pose::IDENTITY;
    let scene = ReportScene::new().robot("arm", &arm.robot, arm.base_in_world, flange, tcp, &[]);
    let recording = recording(arm, log, flange);
    let content = PageContent {
        title: &log.title,
        result: facts(log),
        regions: String::new(),
        facts: String::new(),
        options: "<option value=\"0\">run</option>".into(),
        figures: &plots::perception(&scene, log, &recording),
        tables: stage_times(log) + &rejected_frames(log) + &images(log),
        data: scene_data::data(&scene, &[("", &recording)]),
    };
    write_page(out, &content)
}

/// Time per stage as text: median, 99th percentile and maximum, milliseconds, and the number of frames.
pub fn stage_table(log: &PerceptionLog) -> String {
    let mut out = format!("{:22} {:>9} {:>9} {:>9} {:>7}\n", "stage (ms)", "median", "p99", "max", "frames");
    for (name, times) in log.stages_ms() {
        let at = |share| quantile(&times, share).unwrap_or(0.0);
        let _ = writeln!(out, "{name:22} {:9.3} {:9.3} {:9.3} {:7}", at(0.5), at(0.99), at(1.0), times.len());
    }
    out
}

/// The quantile of sorted values; `None` without values.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    sorted.get((sorted.len().saturating_sub(1) as f64 * share).round() as usize).copied()
}

/// Converts the log to a recording for the scene and the plots; obstacles become moving regions.
fn recording(arm: &MappedArm, log: &PerceptionLog, flange: LinkId) -> Recording {
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
        let nearest = log.ground_truth.iter().enumerate().min_by(|(_, a), (_, b)| {
            let far =
                |poses: &[elbowroom_spatial::Pose]| poses.get(n).map_or(f64::INFINITY, |p| p.translation.distance(tcp));
            far(&a.poses).total_cmp(&far(&b.poses))
        });
        let is_limited = tick.step.state.reason().is_some();
        let reason =
            nearest.filter(|_| is_limited).map_or(OverrideReason::Free, |(i, _)| OverrideReason::Region(RegionId(i)));
        samples.push(Sample {
            t_s: tick.t_s,
            q: tick.step.q.clone(),
            tcp,
            tcp_speed: speed,
            programmed_speed: speed,
            speed_override: if matches!(tick.step.state, ExecutorState::Waiting(_)) { 0.0 } else { tick.step.rate },
            region: nearest.map(|(i, _)| CellRegionId(i)),
            distance_m: tick.distance_m,
            governing: None,
            reason,
        });
    }
    let waiting = log.ticks.iter().filter(|t| matches!(t.step.state, ExecutorState::Waiting(_))).count();
    let chain = &arm.robot.chain;
    let robot = RobotTrack {
        absent_links: Vec::new(),
        name: "arm".into(),
        flange: chain.links()[flange.0].clone(),
        joints: chain.active_joints().iter().map(|id| chain.joints()[id.0].name.clone()).collect(),
        min_override: log.ticks.iter().map(|t| t.step.rate).fold(1.0, f64::min),
        parts: Vec::new(),
        samples,
        stops: Vec::new(),
        finished: true,
        stopped_s: waiting as f64 * log.tick_s,
        collisions: Vec::new(),
        avoidance: None,
        perception: None,
        ending: elbowroom_sim::RobotEnding::default(),
    };
    Recording {
        cell: log.title.clone(),
        checksum: String::new(),
        tick_s: log.tick_s,
        duration_s: log.ticks.last().map_or(0.0, |t| t.t_s),
        end: elbowroom_sim::RunEnd::Finished,
        monitored: true,
        robots: vec![robot],
        regions: log.ground_truth.iter().map(region).collect(),
        objects: Vec::new(),
        sensors: Vec::new(),
        deadlocks: Vec::new(),
        events: Vec::new(),
        tick_ns: TickTimes::default(),
    }
}

fn region(ground_truth: &elbowroom_perception::GroundTruth) -> RegionTrack {
    RegionTrack {
        name: ground_truth.name.clone(),
        kind: RecordedRegionKind::Obstacle,
        life: Life::Permanent,
        guards: Guards::default(),
        robots: vec![RobotId(0)],
        warning_m: 0.0,
        shape: ground_truth.shape.clone(),
        poses: RegionPoses::Moving(ground_truth.poses.clone()),
        active: vec![(0.0, true)],
        min_distance_m: None,
        entered: false,
        warned_s: 0.0,
        warning_spans: Vec::new(),
        inside_spans: Vec::new(),
    }
}

fn facts(log: &PerceptionLog) -> String {
    let lines = log.facts.iter().map(|line| format!("<li>{}</li>", escape(line)));
    card("Result", &format!("<ul class=\"facts\">{}</ul>", lines.collect::<String>()))
}

fn card(heading: &str, body: &str) -> String {
    format!("<section class=\"card wide\"><h2>{}</h2>{body}</section>\n", escape(heading))
}

fn stage_times(log: &PerceptionLog) -> String {
    let names = ["stage", "median (ms)", "p99 (ms)", "max (ms)", "frames"];
    let mut table = Table::new("Of each picture", &names);
    for (name, times) in log.stages_ms() {
        let at = |share| quantile(&times, share).map_or_else(|| "–".into(), |ms| format!("{ms:.3}"));
        table.row(&[name.to_owned(), at(0.5), at(0.99), at(1.0), times.len().to_string()], "");
    }
    card("Time per stage", &format!("<div class=\"scroll\">{}</div>", table.end()))
}

/// Table of rejected frames.
fn rejected_frames(log: &PerceptionLog) -> String {
    let mut rejected = log.frames.iter().filter_map(|f| Some((f.t_s, f.result.as_ref().err()?))).peekable();
    if rejected.peek().is_none() {
        return String::new();
    }
    let mut table = Table::new("What was not used, and why", &["frame at (s)", "reason"]);
    rejected.for_each(|(t, why)| table.row(&[format!("{t:.3}"), why.clone()], "bad"));
    card("Rejected frames", &format!("<div class=\"scroll\">{}</div>", table.end()))
}

fn images(log: &PerceptionLog) -> String {
    let one = |p: &elbowroom_perception::ReportImage| {
        format!(
            "<section class=\"card\"><h2>{}</h2><p class=\"note\">{}</p><img alt=\"{}\" style=\"width:100%;\
             image-rendering:auto;border-radius:6px\" src=\"data:image/png;base64,{}\"></section>\n",
            escape(&p.title),
            escape(&p.note),
            escape(&p.title),
            STANDARD.encode(&p.png)
        )
    };
    log.images.iter().map(one).collect()
}
