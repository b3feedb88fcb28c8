//! Text summary of a run.

use std::fmt;

use elbowroom_sim::{
    AvoidanceSummary, AvoidanceTrack, Collision, Deadlock, OperatorSummary, Outcome, PartKind, PerceptionSummary,
    PerceptionTrack, RecordedRegionKind, Recording, RegionTrack, RobotEnding, RobotTrack, RunEnd, SensorSummary,
    SensorTrack, Stop, VirtualRobotSummary,
};

use crate::carried_motion::carried;
use crate::explanation::explanation;
use crate::last_motion::{STATIONARY_M_S, finished_at, moved_until};
use crate::sparkline::sparkline;

/// Largest number of listed regions; the rest is counted.
const MAX_REGIONS: usize = 12;
/// Largest number of listed stops of a robot that finished.
const MAX_STOPS: usize = 3;

/// Text summary of a run: robots, regions, tick times.
///
/// No line is longer than `width` (at least 40) characters. Colour codes appear only if `color` is true (a terminal).
/// To list written files, use [`TextSummary`].
///
/// ```
/// use elbowroom_sim::{Recording, RunEnd, TickTimes};
/// let recording = Recording {
///     cell: "welding column".into(), checksum: "3fa9".into(), tick_s: 0.002, duration_s: 1.0, end: RunEnd::Finished,
///     monitored: true,
///     robots: vec![], regions: vec![], grids: vec![], objects: vec![], sensors: vec![], virtual_robots: vec![], deadlocks: vec![], events: vec![],
///     tick_ns: TickTimes::default(),
/// };
/// assert!(elbowroom_report::summary(&recording, 80, false).contains("welding column"));
/// ```
pub fn summary(recording: &Recording, width: usize, color: bool) -> String {
    TextSummary::new(recording).width(width).color(color).to_string()
}

/// A [`summary`] with options. Its `Display` is the text, with a line break after every line.
#[derive(Debug, Clone)]
pub struct TextSummary<'a> {
    recording: &'a Recording,
    width: usize,
    color: bool,
    is_whole: bool,
    files: Vec<(String, String)>,
}

impl<'a> TextSummary<'a> {
    /// Creates a summary with 80 columns, no colour, no files.
    pub fn new(recording: &'a Recording) -> Self {
        Self { recording, width: 80, color: false, is_whole: false, files: Vec::new() }
    }

    /// Sets the largest line length, in characters; at least 40.
    #[must_use]
    pub fn width(mut self, columns: usize) -> Self {
        self.width = columns.max(40);
        self
    }

    /// Sets whether texts longer than the width are kept whole, for a file or another program.
    #[must_use]
    pub fn whole(self, is_whole: bool) -> Self {
        Self { is_whole, ..self }
    }

    /// Sets whether ANSI colours are used.
    #[must_use]
    pub fn color(mut self, color: bool) -> Self {
        self.color = color;
        self
    }

    /// Adds a written file: what it is, and its path. Paths are never shortened.
    #[must_use]
    pub fn file(mut self, what: impl Into<String>, path: impl fmt::Display) -> Self {
        self.files.push((what.into(), path.to_string()));
        self
    }
}

#[derive(Clone, Copy)]
enum Style {
    Plain,
    Bold,
    Dim,
    Good,
    Bad,
    Warn,
}

impl Style {
    fn code(self) -> &'static str {
        match self {
            Self::Plain => "0",
            Self::Bold => "1",
            Self::Dim => "2",
            Self::Good => "32",
            Self::Bad => "31",
            Self::Warn => "33",
        }
    }
}

type Line = Vec<(String, Style)>;

