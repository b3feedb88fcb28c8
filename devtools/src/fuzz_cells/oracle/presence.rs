//! Check of entries into forbidden regions.

use elbowroom_monitor::RegionKind;

use super::findings::{Finding, Findings, TOLERANCE_M};
use super::guarded::Guarded;
use super::motion::OracleMotion;
use super::promises::Promises;
use super::sweep::{SweptPair, Touch, first_touch};

/// Number of ticks to skip after a region has touched a robot at rest.
const LATER_TICKS: usize = 8;

/// Finds entries into forbidden regions. If entry is excluded, any entry counts. Otherwise, with the stopping distance,
/// entries count of robots that were outside when the region became active; if it was switched on beside a moving robot,
/// the robot must have been at rest outside since.
pub fn entries(motion: &OracleMotion<'_>, guarded: &[Vec<Guarded>], promises: &Promises<'_>, findings: &mut Findings) {
    for (region, place) in motion.places.iter().enumerate() {
        if !matches!(place.kind, RegionKind::Forbidden) {
            continue;
        }
        for &robot in &place.robots {
            let pairs: Vec<SweptPair<'_>> = guarded[robot]
                .iter()
                .filter(|g| g.counts_for(place.guards))
                .map(|g| SweptPair::new(motion, g, robot, region))
                .filter(SweptPair::is_moved)
                .collect();
            findings.judged.watched += usize::from(!pairs.is_empty());
            let watch = Watch { motion, pairs, robot, region };
            // A robot that is never inside breaks no promise.
            let Some((k, u, pair)) = watch.any_touch() else { continue };
            if promises.exclude(region, robot) {
                let (t_s, speed) = (motion.time_s(k, u), pair.own_speed(k));
                findings.list.push(Finding::Excluded { robot, region, t_s, speed });
            } else if motion.cell.monitoring.stopping_reaction_s.is_some() {
                watch.driven(findings);
            }
        }
    }
}

/// One robot and one region.
struct Watch<'a> {
    motion: &'a OracleMotion<'a>,
    pairs: Vec<SweptPair<'a>>,
    robot: usize,
    region: usize,
}

impl<'a> Watch<'a> {
    /// Returns the first time at which any part of the robot is inside, whether robot or region moved.
    fn any_touch(&self) -> Option<Touch<'_, 'a>> {
        self.motion.spans(self.region, self.robot).into_iter().find_map(|(from, to)| {
            let there = || self.pairs.iter().filter(|p| p.is_there(from));
            let inside = there().find(|p| p.is_inside(from)).map(|p| (from, 0.0, p));
            inside.or_else(|| first_touch(&self.pairs, from, to))
        })
    }

    /// Adds the first entry by the robot's own motion.
    fn driven(&self, findings: &mut Findings) {
        for (begin, end) in self.motion.spans(self.region, self.robot) {
            let mut k = begin;
            while let Some((touch, u, pair)) = self.responsible(k, end) {
                k = touch + LATER_TICKS;
                if !self.drove_in(pair, touch, u) {
                    continue;
                }
                if self.motion.is_foreseen(self.region, self.robot, (touch, u)) {
                    let (t_s, speed) = (self.motion.time_s(touch, u), pair.own_speed(touch));
                    findings.list.push(Finding::Entry { robot: self.robot, region: self.region, t_s, speed });
                    return;
                }
                findings.unforeseen_entries += 1;
            }
        }
    }

    /// Returns the first touch after the robot was at rest and outside.
    fn responsible(&self, begin: usize, end: usize) -> Option<Touch<'_, 'a>> {
        // The start counts as rest: nothing has moved before it. So does a step that changes what is in the hand.
        let moves = |k: usize| self.motion.moves(self.robot, k);
        let steps = self.motion.hand_changes(self.robot);
        let at_rest = |k: &usize| *k == 0 || (!moves(*k) && !moves(k - 1)) || steps.contains(k);
        let first = (begin..end).find(at_rest)?;
        let mut rests = (first..end).step_by(LATER_TICKS).filter(at_rest);
        // At rest a robot cannot leave a region that does not move.
        let from = if self.place_is_fixed() {
            let begins = |k: &usize| at_rest(k) && (*k == first || !at_rest(&(k - 1)));
            (first..end).filter(begins).find(|k| self.is_outside(*k))
        } else {
            rests.find(|k| self.is_outside(*k))
        }?;
        first_touch(&self.pairs, from, self.until_jump(from, end))
    }

    fn place_is_fixed(&self) -> bool {
        self.motion.places[self.region].is_fixed()
    }

    fn is_outside(&self, k: usize) -> bool {
        let mut there = self.pairs.iter().filter(|p| p.is_there(k));
        there.all(|p| p.distance(k, 0.0).lower > 10.0 * TOLERANCE_M && !p.is_inside(k))
    }

    /// Returns the tick at which a belt begins again, or the end.
    fn until_jump(&self, from: usize, end: usize) -> usize {
        let Some(pair) = self.pairs.first() else { return end };
        let last = end.min(self.motion.ticks().saturating_sub(1));
        (from..last).find(|k| pair.region_jumps(*k)).unwrap_or(end)
    }

    /// False if the region ran into a robot at rest. If the region moves, the robot must move at the touch; if the
    /// region is fixed, the robot must have come nearer by more than the tolerance within the last tick.
    fn drove_in(&self, pair: &SweptPair<'_>, k: usize, u: f64) -> bool {
        if k == 0 {
            return true;
        }
        if !self.place_is_fixed() {
            return pair.moves_at(k, u);
        }
        let moved = pair.own_speed(k) > 0.0 || (u <= 0.0 && pair.own_speed(k - 1) > 0.0);
        moved && pair.distance_between((k - 1, u), (k, u)).lower > TOLERANCE_M
    }
}
