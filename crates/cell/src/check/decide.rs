//! Is entry excluded, by what, and what is missing.

use elbowroom_formats::Warning;
use elbowroom_kinematics::JointKind;
use elbowroom_monitor::{Kind, Life};
use elbowroom_proximity::Shape;

use super::RobotProgram;
use super::profile::{Pace, lateness};
use crate::{Cell, CellRegion, CellRobot};

/// So much (m) is rounding of the speeds and no thickness.
const ROUNDING_M: f64 = 1e-6;

/// One region and one robot that it concerns.
pub(super) struct Pair<'a> {
    pub cell: &'a Cell,
    pub region: usize,
    pub robot: usize,
    pub program: &'a RobotProgram,
    /// Largest speed of the region, m/s.
    pub travel_m_s: f64,
    /// True where the robot begins inside.
    pub starts_inside: bool,
    /// True where another robot begins inside what this robot would have to share.
    pub shared_at_start: bool,
}

/// What [`Pair::decide`] says.
pub(super) struct Decision {
    pub excluded: bool,
    pub reason: String,
    pub write_instead: Option<String>,
    pub needed_warning_m: Option<f64>,
}

/// Why the laws do not keep the robot out.
struct Missing {
    why: String,
    write: String,
}

impl Missing {
    fn new(why: impl Into<String>, write: impl Into<String>) -> Self {
        Self { why: why.into(), write: write.into() }
    }
}