impl fmt::Display for TextSummary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rec = self.recording;
        let mut lines = vec![heading(rec), Line::new()];
        let longest = rec.robots.iter().map(|r| r.name.chars().count()).max().unwrap_or(0);
        let names = longest.clamp(5, if self.is_whole { usize::MAX } else { 14 });
        lines.extend(rec.robots.iter().flat_map(|robot| robot_lines(robot, rec, names, self.width)));
        if !rec.regions.is_empty() {
            lines.push(Line::new());
            lines.extend(region_lines(rec, self.longest_line()));
        }
        for track in &rec.virtual_robots {
            let text = carried(&VirtualRobotSummary::new(track, rec.tick_s));
            lines.push(vec![(format!("  {}  {text}", pad(&track.name, names)), Style::Plain)]);
        }
        if !rec.deadlocks.is_empty() {
            lines.push(Line::new());
            lines.extend(rec.deadlocks.iter().flat_map(deadlock_lines));
        }
        lines.push(Line::new());
        if rec.end == RunEnd::Standstill {
            let why = "  ended   robots at override 0 for 10 s, only endless belts moved";
            lines.push(vec![(why.into(), Style::Warn)]);
        }
        lines.extend(rec.sensors.iter().map(sensor_line));
        lines.push(ticks(rec));
        for line in &lines {
            self.write_line(f, line)?;
        }
        for (what, path) in &self.files {
            writeln!(f, "  {} {path}", pad(what, 7))?;
        }
        self.write_line(f, &vec![("  Not a certified safety device.".into(), Style::Dim)])
    }
}

impl TextSummary<'_> {
    fn longest_line(&self) -> usize {
        if self.is_whole { usize::MAX } else { self.width }
    }

    fn write_line(&self, f: &mut fmt::Formatter<'_>, line: &Line) -> fmt::Result {
        let mut left = self.longest_line();
        for (text, style) in line {
            let text = clip(text, left);
            left -= text.chars().count();
            if self.color && !matches!(style, Style::Plain) {
                write!(f, "\u{1b}[{}m{text}\u{1b}[0m", style.code())?;
            } else {
                f.write_str(&text)?;
            }
        }
        writeln!(f)
    }
}

fn heading(rec: &Recording) -> Line {
    let (monitor, style) = if rec.monitored { ("monitor on", Style::Good) } else { ("monitor off", Style::Warn) };
    vec![
        (clean(&rec.cell), Style::Bold),
        (format!(" · {:.2} s · ", rec.duration_s), Style::Plain),
        (monitor.into(), style),
        (format!(" · checksum {}", rec.checksum.chars().take(12).collect::<String>()), Style::Dim),
    ]
}

fn robot_lines(robot: &RobotTrack, rec: &Recording, names: usize, width: usize) -> Vec<Line> {
    let indent = " ".repeat(names + 4);
    let style = match robot.ending.outcome {
        Outcome::Collided | Outcome::Deadlock => Style::Bad,
        Outcome::Mechanism if robot.collisions.is_empty() => Style::Plain,
        _ if !robot.collisions.is_empty() => Style::Bad,
        _ if robot.finished => Style::Good,
        _ => Style::Warn,
    };
    let mut lines = vec![vec![(format!("  {}  ", pad(&robot.name, names)), Style::Bold), (outcome(robot, rec), style)]];
    lines.extend(collision_lines(robot, &indent));
    if robot.is_mechanism() {
        return lines;
    }
    let values: Vec<f64> = robot.samples.iter().map(|s| s.speed_override).collect();
    let numbers = format!("  smallest {:.1} %, stopped {:.2} s", 100.0 * robot.min_override, robot.stopped_s);
    let available = width.saturating_sub(indent.len() + "override ".len() + numbers.len());
    let curve = sparkline(&values, available.clamp(4, 60));
    lines.push(vec![
        (indent.clone(), Style::Plain),
        ("override ".into(), Style::Dim),
        (curve, Style::Plain),
        (numbers, Style::Dim),
    ]);
    let details = detail_texts(robot).into_iter().flat_map(|text| wrap(&text, width.saturating_sub(indent.len())));
    lines.extend(details.map(|text| vec![(format!("{indent}{text}"), Style::Dim)]));
    if let Some(track) = &robot.avoidance {
        lines.push(vec![(format!("{indent}{}", evaded(track, rec.tick_s)), Style::Dim)]);
    }
    if let Some(guided) = OperatorSummary::of(robot, rec.tick_s) {
        lines.push(vec![(format!("{indent}{}", followed(&guided)), Style::Dim)]);
    }
    if let Some(track) = &robot.perception {
        lines.extend(kept_clear(track).into_iter().map(|text| vec![(format!("{indent}{text}"), Style::Dim)]));
    }
    lines
}

