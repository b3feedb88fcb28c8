//! Away from an end of a route that stands nearer to something than the route may.

use super::random::Random;
use super::way::Way;
use super::{Connect, RouteError, RouteOptions};
use crate::path::End;

/// The first places that are tried are so far away, as rad (or m) of the joint that moves solids most; …
const FIRST: f64 = 0.01;
/// … the last ones so far; …
const LAST: f64 = 1.0;
/// … and each round goes so much farther.
const GROWTH: f64 = 1.4;
/// Places in a round.
const TRIES: usize = 32;

impl Connect<'_> {
    /// Where the route itself begins and ends.
    pub(super) fn exits(
        &mut self,
        ends: &[Vec<f64>; 2],
        random: &mut Random,
        options: &RouteOptions,
    ) -> Result<[Vec<f64>; 2], RouteError> {
        let mut exits = ends.clone();
        for (end, exit) in [End::Start, End::Goal].into_iter().zip(&mut exits) {
            let inside = self.way.fenced.as_mut().and_then(|f| f.inside(exit));
            let fenced = |(what, metres)| RouteError::Fenced { end, what, metres };
            if let (End::Goal, Some(inside)) = (end, &inside) {
                return Err(fenced(inside.clone()));
            }
            let found = self.exit(exit, options.clearance_m, random);
            *exit = found.ok_or_else(|| inside.map_or_else(|| self.not_found(ends, 0, options), fenced))?;
        }
        Ok(exits)
    }

    /// The end itself where it has the clearance; else a place near by that has it, and that is reached straight, keeping
    /// half of the end's own room and coming no nearer to a fence. Leaves the sweeps without clearance, as they were.
    fn exit(&mut self, end: &[f64], clearance_m: f64, random: &mut Random) -> Option<Vec<f64>> {
        let before = self.way.sweep;
        let room = self.way.distance(end).map_or(f64::INFINITY, |d| d.metres);
        let apart = room > clearance_m + before.tolerance_m;
        let found = if apart && self.way.fenced.as_mut().is_none_or(|f| f.is_free(end)) {
            Some(end.to_vec())
        } else {
            self.look_around(end, [clearance_m, if apart { clearance_m } else { 0.5 * room }], random)
        };
        self.way.sweep = before;
        found
    }

    fn look_around(&mut self, end: &[f64], [clearance_m, kept_m]: [f64; 2], random: &mut Random) -> Option<Vec<f64>> {
        let mut radius = FIRST;
        let mut place = end.to_vec();
        while radius <= LAST {
            for _ in 0..TRIES {
                if self.way.late() {
                    return None;
                }
                step(&self.way, end, radius, random, &mut place);
                self.bounds.clamp(&mut place);
                self.way.sweep.clearance_m = clearance_m;
                if !self.way.is_free(&place) {
                    continue;
                }
                self.way.sweep.clearance_m = kept_m;
                if self.way.leaves(end, &place) {
                    return Some(place);
                }
            }
            radius *= GROWTH;
        }
        None
    }
}

/// A random step of that size.
fn step(way: &Way<'_>, from: &[f64], radius: f64, random: &mut Random, out: &mut [f64]) {
    for ((to, q), rad) in out.iter_mut().zip(from).zip(way.alike(1.0)) {
        *to = q + random.between(-1.0, 1.0) * rad;
    }
    let far = way.travel(from, out);
    let scale = if far > 0.0 { radius / far } else { 0.0 };
    out.iter_mut().zip(from).for_each(|(to, q)| *to = q + (*to - q) * scale);
}
