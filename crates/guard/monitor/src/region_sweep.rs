//! Continuous check between two snapshots: finds the regions that a volume passes through between them.
//!
//! Joints and regions are assumed to move straight from one snapshot to the next. Then no point of a volume travels
//! farther than `T`: the sum over the joints of motion bound times change, or its chord and bend
//! (`volume_travel.rs`). If the distances at two instants sum to more than the travel between them, the volume cannot
//! have touched the region in between. Otherwise the interval is halved.

use elbowroom_kinematics::motion_bound::update_max_motion_bounds;
use elbowroom_spatial::{Pose, Vec3};

use crate::distance_to_guarded::{BoundedDistance, distance_to_guarded};
use crate::placement::Placement;
use crate::volume_travel::VolumeTravel;
use crate::{AttachError, Configuration, RegionId, SourceState, VolumeId};

/// Size of an unbounded region that rotates, m: the border of a half-space is ignored beyond it.
const UNBOUNDED_SIZE_M: f64 = 100.0;
/// A source that moves farther than twice its reported travel plus this (m) has jumped.
const JUMP_M: f64 = 0.01;
/// Allowance for rounding errors of distances and positions of some metres, m.
const ROUNDING_M: f64 = 1e-12;

/// The motion of a robot and of the regions from one snapshot to the next.
///
/// ```
/// # use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// # use elbowroom_monitor::{Configuration, ConfigurationParts, Guards, Laws, Region, RegionId, RegionSweep, Volume};
/// # use elbowroom_spatial::{Pose, Rotation, Vec3};
/// # let rail = Joint { name: "rail".into(), kind: JointKind::Prismatic, parent: LinkId(0), child: LinkId(1),
/// #     origin: Pose::IDENTITY, axis: Vec3::X, limits: Limits::range(0.0, 2.0), mimic: None };
/// # let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail])?;
/// # let plate = Region::cuboid("plate", Vec3::X, Vec3::new(0.004, 1.0, 1.0), Rotation::IDENTITY).guards(Guards::TCP);
/// # let configuration = Configuration::new(ConfigurationParts { robot: "rail".into(), base_in_world: Pose::IDENTITY, chain,
/// #     volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)], regions: vec![plate], sources: vec![], grids: vec![], laws: Laws::default() })?;
/// // A TCP on a rail moves by 8 mm, through a plate of 4 mm.
/// let mut sweep = RegionSweep::new(&configuration);
/// sweep.advance(&configuration, &[0.996], &[], 0.002);
/// sweep.advance(&configuration, &[1.004], &[], 0.002);
/// assert!(sweep.distance(&configuration, RegionId(0), 1.0).is_some_and(|d| d > 0.0));
/// let closest = sweep.closest_approach(&configuration, RegionId(0), 0.0, 1e-6).expect("it passes through");
/// assert!(closest.distance_m <= 0.0 && closest.fraction > 0.0 && closest.fraction < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct RegionSweep {
    /// The placement at one instant of the motion, and the fraction of the motion at which the robot is placed.
    at: Placement,
    fraction: Option<f64>,
    from: Vec<f64>,
    to: Vec<f64>,
    /// The motions of the dynamic regions, in the order of [`Placement::dynamic_regions`].
    region_motions: Vec<RegionMotion>,
    /// Motion bound of all volumes per joint, m per rad or m.
    motion_bounds: Vec<f64>,
    /// Memory for updates of the bounds.
    scratch: Vec<f64>,
    /// The travel of the volumes between two snapshots that were placed.
    travel: VolumeTravel,
    /// Distance of the volumes from where they were at the previous snapshot, m.
    shift_m: f64,
    travel_m: f64,
    /// Number of known snapshots, up to two.
    known: u8,
}

/// Motion of a dynamic region from one snapshot to the next.
#[derive(Debug, Clone, Copy)]
struct RegionMotion {
    from: Pose,
    to: Pose,
    /// Largest travel of its points, m; infinite after a jump.
    travel_m: f64,
}

/// The closest approach of a region between two snapshots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestApproach {
    /// Fraction of the motion, 0..1.
    pub fraction: f64,
    /// Distance at that instant, m.
    pub distance_m: f64,
}