/// The first collisions, which matter more than a later stop.
fn collision_lines(robot: &RobotTrack, indent: &str) -> Vec<Line> {
    let mut lines = Vec::new();
    for c in robot.collisions.iter().take(3) {
        lines.push(vec![(format!("{indent}collision at {:.3} s: {} with {}", c.t_s, c.a, c.b), Style::Bad)]);
        lines.extend(key_to_ignore(robot, c).map(|key| vec![(format!("{indent}  {key}"), Style::Dim)]));
    }
    lines
}

/// What to write if links that touch at the start always touch.
fn key_to_ignore(robot: &RobotTrack, collision: &Collision) -> Option<String> {
    let link = |name: &str| Some(name.strip_prefix(&robot.name)?.strip_prefix('/')?.to_owned());
    let (a, b) = (link(&collision.a)?, link(&collision.b)?);
    let at_start = collision.t_s <= 0.0;
    at_start.then(|| format!("if they always touch: ignore = [[\"{a}\", \"{b}\"]] in [robot.{}]", robot.name))
}

/// Link of the TCP, the part that was closest to the region that stopped the robot, and what would release the robot.
fn detail_texts(robot: &RobotTrack) -> Vec<String> {
    let RobotEnding { part, part_kind, point, release, .. } = &robot.ending;
    let mut parts = Vec::new();
    if !robot.flange.is_empty() {
        parts.push(format!("TCP on {}", robot.flange));
    }
    // If that part is the TCP itself, the line above has its place.
    if let (Some(part), Some(p)) = (part.as_ref().filter(|part| *part != "tcp"), point) {
        let load = if *part_kind == Some(PartKind::Load) && part != "load" { " (load)" } else { "" };
        parts.push(format!("closest {part}{load} at ({:.3}, {:.3}, {:.3}) m", p.x, p.y, p.z));
    }
    let place = (!parts.is_empty()).then(|| parts.join(", "));
    // One line per way, so that none is cut.
    let ways = release.iter().flat_map(|ways| ways.split(", or ")).enumerate();
    let ways = ways.map(|(i, way)| format!("{} when {way}", if i == 0 { "continues" } else { "or" }));
    let stops = robot.stops.iter().filter(|_| robot.finished).take(MAX_STOPS).map(stop_text);
    place.into_iter().chain(ways).chain(stops).collect()
}

/// A stop after which the robot continued.
fn stop_text(stop: &Stop) -> String {
    let by = stop.by.as_ref();
    let place = by.map_or_else(String::new, |by| format!(", {} before {}", millimetres(stop.distance_m), clean(by)));
    let part = stop.part.as_ref().map_or_else(String::new, |part| format!(", closest {part}"));
    format!("stood {:.2} to {:.2} s{place}{part}", stop.from_s, stop.to_s)
}

/// Summary of avoidance.
fn evaded(track: &AvoidanceTrack, tick_s: f64) -> String {
    let a = AvoidanceSummary::new(track, tick_s);
    let nearest =
        a.min_distance_m.map_or_else(|| "no obstacle near".into(), |m| format!("nearest {}", millimetres(Some(m))));
    let plans = if a.plans > 0 {
        format!(", {} of {} replanning attempts found a path", a.plans_found, a.plans)
    } else {
        String::new()
    };
    let [evading, off_path, waiting] = [a.evading_s, a.off_path_s, a.waiting_s];
    let step = duration(a.step_ns.p50);
    format!("evaded {evading:.2} s, off its path {off_path:.2} s, waited {waiting:.2} s, {nearest}{plans}; step {step}")
}

