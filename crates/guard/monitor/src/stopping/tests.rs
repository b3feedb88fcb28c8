//! Comparison of the travel bound with random programs that fully use the stated accelerations.

use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::Random;

use super::{StopPhases, StoppingInput, StoppingLaw};
use crate::attached_volumes::AttachedVolumes;
use crate::{Configuration, ConfigurationParts, Laws, Part, Presence, StoppingSettings, Volume};

fn list(random: &mut Random, n: usize, largest: f64) -> Vec<f64> {
    (0..n).map(|_| random.between(-largest, largest)).collect()
}

/// A chain of `kinds`, with perpendicular axes or all axes along z, and a sphere at its end.
fn configuration(kinds: &[JointKind], flat: bool, stopping: StoppingSettings) -> Configuration {
    let joint = |(i, kind): (usize, &JointKind)| Joint {
        name: format!("j{i}"),
        kind: *kind,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(if i == 0 { Vec3::ZERO } else { Vec3::X * 0.5 }),
        axis: if flat || i % 2 == 0 { Vec3::Z } else { Vec3::Y },
        limits: Limits { velocity: Some(5.0), ..Limits::symmetric(3.0) },
        mimic: None,
    };
    let links = (0..=kinds.len()).map(|i| format!("l{i}")).collect();
    let chain = Chain::new("arm", links, kinds.iter().enumerate().map(joint).collect()).unwrap();
    let volume = Volume {
        name: "sphere".into(),
        link: LinkId(kinds.len()),
        part: Part::Arm,
        shape: Shape::Sphere(Sphere { radius: 0.01 }),
        in_link: Pose::from_translation(Vec3::X * 0.5),
        presence: Presence::Always,
    };
    Configuration::new(ConfigurationParts {
        robot: "arm".into(),
        base_in_world: Pose::IDENTITY,
        chain,
        volumes: vec![volume],
        regions: Vec::new(),
        sources: Vec::new(),
        grids: vec![],
        laws: Laws { stopping_distance: Some(stopping), ..Laws::default() },
    })
    .unwrap()
}

fn center(chain: &Chain, q: &[f64]) -> Vec3 {
    let mut state = ChainState::new(chain);
    state.q.copy_from_slice(q);
    chain.forward(&mut state);
    state.link_in_root(LinkId(chain.links().len() - 1)).transform_point(Vec3::X * 0.5)
}

/// The largest and the mean travel of the programs, as fractions of the bound.
fn fractions(kinds: &[JointKind], flat: bool, r: &mut Random) -> (f64, f64) {
    let (n, rounds) = (kinds.len(), 1500);
    let (mut largest, mut sum) = (0.0_f64, 0.0);
    for _ in 0..rounds {
        let acceleration: Vec<f64> = (0..n).map(|_| r.between(0.5, 12.0)).collect();
        let stopping = StoppingSettings {
            reaction_s: 0.0,
            period_s: 0.002,
            joint_deceleration: vec![4.0; n],
            joint_acceleration: acceleration.clone(),
        };
        let config = configuration(kinds, flat, stopping.clone());
        let mut law = StoppingLaw::new(&config, &stopping);
        let (q, qd) = (list(r, n, 2.0), list(r, n, 2.0));
        let mut state = ChainState::new(&config.chain);
        state.q.copy_from_slice(&q);
        state.qd.copy_from_slice(&qd);
        config.chain.forward_motion(&mut state);
        let in_world = [state.link_in_root(LinkId(n)) * config.volumes[0].in_link];
        law.begin(
            &config,
            &StoppingInput {
                now: &state,
                intent: &state,
                program_is_known: true,
                now_s: 0.0,
                stamp_s: 0.0,
                programmed_override: 1.0,
                uncertain_s: 0.0,
                unchanged_s: 0.0,
                volume_in_world: &in_world,
                attached: &AttachedVolumes::new(&config),
            },
        );
        // Towards the first axis, which rotation alone reaches, or in a random direction.
        let at = in_world[0].translation;
        let random_direction = Vec3::new(r.between(-1.0, 1.0), r.between(-1.0, 1.0), r.between(-1.0, 1.0));
        let towards = if r.unit() < 0.5 { Vec3::new(-at.x, -at.y, 0.0) } else { random_direction };
        let Some(towards) = towards.try_normalize() else { continue };
        let motion = state.link_motion(LinkId(n));
        let offset = at - state.link_in_root(LinkId(n)).translation;
        let speed = motion.velocity_at(offset).dot(towards);
        let approach = law.approach(0, towards, speed, speed);
        let u = r.between(0.01, 0.3);
        let phases = StopPhases { run: u, stop: 0.0, total: u };
        let bound = law.travel(0, &approach, &phases, &law.program);
        // Every joint accelerates or decelerates at its limit, mostly in the direction of its motion.
        let then: Vec<f64> = (0..n)
            .map(|j| {
                let push = if r.unit() < 0.7 { qd[j].signum() } else { r.between(-1.0, 1.0) };
                q[j] + qd[j] * u + push * acceleration[j] * u * u / 2.0
            })
            .collect();
        let travelled = (center(&config.chain, &then) - at).dot(towards);
        assert!(
            travelled <= bound + 1e-12,
            "travelled {travelled}, bound {bound}, u {u}, q {q:?}, qd {qd:?}, A {acceleration:?}"
        );
        if bound > 1e-3 {
            largest = largest.max(travelled / bound);
            sum += travelled.max(0.0) / bound;
        }
    }
    (largest, sum / f64::from(rounds))
}

#[test]
fn no_program_travels_farther_than_the_bound() {
    use JointKind::{Prismatic, Revolute};
    let mut r = Random(13);
    for kinds in
        [&[Revolute][..], &[Revolute; 2], &[Prismatic, Revolute], &[Revolute, Prismatic, Revolute], &[Revolute; 6]]
    {
        for flat in [true, false] {
            let (largest, mean) = fractions(kinds, flat, &mut r);
            eprintln!(
                "{} joints, flat {flat}: at largest {largest:.3} of the bound, {mean:.3} on average",
                kinds.len()
            );
            // Some programs must nearly reach the bound; otherwise the test proves little.
            assert!(kinds.len() > 2 || largest > 0.9, "{largest}");
        }
    }
}
