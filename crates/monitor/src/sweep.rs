//! What happens between two snapshots: regions that a volume passes from one to the next.
//!
//! Joints and regions are taken to go straight from one snapshot to the next. No point of a volume then travels farther than
//! `T`, the sum over the joints of lever times change; so while the distances at two instants sum to more than the travel
//! between them, the volume cannot have touched in between. Where they do not, the interval is halved.

use elbowroom_scene::pairs::motion_bound;
use elbowroom_spatial::Pose;

use crate::gaps;
use crate::placement::Placement;
use crate::{Configuration, RegionId, Source};

/// Size of a region that turns and has no end, m: a half-space's border beyond this does not count.
const FAR_M: f64 = 100.0;
/// A source that goes farther than twice what its velocity says, and this (m), begins again elsewhere.
const LEAP_M: f64 = 0.01;
/// What the rounding of distances and positions of some metres can add up to, m.
const ROUNDING_M: f64 = 1e-12;

/// The way of a robot and of the regions from one snapshot to the next.
///
/// ```
/// # use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// # use elbowroom_monitor::{Configuration, ConfigurationParts, Guards, Laws, Region, RegionId, Sweep, Volume};
/// # use elbowroom_spatial::{Pose, Rotation, Vec3};
/// # let rail = Joint { name: "rail".into(), kind: JointKind::Prismatic, parent: LinkId(0), child: LinkId(1),
/// #     origin: Pose::IDENTITY, axis: Vec3::X, limits: Limits::range(0.0, 2.0), mimic: None };
/// # let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail])?;
/// # let plate = Region::cuboid("plate", Vec3::X, Vec3::new(0.004, 1.0, 1.0), Rotation::IDENTITY).guards(Guards::TCP);
/// # let configuration = Configuration::new(ConfigurationParts { robot: "rail".into(), base_in_world: Pose::IDENTITY, chain,
/// #     volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)], regions: vec![plate], sources: vec![], laws: Laws::default() })?;
/// // A TCP on a rail goes 8 mm, through a plate of 4 mm.
/// let mut sweep = Sweep::new(&configuration);
/// sweep.go(&configuration, &[0.996], &[], 0.002);
/// sweep.go(&configuration, &[1.004], &[], 0.002);
/// assert!(sweep.distance(&configuration, RegionId(0), 1.0).is_some_and(|d| d > 0.0));
/// let least = sweep.least(&configuration, RegionId(0), 0.0, 1e-6).expect("it passes through");
/// assert!(least.distance_m <= 0.0 && least.share > 0.0 && least.share < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Sweep {
    /// Everything at some instant on the way; at which share of it the robot is there.
    at: Placement,
    share: Option<f64>,
    from: Vec<f64>,
    to: Vec<f64>,
    /// Per region that follows a source: where it was, where it is, and how far any of its points goes, m; infinite where it
    /// leapt.
    riders: Vec<(Pose, Pose, f64)>,
    /// Per joint the farthest that any point of any volume moves, m per rad or m.
    levers: Vec<f64>,
    travel_m: f64,
    /// Snapshots known, up to two.
    known: u8,
}

/// Where a region is nearest on the way from one snapshot to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Least {
    /// Share of the way, 0..1.
    pub share: f64,
    /// Distance there, m.
    pub distance_m: f64,
}

/// How finely a way is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Detail {
    /// So often an interval is halved.
    pub(crate) halvings: u32,
    /// Whether what is not decided then counts as near as it can be.
    pub(crate) cautious: bool,
}

/// In a tick time is short: at most 63 places are looked at, and what is not decided by then counts.
const IN_THE_TICK: Detail = Detail { halvings: 6, cautious: true };

impl Sweep {
    /// For this configuration; everything is allocated here.
    pub fn new(config: &Configuration) -> Self {
        let at = Placement::new(config);
        let dof = config.chain.dof();
        Self {
            riders: vec![(Pose::IDENTITY, Pose::IDENTITY, 0.0); at.riders.len()],
            share: None,
            from: vec![0.0; dof],
            to: vec![0.0; dof],
            levers: levers(config),
            travel_m: 0.0,
            known: 0,
            at,
        }
    }

