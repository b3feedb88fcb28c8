//! Robots that are kept inside of a solid, or within a fence, whatever their programs say.

use crate::common::parse;
use elbowroom_kinematics::ChainState;
use elbowroom_sim::{RunOptions, simulate};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::random::SplitMix;

/// An arm of three joints whose forearm ends in a ball.
const ARM: &str = r#"
version = 1
units = { length = "m", angle = "deg" }
tick_ms = 4
max_s = 8
[robot.arm]
dh = [
    { alpha = 90, min = -170, max = 170, speed = 120 },
    { a = 0.6, min = -90, max = 150, speed = 120 },
    { a = 0.5, min = -150, max = 150, speed = 150 },
]
links = [[], { capsule = { from = [-0.6, 0, 0], to = [0, 0, 0], radius = 0.06 } }, [{ capsule = { from = [-0.5, 0, 0], to = [0, 0, 0], radius = 0.05 } }, { sphere = { at = [0, 0, 0], radius = 0.08 } }]]
start = [0, 80, 20]
[monitor]
stopping_distance = true
direction_aware = true
"#;

/// Depth of a point inside, m.
type Depth = fn(Vec3) -> f64;

const ROOMS: &[(&str, Depth)] = &[
    ("[region.room]\nshape = \"sphere\"\ncentre = [0, 0, 0.2]\nradius = 1.1\nkeep = \"inside\"\n", |p| {
        1.1 - (p - Vec3::Z * 0.2).length()
    }),
    (
        "[region.room]\nshape = \"cylinder\"\nbase = [0, 0, -0.9]\nradius = 0.8\nheight = 2.4\nkeep = \"inside\"\n",
        |p| (0.8 - p.x.hypot(p.y)).min(1.5 - p.z).min(p.z + 0.9),
    ),
    ("[region.room]\nshape = \"box\"\nfrom = [-0.9, -0.7, -0.6]\nto = [0.8, 0.8, 1.4]\nkeep = \"inside\"\n", |p| {
        [p.x + 0.9, 0.8 - p.x, p.y + 0.7, 0.8 - p.y, p.z + 0.6, 1.4 - p.z].into_iter().fold(f64::INFINITY, f64::min)
    }),
    ("[fence.room]\ncorners = [[-0.9, -0.7], [-0.9, 0.8], [0.8, 0.8], [0.8, -0.7]]\nfloor = -2\nheight = 4\n", |p| {
        [p.x + 0.9, 0.8 - p.x, p.y + 0.7, 0.8 - p.y].into_iter().fold(f64::INFINITY, f64::min)
    }),
];

#[test]
fn no_point_of_an_arm_leaves_its_room() {
    let mut random = SplitMix(3);
    for (room, depth) in ROOMS {
        let (mut least_m, mut least_free_m) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..4 {
            let mut target =
                || [random.between(-160.0, 160.0), random.between(-60.0, 120.0), random.between(-100.0, 100.0)];
            let steps: Vec<String> = (0..3).map(|_| format!("{{ move = \"joint\", to = {:?} }}", target())).collect();
            let text = format!("{ARM}{room}warning = 0.2\n[program.arm]\nsteps = [{}]\n", steps.join(", "));
            let cell = parse(&text);
            for (apply_override, least) in [(true, &mut least_m), (false, &mut least_free_m)] {
                let run = simulate(&cell, &RunOptions { apply_override, ..RunOptions::default() }).unwrap().recording;
                let chain = &cell.robots[0].robot.chain;
                let mut state = ChainState::new(chain);
                for sample in &run.robots[0].samples {
                    state.q.copy_from_slice(&sample.q);
                    chain.forward(&mut state);
                    let links: Vec<Vec3> = (0..chain.links().len())
                        .map(|link| state.link_in_root(elbowroom_kinematics::LinkId(link)).translation)
                        .collect();
                    let [shoulder, elbow, tip] = links[links.len() - 3..] else { unreachable!() };
                    let along = |a: Vec3, b: Vec3, radius: f64| {
                        (0..=20).map(|k| depth(a.lerp(b, f64::from(k) / 20.0)) - radius).fold(f64::INFINITY, f64::min)
                    };
                    *least =
                        least.min(along(shoulder, elbow, 0.06)).min(along(elbow, tip, 0.05)).min(depth(tip) - 0.08);
                }
                assert!(!(run.regions[0].entered && apply_override), "{room}");
            }
        }
        assert!(least_m > 0.0, "{room}: {least_m}");
        assert!(least_free_m < 0.0, "{room}: without the monitor it leaves, {least_free_m}");
    }
}
