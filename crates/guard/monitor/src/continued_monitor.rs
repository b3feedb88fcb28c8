//! Replacement of a monitor by one with other regions for the same robot, without a break.

use crate::{Configuration, Monitor, Presence, RegionId, VolumeId};

/// Maps each region of `new` to the region of `old` with the same name, place, shape, laws and source; `None` if the
/// region is new or was changed.
pub fn same_regions(new: &Configuration, old: &Configuration) -> Vec<Option<RegionId>> {
    let source = |c: &Configuration, r: RegionId| c.regions[r.0].follow.map(|s| c.sources[s.0].clone());
    let same = |r: RegionId| {
        let before = old.region(&new.regions[r.0].name)?;
        let is_same = new.regions[r.0].checksum() == old.regions[before.0].checksum();
        (is_same && source(new, r) == source(old, before)).then_some(before)
    };
    (0..new.regions.len()).map(|r| same(RegionId(r))).collect()
}

impl Monitor {
    /// Copies the state of the former monitor of the same robot, so that this monitor continues without a break: the
    /// last joint values and overrides, the present fault and the attached volumes. For each region that has not changed
    /// (`same`: [`same_regions`]) it also copies whether the region is on, entered and granted; all other regions are as
    /// in a new monitor. Call it between two ticks; do not use the former monitor afterwards. Never allocates.
    ///
    /// Both monitors must have the same robot, volumes and laws.
    ///
    /// ```
    /// # use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
    /// # use elbowroom_monitor::{Configuration, ConfigurationParts, Guards, Laws, Monitor, Region, Snapshot};
    /// # use elbowroom_monitor::{Volume, same_regions};
    /// # use elbowroom_spatial::{Pose, Vec3};
    /// # let rail = Joint { name: "rail".into(), kind: JointKind::Prismatic, parent: LinkId(0), child: LinkId(1),
    /// #     origin: Pose::IDENTITY, axis: Vec3::X, limits: Limits::range(0.0, 2.0), mimic: None };
    /// # let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail])?;
    /// # let configuration = |x: f64| Configuration::new(ConfigurationParts { robot: "rail".into(), chain: chain.clone(),
    /// #     base_in_world: Pose::IDENTITY, volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)], sources: vec![],
    /// #     regions: vec![Region::sphere("pillar", Vec3::X * x, 0.5).warning(0.4).guards(Guards::TCP)], grids: vec![], laws: Laws::default() });
    /// let mut former = Monitor::new(configuration(2.0)?, None)?;
    /// assert_eq!(former.tick(&Snapshot::stationary(0.0, &[0.5])).speed_override, 1.0);
    /// // The pillar comes nearer.
    /// let mut monitor = Monitor::new(configuration(1.2)?, None)?;
    /// let same = same_regions(monitor.configuration(), former.configuration());
    /// assert_eq!(same, [None]);
    /// monitor.continue_from(&mut former, &same);
    /// assert!(monitor.tick(&Snapshot::stationary(0.002, &[0.5])).speed_override < 1.0);
    /// // It knows where the robot was.
    /// assert_eq!(monitor.tick(&Snapshot::stationary(0.004, &[1.5])).speed_override, 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn continue_from(&mut self, former: &mut Self, same: &[Option<RegionId>]) {
        self.attach_as(former);
        std::mem::swap(&mut self.watchdog, &mut former.watchdog);
        std::mem::swap(&mut self.stopping_law, &mut former.stopping_law);
        (self.last_override, self.faults) = (former.last_override, former.faults);
        self.just_attached |= former.just_attached;
        self.sweep.reset();
        if let (Some(client), Some(before)) = (&mut self.zone_client, &former.zone_client) {
            client.continue_from(before);
        }
        // These events repeat changes that the former monitor has reported; the next tick clears them.
        self.regions.continue_from(&self.config, &former.regions, same, &mut self.log);
    }

    /// Attaches and detaches volumes so that the same ones are parts of the robot as in `former`.
    fn attach_as(&mut self, former: &Self) {
        for v in 0..self.config.volumes.len() {
            if self.config.volumes[v].presence == Presence::Always {
                continue;
            }
            // Errors concern only volumes that are always attached (skipped above) and poses that the former monitor has
            // accepted.
            let _ = match former.now.attached.in_link(v) {
                Some(in_link) => self.attach(VolumeId(v), in_link),
                None => self.detach(VolumeId(v)),
            };
        }
        self.just_attached = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ConfigurationParts, Fault, Guards, Laws, OverrideReason, Region, Snapshot, Volume};
    use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
    use elbowroom_spatial::{Pose, Vec3};

    fn configuration(regions: Vec<Region>) -> Configuration {
        let rail = Joint {
            name: "rail".into(),
            kind: JointKind::Prismatic,
            parent: LinkId(0),
            child: LinkId(1),
            origin: Pose::IDENTITY,
            axis: Vec3::X,
            limits: Limits::range(0.0, 2.0),
            mimic: None,
        };
        let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail]).unwrap();
        let parts = ConfigurationParts {
            robot: "rail".into(),
            base_in_world: Pose::IDENTITY,
            chain,
            volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)],
            regions,
            sources: vec![],
            grids: vec![],
            laws: Laws { override_rate: 2.0, ..Laws::default() },
        };
        Configuration::new(parts).unwrap()
    }

    fn with_output(x: f64) -> Region {
        let mut region = Region::sphere("out", Vec3::X * x, 0.1).warning(0.2).guards(Guards::TCP);
        region.output = Some(3);
        region
    }

    /// A monitor of the second configuration that continues from a monitor of the first one after a tick.
    fn continued(first: Configuration, second: Configuration, q: f64) -> Monitor {
        let mut former = Monitor::new(first, None).unwrap();
        former.tick(&Snapshot::stationary(0.0, &[q]));
        let mut monitor = Monitor::new(second, None).unwrap();
        let same = same_regions(monitor.configuration(), former.configuration());
        monitor.continue_from(&mut former, &same);
        monitor
    }

    #[test]
    fn what_is_the_same_goes_on_without_events_and_outputs_stay() {
        let other = Region::sphere("other", Vec3::X * 9.0, 0.1).warning(0.2);
        let mut monitor =
            continued(configuration(vec![with_output(1.0)]), configuration(vec![other, with_output(1.0)]), 1.0);
        assert!(monitor.is_inside(RegionId(1)));
        let report = monitor.tick(&Snapshot::stationary(0.002, &[1.0]));
        assert_eq!((report.outputs, monitor.events()), (1 << 3, &[][..]));
        // Removing a region switches its output off.
        let mut monitor = continued(configuration(vec![with_output(1.0)]), configuration(vec![]), 1.0);
        assert_eq!(monitor.tick(&Snapshot::stationary(0.002, &[1.0])).outputs, 0);
    }

    #[test]
    fn the_override_does_not_rise_at_once_and_a_fault_is_not_forgotten() {
        let mut monitor = continued(configuration(vec![with_output(1.0)]), configuration(vec![]), 1.0);
        let report = monitor.tick(&Snapshot::stationary(0.002, &[1.0]));
        assert!(report.speed_override < 0.1 && report.reason == OverrideReason::Rate, "{report:?}");
        let mut monitor = continued(configuration(vec![]), configuration(vec![with_output(9.0)]), 0.2);
        let report = monitor.tick(&Snapshot::stationary(0.002, &[1.8]));
        assert_eq!(report.reason, OverrideReason::Fault(Fault::TooFast { joint: 0 }));
    }
}