    /// The next snapshot, `dt_s` (s) after the last one: joint values (rad, m) and one source per source of the
    /// configuration. False, and nothing known, where these are not as many as they must be, or not finite.
    pub fn go(&mut self, config: &Configuration, q: &[f64], sources: &[Source], dt_s: f64) -> bool {
        let fits = q.len() == self.to.len() && sources.len() == config.sources.len();
        if !fits || !q.iter().all(|v| v.is_finite()) {
            self.forget();
            return false;
        }
        self.at.place_sources(config, sources);
        let poses = self.at.riders.iter().map(|(r, _)| self.at.region_in_world[*r]);
        for ((from, to, _), pose) in self.riders.iter_mut().zip(poses) {
            (*from, *to) = (*to, pose);
        }
        self.step(config, q, dt_s, sources);
        true
    }

    /// As [`Sweep::go`], in the tick, `dt_s` (s) after the snapshot before: everything has been checked and placed.
    pub(crate) fn tick(&mut self, config: &Configuration, now: &Placement, dt_s: f64, sources: &[Source]) {
        for ((from, to, _), (r, _)) in self.riders.iter_mut().zip(&now.riders) {
            (*from, *to) = (*to, now.region_in_world[*r]);
        }
        self.step(config, &now.chain.q, dt_s, sources);
    }

    fn step(&mut self, config: &Configuration, q: &[f64], dt_s: f64, sources: &[Source]) {
        std::mem::swap(&mut self.from, &mut self.to);
        self.to.copy_from_slice(q);
        self.share = None;
        self.known = (self.known + 1).min(2);
        let moved = self.from.iter().zip(&self.to).zip(&self.levers);
        let travel: f64 = moved.map(|((a, b), lever)| if a == b { 0.0 } else { lever * (b - a).abs() }).sum();
        self.travel_m = travel + ROUNDING_M;
        for ((from, to, travel), (r, source)) in self.riders.iter_mut().zip(&self.at.riders) {
            let shift = (to.translation - from.translation).length();
            let told = sources[*source].motion.velocity.length() * dt_s;
            let turned = (from.rotation.inverse() * to.rotation).angle().abs();
            let lever = config.regions[*r].shape.aabb(&Pose::IDENTITY);
            let lever = lever.min.abs().max(lever.max.abs()).length().min(FAR_M);
            let leapt = shift > 2.0 * (told + turned * lever.max(to.translation.length())) + LEAP_M;
            *travel = if leapt { f64::INFINITY } else { shift + turned * lever };
        }
    }

    /// Nothing is known of where the robot comes from.
    pub fn forget(&mut self) {
        self.known = 0;
    }

    /// How far (m) a volume and a region can have come nearer to each other since the last snapshot; infinite where that is
    /// not known.
    pub fn travel(&self, region: RegionId) -> f64 {
        if self.known < 2 {
            return f64::INFINITY;
        }
        self.travel_m + self.rider(region).map_or(0.0, |i| self.riders[i].2)
    }

    /// What volumes can have travelled since the last snapshot, and with the regions that move, m; 0 where it is not known.
    pub(crate) fn reach(&self) -> (f64, f64) {
        if self.known < 2 {
            return (0.0, 0.0);
        }
        let finite = self.riders.iter().map(|r| r.2).filter(|t| t.is_finite());
        (self.travel_m, self.travel_m + finite.fold(0.0, f64::max))
    }

    /// Distance (m) of the region from what it guards at the last snapshot, where it is not above `limit`.
    pub fn distance(&mut self, config: &Configuration, region: RegionId, limit: f64) -> Option<f64> {
        self.place(config, region, 1.0);
        gaps::distance(config, &self.at, region, limit).map(|closest| closest.distance)
    }

    /// Where between the last two snapshots the region was nearest to what it guards, where it came nearer than `below_m`
    /// and nearer than at both ends; to within `resolution_m` (m). `None`, too, where the way is not known.
    pub fn least(
        &mut self,
        config: &Configuration,
        region: RegionId,
        below_m: f64,
        resolution_m: f64,
    ) -> Option<Least> {
        let travel = self.travel(region);
        if !travel.is_finite() {
            return None;
        }
        let halvings = (travel / resolution_m).log2().ceil().clamp(0.0, 30.0) as u32;
        let ends = [0.0, 1.0].map(|share| self.lower_bound(config, region, share, below_m + travel).1);
        self.least_between(config, region, below_m, ends, Detail { halvings, cautious: false })
    }

    /// [`Sweep::least`] where the distances at the ends are known to be not below `ends`.
    pub(crate) fn least_between(
        &mut self,
        config: &Configuration,
        region: RegionId,
        below_m: f64,
        ends: [f64; 2],
        detail: Detail,
    ) -> Option<Least> {
        let travel = self.travel(region);
        if !travel.is_finite() {
            return None;
        }
        let below_m = below_m.min(ends[0]).min(ends[1]);
        let mut search = Search { sweep: self, config, region, travel, below_m, cautious: detail.cautious, best: None };
        search.halve((0.0, ends[0]), (1.0, ends[1]), detail.halvings);
        search.best
    }

