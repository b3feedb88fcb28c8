//! Results of the fuzzer, in a table or as JSON.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Duration;

use elbowroom_cell::Cell;

use super::checked_run::CheckedRun;
use super::coverage::Coverage;
use super::oracle::Finding;

/// Counts of one kind of cells.
#[derive(Debug, Default)]
pub struct Summary {
    kind: &'static str,
    /// Number of cells that were run.
    pub cells: usize,
    /// Numbers of cells that the cell file or the programs refuse, by reason.
    refused: BTreeMap<String, usize>,
    robots: usize,
    finished: usize,
    slowed: usize,
    stopped: usize,
    watched: usize,
    deadlocks: usize,
    unforeseen: usize,
    simulated_s: f64,
    failing: FailingCells,
    pub took: Duration,
    /// The keys that the cells have.
    pub coverage: Coverage,
    /// Failing cells as files, each with its findings.
    pub files: Vec<(PathBuf, String)>,
}

/// Numbers of cells with at least one finding, by kind of finding.
#[derive(Debug, Default)]
struct FailingCells {
    entries: usize,
    broken_promises: usize,
    two_inside: usize,
    silent: usize,
    too_hard: usize,
    too_near: usize,
    energy_made: usize,
    cooperating: usize,
    tilted: usize,
    wrong_cells: usize,
    off_entry: usize,
    misread: usize,
    slowed_mechanisms: usize,
    zones_and_outputs: usize,
    any: usize,
}

impl FailingCells {
    fn add(&mut self, findings: &[Finding]) {
        let has = |test: fn(&Finding) -> bool| usize::from(findings.iter().any(test));
        self.entries += has(|f| matches!(f, Finding::Entry { .. }));
        self.broken_promises += has(|f| matches!(f, Finding::Excluded { .. }));
        self.two_inside += has(|f| matches!(f, Finding::TwoInside { .. }));
        self.silent += has(|f| matches!(f, Finding::SilentDeadlock { .. }));
        self.too_hard += has(|f| matches!(f, Finding::TooHard { .. }));
        self.too_near += has(|f| matches!(f, Finding::TooNear { .. }));
        self.energy_made += has(|f| matches!(f, Finding::EnergyMade { .. }));
        self.cooperating += has(|f| {
            matches!(
                f,
                Finding::NotHeld { .. }
                    | Finding::OffPath { .. }
                    | Finding::WrongView { .. }
                    | Finding::Touched { .. }
                    | Finding::TooFast { .. }
            )
        });
        self.tilted += has(|f| matches!(f, Finding::Tilted { .. }));
        self.wrong_cells += has(|f| matches!(f, Finding::WrongCell { .. }));
        self.off_entry += has(|f| matches!(f, Finding::OffEntry { .. }));
        self.misread += has(|f| matches!(f, Finding::MisreadLimits { .. }));
        self.slowed_mechanisms += has(|f| matches!(f, Finding::Slowed { .. }));
        self.zones_and_outputs += has(|f| matches!(f, Finding::TooFastInZone { .. } | Finding::OutputOff { .. }));
        self.any += usize::from(!findings.is_empty());
    }
}

impl Summary {
    pub fn new(kind: &'static str) -> Self {
        Self { kind, ..Self::default() }
    }

    /// Number of cells with findings.
    pub fn failed(&self) -> usize {
        self.failing.any
    }

    pub(super) fn add(&mut self, run: &CheckedRun) {
        let o = &run.findings;
        self.cells += 1;
        self.robots += run.robots;
        self.finished += run.finished;
        self.slowed += run.slowed;
        self.stopped += run.stopped;
        self.watched += o.watched;
        self.deadlocks += o.deadlocks;
        self.unforeseen += o.unforeseen_entries;
        self.simulated_s += run.simulated_s;
        self.failing.add(&o.list);
    }

    pub fn refuse(&mut self, why: &str) {
        // Without its numbers and names a message stands for many.
        let short: String = why.lines().next().unwrap_or("").chars().filter(|c| !c.is_ascii_digit()).take(90).collect();
        *self.refused.entry(short).or_default() += 1;
    }

