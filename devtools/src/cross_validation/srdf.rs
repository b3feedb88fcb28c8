//! Comparison of elbowroom's allowed collision matrix with an SRDF's list of disabled pairs.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use elbowroom_kinematics::LinkId;
use elbowroom_robot::RobotId;
use elbowroom_robot::{GeometryId, Robot};
use elbowroom_scene::{PairEntry, PairState, Reason, Scene};

use super::world;

/// Number of states that the suggestions are sampled from.
const SAMPLES: u64 = 1000;

/// Comparison of every pair of links of one robot.
pub struct Comparison {
    /// (what the SRDF says, what elbowroom says) → pairs of link names.
    pub cases: BTreeMap<(String, String), Vec<String>>,
    /// Number of pairs that both test or both skip.
    pub equal: usize,
}

/// Compares. `plain` is the robot without its SRDF, `disabled` the pairs of the SRDF.
pub fn compare(name: &str, plain: Robot, disabled: &[(LinkId, LinkId, String)]) -> Result<Comparison, String> {
    let links = plain.chain.links().to_vec();
    let scene = world::scene(name, plain, Vec::new())?;
    let matrix = scene.allowed_collision_matrix().sampled(&scene, SAMPLES);
    let mut comparison = Comparison { cases: BTreeMap::new(), equal: 0 };
    let listed = |a: LinkId, b: LinkId| {
        let same = |p: &&(LinkId, LinkId, String)| (p.0, p.1) == (a, b) || (p.0, p.1) == (b, a);
        disabled.iter().find(same).map(|p| p.2.clone())
    };
    for entry in matrix.entries() {
        let (GeometryId::Link { link: a, .. }, GeometryId::Link { link: b, .. }) = (entry.a, entry.b) else { continue };
        comparison.add(listed(a, b), Some(entry), format!("{} - {}", links[a.0], links[b.0]));
    }
    for (a, b, why) in disabled {
        if !has_entry(&scene, *a, *b) {
            comparison.add(Some(why.clone()), None, format!("{} - {}", links[a.0], links[b.0]));
        }
    }
    Ok(comparison)
}

fn has_entry(scene: &Scene, a: LinkId, b: LinkId) -> bool {
    let geometry = |link| GeometryId::Link { robot: RobotId(0), link };
    scene.allowed_collision_matrix().get(geometry(a), geometry(b)).is_some()
}

impl Comparison {
    fn add(&mut self, srdf: Option<String>, entry: Option<&PairEntry>, names: String) {
        let skipped = entry.is_none_or(|e| e.state == PairState::Skipped);
        self.equal += usize::from(srdf.is_some() == skipped);
        let theirs = srdf.unwrap_or_else(|| "tested".into());
        self.cases.entry((theirs, ours(entry))).or_default().push(names);
    }

    /// Number of pairs that one side tests and the other does not.
    pub fn different(&self) -> usize {
        self.cases.values().map(Vec::len).sum::<usize>() - self.equal
    }

    /// Formats a table: what both say, how many pairs, and the names of pairs that differ.
    pub fn table(&self) -> String {
        let mut out = String::from("| SRDF | elbowroom | pairs | which |\n| --- | --- | ---: | --- |\n");
        for ((theirs, ours), pairs) in &self.cases {
            let differ = (theirs == "tested") != ours.starts_with("tested");
            let which = if differ { pairs.join(", ") } else { String::new() };
            let _ = writeln!(out, "| {theirs} | {ours} | {} | {which} |", pairs.len());
        }
        out
    }
}

/// Returns elbowroom's reason, without the numbers in which pairs differ.
fn ours(entry: Option<&PairEntry>) -> String {
    let Some(entry) = entry else { return "no solid".into() };
    match (entry.state, &entry.reason, &entry.suggestion) {
        (PairState::Skipped, Reason::OutOfReach { .. }, _) => "skipped: proven out of reach".into(),
        (PairState::Skipped, reason, _) => format!("skipped: {reason}"),
        (PairState::Tested, _, Some(Reason::NeverInSamples { samples, .. })) => {
            format!("tested: no contact in {samples} samples is no proof")
        }
        (PairState::Tested, _, Some(Reason::AlwaysInContact { samples })) => {
            format!("tested: in contact in all {samples} samples")
        }
        (PairState::Tested, ..) => "tested: contact in some samples, not in all".into(),
    }
}
