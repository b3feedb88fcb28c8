//! Comparison of batched motion with double precision: positions, chords and deviations from chords.

use elbowroom_kinematics::{Chain, ChainState, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::Random;
use fearless_simd::dispatch;

use super::joint_stretch::INTERVALS;
use super::motion_table::MotionTable;
use super::segment::Stretch;
use super::workspace::Workspace;
use crate::lanes::{LANES, detected_simd_level};
use crate::model::{CoveredLinkId, CoveredRobot};

const BALL_M: f64 = 0.02;

/// Random chains.
trait RandomChain {
    /// A vector with each coordinate within `size` of 0.
    fn vec3(&mut self, size: f64) -> Vec3;

    fn rotation(&mut self) -> Rotation;

    fn axis(&mut self) -> Vec3;

    /// A chain with all kinds of joints, branches, and joints that follow others.
    fn chain(&mut self, joints: usize, size: f64) -> Chain;

    /// Joint values within the limits; for joints without limits within `unlimited` of 0.
    fn q(&mut self, chain: &Chain, unlimited: f64) -> Vec<f64>;
}

impl RandomChain for Random {
    fn vec3(&mut self, size: f64) -> Vec3 {
        Vec3::from(self.within(size))
    }

    fn rotation(&mut self) -> Rotation {
        let axis = self.vec3(1.0).try_normalize().unwrap_or(Vec3::Z);
        match self.index(3) {
            0 => Rotation::from_axis_angle(Vec3::X, std::f64::consts::FRAC_PI_2),
            _ => Rotation::from_axis_angle(axis, self.between(-3.0, 3.0)),
        }
    }

    fn axis(&mut self) -> Vec3 {
        match self.index(3) {
            0 => Vec3::Z,
            1 => -Vec3::Y,
            _ => self.vec3(1.0).try_normalize().unwrap_or(Vec3::X),
        }
    }

    fn chain(&mut self, joints: usize, size: f64) -> Chain {
        let mut list: Vec<Joint> = Vec::new();
        for i in 0..joints {
            use JointKind::{Continuous, Fixed, Prismatic, Revolute};
            let kind = [Revolute, Revolute, Continuous, Continuous, Prismatic, Fixed][self.index(6)];
            let limits =
                if kind == Prismatic { Limits::range(-0.3 * size, 0.5 * size) } else { Limits::symmetric(3.0) };
            let source = (0..i).find(|&j| matches!(list[j].kind, Revolute | Continuous) && list[j].mimic.is_none());
            let mimic = source.filter(|_| kind != Fixed && self.index(6) == 0);
            let multiplier = if kind == Prismatic { 0.1 * size } else { -0.5 };
            // A slide that follows a revolute joint needs that joint's limits.
            let mimic = mimic.filter(|&j| kind != Prismatic || list[j].kind == Revolute);
            let mimic = mimic.map(|j| Mimic { joint: JointId(j), multiplier, offset: 0.1 });
            let parent = if i > 1 && self.index(5) == 0 { i - 2 } else { i };
            list.push(Joint {
                name: format!("joint {i}"),
                kind,
                parent: LinkId(parent),
                child: LinkId(i + 1),
                origin: Pose::new(self.rotation(), self.vec3(size)),
                axis: self.axis(),
                limits,
                mimic,
            });
        }
        let links = (0..=joints).map(|i| format!("link {i}")).collect();
        Chain::new("random", links, list).unwrap()
    }

    fn q(&mut self, chain: &Chain, unlimited: f64) -> Vec<f64> {
        let (lower, upper) = (chain.lower(), chain.upper());
        let ends = lower.iter().zip(&upper);
        ends.map(|(&l, &u)| if l.is_finite() { self.between(l, u) } else { self.between(-unlimited, unlimited) })
            .collect()
    }
}

/// A chain with a ball on every link, in single and in double precision.
struct Case {
    chain: Chain,
    base: Pose,
    covered: CoveredRobot,
    /// Centre of the ball of each link.
    centres: Vec<Vec3>,
    state: ChainState,
}

impl Case {
    fn new(random: &mut Random, joints: usize, size: f64) -> Self {
        let chain = random.chain(joints, size);
        let base = Pose::new(random.rotation(), random.vec3(size));
        let mut covered = CoveredRobot::without_pairs(&Robot::new(chain.clone()), base).unwrap();
        let centres: Vec<Vec3> = (0..=joints).map(|_| random.vec3(0.5 * size)).collect();
        let ball = Shape::Sphere(Sphere { radius: BALL_M });
        for (link, &centre) in centres.iter().enumerate() {
            covered.add_covered_link(&chain, LinkId(link), &[(&ball, Pose::from_translation(centre))]).unwrap();
        }
        for a in 0..=joints {
            for b in 0..a {
                covered.add_pair(CoveredLinkId(a), CoveredLinkId(b), 0.0);
            }
        }
        let state = ChainState::new(&chain);
        Self { chain, base, covered, centres, state }
    }

    fn workspace(&self) -> (MotionTable, Workspace) {
        let table = MotionTable::new(&self.covered);
        let workspace = Workspace::new(&self.covered, &table);
        (table, workspace)
    }

    fn set(&mut self, q: &[f64]) {
        self.state.q.copy_from_slice(q);
        self.chain.forward(&mut self.state);
    }

    fn in_world(&self, link: usize, p: Vec3) -> Vec3 {
        self.base.transform_point(self.state.link_in_root(LinkId(link)).transform_point(p))
    }

    /// Vector from the ball of one link to the ball of another, in the frame of the last link that carries both.
    fn between(&self, a: usize, b: usize) -> Vec3 {
        let (of_a, of_b) = (self.chain.path(LinkId(a)), self.chain.path(LinkId(b)));
        let common = of_a.iter().zip(&of_b).take_while(|(i, j)| i == j).last();
        let carrier = common.map_or(self.chain.root(), |(joint, _)| self.chain.joints()[joint.0].child);
        let rotation = self.base.rotation * self.state.link_in_root(carrier).rotation;
        rotation.inverse() * (self.in_world(a, self.centres[a]) - self.in_world(b, self.centres[b]))
    }

    /// Largest error of a ball's centre in a lane, as a fraction of the enlargement of its radius.
    fn worst_share(&self, workspace: &Workspace, lane: usize) -> f64 {
        let mut worst: f64 = 0.0;
        for (link, body) in self.covered.covered_links.iter().enumerate() {
            let node = &self.covered.nodes[body.nodes.start as usize];
            let centre = dispatch!(detected_simd_level(), simd => {
                let mut out = crate::lanes::PointRow::ZERO;
                out.store(workspace.frames[body.frame].point(simd, node.centre));
                out
            });
            let found = [0, 1, 2].map(|k| f64::from(centre.0[k].0[lane]));
            let error = self.in_world(link, self.centres[link]).distance(Vec3::new(found[0], found[1], found[2]));
            worst = worst.max(error / (f64::from(node.radius) - BALL_M));
        }
        worst
    }
}

#[test]
fn single_precision_stays_within_its_bound() {
    let mut random = Random(31);
    let (mut worst_state, mut worst_stretch): (f64, f64) = (0.0, 0.0);
    for round in 0..2500 {
        let joints = 1 + random.index(12);
        let size = [0.02, 0.4, 0.4, 3.0][round % 4];
        let mut case = Case::new(&mut random, joints, size);
        let (table, mut workspace) = case.workspace();
        let all: Vec<Vec<f64>> = (0..LANES).map(|_| random.q(&case.chain, 1000.0)).collect();
        for (lane, q) in all.iter().enumerate() {
            assert!(workspace.set_lane(&case.covered, lane, q));
        }
        let simd_level = detected_simd_level();
        dispatch!(simd_level, simd => case.covered.chain.forward(simd, &workspace.values, &mut workspace.frames));
        for (lane, q) in all.iter().enumerate() {
            case.set(q);
            worst_state = worst_state.max(case.worst_share(&workspace, lane));
        }
        let (from, mut to) = (&all[0], all[1].clone());
        for (to, from) in to.iter_mut().zip(from) {
            *to = from + (*to - from).clamp(-4.4, 4.4);
        }
        let stretch = Stretch { from, to: &to, begin: 0.0, end: 1.0 };
        assert!(workspace.set_stretch(&case.covered, &stretch));
        dispatch!(simd_level, simd => workspace.spread(simd, &case.covered, &table));
        dispatch!(simd_level, simd => case.covered.chain.forward(simd, &workspace.values, &mut workspace.frames));
        for lane in 0..LANES {
            let share = lane as f64 / INTERVALS as f64;
            let q: Vec<f64> = from.iter().zip(&to).map(|(a, b)| a + share * (b - a)).collect();
            case.set(&q);
            worst_stretch = worst_stretch.max(case.worst_share(&workspace, lane));
        }
    }
    println!("largest error as a share of the bound: states {worst_state:.3}, edges {worst_stretch:.3}");
    // The bound covers worst cases; random errors partly cancel.
    assert!(worst_state < 0.5 && worst_stretch < 0.7);
    assert!(worst_state > 0.01, "errors far below the bound: it can be smaller");
}

/// For points at equal fractions of an interval: the largest distance from the nearer end and from the chord.
fn chord_and_sag(points: &[Vec3]) -> (f64, f64) {
    let (first, last) = (points[0], points[points.len() - 1]);
    let mut most: (f64, f64) = (0.0, 0.0);
    for (i, p) in points.iter().enumerate() {
        let share = i as f64 / (points.len() - 1) as f64;
        most.0 = most.0.max(p.distance(first).min(p.distance(last)));
        most.1 = most.1.max(p.distance(first.lerp(last, share)));
    }
    most
}

/// Samples per interval.
const SAMPLES: usize = 16;

/// Samples three intervals of a stretch, compares with the bounds, and returns the largest fractions of the bounds seen.
fn compare_motion(case: &mut Case, from: &[f64], to: &[f64], random: &mut Random) -> [f64; 4] {
    let (table, mut workspace) = case.workspace();
    assert!(workspace.set_stretch(&case.covered, &Stretch { from, to, begin: 0.0, end: 1.0 }));
    dispatch!(detected_simd_level(), simd => workspace.spread(simd, &case.covered, &table));
    let links = case.centres.len();
    let pairs: Vec<(usize, usize, usize)> =
        case.covered.pairs.iter().enumerate().map(|(i, p)| (p.a.0, p.b.0, i)).collect();
    // A point on the surface of each ball, in addition to its centre.
    let on_ball: Vec<Vec3> =
        (0..links).map(|i| case.centres[i] + random.vec3(1.0).try_normalize().unwrap_or(Vec3::X) * BALL_M).collect();
    let mut most = [0.0_f64; 4];
    let share_of = |seen: f64, bound: f32| {
        let bound = f64::from(bound);
        assert!(seen <= bound + 1e-12, "{seen} is beyond {bound}");
        if bound > 1e-6 { seen / bound } else { 0.0 }
    };
    for interval in [0, random.index(INTERVALS), INTERVALS - 1] {
        let mut of_links = vec![Vec::new(); 2 * links];
        let mut of_pairs = vec![Vec::new(); pairs.len()];
        for i in 0..=SAMPLES {
            let share = (interval as f64 + i as f64 / SAMPLES as f64) / INTERVALS as f64;
            let q: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect();
            case.set(&q);
            for link in 0..links {
                of_links[2 * link].push(case.in_world(link, case.centres[link]));
                of_links[2 * link + 1].push(case.in_world(link, on_ball[link]));
            }
            for &(a, b, index) in &pairs {
                of_pairs[index].push(case.between(a, b));
            }
        }
        for (i, points) in of_links.iter().enumerate() {
            let (bound, seen) = (workspace.body_motion(i / 2), chord_and_sag(points));
            most[0] = most[0].max(share_of(seen.0, bound.0));
            most[1] = most[1].max(share_of(seen.1, bound.1));
        }
        for (&(_, _, index), points) in pairs.iter().zip(&of_pairs) {
            let common = case.covered.pairs[index].common_frame;
            let (bound, seen) = (workspace.pair_motion(table.pair(index), common), chord_and_sag(points));
            most[2] = most[2].max(share_of(seen.0, bound.0));
            most[3] = most[3].max(share_of(seen.1, bound.1));
        }
    }
    // No point moves farther than the bound of the whole edge.
    case.set(from);
    let before: Vec<Vec3> = (0..links).map(|l| case.in_world(l, on_ball[l])).collect();
    case.set(to);
    let whole = table.displacement_m(&case.covered.chain, from, to);
    for (link, p) in before.iter().enumerate() {
        assert!(p.distance(case.in_world(link, on_ball[link])) <= whole + 1e-12);
    }
    most
}

#[test]
fn no_point_leaves_its_chord_farther_than_the_bound() {
    let mut random = Random(77);
    let mut most = [0.0_f64; 4];
    for round in 0..700 {
        let joints = 1 + random.index(9);
        let mut case = Case::new(&mut random, joints, [0.3, 1.0][round % 2]);
        for largest in [0.05, 1.0, 4.4] {
            let (from, mut to) = (random.q(&case.chain, 30.0), random.q(&case.chain, 30.0));
            to.iter_mut().zip(&from).for_each(|(to, from)| *to = from + (*to - from).clamp(-largest, largest));
            // In many cases most joints rest.
            if round % 3 == 0 && !to.is_empty() {
                let moving = random.index(to.len());
                (0..to.len()).filter(|&i| i != moving).for_each(|i| to[i] = from[i]);
            }
            let seen = compare_motion(&mut case, &from, &to, &mut random);
            most.iter_mut().zip(seen).for_each(|(m, s)| *m = m.max(s));
        }
    }
    println!(
        "largest share of the bounds: covered_links, half chord {:.3}, deviation {:.3}; pairs {:.3}, {:.3}",
        most[0], most[1], most[2], most[3]
    );
    // The bounds are nearly reached.
    assert!(most.iter().all(|&m| m > 0.5), "{most:?}");
}

/// Revolute joints about z in a row, 0.5 m apart, with a ball 0.5 m beyond the last joint.
fn planar(joints: usize) -> Case {
    let list = (0..joints)
        .map(|i| Joint {
            name: format!("joint {i}"),
            kind: JointKind::Revolute,
            parent: LinkId(i),
            child: LinkId(i + 1),
            origin: Pose::from_translation(if i == 0 { Vec3::ZERO } else { Vec3::X * 0.5 }),
            axis: Vec3::Z,
            limits: Limits::symmetric(3.0),
            mimic: None,
        })
        .collect();
    let chain = Chain::new("planar", (0..=joints).map(|i| format!("link {i}")).collect(), list).unwrap();
    let mut covered = CoveredRobot::without_pairs(&Robot::new(chain.clone()), Pose::IDENTITY).unwrap();
    let ball = Shape::Sphere(Sphere { radius: BALL_M });
    let centres: Vec<Vec3> = (0..=joints).map(|_| Vec3::X * 0.5).collect();
    for link in 0..=joints {
        covered.add_covered_link(&chain, LinkId(link), &[(&ball, Pose::from_translation(centres[link]))]).unwrap();
    }
    let state = ChainState::new(&chain);
    Case { chain, base: Pose::IDENTITY, covered, centres, state }
}

#[test]
fn the_bounds_are_tight_in_simple_cases() {
    let mut random = Random(5);
    for (joints, least) in [(1, 0.85), (2, 0.6), (3, 0.5), (6, 0.3)] {
        let mut case = planar(joints);
        let seen = compare_motion(&mut case, &vec![-0.3; joints], &vec![0.3; joints], &mut random);
        println!("{joints} joints: {:.2} of the half chord, {:.2} of the deviation", seen[0], seen[1]);
        assert!(seen[0] > least && seen[1] > 0.7 * least, "{seen:?}");
    }
}
