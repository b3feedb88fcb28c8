//! Results of the fuzzer, in a table or as JSON.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

use elbowroom_cell::Cell;

use super::checked_run::CheckedRun;
use super::coverage::Coverage;
use super::oracle::{Finding, Judged};

/// Counts of one kind of cells.
#[derive(Debug, Default)]
pub struct Summary {
    kind: &'static str,
    /// Number of cells that were run.
    pub cells: usize,
    refused: RefusedCells,
    robots: usize,
    finished: usize,
    slowed: usize,
    stopped: usize,
    deadlocks: usize,
    unforeseen: usize,
    pub judged: Judged,
    simulated_s: f64,
    failing: FailingCells,
    pub took: Duration,
    /// The keys that the cells have.
    pub coverage: Coverage,
    /// Failing cells as files, each with its findings.
    pub files: Vec<(PathBuf, String)>,
}

/// Numbers of cells that the cell file or the programs refuse.
#[derive(Debug, Default)]
struct RefusedCells {
    by_reason: BTreeMap<String, usize>,
    /// Those whose reason is not known.
    unknown: usize,
}

impl RefusedCells {
    fn all(&self) -> usize {
        self.by_reason.values().sum()
    }
}

/// Numbers of cells with findings: by the name of the finding, and of all.
#[derive(Debug, Default)]
struct FailingCells {
    by_name: BTreeMap<&'static str, usize>,
    all: usize,
}

impl FailingCells {
    fn add(&mut self, findings: &[Finding]) {
        let names: BTreeSet<&'static str> = findings.iter().map(name).collect();
        for name in names {
            *self.by_name.entry(name).or_default() += 1;
        }
        self.all += usize::from(!findings.is_empty());
    }

    fn with(&self, name: &str) -> usize {
        self.by_name.get(name).copied().unwrap_or_default()
    }
}

/// Makes the list of the names of findings, and the function that says which one a finding has.
macro_rules! names {
    ($($name:literal: $($variant:ident)|+,)*) => {
        /// What findings are called in tables, and in JSON with underscores.
        const NAMES: &[&str] = &[$($name),*];

        /// The name of a finding.
        fn name(finding: &Finding) -> &'static str {
            match finding {
                $($(Finding::$variant { .. })|+ => $name,)*
            }
        }
    };
}

names! {
    "entries": Entry,
    "broken promises": Excluded,
    "two inside": TwoInside,
    "silent deadlocks": SilentDeadlock,
    "too hard": TooHard,
    "too fast": TooFast,
    "too near": TooNear,
    "touched": Touched,
    "energy made": EnergyMade,
    "cooperating": NotHeld | OffPath | WrongView,
    "tilted": Tilted,
    "wrong cells": WrongCell,
    "off entry": OffEntry,
    "misread": Misread,
    "misread limits": MisreadLimits,
    "off goal": OffGoal,
    "slowed mechanisms": Slowed,
    "zones and outputs": TooFastInZone | OutputOff,
    "off recordings": OffRecording,
    "sensors": TouchedSeen | MovedUnseen | HeldForNothing,
}

/// Why a cell or one of its programs may be refused: messages have one of these parts. Any other refusal is a mistake of
/// the generator or of the reader.
const KNOWN_REFUSALS: &[&str] = &[
    // The start or a target of a real robot may be beyond its limits.
    "brings joint",
    // A line may leave the reach.
    "cannot be followed",
    // The flange of a robot may be a link that nothing moves.
    "guards nothing of robot",
    // No grid is for a mechanism, and it makes no linear moves.
    "which is a mechanism",
    "is a step of the mechanism",
    // A map does not know the regions that its robot must go around.
    "the path through free cells is not proven free",
    // There may be no path, and a search has a time limit.
    "no path",
    // A guided tool, or a planned move, may begin or end at an object.
    "the tool starts",
    "the start of robot",
    "the goal of robot",
];

fn is_known_refusal(why: &str) -> bool {
    KNOWN_REFUSALS.iter().any(|part| why.contains(part))
}

impl Summary {
    pub fn new(kind: &'static str) -> Self {
        Self { kind, ..Self::default() }
    }

    /// Number of cells with findings, and of those that are refused for a reason that is not known.
    pub fn failed(&self) -> usize {
        self.failing.all + self.refused.unknown
    }

    pub(super) fn add(&mut self, run: &CheckedRun) {
        let o = &run.findings;
        self.cells += 1;
        self.robots += run.robots;
        self.finished += run.finished;
        self.slowed += run.slowed;
        self.stopped += run.stopped;
        self.deadlocks += o.deadlocks;
        self.unforeseen += o.unforeseen_entries;
        self.judged.add(&o.judged);
        self.simulated_s += run.simulated_s;
        self.failing.add(&o.list);
    }

    pub fn refuse(&mut self, case: u64, why: &str) {
        let is_known = is_known_refusal(why);
        self.refused.unknown += usize::from(!is_known);
        // Without folders, numbers and names a message stands for many.
        let message = why.lines().next().unwrap_or("");
        let message = message.split_once("fuzz.toml:").map_or(message, |(_, message)| message);
        let shown = if is_known { 90 } else { 400 };
        let short: String = message.chars().filter(|c| !c.is_ascii_digit()).take(shown).collect();
        let short = if is_known { short } else { format!("not known, as of case {case}: {short}") };
        *self.refused.by_reason.entry(short).or_default() += 1;
    }

