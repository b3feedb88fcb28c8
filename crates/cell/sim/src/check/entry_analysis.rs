//! Decides whether a robot is kept out of a region, by which law, and what is missing if it is not.

use elbowroom_cell::{Cell, CellRegion, CellRegionId, CellRobot, StepAction};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::JointKind;
use elbowroom_monitor::{Life, RegionKind};
use elbowroom_proximity::Shape;
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use super::mounted_overlap::{MountedOverlap, PlacedRegion};
use super::program::RobotProgram;
use super::region_speed::replans;
use super::stopping_profile::{StoppingProfile, response_delay};

/// Tolerance for the rounding of thicknesses, m.
const ROUNDING_M: f64 = 1e-6;

/// One region and one robot that it guards.
pub(super) struct EntryAnalysis<'a> {
    pub cell: &'a Cell,
    pub region: CellRegionId,
    pub robot: RobotId,
    pub program: &'a RobotProgram,
    /// Largest speed of any point of the region, m/s; infinite if it is not known in advance.
    pub region_speed_m_s: f64,
    /// Pose of the region in the world at the start.
    pub region_in_world: Pose,
    /// True if the robot starts inside.
    pub starts_inside: bool,
    /// True if another robot starts inside a region that shares a slot with this one.
    pub shared_at_start: bool,
}

/// Result of [`EntryAnalysis::decide`].
pub(super) struct EntryDecision {
    pub excluded: bool,
    pub reason: String,
    pub write_instead: Option<String>,
    pub needed_warning_m: Option<f64>,
}

/// Reason why the laws do not exclude entry.
struct MissingGuarantee {
    why: String,
    write: String,
}

impl MissingGuarantee {
    fn new(why: impl Into<String>, write: impl Into<String>) -> Self {
        Self { why: why.into(), write: write.into() }
    }
}