/// Summary of a guided robot.
pub fn followed(guided: &OperatorSummary) -> String {
    let OperatorSummary { name, free_s, contact_s, stopped_s, least_gap_m, largest_force_n, .. } = guided;
    let force = largest_force_n.map_or_else(String::new, |force| format!(", felt at most {force:.1} N"));
    let gap = least_gap_m.map_or_else(String::new, |gap| format!(", no nearer than {}", millimetres(Some(gap))));
    format!("guided by {name}: {free_s:.2} s free, {contact_s:.2} s at surfaces{gap}, stood {stopped_s:.2} s{force}")
}

/// Summary of a robot's reactions to the obstacles that sensors see.
fn kept_clear(track: &PerceptionTrack) -> Vec<String> {
    let p = PerceptionSummary::from(track);
    let [in_motion, from_rest] = [p.replans_in_motion, p.replans_from_rest];
    let blind = (p.stale_s > 0.0).then(|| format!("waited {:.2} s for pictures", p.stale_s));
    let paths = format!("new paths: {in_motion} in motion, {from_rest} from rest; waited {:.2} s", p.waited_s);
    let searches = (p.replans_failed > 0).then(|| format!("searches without a path: {}", p.replans_failed));
    let longest = (!track.replans.is_empty()).then(|| format!("longest search {:.0} ms", 1e3 * p.longest_search_s));
    [Some(paths), searches, longest, blind].into_iter().flatten().collect()
}

/// Summary of a sensor's input and obstacles.
fn sensor_line(track: &SensorTrack) -> Line {
    let s = SensorSummary::from(track);
    let what = if track.kind == "cloud" { "clouds" } else { "pictures" };
    let rejected = if s.rejected > 0 { format!(", {} rejected", s.rejected) } else { String::new() };
    let obstacles = match s.obstacles.len() {
        1 => "1 obstacle".to_owned(),
        n => format!("{n} obstacles"),
    };
    let time = duration(s.processing_ns.p50);
    let text = format!("  {} {}: {} {what}{rejected}, {obstacles}", pad(track.kind, 7), s.name, s.frames);
    vec![(text, Style::Plain), (format!(", {time} each"), Style::Dim)]
}

/// Description of the outcome of a robot's program.
pub fn outcome(robot: &RobotTrack, rec: &Recording) -> String {
    let Some(last) = robot.samples.last() else { return "no samples".into() };
    if robot.is_mechanism() {
        return moved_until(robot);
    }
    if robot.finished {
        return finished_at(robot);
    }
    let since = robot.ending.stopped_at_s.unwrap_or(last.t_s);
    if robot.ending.outcome == Outcome::Deadlock {
        let at = robot.ending.by.as_deref().unwrap_or("an exchange region");
        return format!("deadlock: stopped since {since:.2} s, waiting for {}", clean(at));
    }
    let p = last.tcp;
    let place = format!("at {since:.2} s, TCP ({:.3}, {:.3}, {:.3}) m", p.x, p.y, p.z);
    match (last.region.and_then(|i| rec.regions.get(i.0)), last.distance_m) {
        (Some(region), Some(d)) if d > 0.0 => {
            format!("stopped {} before {}, {place}", millimetres(Some(d)), clean(&region.name))
        }
        (Some(region), _) => format!("stopped at {}, {place}", clean(&region.name)),
        _ if last.tcp_speed > STATIONARY_M_S => format!("still moving at {:.2} s", last.t_s),
        _ => format!("stopped {place}: {}", explanation(robot, robot.samples.len() - 1, rec)),
    }
}

/// Two lines, for narrow screens.
fn deadlock_lines(deadlock: &Deadlock) -> [Line; 2] {
    let who = format!("  deadlock since {:.2} s: {} wait for each other", deadlock.t_s, deadlock.robots.join(", "));
    let what = format!("           at {}; one of them must be moved out by hand", deadlock.regions.join(", "));
    [vec![(who, Style::Bad)], vec![(what, Style::Bad)]]
}

