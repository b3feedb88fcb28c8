//! Judge of a schedule: knows the true places of the carriages, and what people were told; shares no distances or laws with
//! the service.

use std::collections::BTreeMap;

use super::cell::{
    APART_M, CARRIAGE_M, CART_AT_M, CART_M, EXCHANGE_AT_M, EXCHANGE_M, FOLLOWING_M, Follows, WALL_AT_M, WALL_M, belt,
    sharing,
};
use super::process_clock::true_us;

/// Time after which a switched region surely counts: the table's validity, a late message, and a stop.
const SURELY_ON_US: u64 = 2_000_000;
/// Time in which a robot that was named in an answer may still come in.
const NAMED_US: u64 = 2_000_000;
/// Speed below which a carriage counts as at rest, m/s.
const REST_M_S: f64 = 0.01;
/// Depth that counts as inside, m.
const INSIDE_M: f64 = 1e-6;

/// What a schedule has shown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Findings {
    /// What must not occur, in words.
    pub(super) wrong: Vec<String>,
    /// Number of passages through exchange regions.
    pub(super) passages: u64,
    /// Number of targets that carriages have reached.
    pub(super) arrivals: u64,
    /// Number of milliseconds at rest before a region in force, within 50 mm.
    pub(super) held_ms: u64,
}

/// A sphere that carriages must not enter.
#[derive(Debug, Clone)]
pub(super) struct Zone {
    pub(super) name: String,
    pub(super) x: f64,
    pub(super) z: f64,
    pub(super) radius: f64,
    /// The rails whose carriages were named in the answer: they may come in for a while.
    pub(super) named: Vec<usize>,
    pub(super) since_us: u64,
}

impl Zone {
    /// Distance of a carriage from it, m.
    pub(super) fn distance(&self, rail: usize, q: f64) -> f64 {
        (self.x - APART_M * rail as f64).hypot(self.z - q) - self.radius - CARRIAGE_M
    }
}

/// The judge.
pub(super) struct Judge {
    follows: Follows,
    pub(super) findings: Findings,
    /// Places of the last millisecond.
    before: Vec<f64>,
    before_carried: f64,
    /// Regions that were added or moved, with their places.
    pub(super) zones: Vec<Zone>,
    /// The region that people ask to be moved or removed, and whether a carriage has entered its place since.
    moving: Option<(String, bool)>,
    /// Their places before the last move.
    former: BTreeMap<String, (f64, f64)>,
    /// True time since which the switched region is on in the table; `None` while it is off or unknown.
    pub(super) cart_on_since_us: Option<u64>,
    inside: Vec<Option<usize>>,
}

impl Judge {
    pub(super) fn new(follows: Follows, places: &[f64]) -> Self {
        Self {
            follows,
            findings: Findings::default(),
            before: places.to_vec(),
            before_carried: 0.0,
            zones: Vec::new(),
            moving: None,
            former: BTreeMap::new(),
            cart_on_since_us: None,
            inside: vec![None; places.len()],
        }
    }

    pub(super) fn wrong(&mut self, what: &str) {
        self.findings.wrong.push(format!("{:.3} s: {what}", true_us() as f64 * 1e-6));
    }

    /// Looks at places and velocities after a millisecond.
    pub(super) fn look(&mut self, places: &[f64], velocities: &[f64]) {
        self.exchange_regions(places);
        let fixed = |name: &str, x: f64, z: f64, radius: f64| Zone {
            name: name.into(),
            x,
            z,
            radius,
            named: Vec::new(),
            since_us: 0,
        };
        let mut zones = vec![fixed("wall", APART_M, WALL_AT_M, WALL_M)];
        if self.cart_on_since_us.is_some_and(|since| true_us() - since > SURELY_ON_US) {
            zones.push(fixed("cart", 0.0, CART_AT_M, CART_M));
        }
        zones.extend(self.zones.iter().cloned());
        for zone in &zones {
            self.entries(zone, places, velocities);
        }
        self.carried(places, velocities);
        self.before.copy_from_slice(places);
    }