impl Pair<'_> {
    pub fn decide(&self) -> Decision {
        let needed = self.needed_m();
        let needed_warning_m = Some(needed).filter(|n| n.is_finite());
        if let Kind::Monitored { slow_to } = self.region().region.kind {
            let what = if slow_to.is_some() { "slows" } else { "reports" };
            let reason = format!("monitored: it {what} and keeps nobody out, so nothing is missing");
            return Decision { excluded: false, reason, write_instead: None, needed_warning_m: None };
        }
        let missing = self.unprovable().or_else(|| self.too_fast());
        match missing {
            Some(Missing { why, write }) => {
                Decision { excluded: false, reason: why, write_instead: Some(write), needed_warning_m }
            }
            None => Decision { excluded: true, reason: self.proof(), write_instead: None, needed_warning_m },
        }
    }

    /// What to tell before a run, where the robot can come to the border faster than it can stop.
    pub fn overrun(&self) -> Option<Warning> {
        if matches!(self.region().region.kind, Kind::Monitored { .. }) {
            return None;
        }
        let Missing { why, write } = self.too_fast()?;
        let (region, robot) = (&self.region().region.name, &self.robot().name);
        let what = format!("robot \"{robot}\" can overrun the border of region \"{region}\": {why}");
        Some(Warning::new(&self.cell.file, self.region().line, what).hint(write))
    }

    fn region(&self) -> &CellRegion {
        &self.cell.regions[self.region]
    }

    fn robot(&self) -> &CellRobot {
        &self.cell.robots[self.robot]
    }

    fn paces(&self) -> impl Iterator<Item = &Pace> {
        self.program.paces(self.region().region.guards)
    }

    /// Largest speed of any guarded point, m/s.
    fn fastest_m_s(&self) -> f64 {
        self.paces().map(|p| p.fastest_m_s).fold(0.0, f64::max)
    }

    /// The thickness of the guarded point that needs most, and the way that the region comes nearer meanwhile, m.
    fn needed_m(&self) -> f64 {
        let own = self.paces().map(|p| p.needed_m).fold(0.0, f64::max);
        own + self.travel_m_s * (self.late_s() + self.program.profile.braking_s)
    }

    /// How late (s) the robot obeys after it has come into the zone: one tick until the monitor sees it, and the reaction time.
    fn late_s(&self) -> f64 {
        lateness(self.cell).late_s
    }

    /// What no law and no thickness helps against.
    fn unprovable(&self) -> Option<Missing> {
        let region = &self.region().region;
        let exchange = matches!(region.kind, Kind::Exchange { .. });
        if self.starts_inside && !exchange {
            return Some(Missing::new(
                "the robot starts inside",
                format!("another `start` of [robot.{}], or another place of the region", self.robot().name),
            ));
        }
        if self.starts_inside && self.shared_at_start {
            let why = "it starts inside, and so does another robot that shares this exchange region";
            return Some(Missing::new(why, format!("another `start` of [robot.{}]", self.robot().name)));
        }
        if region.life == Life::Temporary {
            return Some(Missing::new(
                "temporary: nothing keeps the robot out while it is off, and it may be inside when it is switched on",
                "life = \"permanent\"",
            ));
        }
        if self.travel_m_s > 0.0 {
            let why = "the region moves: the laws stop the robot, but the region can come to a robot that stands";
            let name = &region.name;
            let write = format!("warning_output = 1 in [region.{name}], wired to what stops the carrier of the region");
            return Some(Missing::new(why, write));
        }
        if self.cell.avoidance.get(self.robot).is_some_and(Option::is_some) {
            return Some(Missing::new(
                "the robot evades: off its program its speeds are not known beforehand",
                format!("no [avoidance.{}]", self.robot().name),
            ));
        }
        None
    }

    /// Where neither stopping distance nor thickness is enough.
    fn too_fast(&self) -> Option<Missing> {
        if self.fastest_m_s() <= 0.0 || self.stops_in_time() || self.thick_enough() {
            return None;
        }
        let units = self.cell.units;
        let [needed, zone] = [round_up(self.needed_m()), self.region().region.warning_m];
        let law = "`stopping_distance` is off";
        if self.is_released() {
            let why = format!(
                "{law}, and `direction_aware` lets it go at full speed anywhere in the warning zone while it leaves: where its \
                 program then turns inwards no thickness is enough"
            );
            return Some(Missing::new(why, "stopping_distance = true in [monitor], or direction_aware = false"));
        }
        let why = format!(
            "{law}, and from {}/s {} it needs a warning zone of {}; it has {}",
            units.show_length(round(self.fastest_m_s())),
            self.braking(),
            units.show_length(needed),
            units.show_length(zone),
        );
        let enough = units.in_file_units(needed);
        Some(Missing::new(
            why,
            format!(
                "stopping_distance = true in [monitor], or warning = {enough} in [region.{}]",
                self.region().region.name
            ),
        ))
    }

    /// `(braking 8000 mm/s², obeying 2 ms late)`.
    fn braking(&self) -> String {
        let (v, way) = (self.fastest_m_s(), self.paces().map(|p| p.braking_m).fold(0.0, f64::max));
        let deceleration = self.cell.units.show_length(round(v * v / (2.0 * way)));
        format!("(braking {deceleration}/s², obeying {} ms late)", round(self.late_s() * 1e3))
    }

    /// True where the stopping-distance law is on; `override_rate` does not delay it.
    fn stops_in_time(&self) -> bool {
        self.cell.laws.stopping_reaction_s.is_some()
    }

    /// True where the warning zone alone is enough.
    fn thick_enough(&self) -> bool {
        self.thick() && !self.is_released()
    }

    /// True where `direction_aware` may let the robot go at full speed within the zone.
    fn is_released(&self) -> bool {
        self.cell.laws.laws.direction_aware && !self.never_turns()
    }

    fn thick(&self) -> bool {
        self.region().region.warning_m + ROUNDING_M >= self.needed_m()
    }

    /// True where a guarded point that moves away from the region never comes back: the program is one straight move of sliding
    /// joints, and the region is convex. After a rest it may come back, and it still runs by the override that it was told
    /// while it left.
    fn never_turns(&self) -> bool {
        let slides = |j: &elbowroom_kinematics::Joint| matches!(j.kind, JointKind::Prismatic | JointKind::Fixed);
        let program = self.cell.programs.get(self.robot).and_then(Option::as_ref);
        self.robot().robot.chain.joints().iter().all(slides)
            && program.is_none_or(is_one_move)
            && !matches!(self.region().region.shape, Shape::Mesh(_))
    }

    fn plays_a_recording(&self) -> bool {
        let program = self.cell.programs.get(self.robot).and_then(Option::as_ref);
        program.is_some_and(|p| matches!(p.body, crate::ProgramBody::Trajectory(_)))
    }

    /// Why entry is excluded, with the assumptions.
    fn proof(&self) -> String {
        let units = self.cell.units;
        let obeys = |seconds: f64| format!("it obeys within {} ms", round(seconds * 1e3));
        let exchange =
            if matches!(self.region().region.kind, Kind::Exchange { .. }) { "without the grant " } else { "" };
        if self.fastest_m_s() <= 0.0 {
            return "no program moves what is guarded, and it stands outside".into();
        }
        if self.stops_in_time() {
            let reaction = obeys(self.cell.laws.reaction_s);
            let program = if self.plays_a_recording() {
                "it plays the recording as it is (its accelerations are reckoned with)"
            } else {
                "its program keeps the stated accelerations"
            };
            return format!(
                "`stopping_distance`: {exchange}it stops before the border, provided that its joints brake as `stop_time` \
                 states, {reaction}, {program}, and model, TCP and tool are as described"
            );
        }
        let reaction = obeys(self.late_s());
        format!(
            "the warning zone of {} is thick enough ({} needed): {exchange}it stops before the border, provided that its joints \
             brake as `stop_time` states, {reaction}, and model, TCP and tool are as described",
            units.show_length(self.region().region.warning_m),
            units.show_length(round_up(self.needed_m())),
        )
    }
}

fn is_one_move(program: &crate::Program) -> bool {
    let moves = |s: &&crate::Step| matches!(s.action, crate::Action::Joint { .. } | crate::Action::Linear { .. });
    let once = program.repeat <= 1;
    matches!(&program.body, crate::ProgramBody::Steps(steps) if once && steps.iter().filter(moves).count() <= 1)
}

/// To four digits, for messages.
fn round(v: f64) -> f64 {
    if v == 0.0 || !v.is_finite() {
        return v;
    }
    let scale = 10_f64.powi(3 - v.abs().log10().floor() as i32);
    (v * scale).round() / scale
}

/// Up to the next whole millimetre.
pub(super) fn round_up(metres: f64) -> f64 {
    (((metres - ROUNDING_M) * 1e3).ceil() / 1e3).max(0.0)
}