fn region_lines(rec: &Recording, width: usize) -> Vec<Line> {
    // 2 + name + the columns below make 80.
    let (most, longest) = (width.saturating_sub(56).max(8), rec.regions.iter().map(|r| r.name.chars().count()).max());
    let names = longest.unwrap_or(0).clamp(most.min(24), most);
    let head = format!(
        "  {} {:<10}{:>11}  {:<8}{:>10} {:<11}",
        pad("region", names),
        "kind",
        "closest",
        "entered",
        "warned for",
        "output"
    );
    let mut lines = vec![vec![(head, Style::Dim)]];
    for region in rec.regions.iter().take(MAX_REGIONS) {
        lines.push(region_line(region, rec, names));
    }
    if rec.regions.len() > MAX_REGIONS {
        lines.push(vec![(format!("  and {} more regions", rec.regions.len() - MAX_REGIONS), Style::Dim)]);
    }
    lines
}

/// Whether a region was entered: `yes`, `no`, or `granted` if only a robot that held it was inside.
pub fn entry(region: &RegionTrack) -> &'static str {
    let is_inside = region.min_distance_m.is_some_and(|distance| distance <= 0.0);
    match region.entered {
        true => "yes",
        false if is_inside && matches!(region.kind, RecordedRegionKind::Exchange) => "granted",
        false => "no",
    }
}

fn region_line(region: &RegionTrack, rec: &Recording, names: usize) -> Line {
    let bad = region.is_violated();
    let rises = rec.events.iter().filter(|e| e.region == region.name && e.event.name() == "output_on").count();
    let output = if rises == 0 { "–".into() } else { format!("on {rises}×") };
    let style = match (bad, region.warned_s > 0.0) {
        (true, _) => Style::Bad,
        (false, true) => Style::Warn,
        (false, false) => Style::Plain,
    };
    let entered = if bad { "YES" } else { entry(region) };
    vec![
        (format!("  {} ", pad(&region.name, names)), Style::Bold),
        (format!("{:<10}{:>11}  ", region.kind.name(), millimetres(region.min_distance_m)), Style::Plain),
        (format!("{entered:<8}"), if bad { Style::Bad } else { Style::Good }),
        (format!("{:>8.2} s ", region.warned_s), style),
        (output, Style::Plain),
    ]
}

fn ticks(rec: &Recording) -> Line {
    let t = rec.tick_ns;
    let text = format!("  tick    median {}, p99 {}, max {}", duration(t.p50), duration(t.p99), duration(t.max));
    vec![(text, Style::Plain), (format!(" ({} of {} ms)", t.count, 1e3 * rec.tick_s), Style::Dim)]
}

/// A duration with a suitable unit.
pub fn duration(ns: u64) -> String {
    match ns {
        0..1_000 => format!("{ns} ns"),
        1_000..1_000_000 => format!("{:.1} µs", ns as f64 * 1e-3),
        _ => format!("{:.1} ms", ns as f64 * 1e-6),
    }
}

/// Metres as millimetres; a dash for `None`.
pub fn millimetres(metres: Option<f64>) -> String {
    match metres {
        None => "–".into(),
        Some(d) if d.abs() < 0.1 => format!("{:.2} mm", 1e3 * d),
        Some(d) => format!("{:.0} mm", 1e3 * d),
    }
}

/// Control characters become spaces, so that names cannot control the terminal.
fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// At most `width` characters of one line, without control characters.
fn clip(text: &str, width: usize) -> String {
    let text = clean(text);
    if text.chars().count() <= width {
        return text;
    }
    let kept = text.chars().take(width.saturating_sub(1));
    if width == 0 { String::new() } else { kept.chain(['…']).collect() }
}

/// The words of a text in lines of at most `width` characters, all but the first indented by two; a longer word has its own line.
fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => *line = format!("{line} {word}"),
            Some(_) => lines.push(format!("  {word}")),
            None => lines.push(word.to_owned()),
        }
    }
    lines
}

fn pad(text: &str, width: usize) -> String {
    let text = clip(text, width);
    let missing = width - text.chars().count();
    text + &" ".repeat(missing)
}