impl EntryAnalysis<'_> {
    pub fn decide(&self) -> EntryDecision {
        let needed = self.needed_m();
        let needed_warning_m = Some(needed).filter(|n| n.is_finite());
        if let RegionKind::Monitored { slow_to } = self.region().region.kind {
            let what = if slow_to.is_some() { "slows down" } else { "raises outputs" };
            let reason = format!("monitored: it only {what}, entry is permitted");
            return EntryDecision { excluded: false, reason, write_instead: None, needed_warning_m: None };
        }
        let missing = self.unguaranteed().or_else(|| self.too_fast());
        match missing {
            Some(MissingGuarantee { why, write }) => {
                EntryDecision { excluded: false, reason: why, write_instead: Some(write), needed_warning_m }
            }
            None => EntryDecision { excluded: true, reason: self.guarantee(), write_instead: None, needed_warning_m },
        }
    }

    /// Warning before a run if the robot can reach the border faster than it can stop.
    pub fn overrun(&self) -> Option<Diagnostic> {
        if matches!(self.region().region.kind, RegionKind::Monitored { .. }) {
            return None;
        }
        let MissingGuarantee { why, write } = self.too_fast()?;
        let (region, robot) = (&self.region().region.name, &self.robot().name);
        let what = format!("robot \"{robot}\" can overrun the border of region \"{region}\": {why}");
        Some(Diagnostic::new(&self.cell.file, self.region().line, what).hint(write))
    }

    fn region(&self) -> &CellRegion {
        &self.cell.regions[self.region.0]
    }

    fn robot(&self) -> &CellRobot {
        &self.cell.robots[self.robot.0]
    }

    fn stopping_profiles(&self) -> impl Iterator<Item = &StoppingProfile> {
        self.program.stopping_profiles(self.region().region.guards)
    }

    /// Largest speed of any guarded point, m/s.
    fn fastest_m_s(&self) -> f64 {
        self.stopping_profiles().map(|p| p.fastest_m_s).fold(0.0, f64::max)
    }

    /// Thickness of the warning zone for the most demanding guarded point, plus the motion of the region meanwhile, m.
    fn needed_m(&self) -> f64 {
        let own = self.stopping_profiles().map(|p| p.needed_m).fold(0.0, f64::max);
        own + self.region_speed_m_s * (self.delay_s() + self.program.profile.braking_s)
    }

    /// Delay (s) from entering the zone to the first deceleration: one tick until the monitor sees it, and the reaction
    /// time.
    fn delay_s(&self) -> f64 {
        response_delay(self.cell).delay_s
    }

    /// A cause of entry that no law and no thickness excludes.
    fn unguaranteed(&self) -> Option<MissingGuarantee> {
        let region = &self.region().region;
        let exchange = matches!(region.kind, RegionKind::Exchange { .. });
        if self.starts_inside && !exchange {
            return Some(MissingGuarantee::new(
                "the robot starts inside",
                format!("another `start` of [robot.{}], or another place of the region", self.robot().name),
            ));
        }
        if self.starts_inside && self.shared_at_start {
            let why = "it starts inside, and so does another robot that shares this exchange region";
            return Some(MissingGuarantee::new(why, format!("another `start` of [robot.{}]", self.robot().name)));
        }
        if let Some(missing) = self.mounts_inside() {
            return Some(missing);
        }
        if region.life == Life::Temporary {
            return Some(MissingGuarantee::new(
                "temporary: it is not guarded while it is off, and the robot may be inside when it is switched on",
                "life = \"permanent\"",
            ));
        }
        if self.region_speed_m_s > 0.0 {
            let why = "the region moves: the laws stop the robot, but the region can reach a stopped robot";
            let table = self.region().table();
            let write = format!("warning_output = 1 in {table}, wired to a stop of the carrier of the region");
            return Some(MissingGuarantee::new(why, write));
        }
        if self.robot().avoidance.is_some() {
            return Some(MissingGuarantee::new(
                "the robot has avoidance: its speeds off its program are not known in advance",
                format!("no [avoidance.{}]", self.robot().name),
            ));
        }
        if let Some(operator) = self.cell.guidance.operator_of(self.robot) {
            return Some(MissingGuarantee::new(
                "a person guides the robot: its speeds and ways are not known in advance",
                format!("a program instead of [operator.{}]", operator.name),
            ));
        }
        None
    }

    /// Entry by a part or tool that the program mounts inside the region: it is a part of the robot from then on.
    fn mounts_inside(&self) -> Option<MissingGuarantee> {
        if self.region_speed_m_s > 0.0 {
            return None;
        }
        let region = PlacedRegion { region: self.region(), in_world: self.region_in_world };
        let MountedOverlap { step, name, is_certain } =
            MountedOverlap::find(self.cell, self.robot, self.program, region)?;
        let why = if is_certain {
            format!("its program {step} inside of it: from then on \"{name}\" counts as a part of the robot")
        } else {
            format!("where its program {step} is known in the run only: the part may be inside of it")
        };
        let write = "another place of the step or of the region, or robots = […] in the region without this robot";
        Some(MissingGuarantee::new(why, write))
    }

    /// Entry because of speed if it is not known how far a part extends beyond the hand.
    fn unknown_lever(&self) -> Option<MissingGuarantee> {
        let guards = self.region().region.guards;
        let unknown = self.program.parts().find(|action| action.attachment.is_none())?;
        let part = self.cell.gripped_volume(self.robot, unknown.object, unknown.link);
        part.part.counts_for(guards).then(|| {
            let why = format!(
                "`stopping_distance` is off, and how \"{}\" is in the hand is known in the run only",
                part.name
            );
            MissingGuarantee::new(why, "stopping_distance = true in [monitor]")
        })
    }

    /// Entry because of speed: the stopping-distance law is off, and the warning zone is too thin.
    fn too_fast(&self) -> Option<MissingGuarantee> {
        if self.has_stopping_law() {
            return None;
        }
        // Another path may move volumes that the program does not move.
        if replans(self.cell, self.robot) {
            let why = "`stopping_distance` is off, and paths that the robot plans around what sensors see are known in the run only";
            return Some(MissingGuarantee::new(why, "stopping_distance = true in [monitor]"));
        }
        if self.fastest_m_s() <= 0.0 {
            return None;
        }
        if let Some(missing) = self.unknown_lever() {
            return Some(missing);
        }
        if self.is_zone_sufficient() {
            return None;
        }
        if self.region_speed_m_s.is_infinite() {
            let why = "`stopping_distance` is off, and how fast the region moves is known in the run only";
            return Some(MissingGuarantee::new(why, "stopping_distance = true in [monitor]"));
        }
        let units = self.cell.units;
        let [needed, zone] = [round_up(self.needed_m()), self.region().region.warning_m];
        let law = "`stopping_distance` is off";
        if self.releases_leaving_robot() {
            let why = format!(
                "{law}, and `direction_aware` permits full speed anywhere in the warning zone while the robot leaves: \
                 where its program then turns inwards no thickness is enough"
            );
            return Some(MissingGuarantee::new(
                why,
                "stopping_distance = true in [monitor], or direction_aware = false",
            ));
        }
        let why = format!(
            "{law}, and from {}/s {} it needs a warning zone of {}; it has {}",
            units.show_length(round(self.fastest_m_s())),
            self.braking(),
            units.show_length(needed),
            units.show_length(zone),
        );
        let enough = units.in_file_units(needed);
        Some(MissingGuarantee::new(
            why,
            format!("stopping_distance = true in [monitor], or warning = {enough} in {}", self.region().table()),
        ))
    }

    /// Braking and delay in words, for example `(braking 8000 mm/s², with a delay of 2 ms)`.
    fn braking(&self) -> String {
        let (v, distance) = (self.fastest_m_s(), self.stopping_profiles().map(|p| p.braking_m).fold(0.0, f64::max));
        let deceleration = self.cell.units.show_length(round(v * v / (2.0 * distance)));
        format!("(braking {deceleration}/s², with a delay of {} ms)", round(self.delay_s() * 1e3))
    }

    /// True if the stopping-distance law is on. `override_rate` does not delay it.
    fn has_stopping_law(&self) -> bool {
        self.cell.monitoring.stopping_reaction_s.is_some()
    }

    /// True if the warning zone alone is sufficient.
    fn is_zone_sufficient(&self) -> bool {
        self.has_needed_thickness() && !self.releases_leaving_robot()
    }

    /// True if `direction_aware` may permit full speed within the zone.
    fn releases_leaving_robot(&self) -> bool {
        self.cell.monitoring.laws.direction_aware && !self.never_reverses()
    }

    fn has_needed_thickness(&self) -> bool {
        self.region().region.warning_m + ROUNDING_M >= self.needed_m()
    }

    /// True if a guarded point that moves away from the region never returns.
    ///
    /// This holds if the program is a single straight move of prismatic joints and the region is convex. With two moves
    /// the point may return after a rest, while the override for leaving still applies.
    fn never_reverses(&self) -> bool {
        let is_prismatic_or_fixed =
            |j: &elbowroom_kinematics::Joint| matches!(j.kind, JointKind::Prismatic | JointKind::Fixed);
        let program = self.robot().program.as_ref();
        self.robot().robot.chain.joints().iter().all(is_prismatic_or_fixed)
            && program.is_none_or(is_one_move)
            && !matches!(self.region().region.shape, Shape::Mesh(_))
    }

    fn plays_trajectory(&self) -> bool {
        let program = self.robot().program.as_ref();
        program.is_some_and(|p| matches!(p.body, elbowroom_cell::ProgramBody::Trajectory(_)))
    }

    /// Reason why entry is excluded, with the assumptions.
    fn guarantee(&self) -> String {
        let units = self.cell.units;
        let reacts_within = |seconds: f64| format!("it reacts within {} ms", round(seconds * 1e3));
        let exchange =
            if matches!(self.region().region.kind, RegionKind::Exchange { .. }) { "without the grant " } else { "" };
        if self.fastest_m_s() <= 0.0 {
            return "no program moves the guarded volumes, and they are outside".into();
        }
        if self.has_stopping_law() {
            let reaction = reacts_within(self.cell.monitoring.reaction_s);
            let program = if self.plays_trajectory() {
                "it plays the recording unchanged (its accelerations are taken into account)"
            } else {
                "its program keeps the stated accelerations"
            };
            return format!(
                "`stopping_distance`: {exchange}it stops before the border, provided that its joints brake as `stop_time` \
                 states, {reaction}, {program}, and model, TCP and tool are as described"
            );
        }
        let reaction = reacts_within(self.delay_s());
        format!(
            "the warning zone of {} is thick enough ({} needed): {exchange}it stops before the border, provided that its joints \
             brake as `stop_time` states, {reaction}, and model, TCP and tool are as described",
            units.show_length(self.region().region.warning_m),
            units.show_length(round_up(self.needed_m())),
        )
    }
}

fn is_one_move(program: &elbowroom_cell::Program) -> bool {
    let moves = |s: &&elbowroom_cell::ProgramStep| {
        matches!(s.action, StepAction::Joint { .. } | StepAction::Linear { .. } | StepAction::Planned { .. })
    };
    let once = program.repeat <= 1;
    matches!(&program.body, elbowroom_cell::ProgramBody::Steps(steps) if once && steps.iter().filter(moves).count() <= 1)
}

/// Rounded to four digits, for messages.
fn round(v: f64) -> f64 {
    if v == 0.0 || !v.is_finite() {
        return v;
    }
    let scale = 10_f64.powi(3 - v.abs().log10().floor() as i32);
    (v * scale).round() / scale
}

/// Rounded up to the next millimetre.
pub(super) fn round_up(metres: f64) -> f64 {
    (((metres - ROUNDING_M) * 1e3).ceil() / 1e3).max(0.0)
}
