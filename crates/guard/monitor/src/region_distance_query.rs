//! Distances to regions at any joint values, for planners.

use elbowroom_kinematics::LinkId;
use elbowroom_kinematics::motion_bound::displacement_bound;

use crate::distance_to_guarded::distance_to_guarded;
use crate::placement::Placement;
use crate::{Configuration, Monitor, RegionId, SourceState, Volume};

/// Distances at any joint values between the guarded volumes and the regions that are closed to a robot
/// ([`Monitor::is_closed`]), with the volumes, guards and shapes of its monitor. [`Monitor::region_distance`] fixes
/// the set of closed regions and their poses.
///
/// ```
/// use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// use elbowroom_monitor::{Configuration, ConfigurationParts, Guards, Laws, Monitor, Region, RegionId, Volume};
/// use elbowroom_spatial::{Pose, Vec3};
///
/// let rail = Joint {
///     name: "rail".into(),
///     kind: JointKind::Prismatic,
///     parent: LinkId(0),
///     child: LinkId(1),
///     origin: Pose::IDENTITY,
///     axis: Vec3::X,
///     limits: Limits::range(0.0, 2.0),
///     mimic: None,
/// };
/// let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail])?;
/// let configuration = Configuration::new(ConfigurationParts {
///     robot: "rail".into(),
///     base_in_world: Pose::IDENTITY,
///     volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)],
///     regions: vec![Region::sphere("pillar", Vec3::X * 2.0, 0.5).guards(Guards::TCP)],
///     sources: vec![],
///     grids: vec![],
///     laws: Laws::default(),
///     chain,
/// })?;
/// let monitor = Monitor::new(configuration, None)?;
/// let mut query = monitor.region_distance(&[]);
/// query.set_q(&[1.0]);
/// let (region, metres) = query.distances(1.0).next().expect("the pillar is near");
/// assert!(region == RegionId(0) && (metres - 0.5).abs() < 1e-12);
/// assert_eq!(query.distances(0.4).next(), None);
/// assert_eq!(query.motion_bound(&[0.0], &[0.3]), 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct RegionDistanceQuery<'m> {
    config: &'m Configuration,
    now: Placement,
    regions: Vec<RegionId>,
    links: Vec<GuardedLink>,
    /// True if the poses of the regions are known.
    regions_placed: bool,
    /// True if the joint values are known.
    robot_placed: bool,
}

/// A link with volumes that any of the regions guards against.
#[derive(Debug, Clone, Copy)]
struct GuardedLink {
    link: LinkId,
    /// Largest distance of a point of the volumes from the link's origin, m.
    radius_m: f64,
}

impl Monitor {
    /// Creates a query for the regions that are closed now and the volumes that are attached now. Dynamic regions are at
    /// the poses given by `sources`, one per source of the configuration.
    pub fn region_distance(&self, sources: &[SourceState]) -> RegionDistanceQuery<'_> {
        let config = self.configuration();
        let regions: Vec<_> = (0..config.regions.len()).map(RegionId).filter(|r| self.is_closed(*r)).collect();
        let mut now = Placement::new(config);
        now.attached.copy_from(self.attached());
        let regions_placed = sources.len() == config.sources.len();
        if regions_placed {
            now.place_sources(config, sources);
        }
        RegionDistanceQuery {
            links: guarded_links(config, &now, &regions),
            config,
            now,
            regions,
            regions_placed,
            robot_placed: false,
        }
    }
}

impl RegionDistanceQuery<'_> {
    /// The regions, in the order of the configuration.
    pub fn regions(&self) -> &[RegionId] {
        &self.regions
    }

    /// Sets the joint values (rad; m for prismatic joints).
    pub fn set_q(&mut self, q: &[f64]) {
        self.robot_placed = q.len() == self.config.chain.dof() && q.iter().all(|v| v.is_finite());
        if self.robot_placed {
            self.now.place_robot(self.config, q);
        }
    }

    /// The regions within `limit_m` (m) of the volumes that they guard against, each with a proven lower bound of the
    /// distance. The bound is 0 inside, and 0 for all regions if their poses or the joint values are not known.
    pub fn distances(&self, limit_m: f64) -> impl Iterator<Item = (RegionId, f64)> + '_ {
        self.regions.iter().filter_map(move |region| {
            if !(self.regions_placed && self.robot_placed) {
                return Some((*region, 0.0));
            }
            distance_to_guarded(self.config, &self.now, *region, limit_m).map(|d| (*region, d.lower_bound))
        })
    }

    /// Upper bound of the travel (m) of any point of the guarded volumes while all joints move straight and together
    /// from one configuration to another. During a fraction of the motion, the travel is at most that fraction of the
    /// bound.
    pub fn motion_bound(&self, from: &[f64], to: &[f64]) -> f64 {
        let chain = &self.config.chain;
        let each = self.links.iter().map(|l| displacement_bound(chain, l.link, l.radius_m, from, to));
        // `f64::max` would drop NaN.
        each.fold(0.0, |max, travel| if travel <= max || max.is_nan() { max } else { travel })
    }
}

fn guarded_links(config: &Configuration, now: &Placement, regions: &[RegionId]) -> Vec<GuardedLink> {
    let mut links: Vec<GuardedLink> = Vec::new();
    let counts = |v: &Volume| regions.iter().any(|r| v.part.counts_for(config.regions[r.0].guards));
    for (volume, in_link) in now.attached.iter(config).filter(|(v, _)| counts(v)) {
        let radius_m = volume.radius_at(in_link);
        match links.iter_mut().find(|l| l.link == volume.link) {
            Some(known) => known.radius_m = known.radius_m.max(radius_m),
            None => links.push(GuardedLink { link: volume.link, radius_m }),
        }
    }
    links
}
