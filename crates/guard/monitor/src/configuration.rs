//! Configuration of a monitor: one robot, its guarded volumes, regions, sources of motion and laws.

use std::collections::HashSet;

use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_spatial::Pose;

use crate::{Laws, OutputGrid, Region, RegionId, RegionKind, SourceSpec, Volume};

/// The parts of a [`Configuration`]; [`Configuration::new`] validates them.
#[derive(Debug, Clone)]
pub struct ConfigurationParts {
    /// The robot's name.
    pub robot: String,
    /// Pose of the chain's root link.
    pub base_in_world: Pose,
    /// The robot's joints and links.
    pub chain: Chain,
    /// The guarded volumes.
    pub volumes: Vec<Volume>,
    /// The regions.
    pub regions: Vec<Region>,
    /// The sources that regions follow; a snapshot holds one [`SourceState`](crate::SourceState) for each. A name alone gets
    /// the default limits: `sources: vec!["belt".into()]`.
    pub sources: Vec<SourceSpec>,
    /// The laws.
    pub laws: Laws,
    /// The grids whose occupied cell is on digital outputs.
    pub grids: Vec<OutputGrid>,
}

/// One robot, its guarded volumes and the regions that apply to it. Valid by construction; [`Configuration::edit`], which
/// checks the caller's access class, is the only way to change it.
///
/// The fields are private:
///
/// ```compile_fail,E0616
/// fn remove_all(configuration: &mut elbowroom_monitor::Configuration) {
///     configuration.regions.clear();
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Configuration {
    pub(crate) robot: String,
    pub(crate) base_in_world: Pose,
    pub(crate) chain: Chain,
    pub(crate) volumes: Vec<Volume>,
    pub(crate) regions: Vec<Region>,
    pub(crate) sources: Vec<SourceSpec>,
    pub(crate) laws: Laws,
    pub(crate) grids: Vec<OutputGrid>,
}

/// Why a configuration is invalid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// A region is invalid.
    #[error("region `{region}`: {why}")]
    Region {
        /// The region.
        region: String,
        /// What is wrong.
        why: String,
    },
    /// Two regions have the same name.
    #[error("two regions are named `{0}`; names must differ")]
    DuplicateRegion(String),
    /// A volume is invalid.
    #[error("volume `{volume}`: {why}")]
    Volume {
        /// The volume.
        volume: String,
        /// What is wrong.
        why: String,
    },
    /// A source is invalid.
    #[error("source `{source_name}`: {why}")]
    Source {
        /// The source.
        source_name: String,
        /// What is wrong.
        why: String,
    },
    /// A grid is invalid.
    #[error("grid `{grid}`: {why}")]
    Grid {
        /// The grid.
        grid: String,
        /// What is wrong.
        why: String,
    },
    /// A law is invalid.
    #[error("laws: {0}")]
    Laws(String),
    /// The pose of the robot's base is not finite.
    #[error("the robot's base is not at a finite position")]
    Base,
    /// The configuration has exchange regions, but no interlock grants their slots.
    #[error("region `{0}` is an exchange region: it needs an Interlock that has its slot")]
    NoArbiter(String),
    /// An exchange region is shared with robots of other processes, but the stopping-distance law, which shows whether
    /// this robot can stop outside, is off.
    #[error(
        "region `{0}` is an exchange region between controllers: a grant may end while the robot moves, so it must be known \
         where it can stop; write `stopping_distance = true` into `[monitor]` of the cell file, and the robot's measured \
         `stop_time` into its table"
    )]
    NoStoppingDistance(String),
}

/// The per-joint rates of [`StoppingSettings`](crate::StoppingSettings).
#[derive(Debug, Clone, Copy)]
enum JointRate {
    Acceleration,
    Deceleration,
}

impl Configuration {
    /// Validates the parts and assembles them.
    ///
    /// # Errors
    /// [`ConfigError`] names the first invalid part.
    pub fn new(parts: ConfigurationParts) -> Result<Self, ConfigError> {
        let ConfigurationParts { robot, base_in_world, chain, volumes, regions, sources, laws, grids } = parts;
        let built = Self { robot, base_in_world, chain, volumes, regions, sources, laws, grids };
        built.validate()?;
        Ok(built)
    }

    /// The robot's name.
    pub fn robot(&self) -> &str {
        &self.robot
    }

    /// Pose of the chain's root link.
    pub fn base_in_world(&self) -> &Pose {
        &self.base_in_world
    }

    /// The robot's joints and links.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// The guarded volumes.
    pub fn volumes(&self) -> &[Volume] {
        &self.volumes
    }

    /// The regions; a [`RegionId`] is an index into them.
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// The sources that regions follow; a [`SourceId`](crate::SourceId) is an index into them.
    pub fn sources(&self) -> &[SourceSpec] {
        &self.sources
    }

    /// The laws.
    pub fn laws(&self) -> &Laws {
        &self.laws
    }

    /// The grids.
    pub fn grids(&self) -> &[OutputGrid] {
        &self.grids
    }

    /// The region with this name.
    pub fn region(&self, name: &str) -> Option<RegionId> {
        self.regions.iter().position(|r| r.name == name).map(RegionId)
    }

