//! `follow = { … }` of a region: the source that moves it, and its largest plausible speed.

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_kinematics::motion_bound::{joint_reaches, motion_bound};
use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_monitor::SourceLimits;
use elbowroom_robot::ObjectId;
use elbowroom_spatial::Pose;

use super::definitions::{Definitions, encoder_index, robot_id};
use super::flange::unknown_link;
use super::poses;
use super::schema::{FOLLOW, FOLLOW_SOURCES, names};
use crate::{CellRobot, Follow, PoseRate, PoseTrack, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const EXAMPLE: &str = "follow = { robot = \"r2\", frame = \"flange\" }   (or: { encoder = \"conveyor\" }, { object = \"cart\" }, \
                       { poses = \"cart.csv\" })";
/// Factor on the rated joint speeds for plausibility, as in the monitor's watchdog.
const FASTER: f64 = 1.5;

/// Reads the table; a pose file is added to `known`.
pub(super) fn read(
    v: &Value<'_>,
    units: Units,
    known: &mut Definitions<'_>,
    warnings: &mut Vec<Diagnostic>,
) -> Result<(Follow, SourceLimits)> {
    let t = v.table(EXAMPLE)?;
    t.only(&names(&[FOLLOW_SOURCES, FOLLOW]))?;
    let mut named = FOLLOW_SOURCES.iter().filter_map(|k| Some((k.name, t.get(k.name)?)));
    let Some((kind, source)) = named.next() else { return Err(v.error("names nothing to follow").hint(EXAMPLE)) };
    if let Some((_, other)) = named.next() {
        return Err(other.error(format!("contradicts `{kind}`: a region follows one source")).hint(EXAMPLE));
    }
    if let Some(frame) = t.get("frame").filter(|_| kind != "robot") {
        return Err(frame.error(format!("belongs to `robot`; `{kind}` has one frame")).hint("leave it out"));
    }
    let mut limits = SourceLimits::default();
    let follow = match kind {
        "robot" => {
            let id = robot_id(&source, known.robots)?;
            let robot = &known.robots[id.0];
            let (link, in_link) = frame(&t, robot)?;
            let speeds: Vec<f64> = robot.limits.iter().map(|limit| limit.velocity * FASTER).collect();
            limits = fastest(&robot.robot.chain, &speeds, link, in_link);
            Follow::Robot { robot: id, link, in_link }
        }
        "encoder" => {
            let index = encoder_index(&source, known.encoders)?;
            let encoder = &known.encoders[index];
            limits.wrap_m = encoder.wrap_m.map(|travel| encoder.direction * travel);
            Follow::Encoder(index)
        }
        "object" => {
            let object = object_id(&source, known)?;
            if let Some(crate::Drive::Belt(encoder)) =
                known.moving_objects.iter().find(|m| m.object == object).map(|m| &m.drive)
            {
                limits.wrap_m = encoder.wrap_m.map(|travel| encoder.direction * travel);
            }
            Follow::Object(object)
        }
        _ => {
            known.pose_tracks.push(poses::read(&source, units)?);
            Follow::Poses(known.pose_tracks.len() - 1)
        }
    };
    given(&t, units, &mut limits)?;
    warn_of_motion(&t, follow, known, &limits, units, warnings);
    Ok((follow, limits))
}

/// Warns if the source itself moves faster than the limits.
fn warn_of_motion(
    t: &Table<'_>,
    follow: Follow,
    known: &Definitions<'_>,
    limits: &SourceLimits,
    units: Units,
    warnings: &mut Vec<Diagnostic>,
) {
    match follow {
        Follow::Poses(index) => warn_of_jumps(t, &known.pose_tracks[index], limits, units, warnings),
        Follow::Encoder(index) => {
            let encoder = &known.encoders[index];
            let speed = encoder.fastest(0.0, f64::INFINITY);
            if speed > limits.speed_m_s {
                let what = format!("encoder \"{}\" moves at {}/s", encoder.name, units.show_length(speed));
                warn_of_jump(t, &what, warnings);
            }
        }
        Follow::Robot { .. } | Follow::Object(_) => {}
    }
}

/// Largest limits of a source, m/s and rad/s: larger ones would permit every jump.
const MAX_SPEED_M_S: f64 = 1000.0;
const MAX_TURN_RAD_S: f64 = 500.0;

/// Reads `max_speed` and `max_turn`, if given.
fn given(t: &Table<'_>, units: Units, limits: &mut SourceLimits) -> Result<()> {
    if let Some(v) = t.get("max_speed") {
        limits.speed_m_s = units.positive_length(&v)?;
        if limits.speed_m_s > MAX_SPEED_M_S {
            let what = format!(
                "is {}/s: no source in a cell is that fast, so no jump would be noticed",
                units.show_length(limits.speed_m_s)
            );
            return Err(v.error(what).hint(format!("at most {}/s", units.show_length(MAX_SPEED_M_S))));
        }
    }
    if let Some(v) = t.get("max_turn") {
        limits.turn_rad_s = units.angle.to_radians(v.positive()?);
        if limits.turn_rad_s > MAX_TURN_RAD_S {
            let what = format!(
                "is {:.0} rad/s: no source in a cell turns that fast, so no jump would be noticed",
                limits.turn_rad_s
            );
            return Err(v.error(what).hint(format!("at most {MAX_TURN_RAD_S} rad/s, or 28647 deg/s")));
        }
    }
    Ok(())
}

/// Upper bound of the motion of a frame on a link, from the speeds of the independent joints; at least the default.
///
/// `speeds` are in rad/s or m/s, in the order of `q`.
fn fastest(chain: &Chain, speeds: &[f64], link: LinkId, in_link: Pose) -> SourceLimits {
    let bound = motion_bound(chain, link, in_link.translation.length(), &chain.path(link));
    // A joint that follows another one turns by a multiple of its motion, whatever the kind of the other joint.
    // Reaches, and so strokes, do not count: a rotation has no lever.
    let turning = joint_reaches(chain, link, 0.0, |_| 0.0)
        .filter(|reach| reach.kind.turns())
        .filter_map(|reach| reach.coupling)
        .map(|coupling| coupling.multiplier.abs() * speeds[coupling.index]);
    let default = SourceLimits::default();
    SourceLimits {
        speed_m_s: bound.iter().map(|(j, bound)| bound * speeds[*j]).sum::<f64>().max(default.speed_m_s),
        turn_rad_s: turning.sum::<f64>().max(default.turn_rad_s),
        wrap_m: None,
    }
}

fn object_id(v: &Value<'_>, known: &Definitions<'_>) -> Result<ObjectId> {
    let name = v.text()?;
    let names = || known.objects.iter().map(|o| o.name.as_str());
    names().position(|n| n == name).map(ObjectId).ok_or_else(|| {
        let what = format!("names the object \"{name}\", which has no table [object.{name}]");
        v.error(what).hint(suggest::hint(name, names()))
    })
}

fn frame(t: &Table<'_>, robot: &CellRobot) -> Result<(LinkId, Pose)> {
    let v = t.get("frame");
    if robot.is_mechanism() {
        return part_of_mechanism(t, v.as_ref(), robot);
    }
    let Some(v) = &v else { return Ok((robot.flange, Pose::IDENTITY)) };
    match v.text()? {
        "flange" => Ok((robot.flange, Pose::IDENTITY)),
        "tool" | "tcp" => Ok((robot.flange, robot.tcp_in_flange)),
        name => match robot.robot.chain.link(name) {
            Some(link) => Ok((link, Pose::IDENTITY)),
            None => Err(unknown_link(v, name, &robot.robot.chain)),
        },
    }
}

/// The part that moves a region: a mechanism has no flange that would go without saying.
fn part_of_mechanism(t: &Table<'_>, v: Option<&Value<'_>>, robot: &CellRobot) -> Result<(LinkId, Pose)> {
    let chain = &robot.robot.chain;
    let Some(v) = v else {
        let what = format!("`{}` needs the key `frame`: which part of the mechanism \"{}\"", t.name, robot.name);
        let solid = robot.robot.links_with_colliders().map(|link| format!("\"{}\"", chain.links()[link.0]));
        let parts = solid.collect::<Vec<_>>().join(" or ");
        return Err(t.error(what).hint(format!("frame = {parts}")));
    };
    let name = v.text()?;
    chain.link(name).map(|link| (link, Pose::IDENTITY)).ok_or_else(|| unknown_link(v, name, chain))
}

/// Warns before a run if the monitors will treat a motion in the file as a jump.
fn warn_of_jumps(
    t: &Table<'_>,
    track: &PoseTrack,
    limits: &SourceLimits,
    units: Units,
    warnings: &mut Vec<Diagnostic>,
) {
    let too_fast = |rate: &PoseRate| rate.speed_m_s > limits.speed_m_s || rate.turn_rad_s > limits.turn_rad_s;
    let Some(PoseRate { from_s, speed_m_s, turn_rad_s }) = track.rates().find(too_fast) else { return };
    let (file, speed) = (track.file.display(), units.show_length(speed_m_s));
    let what = format!("{file}: from t_s = {from_s} on the poses move at {speed}/s and {turn_rad_s:.3} rad/s");
    warn_of_jump(t, &what, warnings);
}

fn warn_of_jump(t: &Table<'_>, what: &str, warnings: &mut Vec<Diagnostic>) {
    let what = format!("{what}: the monitor takes that for a jump and stops the robots");
    let hint = "max_speed and max_turn in `follow`, if the source can be that fast";
    warnings.push(Diagnostic::new(t.file, t.line, what).hint(hint));
}

#[cfg(test)]
mod tests {
    use elbowroom_kinematics::{ChainState, Joint, JointId, JointKind, Limits, Mimic};
    use elbowroom_spatial::Vec3;

    use super::*;

    /// Kind, and the multiplier with which the joint follows joint 0, if it does.
    type TestJoint = (JointKind, Option<f64>);

    /// Joints about or along z, 0.3 m apart.
    fn chain(joints: &[TestJoint]) -> Chain {
        let joint = |(i, (kind, multiplier)): (usize, &TestJoint)| Joint {
            name: format!("j{i}"),
            kind: *kind,
            parent: LinkId(i),
            child: LinkId(i + 1),
            origin: Pose::from_translation(Vec3::X * 0.3),
            axis: Vec3::Z,
            limits: Limits::symmetric(3.0),
            mimic: multiplier.map(|multiplier| Mimic { joint: JointId(0), multiplier, offset: 0.1 }),
        };
        let links = (0..=joints.len()).map(|i| format!("l{i}")).collect();
        Chain::new("chain", links, joints.iter().enumerate().map(joint).collect()).unwrap()
    }

    /// Turning speed of the last link while all independent joints move at their speeds, by differences, rad/s.
    fn true_turn_rad_s(chain: &Chain, speeds: &[f64]) -> f64 {
        let mut state = ChainState::new(chain);
        let mut at = |t: f64| {
            state.q.iter_mut().zip(speeds).for_each(|(q, speed)| *q = speed * t);
            chain.forward(&mut state);
            state.link_in_root(chain.tip()).rotation
        };
        let step_s = 1e-6;
        (at(0.0).inverse() * at(step_s)).angle() / step_s
    }

    #[test]
    fn joints_that_follow_another_turn_by_their_multiplier() {
        use JointKind::{Prismatic, Revolute};
        let cases: [(&[TestJoint], &[f64], f64); 5] = [
            (&[(Revolute, None), (Revolute, Some(3.0))], &[10.0], 40.0),
            (&[(Revolute, None), (Revolute, Some(-3.0))], &[10.0], 40.0),
            (&[(Revolute, None), (Revolute, Some(2.0)), (Revolute, None)], &[10.0, 15.0], 45.0),
            // A rotation that follows a slide turns, a slide that follows a rotation does not.
            (&[(Prismatic, None), (Revolute, Some(50.0))], &[1.0], 50.0),
            (&[(Revolute, None), (Prismatic, Some(5.0))], &[30.0], 30.0),
        ];
        for (joints, speeds, expected) in cases {
            let chain = chain(joints);
            let limits = fastest(&chain, speeds, chain.tip(), Pose::IDENTITY);
            assert!((limits.turn_rad_s - expected).abs() < 1e-9, "{joints:?}: {limits:?}");
            assert!(true_turn_rad_s(&chain, speeds) <= limits.turn_rad_s + 1e-3, "{joints:?}");
        }
        let slow = chain(&[(Revolute, None), (Revolute, Some(0.5))]);
        assert_eq!(fastest(&slow, &[1.0], slow.tip(), Pose::IDENTITY), SourceLimits::default());
    }
}