    fn exchange_regions(&mut self, places: &[f64]) {
        let shares = |region: usize, rail: usize| sharing(region).contains(&rail);
        let (rails, regions) = (places.len(), places.len() - 1);
        let is_in = |region: usize, rail: usize| {
            let x = APART_M * (region as f64 + 0.5 - rail as f64);
            shares(region, rail) && x.hypot(EXCHANGE_AT_M[region] - places[rail]) < EXCHANGE_M + CARRIAGE_M - INSIDE_M
        };
        let now: Vec<Option<usize>> = (0..rails).map(|rail| (0..regions).find(|region| is_in(*region, rail))).collect();
        for rail in 0..rails {
            let has_entered = now[rail].is_some() && now[rail] != self.inside[rail];
            self.findings.passages += u64::from(has_entered);
            let other = (0..rails).find(|other| *other != rail && now[*other] == now[rail]);
            if let (true, Some(region), Some(other)) = (has_entered, now[rail], other) {
                self.wrong(&format!("r{rail} enters shared{region} while r{other} is inside"));
            }
        }
        self.inside = now;
    }

    fn entries(&mut self, zone: &Zone, places: &[f64], velocities: &[f64]) {
        for rail in 0..places.len() {
            let (distance, before) = (zone.distance(rail, places[rail]), zone.distance(rail, self.before[rail]));
            let is_excused = zone.named.contains(&rail) && true_us() - zone.since_us < NAMED_US;
            if distance < -INSIDE_M && before >= -INSIDE_M && !is_excused {
                if self.moving.as_ref().is_some_and(|(name, _)| *name == zone.name) {
                    self.moving = Some((zone.name.clone(), true));
                    continue;
                }
                self.wrong(&format!(
                    "r{rail} enters {} at {:.3} m with {:.3} m/s",
                    zone.name, places[rail], velocities[rail]
                ));
            }
            self.findings.held_ms += u64::from((0.0..0.05).contains(&distance) && velocities[rail] == 0.0);
        }
    }

    /// A carriage must not come to the region on the last one, or on the belt, by its own motion: a region that comes
    /// faster than the carriage, which brakes or cannot know, has come to it.
    fn carried(&mut self, places: &[f64], velocities: &[f64]) {
        let last = places.len() - 1;
        let z = match self.follows {
            Follows::Nothing => return,
            Follows::Carriage => places[last],
            Follows::Belt => belt(true_us() as f64 * 1e-6).0,
        };
        let distance = |q: f64, z: f64| APART_M.hypot(z - q) - FOLLOWING_M - CARRIAGE_M;
        let (q, v) = (places[last - 1], velocities[last - 1]);
        let has_come = distance(q, z) < -INSIDE_M && distance(self.before[last - 1], self.before_carried) >= -INSIDE_M;
        let towards = (z - q).signum();
        let (own, of_region) = (v * towards, 1e3 * (self.before_carried - z) * towards);
        if has_come && own > REST_M_S && own > of_region {
            self.wrong(&format!(
                "r{} enters the region that moves, at {q:.3} m with {v:.3} m/s, the region at {z:.3} m",
                last - 1
            ));
        }
        self.before_carried = z;
    }

    /// People ask for a region to be moved or removed: if that is done, its place may be free before they are told.
    pub(super) fn begin_change(&mut self, name: &str) {
        self.moving = Some((name.to_owned(), false));
    }

    /// The request has ended.
    pub(super) fn end_change(&mut self, is_refused: bool) {
        if let Some((name, true)) = self.moving.take().filter(|_| is_refused) {
            self.wrong(&format!("a carriage enters {name}, which stays where it is"));
        }
    }

    /// Where a region was before it was moved.
    pub(super) fn former(&self, name: &str) -> Option<(f64, f64)> {
        self.former.get(name).copied()
    }

    /// An answer says that the switched region is on, or off.
    pub(super) fn switched(&mut self, is_on: bool) {
        self.cart_on_since_us = is_on.then(|| self.cart_on_since_us.unwrap_or(true_us()));
    }

