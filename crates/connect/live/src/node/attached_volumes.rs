//! The volumes that are attached to a monitor, as a controller names them.

use elbowroom_monitor::{Configuration, Monitor, Presence, VolumeId};
use elbowroom_spatial::Pose;

use crate::messages::{AttachedVolume, MAX_ATTACHED};

/// The optional volumes of a monitor that are attached to it now.
pub(crate) struct AttachedVolumes {
    attached: Vec<AttachedVolume>,
    /// The controller has named an attached volume once: from then on it is known to name them all.
    are_named: bool,
}

impl AttachedVolumes {
    /// What is mounted at the start, until the controller names what is attached.
    pub fn new(configuration: &Configuration) -> Self {
        let volumes = configuration.volumes().iter().enumerate();
        let mounted = volumes.filter(|(_, v)| v.presence == Presence::Attached);
        let mut attached = Vec::with_capacity(MAX_ATTACHED);
        attached.extend(mounted.map(|(i, v)| AttachedVolume { volume: VolumeId(i), in_link: v.in_link }));
        Self { attached, are_named: false }
    }

    /// Attaches and detaches volumes until only those are attached that the controller names; false if it names one that the
    /// monitor does not have. Each change is passed to `changed`: the volume, and its pose if it was attached.
    pub fn apply(
        &mut self,
        named: &[AttachedVolume],
        monitor: &mut Monitor,
        mut changed: impl FnMut(VolumeId, Option<&Pose>),
    ) -> bool {
        self.are_named |= !named.is_empty();
        if !self.are_named || self.attached == named {
            return true;
        }
        for gone in self.attached.iter().filter(|a| !named.iter().any(|wanted| wanted.volume == a.volume)) {
            // It was attached before, so that it can be detached.
            let _ = monitor.detach(gone.volume);
            changed(gone.volume, None);
        }
        self.attached.clear();
        for volume in named {
            if monitor.attach(volume.volume, &volume.in_link).is_ok() {
                self.attached.push(*volume);
                changed(volume.volume, Some(&volume.in_link));
            }
        }
        self.attached.len() == named.len()
    }
}