    pub fn progress(&self) -> String {
        let refused = self.refused.all();
        let found: Vec<String> = self.failing.by_name.iter().map(|(name, count)| format!(", {name} {count}")).collect();
        format!(
            "{}: {} cells, {refused} refused, {} with findings{}",
            self.kind,
            self.cells,
            self.failed(),
            found.concat()
        )
    }

    fn rows(&self) -> Vec<(&'static str, String)> {
        let share = |n: usize| format!("{:.1} %", 100.0 * n as f64 / self.robots.max(1) as f64);
        let mut rows = vec![
            ("cells", self.cells.to_string()),
            ("refused", self.refused.all().to_string()),
            ("simulated s", format!("{:.0}", self.simulated_s)),
            ("pairs watched", self.judged.watched.to_string()),
            ("robots slowed", share(self.slowed)),
            ("robots stopped", share(self.stopped)),
            ("robots finished", share(self.finished)),
            ("deadlocks", self.deadlocks.to_string()),
            ("unforeseen", self.unforeseen.to_string()),
            ("boxes judged", self.judged.boxes.map(|n| n.to_string()).join("/")),
            ("took s", format!("{:.1}", self.took.as_secs_f64())),
        ];
        rows.extend(NAMES.iter().map(|name| (*name, self.failing.with(name).to_string())));
        rows
    }
}

/// Prints a table, and the failing cells.
pub fn print(summaries: &[Summary]) {
    let names = summaries.iter().map(|s| format!(" {:>11}", s.kind)).collect::<Vec<_>>().concat();
    println!("{:<18}{names}", "");
    let rows: Vec<_> = summaries.iter().map(Summary::rows).collect();
    for i in 0..rows.first().map_or(0, Vec::len) {
        let values = rows.iter().map(|r| format!(" {:>11}", r[i].1)).collect::<Vec<_>>().concat();
        println!("{:<18}{values}", rows[0][i].0);
    }
    for s in summaries {
        for (why, count) in &s.refused.by_reason {
            println!("{} refused {count}: {why}", s.kind);
        }
        for (file, words) in &s.files {
            println!("{}\n    {words}", file.display());
        }
    }
}

/// Formats one line of JSON; with keys it has their pairs and the file of their table.
pub fn json(seed: u64, summaries: &[Summary], keys: Option<(&Coverage, &Path)>) -> String {
    let kind = |s: &Summary| {
        let mut counts = serde_json::Map::new();
        for name in NAMES {
            counts.insert(name.replace(' ', "_"), s.failing.with(name).into());
        }
        let mut of_kind = serde_json::json!({
            "kind": s.kind,
            "cells": s.cells,
            "refused": s.refused.all(),
            "refused_for_other_reasons": s.refused.unknown,
            "robots": s.robots,
            "finished": s.finished,
            "slowed": s.slowed,
            "stopped": s.stopped,
            "deadlocks": s.deadlocks,
            "unforeseen_entries": s.unforeseen,
            "judged_boxes": s.judged.boxes,
            "judged_stale_ticks": s.judged.stale_ticks,
            "judged_holds": s.judged.holds,
            "failed": s.failed(),
            "simulated_s": s.simulated_s,
            "took_s": s.took.as_secs_f64(),
        });
        of_kind.as_object_mut().expect("it is an object").append(&mut counts);
        of_kind
    };
    let mut all = serde_json::json!({ "seed": seed, "kinds": summaries.iter().map(kind).collect::<Vec<_>>() });
    if let Some((coverage, table)) = keys {
        let (seen, possible) = coverage.pairs_of_keys();
        all["keys"] = serde_json::json!({ "pairs": seen, "possible_pairs": possible, "table": table });
    }
    all.to_string()
}