    /// The least distance (m) on the way here where it is in the region; or in the warning zone, where the robot is not `warned`
    /// anyway. `ends` are the distances then and now. What cannot be decided counts as passed.
    pub(crate) fn passed(
        &mut self,
        config: &Configuration,
        region: RegionId,
        ends: [f64; 2],
        warned: bool,
    ) -> Option<f64> {
        let zone_m = if warned { 0.0 } else { config.regions[region.0].warning_m };
        // Most ticks end here: coming or going straight, the ends are farther apart than that.
        if ends[0] + ends[1] - 2.0 * zone_m > self.travel(region) {
            return None;
        }
        let mut least = |below_m| self.least_between(config, region, below_m, ends, IN_THE_TICK);
        let zone = least(zone_m)?;
        if zone_m > 0.0 && zone.distance_m > 0.0 { least(0.0).or(Some(zone)) } else { Some(zone) }.map(|l| l.distance_m)
    }

    /// Distance at a share of the way, and a proven lower bound; both `limit` where it is above.
    fn lower_bound(&mut self, config: &Configuration, region: RegionId, share: f64, limit: f64) -> (f64, f64) {
        self.place(config, region, share);
        gaps::distance(config, &self.at, region, limit).map_or((limit, limit), |c| (c.distance, c.lower_bound))
    }

    fn place(&mut self, config: &Configuration, region: RegionId, share: f64) {
        if self.share != Some(share) {
            let Self { at, from, to, .. } = self;
            let mix = at.chain.q.iter_mut().zip(from.iter().zip(to.iter()));
            mix.for_each(|(q, (a, b))| *q = if share < 1.0 { a + (b - a) * share } else { *b });
            at.place_there(config);
            self.share = Some(share);
        }
        if let Some(i) = self.rider(region) {
            let (from, to, _) = &self.riders[i];
            let pose = if share < 1.0 { from.interpolate(to, share) } else { *to };
            self.at.region_in_world[region.0] = pose;
            self.at.region_box[region.0] = config.regions[region.0].shape.aabb(&pose);
        }
    }

    fn rider(&self, region: RegionId) -> Option<usize> {
        self.at.riders.iter().position(|(r, _)| *r == region.0)
    }
}

/// A search for the least distance on the way.
struct Search<'a> {
    sweep: &'a mut Sweep,
    config: &'a Configuration,
    region: RegionId,
    travel: f64,
    below_m: f64,
    cautious: bool,
    best: Option<Least>,
}

impl Search<'_> {
    /// Looks between two shares of the way with proven distances; the depth of the recursion is `halvings`.
    fn halve(&mut self, a: (f64, f64), b: (f64, f64), halvings: u32) {
        let travel = self.travel * (b.0 - a.0);
        let lower = 0.5 * (a.1 + b.1 - travel);
        let so_far = self.best.map_or(f64::INFINITY, |l| l.distance_m);
        if lower > self.below_m || lower >= so_far || so_far <= 0.0 {
            return;
        }
        let share = f64::midpoint(a.0, b.0);
        if halvings == 0 {
            if self.cautious {
                self.best = Some(Least { share, distance_m: lower });
            }
            return;
        }
        let limit = self.below_m + 0.5 * travel;
        let (distance_m, lower) = self.sweep.lower_bound(self.config, self.region, share, limit);
        if distance_m <= self.below_m && distance_m < so_far {
            self.best = Some(Least { share, distance_m });
        }
        self.halve(a, (share, lower), halvings - 1);
        self.halve((share, lower), b, halvings - 1);
    }
}

/// Per joint the farthest that any point of any volume moves per unit, m per rad or m.
fn levers(config: &Configuration) -> Vec<f64> {
    let mut most = vec![0.0; config.chain.dof()];
    for volume in &config.volumes {
        let bounds = volume.shape.aabb(&volume.in_link);
        let radius = bounds.min.abs().max(bounds.max.abs()).length();
        let mut own = vec![0.0; most.len()];
        let path = config.chain.path(volume.link);
        // Joints that follow one another have its index, and add up.
        for (joint, lever) in motion_bound(&config.chain, volume.link, radius, &path) {
            own[joint] += lever;
        }
        most.iter_mut().zip(own).for_each(|(most, own): (&mut f64, f64)| *most = most.max(own));
    }
    most
}
