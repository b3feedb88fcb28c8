//! What a monitor would measure if the robot were elsewhere: for whoever plans.

use elbowroom_kinematics::LinkId;
use elbowroom_scene::pairs;

use crate::gaps;
use crate::placement::Placement;
use crate::{Configuration, Monitor, RegionId, Source};

/// Distances of the regions that are closed to a robot ([`Monitor::is_closed`]) from what it guards, at any joint values: by
/// the volumes, guards and shapes that its monitor goes by. Which are closed and where they stand stays as it was when the
/// gauge was made, by [`Monitor::gauge`].
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
///     laws: Laws::default(),
///     chain,
/// })?;
/// let monitor = Monitor::new(configuration, None)?;
/// let mut gauge = monitor.gauge(&[]);
/// gauge.place(&[1.0]);
/// let (region, metres) = gauge.distances(1.0).next().expect("the pillar is near");
/// assert!(region == RegionId(0) && (metres - 0.5).abs() < 1e-12);
/// assert_eq!(gauge.distances(0.4).next(), None);
/// assert_eq!(gauge.travel(&[0.0], &[0.3]), 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Gauge<'m> {
    config: &'m Configuration,
    now: Placement,
    regions: Vec<RegionId>,
    /// Links with a volume that counts for any of the regions, and the farthest from their origin that it goes, m.
    links: Vec<(LinkId, f64)>,
    /// It is known where the regions are.
    placed: bool,
    /// It is known where the robot is.
    found: bool,
}

impl Monitor {
    /// To measure elsewhere than where the robot is. Regions stand where `sources` have them, one per source of the
    /// configuration.
    pub fn gauge(&self, sources: &[Source]) -> Gauge<'_> {
        let config = self.configuration();
        let regions: Vec<_> = (0..config.regions.len()).map(RegionId).filter(|r| self.is_closed(*r)).collect();
        let mut now = Placement::new(config);
        let placed = sources.len() == config.sources.len();
        if placed {
            now.place_sources(config, sources);
        }
        Gauge { links: links(config, &regions), config, now, regions, placed, found: false }
    }
}

impl Gauge<'_> {
    /// The regions, in the order of the configuration.
    pub fn regions(&self) -> &[RegionId] {
        &self.regions
    }

    /// Puts the robot somewhere (rad, m where a joint slides).
    pub fn place(&mut self, q: &[f64]) {
        self.found = q.len() == self.config.chain.dof() && q.iter().all(|v| v.is_finite());
        if self.found {
            self.now.place_robot(self.config, q);
        }
    }

    /// The regions that are not farther than `limit_m` (m) from what they guard against, each with a proven lower bound of the
    /// distance: 0 inside, and for all where it is not known where they or the robot are.
    pub fn distances(&self, limit_m: f64) -> impl Iterator<Item = (RegionId, f64)> + '_ {
        self.regions.iter().filter_map(move |region| {
            if !(self.placed && self.found) {
                return Some((*region, 0.0));
            }
            gaps::distance(self.config, &self.now, *region, limit_m).map(|closest| (*region, closest.lower_bound))
        })
    }

    /// No point of the guarded volumes travels farther than this, m, while all joints go straight and together from one
    /// configuration to another; in a share of that no farther than the same share.
    pub fn travel(&self, from: &[f64], to: &[f64]) -> f64 {
        let chain = &self.config.chain;
        let each = self.links.iter().map(|(link, radius)| pairs::farthest(chain, *link, *radius, from, to));
        // `f64::max` would forget what is no number.
        each.fold(0.0, |most, far| if far <= most || most.is_nan() { most } else { far })
    }
}

fn links(config: &Configuration, regions: &[RegionId]) -> Vec<(LinkId, f64)> {
    let mut links: Vec<(LinkId, f64)> = Vec::new();
    let counts = |v: &crate::Volume| regions.iter().any(|r| v.part.counts_for(config.regions[r.0].guards));
    for volume in config.volumes.iter().filter(|v| counts(v)) {
        let bounds = volume.shape.aabb(&volume.in_link);
        let radius = bounds.min.abs().max(bounds.max.abs()).length();
        match links.iter_mut().find(|(link, _)| *link == volume.link) {
            Some((_, most)) => *most = most.max(radius),
            None => links.push((volume.link, radius)),
        }
    }
    links
}