/// Largest travel since the previous tick, m; pairs within it are measured too.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TravelBound {
    /// Distance of the volumes from where they were; infinite if that is not known.
    pub(crate) shift: f64,
    /// Travel of the volumes.
    pub(crate) volumes: f64,
    /// Travel of volumes and dynamic regions towards each other.
    pub(crate) relative: f64,
}

/// Settings of the bisection.
#[derive(Debug, Clone, Copy)]
struct BisectionSettings {
    /// Largest number of halvings of the interval.
    max_depth: u32,
    /// If true, an interval that is undecided at the largest depth counts with its lower bound.
    conservative: bool,
}

/// Settings in a tick: at most 63 instants are measured, and undecided intervals count.
const IN_TICK: BisectionSettings = BisectionSettings { max_depth: 6, conservative: true };

/// An instant of the motion with a proven lower bound of the distance.
#[derive(Debug, Clone, Copy)]
struct Sample {
    fraction: f64,
    lower_bound: f64,
}

impl RegionSweep {
    /// Creates a sweep for this configuration; allocates all of its memory.
    pub fn new(config: &Configuration) -> Self {
        let at = Placement::new(config);
        let dof = config.chain.dof();
        let at_rest = RegionMotion { from: Pose::IDENTITY, to: Pose::IDENTITY, travel_m: 0.0 };
        let mut sweep = Self {
            region_motions: vec![at_rest; at.dynamic_regions.len()],
            fraction: None,
            from: vec![0.0; dof],
            to: vec![0.0; dof],
            motion_bounds: vec![0.0; dof],
            scratch: vec![0.0; dof],
            travel: VolumeTravel::new(config),
            shift_m: f64::INFINITY,
            travel_m: 0.0,
            known: 0,
            at,
        };
        sweep.update_motion_bounds(config);
        sweep
    }

    /// Attaches a volume, as [`Monitor::attach`](crate::Monitor::attach) does. Call it when the robot is at the next
    /// snapshot: the volume also counts for the motion to that snapshot, as if it had been attached before.
    ///
    /// # Errors
    /// [`AttachError`]; then nothing changes.
    pub fn attach(&mut self, config: &Configuration, volume: VolumeId, in_link: &Pose) -> Result<(), AttachError> {
        self.at.attached.attach(config, volume, in_link)?;
        self.update_motion_bounds(config);
        Ok(())
    }

    /// Detaches a volume from the next snapshot on.
    ///
    /// # Errors
    /// [`AttachError`]; then nothing changes.
    pub fn detach(&mut self, config: &Configuration, volume: VolumeId) -> Result<(), AttachError> {
        self.at.attached.detach(config, volume)?;
        self.update_motion_bounds(config);
        Ok(())
    }

    fn update_motion_bounds(&mut self, config: &Configuration) {
        let volumes = self.at.attached.iter(config).map(|(v, in_link)| (v.link, v.radius_at(in_link)));
        update_max_motion_bounds(&config.chain, volumes, &mut self.motion_bounds, &mut self.scratch);
        // Volumes have changed: the placements are no longer valid.
        self.fraction = None;
        self.travel.forget();
    }

    /// Advances to the next snapshot, `dt_s` (s) after the last one: joint values (rad, m) and one state per source of
    /// the configuration. Returns false, and resets, if their number is wrong or a value is not finite.
    pub fn advance(&mut self, config: &Configuration, q: &[f64], sources: &[SourceState], dt_s: f64) -> bool {
        let fits = q.len() == self.to.len() && sources.len() == config.sources.len();
        if !fits || !q.iter().all(|v| v.is_finite()) {
            self.reset();
            return false;
        }
        self.at.place_sources(config, sources);
        for (motion, dynamic) in self.region_motions.iter_mut().zip(&self.at.dynamic_regions) {
            (motion.from, motion.to) = (motion.to, self.at.region_in_world[dynamic.region.0]);
        }
        self.shift_m = f64::INFINITY;
        self.step(config, q, dt_s, sources);
        true
    }

    /// Like [`RegionSweep::advance`], for a snapshot that is valid and placed, `dt_s` (s) after the previous one.
    pub(crate) fn advance_to(&mut self, config: &Configuration, now: &Placement, dt_s: f64, sources: &[SourceState]) {
        for (motion, dynamic) in self.region_motions.iter_mut().zip(&now.dynamic_regions) {
            (motion.from, motion.to) = (motion.to, now.region_in_world[dynamic.region.0]);
        }
        self.shift_m = self.travel.advance(now);
        self.step(config, &now.chain.q, dt_s, sources);
    }

