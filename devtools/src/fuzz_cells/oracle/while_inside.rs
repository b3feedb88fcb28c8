//! Check of what holds while a robot is in a region, or near it: the override of speed zones, and the outputs.

use elbowroom_monitor::{OverrideReason, RegionKind};

use super::findings::{Finding, Findings, TOLERANCE_M};
use super::guarded::Guarded;
use super::motion::OracleMotion;
use super::sweep::SweptPair;

/// An override is as large as another up to this.
const SAME_OVERRIDE: f64 = 1e-9;
/// A part counts as in a warning zone if it is nearer than this to its inner border, m: the monitor guards volumes that enclose the
/// parts, so it may only see them sooner.
const MARGIN_M: f64 = 10.0 * TOLERANCE_M;

/// Finds the first tick at which a robot is in a speed zone with a higher override, and the first at which an output is off that
/// should be on. Solids that no joint moves do not count.
pub fn check(motion: &OracleMotion<'_>, guarded: &[Vec<Guarded>], findings: &mut Findings) {
    // A limit of its rate lets the override come down late.
    let is_at_once = motion.cell.monitoring.laws.override_rate == 0.0;
    for (region, place) in motion.places.iter().enumerate() {
        let spec = &motion.cell.regions[region].region;
        let slow_to = match place.kind {
            RegionKind::Monitored { slow_to } if is_at_once => slow_to,
            _ => None,
        };
        if slow_to.is_none() && spec.output.is_none() && spec.warning_output.is_none() {
            continue;
        }
        for &robot in &place.robots {
            let counted = guarded[robot].iter().filter(|g| g.counts_for(place.guards));
            let pairs = counted.map(|g| SweptPair::new(motion, g, robot, region));
            let pairs: Vec<SweptPair<'_>> = pairs.filter(SweptPair::is_moved).collect();
            let inside = Watched { motion, pairs: &pairs, robot, region };
            if let Some(most) = slow_to {
                inside.in_the_zone(most, findings);
            }
            inside.output_is_on(spec.output, 0.0, findings);
            inside.output_is_on(spec.warning_output, spec.warning_m, findings);
        }
    }
}

/// A robot and a region.
struct Watched<'a> {
    motion: &'a OracleMotion<'a>,
    pairs: &'a [SweptPair<'a>],
    robot: usize,
    region: usize,
}

/// A part of the robot, from one tick to the next.
struct Part<'p, 'a> {
    pair: &'p SweptPair<'a>,
    /// Whether it was near when it was last measured.
    near: bool,
    /// For how much of its approach that stays so, m.
    gap_m: f64,
}

impl Part<'_, '_> {
    /// Whether it is on the robot, and in the region or nearer than a distance (m); to be asked at each tick.
    fn is_near(&mut self, k: usize, within_m: f64) -> bool {
        if self.gap_m <= 0.0 {
            let distance = self.pair.distance(k, 0.0);
            let is_inside = distance.upper <= 0.0 || self.pair.is_surrounded(k);
            self.near = is_inside || distance.upper < within_m;
            // Deep inside a mesh its surface is away.
            self.gap_m = match (is_inside, self.near) {
                (true, _) => distance.lower,
                (false, true) => within_m - distance.upper,
                (false, false) => distance.lower - within_m,
            };
        }
        if k + 1 < self.pair.motion.ticks() {
            self.gap_m -= self.pair.travel(k);
        }
        self.near && self.pair.is_there(k)
    }
}

impl Watched<'_> {
    /// The ticks at which a part of the robot is in the active region, or nearer to it than a distance (m).
    fn ticks(&self, within_m: f64) -> impl Iterator<Item = usize> {
        let mut parts: Vec<Part<'_, '_>> =
            self.pairs.iter().map(|pair| Part { pair, near: false, gap_m: 0.0 }).collect();
        (0..self.motion.ticks()).filter(move |k| {
            // Every part is followed, whether or not another one is near.
            let near = parts.iter_mut().filter_map(|part| part.is_near(*k, within_m).then_some(())).count() > 0;
            near && self.motion.is_active(self.region, *k)
        })
    }

    fn in_the_zone(&self, most: f64, findings: &mut Findings) {
        let Self { robot, region, .. } = *self;
        let samples = &self.motion.recording.robots[robot].samples;
        if let Some(k) = self.ticks(0.0).find(|k| samples[*k].speed_override > most + SAME_OVERRIDE) {
            let (t_s, speed_override) = (samples[k].t_s, samples[k].speed_override);
            findings.list.push(Finding::TooFastInZone { robot, region, t_s, speed_override, most });
        }
    }

    fn output_is_on(&self, output: Option<u8>, within_m: f64, findings: &mut Findings) {
        let Some(output) = output else { return };
        let Self { robot, region, .. } = *self;
        let samples = &self.motion.recording.robots[robot].samples;
        // While the input is faulty, such as in a recording that is faster than its robot, outputs stay as they are.
        let is_faulty = |k: &usize| matches!(samples[*k].reason, OverrideReason::Fault(_));
        let is_off = |k: &usize| samples[*k].outputs >> output & 1 == 0 && !is_faulty(k);
        if let Some(k) = self.ticks((within_m - MARGIN_M).max(0.0)).find(is_off) {
            findings.list.push(Finding::OutputOff { robot, region, t_s: samples[k].t_s, output });
        }
    }
}
