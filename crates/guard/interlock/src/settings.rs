//! What an arbiter knows of a cell.

use elbowroom_monitor::{Configuration, RegionKind, SlotId};

use crate::Micros;

/// Settings of an arbiter.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ArbiterSettings {
    /// The robots of the cell file, each at the index of its [`RobotSlot`](elbowroom_monitor::RobotSlot).
    pub robots: Vec<RobotSettings>,
    /// Number of slots.
    pub slots: usize,
    /// The first 8 bytes of the checksum of the cell's configuration; guards with another one are not trusted.
    pub checksum: u64,
    /// Age, on the clock of the arbiter, after which a robot's last message counts as unknown.
    pub silence: Micros,
    /// How long after its request was sent a grant may be obeyed, on the clock of the guard.
    pub validity: Micros,
}

/// What an arbiter knows of a robot.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct RobotSettings {
    /// Its name.
    pub name: String,
    /// The slots that it may ever be in. Others are granted without it.
    pub slots: Vec<SlotId>,
    /// Longest time in which it stops once it may no longer enter, the reaction of its controller included.
    pub stop_time: Micros,
    /// Of robots that wait for a slot the one with the highest priority is granted it first; among equals the first.
    pub priority: i32,
}

impl ArbiterSettings {
    /// A silence of 100 ms, a validity of 50 ms, checksum 0.
    pub fn new(robots: Vec<RobotSettings>, slots: usize) -> Self {
        Self { robots, slots, checksum: 0, silence: Micros(100_000), validity: Micros(50_000) }
    }
}

impl RobotSettings {
    /// A stop time of 1 s, priority 0.
    pub fn new(name: &str, slots: impl IntoIterator<Item = SlotId>) -> Self {
        let slots = slots.into_iter().collect();
        Self { name: name.to_owned(), slots, stop_time: Micros(1_000_000), priority: 0 }
    }

    /// Of the robot of a configuration: the slots of its exchange regions; at least 1 s to stop, longer where the stopping-distance
    /// law says so; priority 0.
    pub fn of(configuration: &Configuration) -> Self {
        let slots = configuration.regions().iter().filter_map(|region| match region.kind {
            RegionKind::Exchange { slot } => Some(slot),
            _ => None,
        });
        let mut settings = Self::new(configuration.robot(), slots);
        settings.slots.sort_unstable();
        settings.slots.dedup();
        settings.stop_time = settings.stop_time.max(Micros::from_seconds(stop_time_s(configuration)));
        settings
    }
}

/// Reaction and braking from the largest joint speeds, as far as they are known; 0 without the stopping-distance law.
fn stop_time_s(configuration: &Configuration) -> f64 {
    let chain = configuration.chain();
    let Some(stopping) = &configuration.laws().stopping_distance else { return 0.0 };
    let speeds = chain.active_joints().iter().map(|id| chain.joints()[id.0].limits.velocity.unwrap_or(0.0));
    let braking_s = speeds.zip(&stopping.joint_deceleration).map(|(speed, deceleration)| speed / deceleration);
    stopping.reaction_s + stopping.period_s + braking_s.fold(0.0, f64::max)
}