    /// A change of a region has been answered: it is in force from now on.
    pub(super) fn in_force(&mut self, zone: Zone, places: &[f64]) {
        for rail in (0..places.len()).filter(|rail| !zone.named.contains(rail)) {
            if zone.distance(rail, places[rail]) < -INSIDE_M {
                self.wrong(&format!("r{rail} is inside {} when the answer says that it is in force", zone.name));
            }
        }
        if let Some(before) = self.zones.iter().find(|other| other.name == zone.name) {
            self.former.insert(zone.name.clone(), (before.x, before.z));
        }
        self.zones.retain(|other| other.name != zone.name);
        self.zones.push(zone);
    }

    /// From now on nobody is promised anything about this region.
    pub(super) fn no_longer(&mut self, name: &str) {
        self.zones.retain(|zone| zone.name != name);
    }
}

#[cfg(test)]
mod tests {
    use super::super::process_clock::set_true_us;
    use super::*;

    fn zone(name: &str, z: f64, named: Vec<usize>) -> Zone {
        Zone { name: name.into(), x: 0.0, z, radius: 0.1, named, since_us: 0 }
    }

    fn found(judge: &Judge, what: &str) -> usize {
        judge.findings.wrong.iter().filter(|wrong| wrong.contains(what)).count()
    }

    #[test]
    fn what_must_not_occur_is_found_once() {
        set_true_us(10_000_000);
        let mut judge = Judge::new(Follows::Nothing, &[0.1, 0.1]);
        let slow = [0.5, 0.5];
        judge.look(&[0.8, 0.1], &slow);
        assert!(judge.findings.wrong.is_empty() && judge.findings.passages == 1);
        for _ in 0..3 {
            judge.look(&[0.8, 0.8], &slow);
        }
        assert_eq!(found(&judge, "r1 enters shared0 while r0 is inside"), 1);
        judge.in_force(zone("far", 1.5, vec![]), &[0.8, 0.8]);
        judge.look(&[1.5, 0.8], &slow);
        judge.look(&[1.5, 2.3], &slow);
        assert_eq!((found(&judge, "r0 enters far"), found(&judge, "r1 enters wall")), (1, 1));
        judge.in_force(zone("on it", 1.5, vec![]), &[1.5, 2.3]);
        assert_eq!(found(&judge, "r0 is inside on it"), 1);
        judge.cart_on_since_us = Some(0);
        judge.look(&[1.25, 2.3], &slow);
        assert_eq!(found(&judge, "r0 enters cart"), 1);
    }

    #[test]
    fn what_an_answer_names_and_what_a_change_frees_is_excused() {
        set_true_us(1_000_000);
        let mut judge = Judge::new(Follows::Nothing, &[0.1, 0.1]);
        judge.in_force(zone("named", 1.5, vec![0]), &[0.1, 0.1]);
        judge.look(&[1.5, 0.1], &[0.5, 0.0]);
        assert!(judge.findings.wrong.is_empty());
        for (is_refused, expected) in [(false, 0), (true, 1)] {
            let mut judge = Judge::new(Follows::Nothing, &[0.1, 0.1]);
            judge.in_force(zone("moved", 1.5, vec![]), &[0.1, 0.1]);
            judge.begin_change("moved");
            judge.look(&[1.5, 0.1], &[0.5, 0.0]);
            judge.end_change(is_refused);
            assert_eq!(judge.findings.wrong.len(), expected);
        }
    }

    /// A region that comes to a carriage at rest, or faster than it brakes, is not entered.
    #[test]
    fn a_carriage_comes_to_a_moving_region_by_its_own_motion_only() {
        set_true_us(0);
        for (before, after, velocity, expected) in
            [([0.5, 0.8], [0.7, 0.8], 0.5, 1), ([0.5, 0.9], [0.5, 0.7], 0.0, 0), ([0.5, 0.9], [0.501, 0.7], 0.5, 0)]
        {
            let places = |[q, z]: [f64; 2]| [0.1, q, z];
            let mut judge = Judge::new(Follows::Carriage, &places(before));
            judge.look(&places(before), &[0.0, velocity, 0.0]);
            judge.look(&places(after), &[0.0, velocity, 0.0]);
            assert_eq!(found(&judge, "the region that moves"), expected, "{before:?} {after:?}");
        }
    }
}