/// Formats a finding as a sentence.
pub fn in_words(finding: &Finding, cell: &Cell) -> String {
    let robot = |r: &usize| cell.robots[*r].name.as_str();
    let region = |r: &usize| cell.regions[*r].region.name.as_str();
    match finding {
        Finding::Entry { robot: r, region: g, t_s, speed } => {
            format!(
                "robot {} entered the forbidden region {} at {t_s:.4} s, at up to {speed:.3} m/s",
                robot(r),
                region(g)
            )
        }
        Finding::Excluded { robot: r, region: g, t_s, speed } => {
            format!(
                "`check` says that robot {} cannot enter {}; it was inside at {t_s:.4} s, moving at up to {speed:.3} m/s",
                robot(r),
                region(g)
            )
        }
        Finding::TwoInside { region: g, robots: [a, b], t_s } => format!(
            "robots {} and {} were both inside the exchange region {} at {t_s:.4} s",
            robot(a),
            robot(b),
            region(g)
        ),
        Finding::SilentDeadlock { robots } => format!(
            "robots {} wait for one another for ever, and the run does not report it",
            robots.iter().map(robot).collect::<Vec<_>>().join(", ")
        ),
        Finding::TooNear { robot: r, object, t_s, distance_m, least_m } => format!(
            "guided robot {} was {distance_m:.6} m from {} at {t_s:.4} s, at least {least_m:.6} m are promised",
            robot(r),
            cell.objects[*object].name
        ),
        Finding::EnergyMade { robot: r, t_s, energy_j } => {
            format!("the forces of robot {} made {:.6} J until {t_s:.4} s", robot(r), -energy_j)
        }
        Finding::OffEntry { robot: r, t_s, off_m } => {
            format!("the shaft of robot {} was {off_m:.9} m off its point of entry at {t_s:.4} s", robot(r))
        }
        Finding::WrongView { t_s, share, recorded } => wrong_view(*t_s, *share, *recorded),
        Finding::NotHeld { robot: r, t_s, by_m } => not_held(robot(r), *t_s, *by_m),
        Finding::OffPath { t_s, off_m } => format!("the work-piece was {off_m:.9} m off its path at {t_s:.4} s"),
        Finding::Touched { robot: r, t_s } => format!("robot {} touched something at {t_s:.4} s", robot(r)),
        Finding::TooFast { robot: r, t_s, share } => {
            format!("a joint of robot {} had {share:.6} of its speed at {t_s:.4} s", robot(r))
        }
        Finding::Tilted { robot: r, t_s, off_rad, within_rad } => format!(
            "the tool of robot {} was {off_rad:.4} rad off the direction that it keeps within {within_rad} at {t_s:.4} s",
            robot(r)
        ),
        of_joints => joints_in_words(of_joints, cell),
    }
}

/// Formats a finding on the joints of one robot, on its grid, or on what it is told, as a sentence.
fn joints_in_words(finding: &Finding, cell: &Cell) -> String {
    let robot = |r: &usize| cell.robots[*r].name.as_str();
    match finding {
        Finding::WrongCell { robot: r, t_s, number } => {
            format!("robot {} was not in cell {number} of its grid at {t_s:.4} s", robot(r))
        }
        Finding::TooFastInZone { robot: r, region, t_s, speed_override, most } => format!(
            "robot {} had the override {speed_override:.4} in speed zone {} at {t_s:.4} s, the zone {most:.4}",
            robot(r),
            cell.regions[*region].region.name
        ),
        Finding::OutputOff { robot: r, region, t_s, output } => format!(
            "output {output} was off at {t_s:.4} s while robot {} was in region {} or its warning zone",
            robot(r),
            cell.regions[*region].region.name
        ),
        Finding::OffRecording { robot: r, t_s, ahead_s: Some(ahead_s) } => {
            let side = if *ahead_s > 0.0 { "ahead of" } else { "behind" };
            format!("robot {} is {:.6} s {side} its recording at {t_s:.4} s", robot(r), ahead_s.abs())
        }
        Finding::OffRecording { robot: r, t_s, ahead_s: None } => {
            format!("robot {} is not on the path of its recording at {t_s:.4} s", robot(r))
        }
        Finding::TouchedSeen { robot: r, t_s } => {
            format!("robot {} touched a box that its sensor had seen from the beginning, at {t_s:.4} s", robot(r))
        }
        Finding::MovedUnseen { robot: r, t_s } => {
            format!("robot {} moved at {t_s:.4} s although the last picture of its sensor was too old", robot(r))
        }
        Finding::HeldForNothing { robot: r, t_s } => {
            format!("robot {} was held at {t_s:.4} s without an old picture or an obstacle", robot(r))
        }
        Finding::Slowed { robot: r, t_s } => format!("mechanism {} was slowed down at {t_s:.4} s", robot(r)),
        Finding::Misread { table, off } => format!("{table}: read otherwise than the file states, by {off:.9}"),
        Finding::OffGoal { robot: r, t_s, off } => {
            format!("robot {} is {off:.9} (m, rad) off the goal of its move at {t_s:.4} s", robot(r))
        }
        Finding::MisreadLimits { robot: r, joint, t_s, stopped } => format!(
            "robot {}: a reading of joint {joint} {} at {t_s:.4} s",
            robot(r),
            if *stopped { "within its limits was reported as beyond" } else { "beyond its limits did not stop it" }
        ),
        Finding::TooHard { robot: r, joint, t_s, deceleration, limit } => format!(
            "robot {}: joint {joint} slowed down with {deceleration:.3} at {t_s:.4} s, its limit is {limit:.3} (rad/s² or m/s²)",
            robot(r)
        ),
        other => format!("{other:?}"),
    }
}

fn wrong_view(t_s: f64, share: f64, recorded: Option<f64>) -> String {
    let recorded = recorded.map_or_else(|| "nothing".to_owned(), |v| format!("{v:.3}"));
    format!("hidden from the camera wrongly at {t_s:.3} s: {share:.3}, recorded {recorded}")
}

fn not_held(robot: &str, t_s: f64, by_m: f64) -> String {
    format!("the work-piece moved by {by_m:.9} m in the hand of robot {robot} at {t_s:.4} s")
}