    /// Validates everything that [`Monitor::new`](crate::Monitor::new) relies on.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        if !self.base_in_world.is_finite() {
            return Err(ConfigError::Base);
        }
        let mut names = HashSet::new();
        for region in &self.regions {
            if !names.insert(&region.name) {
                return Err(ConfigError::DuplicateRegion(region.name.clone()));
            }
            self.validate_region(region)?;
        }
        self.volumes.iter().try_for_each(|v| self.validate_volume(v))?;
        for source in &self.sources {
            if let Some(why) = source.limits.problem() {
                return Err(ConfigError::Source { source_name: source.name.clone(), why });
            }
        }
        self.grids.iter().enumerate().try_for_each(|(i, g)| self.validate_grid(i, g))?;
        self.validate_laws()
    }

    fn validate_region(&self, region: &Region) -> Result<(), ConfigError> {
        let bad = |why: String| ConfigError::Region { region: region.name.clone(), why };
        if let Some(source) = region.follow
            && source.0 >= self.sources.len()
        {
            return Err(bad(format!("it follows source {}, but there are {}", source.0, self.sources.len())));
        }
        region.problem().map_or(Ok(()), |why| Err(bad(why)))
    }

    fn validate_volume(&self, volume: &Volume) -> Result<(), ConfigError> {
        let bad = |why: String| ConfigError::Volume { volume: volume.name.clone(), why };
        if volume.link.0 >= self.chain.links().len() {
            return Err(bad(format!("link {} does not exist", volume.link.0)));
        }
        if !volume.in_link.is_finite() {
            return Err(bad("its position is not a finite number".into()));
        }
        if matches!(volume.shape, elbowroom_proximity::Shape::HalfSpace(_)) {
            return Err(bad("a half-space cannot be carried by a robot".into()));
        }
        volume.shape.validate().map_err(|e| bad(e.to_string()))
    }

    /// Whether an independent joint turns without end.
    pub(crate) fn turns(&self, q: usize) -> bool {
        let joint = self.chain.active_joints()[q];
        self.chain.joints()[joint.0].kind == JointKind::Continuous
    }

    /// A grid's outputs are its own: of bits that a region or another grid raises too, nobody could read a number.
    fn validate_grid(&self, index: usize, grid: &OutputGrid) -> Result<(), ConfigError> {
        let bad = |why: String| ConfigError::Grid { grid: grid.name.clone(), why };
        let has_tcp = self.volumes.iter().any(|v| v.part.is_tcp());
        let turns: Vec<bool> = (0..self.chain.dof()).map(|q| self.turns(q)).collect();
        if let Some(why) = grid.problem(&turns, has_tcp) {
            return Err(bad(why));
        }
        let channels = grid.channels();
        let of_region = |r: &&Region| r.output.into_iter().chain(r.warning_output).any(|c| channels.contains(&c));
        if let Some(region) = self.regions.iter().find(of_region) {
            let name = &region.name;
            return Err(bad(format!(
                "region `{name}` has one of its outputs {} to {}",
                channels.start,
                channels.end - 1
            )));
        }
        let of_grid = |g: &&OutputGrid| g.channels().start < channels.end && channels.start < g.channels().end;
        if let Some(other) = self.grids[..index].iter().find(of_grid) {
            let (name, last) = (&other.name, channels.end - 1);
            return Err(bad(format!("grid `{name}` has one of its outputs {} to {last}", channels.start)));
        }
        Ok(())
    }

    fn validate_laws(&self) -> Result<(), ConfigError> {
        let laws = &self.laws;
        let bad = |why: String| Err(ConfigError::Laws(why));
        if !(laws.stale_s.is_finite() && laws.stale_s > 0.0) {
            return bad(format!("input must grow stale after a positive time, not {} s", laws.stale_s));
        }
        if !(laws.override_rate.is_finite() && laws.override_rate >= 0.0) {
            return bad(format!("override_rate must be 0 or more, not {}", laws.override_rate));
        }
        if !(0.0..=1.0).contains(&laws.recovery) {
            return bad(format!("recovery must lie between 0 and 1, not {}", laws.recovery));
        }
        let Some(stopping) = &laws.stopping_distance else { return Ok(()) };
        if !(stopping.reaction_s.is_finite() && stopping.reaction_s >= 0.0) {
            return bad(format!("the reaction time must be 0 or more, not {} s", stopping.reaction_s));
        }
        if !(stopping.period_s.is_finite() && stopping.period_s > 0.0) {
            return bad(format!("the time between two answers must be positive, not {} s", stopping.period_s));
        }
        self.validate_per_joint(JointRate::Deceleration, &stopping.joint_deceleration)?;
        self.validate_per_joint(JointRate::Acceleration, &stopping.joint_acceleration)
    }

    fn validate_per_joint(&self, rate: JointRate, values: &[f64]) -> Result<(), ConfigError> {
        let what = match rate {
            JointRate::Acceleration => "acceleration",
            JointRate::Deceleration => "deceleration",
        };
        let bad = |why: String| Err(ConfigError::Laws(why));
        if values.len() != self.chain.dof() {
            return bad(format!("{} joint {what}s for {} joints", values.len(), self.chain.dof()));
        }
        values
            .iter()
            .find(|a| !(a.is_finite() && **a > 0.0))
            .map_or(Ok(()), |a| bad(format!("a joint {what} must be positive, not {a}")))
    }

    pub(crate) fn first_exchange(&self) -> Option<&Region> {
        self.regions.iter().find(|r| matches!(r.kind, RegionKind::Exchange { .. }))
    }
}
