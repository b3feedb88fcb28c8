//! The volumes that are part of the robot at present; some are attached and detached while it runs.

use elbowroom_spatial::Pose;

use crate::{Configuration, Presence, Volume, VolumeId};

/// Why a volume cannot be attached or detached.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AttachError {
    /// The configuration has no volume with this index.
    #[error("there is no volume {0}")]
    Unknown(usize),
    /// The volume is always a part of the robot.
    #[error("volume `{0}` is always a part of the robot: only volumes with another presence are attached and detached")]
    Always(String),
    /// The pose is not finite.
    #[error("volume `{0}`: its pose in the link is not a finite number")]
    NotFinite(String),
}

/// Pose in its link of each volume that is a part of the robot at present.
#[derive(Debug, Clone)]
pub(crate) struct AttachedVolumes {
    in_link: Vec<Option<Pose>>,
}

impl AttachedVolumes {
    /// The initial state: a volume whose presence is `Detached` is detached.
    pub(crate) fn new(config: &Configuration) -> Self {
        let in_link = |v: &Volume| (v.presence != Presence::Detached).then_some(v.in_link);
        Self { in_link: config.volumes.iter().map(in_link).collect() }
    }

    /// Pose of a volume in its link; `None` if it is detached.
    #[inline]
    pub(crate) fn in_link(&self, volume: usize) -> Option<&Pose> {
        self.in_link[volume].as_ref()
    }

    /// True if a volume is a part of the robot at present.
    #[inline]
    pub(crate) fn contains(&self, volume: usize) -> bool {
        self.in_link[volume].is_some()
    }

    /// The volumes that are parts of the robot at present, and their poses in their links.
    pub(crate) fn iter<'a>(&'a self, config: &'a Configuration) -> impl Iterator<Item = (&'a Volume, &'a Pose)> {
        config.volumes.iter().zip(&self.in_link).filter_map(|(v, in_link)| Some((v, in_link.as_ref()?)))
    }

    /// Attaches a volume at a pose in its link, or moves it there.
    pub(crate) fn attach(
        &mut self,
        config: &Configuration,
        volume: VolumeId,
        in_link: &Pose,
    ) -> Result<(), AttachError> {
        let v = switchable(config, volume)?;
        if !in_link.is_finite() {
            return Err(AttachError::NotFinite(v.name.clone()));
        }
        self.in_link[volume.0] = Some(*in_link);
        Ok(())
    }

    /// Detaches a volume; without effect if it is detached already.
    pub(crate) fn detach(&mut self, config: &Configuration, volume: VolumeId) -> Result<(), AttachError> {
        switchable(config, volume)?;
        self.in_link[volume.0] = None;
        Ok(())
    }

    /// Copies the state of `other`, which has the same configuration, without allocation.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.in_link.copy_from_slice(&other.in_link);
    }
}

fn switchable(config: &Configuration, volume: VolumeId) -> Result<&Volume, AttachError> {
    let v = config.volumes.get(volume.0).ok_or(AttachError::Unknown(volume.0))?;
    if v.presence == Presence::Always { Err(AttachError::Always(v.name.clone())) } else { Ok(v) }
}