    fn step(&mut self, config: &Configuration, q: &[f64], dt_s: f64, sources: &[SourceState]) {
        std::mem::swap(&mut self.from, &mut self.to);
        self.to.copy_from_slice(q);
        self.fraction = None;
        self.known = (self.known + 1).min(2);
        let moved = self.from.iter().zip(&self.to).zip(&self.motion_bounds);
        let travel: f64 = moved.map(|((a, b), bound)| if a == b { 0.0 } else { bound * (b - a).abs() }).sum();
        self.travel_m = self.travel.path(self.shift_m, travel, &self.from, &self.to) + ROUNDING_M;
        for (motion, dynamic) in self.region_motions.iter_mut().zip(&self.at.dynamic_regions) {
            let shift = (motion.to.translation - motion.from.translation).length();
            let reported = sources[dynamic.source.0].motion.velocity.length() * dt_s;
            let turned = (motion.from.rotation.inverse() * motion.to.rotation).angle().abs();
            let bounds = config.regions[dynamic.region.0].shape.aabb(&Pose::IDENTITY);
            let lever = bounds.max_distance(Vec3::ZERO).min(UNBOUNDED_SIZE_M);
            let jumped = shift > 2.0 * (reported + turned * lever.max(motion.to.translation.length())) + JUMP_M;
            motion.travel_m = if jumped { f64::INFINITY } else { shift + turned * lever };
        }
    }

    /// Discards the known snapshots.
    pub fn reset(&mut self) {
        self.known = 0;
    }

    /// Upper bound of the travel (m) of a volume and a region towards each other since the previous snapshot; infinite
    /// if the motion is not known.
    pub fn travel_bound_of(&self, region: RegionId) -> f64 {
        if self.known < 2 {
            return f64::INFINITY;
        }
        self.travel_m + self.dynamic_index(region).map_or(0.0, |i| self.region_motions[i].travel_m)
    }

    /// Distance beyond the reach of the laws up to which pairs are measured, because of the travel since the previous
    /// snapshot; 0 (nothing to search) if the motion is not known.
    pub(crate) fn extra_reach_for_travel(&self) -> TravelBound {
        if self.known < 2 {
            return TravelBound { shift: self.shift_m, volumes: 0.0, relative: 0.0 };
        }
        let finite = self.region_motions.iter().map(|m| m.travel_m).filter(|t| t.is_finite());
        TravelBound {
            shift: self.shift_m,
            volumes: self.travel_m,
            relative: self.travel_m + finite.fold(0.0, f64::max),
        }
    }

    /// Distance (m) of the region from the guarded volumes at the last snapshot; `None` if it exceeds `limit`.
    pub fn distance(&mut self, config: &Configuration, region: RegionId, limit: f64) -> Option<f64> {
        self.place(config, region, 1.0);
        distance_to_guarded(config, &self.at, region, limit).map(|d| d.distance)
    }

    /// The closest approach of the region and the guarded volumes between the last two snapshots, to within
    /// `resolution_m` (m). `None` if its distance is not below `below_m` and below the distances at both ends, or if the
    /// motion is not known.
    pub fn closest_approach(
        &mut self,
        config: &Configuration,
        region: RegionId,
        below_m: f64,
        resolution_m: f64,
    ) -> Option<ClosestApproach> {
        let travel = self.travel_bound_of(region);
        if !travel.is_finite() {
            return None;
        }
        let max_depth = (travel / resolution_m).log2().ceil().clamp(0.0, 30.0) as u32;
        let ends = [0.0, 1.0].map(|fraction| self.measure(config, region, fraction, below_m + travel).lower_bound);
        self.bisect(config, region, below_m, ends, BisectionSettings { max_depth, conservative: false })
    }

    /// Like [`RegionSweep::closest_approach`], with known lower bounds `ends` of the distances at the ends.
    fn bisect(
        &mut self,
        config: &Configuration,
        region: RegionId,
        below_m: f64,
        ends: [f64; 2],
        settings: BisectionSettings,
    ) -> Option<ClosestApproach> {
        let travel = self.travel_bound_of(region);
        if !travel.is_finite() {
            return None;
        }
        let below_m = below_m.min(ends[0]).min(ends[1]);
        let conservative = settings.conservative;
        let mut bisection = Bisection { sweep: self, config, region, travel, below_m, conservative, best: None };
        let start = Sample { fraction: 0.0, lower_bound: ends[0] };
        let end = Sample { fraction: 1.0, lower_bound: ends[1] };
        bisection.halve(start, end, settings.max_depth);
        bisection.best
    }