    pub fn progress(&self) -> String {
        format!(
            "{}: {} cells, {} refused, {} entries, {} broken promises, {} two inside, {} silent deadlocks, {} too hard, {} guided too near, {} with energy made, {} cooperating wrongly, {} tilted, {} in a wrong cell, {} off their entry, {} with misread limits, {} with slowed mechanisms, {} too fast in a zone or with an output off",
            self.kind,
            self.cells,
            self.refused.values().sum::<usize>(),
            self.failing.entries,
            self.failing.broken_promises,
            self.failing.two_inside,
            self.failing.silent,
            self.failing.too_hard,
            self.failing.too_near,
            self.failing.energy_made,
            self.failing.cooperating,
            self.failing.tilted,
            self.failing.wrong_cells,
            self.failing.off_entry,
            self.failing.misread,
            self.failing.slowed_mechanisms,
            self.failing.zones_and_outputs
        )
    }

    fn rows(&self) -> [(&'static str, String); 24] {
        let share = |n: usize| format!("{:.1} %", 100.0 * n as f64 / self.robots.max(1) as f64);
        [
            ("cells", self.cells.to_string()),
            ("refused", self.refused.values().sum::<usize>().to_string()),
            ("simulated s", format!("{:.0}", self.simulated_s)),
            ("pairs watched", self.watched.to_string()),
            ("robots slowed", share(self.slowed)),
            ("robots stopped", share(self.stopped)),
            ("robots finished", share(self.finished)),
            ("entries", self.failing.entries.to_string()),
            ("broken promises", self.failing.broken_promises.to_string()),
            ("two inside", self.failing.two_inside.to_string()),
            ("deadlocks", self.deadlocks.to_string()),
            ("silent deadlocks", self.failing.silent.to_string()),
            ("braked too hard", self.failing.too_hard.to_string()),
            ("guided too near", self.failing.too_near.to_string()),
            ("energy made", self.failing.energy_made.to_string()),
            ("cooperating wrongly", self.failing.cooperating.to_string()),
            ("tilted", self.failing.tilted.to_string()),
            ("wrong_cells", self.failing.wrong_cells.to_string()),
            ("off their entry", self.failing.off_entry.to_string()),
            ("misread limits", self.failing.misread.to_string()),
            ("slowed mechanisms", self.failing.slowed_mechanisms.to_string()),
            ("zones and outputs", self.failing.zones_and_outputs.to_string()),
            ("unforeseen", self.unforeseen.to_string()),
            ("took s", format!("{:.1}", self.took.as_secs_f64())),
        ]
    }
}

/// Prints a table, and the failing cells.
pub fn print(summaries: &[Summary]) {
    let names = summaries.iter().map(|s| format!(" {:>10}", s.kind)).collect::<Vec<_>>().concat();
    println!("{:<18}{names}", "");
    let rows: Vec<_> = summaries.iter().map(Summary::rows).collect();
    for i in 0..rows.first().map_or(0, |r| r.len()) {
        let values = rows.iter().map(|r| format!(" {:>10}", r[i].1)).collect::<Vec<_>>().concat();
        println!("{:<18}{values}", rows[0][i].0);
    }
    for s in summaries {
        for (why, count) in &s.refused {
            println!("{} refused {count}: {why}", s.kind);
        }
        for (file, words) in &s.files {
            println!("{}\n    {words}", file.display());
        }
    }
}

/// Formats one line of JSON.
pub fn json(seed: u64, summaries: &[Summary]) -> String {
    let mut text = format!("{{\"seed\":{seed},\"kinds\":[");
    for (i, s) in summaries.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        let _ = write!(
            text,
            "{comma}{{\"kind\":\"{}\",\"cells\":{},\"refused\":{},\"robots\":{},\"finished\":{},\"slowed\":{},\"stopped\":{},\
             \"entries\":{},\"broken_promises\":{},\"two_inside\":{},\"deadlocks\":{},\"silent_deadlocks\":{},\"too_hard\":{},\"too_near\":{},\"energy_made\":{},\"unforeseen_entries\":{},\
             \"failed\":{},\"simulated_s\":{:.3},\"took_s\":{:.3}}}",
            s.kind,
            s.cells,
            s.refused.values().sum::<usize>(),
            s.robots,
            s.finished,
            s.slowed,
            s.stopped,
            s.failing.entries,
            s.failing.broken_promises,
            s.failing.two_inside,
            s.deadlocks,
            s.failing.silent,
            s.failing.too_hard,
            s.failing.too_near,
            s.failing.energy_made,
            s.unforeseen,
            s.failing.any,
            s.simulated_s,
            s.took.as_secs_f64()
        );
    }
    text + "]}"
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
        Finding::Slowed { robot: r, t_s } => format!("mechanism {} was slowed down at {t_s:.4} s", robot(r)),
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
