//! Faults of a schedule: what is killed, paused, cut and filled, and when.

use std::collections::{BTreeMap, VecDeque};

use elbowroom_testkit::random::SplitMix;

use super::network::Host;
use super::process::{ARBITER, BELT, controller_host, node_host};
use super::process_clock::true_us;

/// Time after the end of a disturbance within which it may still explain a wait.
const AFTERMATH_US: u64 = 2_500_000;

/// A disturbance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fault {
    /// A process ends, and starts again after this time, perhaps with the other file.
    Kill {
        host: Host,
        down_us: u64,
        has_other_file: bool,
    },
    Start {
        host: Host,
        has_other_file: bool,
    },
    /// A second node of a robot starts beside the first, for this time.
    Twin {
        rail: usize,
    },
    Pause {
        host: Host,
        for_us: u64,
    },
    /// Nothing arrives from one host at another one.
    Cut {
        from: Host,
        to: Host,
        for_us: u64,
    },
    /// Messages from one host to another are late.
    Late {
        from: Host,
        to: Host,
        for_us: u64,
        late_us: u64,
    },
    RestartController {
        rail: usize,
    },
    RestartBelt,
    /// The disk of the log, or of the journal, takes nothing any more.
    FillDisk {
        of_log: bool,
    },
    FreeDisk {
        of_log: bool,
    },
}

/// The faults that are to come, in order of time.
pub(super) struct FaultPlan {
    has_faults: bool,
    faults: VecDeque<(u64, Fault)>,
    /// Per host, true time until which something disturbs it.
    disturbed_until_us: BTreeMap<Host, u64>,
    pub(super) counts: BTreeMap<&'static str, u64>,
    /// Whether a journal could not be written.
    pub(super) has_lost_journal: bool,
}

impl FaultPlan {
    /// Draws faults; a third of the schedules has none.
    pub(super) fn new(rails: usize, length_us: u64, random: &mut SplitMix) -> Self {
        let mut faults = Vec::new();
        let count = if random.below(4) == 0 { 0 } else { random.below(8) };
        for _ in 0..count {
            let at_us = 300_000 + random.bits() % length_us;
            faults.push((at_us, draw(rails, random)));
        }
        faults.sort_by_key(|(at, _)| *at);
        Self {
            has_faults: count > 0,
            faults: faults.into(),
            disturbed_until_us: BTreeMap::new(),
            counts: BTreeMap::new(),
            has_lost_journal: false,
        }
    }

    pub(super) fn has_faults(&self) -> bool {
        self.has_faults
    }

    /// A fault for the moment of a request, in some cases.
    pub(super) fn beside_a_request(&self, rails: usize, random: &mut SplitMix) -> Option<Fault> {
        let host = node_host(random.below(rails));
        let for_us = 50_000 + random.bits() % 2_500_000;
        match random.below(16) {
            0 => Some(Fault::Cut { from: ARBITER, to: host, for_us }),
            1 => Some(Fault::Cut { from: host, to: ARBITER, for_us }),
            2 => Some(Fault::Pause { host, for_us: for_us / 4 }),
            3 => Some(Fault::Late { from: ARBITER, to: host, for_us, late_us: for_us / 3 }),
            _ => None,
        }
        .filter(|_| self.has_faults)
    }

    pub(super) fn take_due(&mut self, now_us: u64) -> Vec<Fault> {
        let mut due = Vec::new();
        while self.faults.front().is_some_and(|(at, _)| *at <= now_us) {
            due.extend(self.faults.pop_front().map(|(_, fault)| fault));
        }
        due
    }

    pub(super) fn later(&mut self, at_us: u64, fault: Fault) {
        let index = self.faults.partition_point(|(at, _)| *at <= at_us);
        self.faults.insert(index, (at_us, fault));
    }

    pub(super) fn disturb(&mut self, host: Host, for_us: u64) {
        let until = self.disturbed_until_us.entry(host).or_default();
        *until = (*until).max(true_us() + for_us + AFTERMATH_US);
    }

    pub(super) fn disturbed_until_us(&self, host: Host) -> u64 {
        self.disturbed_until_us.get(&host).copied().unwrap_or(0)
    }
}

fn draw(rails: usize, random: &mut SplitMix) -> Fault {
    let rail = random.below(rails);
    let host = if random.below(3) == 0 { ARBITER } else { node_host(rail) };
    let for_us = 1_000 * [20, 80, 150, 400, 900, 1_500, 2_500][random.below(7)] + random.bits() % 50_000;
    let (from, to) = link(rail, random);
    match random.below(14) {
        0..=2 => Fault::Kill { host, down_us: for_us, has_other_file: random.below(4) == 0 },
        3 | 4 => Fault::Pause { host, for_us },
        5..=7 => Fault::Cut { from, to, for_us },
        8 | 9 => Fault::Late { from, to, for_us, late_us: 1_000 * [10, 60, 200, 800][random.below(4)] },
        10 => Fault::RestartController { rail },
        11 => Fault::RestartBelt,
        12 => Fault::Twin { rail },
        _ => Fault::FillDisk { of_log: random.below(2) == 0 },
    }
}

/// Two hosts between which messages go.
fn link(rail: usize, random: &mut SplitMix) -> (Host, Host) {
    let (node, controller) = (node_host(rail), controller_host(rail));
    let (from, to) =
        [(node, ARBITER), (controller, node), (controller, ARBITER), (BELT, node), (BELT, ARBITER)][random.below(5)];
    if random.below(2) == 0 { (from, to) } else { (to, from) }
}