    /// The smallest distance (m) since the last snapshot if it is inside the region or, unless the robot is or was
    /// `warned` anyway, in its warning zone. `former_m` is a lower bound of the distance at the last snapshot, `now_m`
    /// the distance now. An undecided interval counts as passed.
    pub(crate) fn passed(
        &mut self,
        config: &Configuration,
        region: RegionId,
        [former_m, now_m]: [f64; 2],
        warned: bool,
    ) -> Option<f64> {
        let zone_m = if warned { 0.0 } else { config.regions[region.0].warning_m };
        let travel = self.travel_bound_of(region);
        // Most ticks end here: the distances at the ends exceed the travel.
        if former_m + now_m - 2.0 * zone_m > travel || !travel.is_finite() {
            return None;
        }
        let former_m = self.measure(config, region, 0.0, zone_m + travel).lower_bound;
        let mut closest_below = |below_m| self.bisect(config, region, below_m, [former_m, now_m], IN_TICK);
        let zone = closest_below(zone_m)?;
        let closest =
            if zone_m > 0.0 && zone.distance_m > 0.0 { closest_below(0.0).or(Some(zone)) } else { Some(zone) };
        closest.map(|c| c.distance_m)
    }

    /// The distance at a fraction of the motion; if it exceeds `limit`, distance and lower bound are `limit`.
    fn measure(&mut self, config: &Configuration, region: RegionId, fraction: f64, limit: f64) -> BoundedDistance {
        self.place(config, region, fraction);
        let beyond = BoundedDistance { distance: limit, lower_bound: limit };
        distance_to_guarded(config, &self.at, region, limit).unwrap_or(beyond)
    }

    fn place(&mut self, config: &Configuration, region: RegionId, fraction: f64) {
        if self.fraction != Some(fraction) {
            let Self { at, from, to, .. } = self;
            let ends = at.chain.q.iter_mut().zip(from.iter().zip(to.iter()));
            ends.for_each(|(q, (a, b))| *q = if fraction < 1.0 { a + (b - a) * fraction } else { *b });
            at.place_at_chain_state(config);
            self.fraction = Some(fraction);
        }
        if let Some(i) = self.dynamic_index(region) {
            let RegionMotion { from, to, .. } = &self.region_motions[i];
            let pose = if fraction < 1.0 { from.interpolate(to, fraction) } else { *to };
            self.at.region_in_world[region.0] = pose;
            self.at.region_box[region.0] = config.regions[region.0].shape.aabb(&pose);
        }
    }

    fn dynamic_index(&self, region: RegionId) -> Option<usize> {
        self.at.dynamic_regions.iter().position(|d| d.region == region)
    }
}

/// Search for the closest approach by bisection.
struct Bisection<'a> {
    sweep: &'a mut RegionSweep,
    config: &'a Configuration,
    region: RegionId,
    travel: f64,
    below_m: f64,
    conservative: bool,
    best: Option<ClosestApproach>,
}

impl Bisection<'_> {
    /// Searches between two samples, with at most `depth` halvings.
    fn halve(&mut self, a: Sample, b: Sample, depth: u32) {
        let travel = self.travel * (b.fraction - a.fraction);
        let lower_bound = 0.5 * (a.lower_bound + b.lower_bound - travel);
        let so_far = self.best.map_or(f64::INFINITY, |c| c.distance_m);
        if lower_bound > self.below_m || lower_bound >= so_far || so_far <= 0.0 {
            return;
        }
        let fraction = f64::midpoint(a.fraction, b.fraction);
        if depth == 0 {
            if self.conservative {
                self.best = Some(ClosestApproach { fraction, distance_m: lower_bound });
            }
            return;
        }
        let limit = self.below_m + 0.5 * travel;
        let BoundedDistance { distance, lower_bound } = self.sweep.measure(self.config, self.region, fraction, limit);
        if distance <= self.below_m && distance < so_far {
            self.best = Some(ClosestApproach { fraction, distance_m: distance });
        }
        let middle = Sample { fraction, lower_bound };
        self.halve(a, middle, depth - 1);
        self.halve(middle, b, depth - 1);
    }
}
