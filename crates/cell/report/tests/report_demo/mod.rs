//! A synthetic run after the paper's figure 12, without simulation, to test the report alone.

use elbowroom_cell::{CellGrid, CellRegionId};
use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
use elbowroom_monitor::{
    EventKind, GridSpace, Guards, Life, OutputGrid, OutputGridAxis, OverrideReason, RegionId, Volume,
};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape, Sphere, project_point};
use elbowroom_report::ReportScene;
use elbowroom_robot::{Collider, Robot, RobotId};
use elbowroom_scene::Object;
use elbowroom_sim::{
    Collision, EventRow, GoverningPoint, RecordedRegionKind, Recording, RegionPoses, RegionTrack, RobotTrack, RunEvent,
    Sample, Span, Stop, TickTimes,
};
use elbowroom_spatial::{Pose, Vec3};

const UPPER: f64 = 0.7;
const FORE: f64 = 0.9;
const SHOULDER_Z: f64 = 0.5;
const PATH_X: f64 = 0.9;
const PATH_Z: f64 = 0.55;

fn joint(name: &str, index: usize, at: Vec3, axis: Vec3) -> Joint {
    Joint {
        name: name.into(),
        kind: JointKind::Revolute,
        parent: LinkId(index),
        child: LinkId(index + 1),
        origin: Pose::from_translation(at),
        axis,
        limits: Limits::symmetric(3.2),
        mimic: None,
    }
}

fn bone(length: f64, radius: f64) -> Collider {
    let shape = Shape::Capsule(Capsule { half_length: 0.5 * length, radius });
    Collider { name: "bone".into(), shape, in_link: Pose::from_translation(Vec3::Z * (0.5 * length)) }
}

fn arm() -> Robot {
    let links = ["base", "turret", "upper", "fore"].map(String::from).to_vec();
    let joints = vec![
        joint("waist", 0, Vec3::Z * 0.3, Vec3::Z),
        joint("shoulder", 1, Vec3::Z * (SHOULDER_Z - 0.3), Vec3::Y),
        joint("elbow", 2, Vec3::Z * UPPER, Vec3::Y),
    ];
    let mut robot = Robot::new(Chain::new("arm", links, joints).unwrap());
    let base = Shape::Cylinder(Cylinder { half_length: 0.15, radius: 0.18 });
    robot.colliders[0].push(Collider {
        name: "base".into(),
        shape: base,
        in_link: Pose::from_translation(Vec3::Z * 0.15),
    });
    robot.colliders[1].push(bone(SHOULDER_Z - 0.3, 0.13));
    robot.colliders[2].push(bone(UPPER, 0.09));
    robot.colliders[3].push(bone(FORE - 0.15, 0.07));
    robot
}

/// Waist, shoulder, elbow that bring the end of the forearm to `p`.
fn reach(p: Vec3) -> Vec<f64> {
    let (r, z) = (p.x.hypot(p.y), p.z - SHOULDER_Z);
    let d = r.hypot(z).min(UPPER + FORE);
    let inner = ((UPPER * UPPER + FORE * FORE - d * d) / (2.0 * UPPER * FORE)).clamp(-1.0, 1.0).acos();
    let lift = ((UPPER * UPPER + d * d - FORE * FORE) / (2.0 * UPPER * d)).clamp(-1.0, 1.0).acos();
    vec![p.y.atan2(p.x), r.atan2(z) - lift, std::f64::consts::PI - inner]
}

/// The geometry.
pub fn scene() -> ReportScene {
    let tool = Collider {
        name: "gun".into(),
        shape: Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.04, 0.03, 0.07) }),
        in_link: Pose::from_translation(Vec3::Z * (FORE - 0.07)),
    };
    let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.3, 0.8, 0.15) });
    let in_world = Pose::from_translation(Vec3::new(1.35, 0.0, 0.15));
    ReportScene::new()
        .robot("ns16", &arm(), Pose::IDENTITY, LinkId(3), Pose::from_translation(Vec3::Z * FORE), &[tool])
        .guarded_by(vec![Volume::tcp(LinkId(3), Vec3::Z * FORE)])
        .object(&Object { name: "table".into(), shape: table, in_world })
}

fn column() -> (Shape, Pose) {
    let pose = Pose::from_translation(Vec3::new(PATH_X, 0.25, 0.5));
    (Shape::Cylinder(Cylinder { half_length: 0.5, radius: 0.15 }), pose)
}

/// The stop at the column, if the run is long enough for it.
/// A grid of boxes around the path.
fn grid() -> CellGrid {
    let axis = |from: f64, to: f64, count: u32| OutputGridAxis { from, to, count };
    let axes = vec![axis(0.0, 1.6, 4), axis(-1.6, 1.6, 8), axis(0.0, 1.6, 1)];
    let space = GridSpace::Tcp { frame_in_world: Pose::IDENTITY };
    let grid = OutputGrid { name: "area".into(), space, axes, output: 8, hysteresis: 0.0 };
    CellGrid { robot: RobotId(0), line: 1, grid }
}

fn stops(samples: &[Sample], name: &str, monitored: bool, end_s: f64) -> Vec<Stop> {
    let stopped = samples.iter().find(|s| monitored && s.speed_override < 1e-3);
    let stop = stopped.map(|s| Stop {
        from_s: s.t_s,
        to_s: end_s,
        by: Some(name.into()),
        part: Some("tcp".into()),
        point: Some(s.tcp),
        distance_m: s.distance_m,
    });
    stop.into_iter().collect()
}

/// The start, an arc to A, the line to B.
fn path(s: f64) -> Vec3 {
    let a = Vec3::new(PATH_X, -0.6, PATH_Z);
    if s < 0.6 {
        let start = Vec3::new(0.55, -0.35, 0.95);
        return start.lerp(a, s / 0.6) + Vec3::X * (0.06 * (std::f64::consts::PI * s / 0.6).sin());
    }
    a + Vec3::Y * (s - 0.6).min(1.3)
}

#[allow(clippy::too_many_lines)] // a table of values
/// A run of `ticks` ticks of 2 ms with the given name of the region.
pub fn recording(monitored: bool, ticks: usize, name: &str) -> Recording {
    let (shape, column_in_world) = column();
    let (tick_s, warning_m) = (0.002, 0.25);
    let (mut s, mut v) = (0.0_f64, 0.0_f64);
    let mut samples = Vec::new();
    let (mut warning, mut inside) = (Vec::new(), Vec::new());
    for i in 0..ticks {
        let t_s = tick_s * i as f64;
        let tcp = path(s);
        let distance = project_point(&shape, &column_in_world, tcp).signed_distance.max(0.0);
        let law = (distance / warning_m).min(1.0);
        let near = distance < warning_m;
        let remaining = (1.9 - s).max(0.0);
        let programmed = 0.5_f64.min((2.0 * remaining * 1.5).sqrt()).min(t_s * 1.5);
        let target = programmed * if monitored { law } else { 1.0 };
        v = target.clamp(v - 6.0 * tick_s, v + 2.0 * tick_s);
        warning.push((t_s, near));
        inside.push((t_s, distance <= 0.0));
        samples.push(Sample {
            t_s,
            q: reach(tcp),
            qd: vec![0.0; 2],
            intent: vec![0.0; 2],
            tcp,
            tcp_speed: v,
            programmed_speed: programmed,
            speed_override: law,
            region: near.then_some(CellRegionId(0)),
            distance_m: near.then_some(distance),
            governing: near.then_some(GoverningPoint { part: 0, point: tcp }),
            reason: if near { OverrideReason::Region(RegionId(0)) } else { OverrideReason::Free },
            outputs: u64::from(grid().grid.cell_at(&tcp.to_array(), 0)) << 8,
        });
        s += v * tick_s;
    }
    let end_s = tick_s * ticks as f64;
    let spans = |marks: &[(f64, bool)]| -> Vec<Span> {
        let on: Vec<f64> = marks.iter().filter(|m| m.1).map(|m| m.0).collect();
        let ends = on.first().zip(on.last());
        ends.map(|(&from_s, &to_s)| Span { robot: RobotId(0), from_s, to_s }).into_iter().collect()
    };
    let (warning_spans, inside_spans) = (spans(&warning), spans(&inside));
    let mut events = Vec::new();
    for (span, on, off) in warning_spans
        .iter()
        .map(|s| (s, EventKind::WarnIn, EventKind::WarnOut))
        .chain(inside_spans.iter().map(|s| (s, EventKind::OutputOn(0), EventKind::OutputOff(0))))
    {
        for (t_s, event) in [(span.from_s, on), (span.to_s, off)] {
            events.push(EventRow { t_s, robot: "ns16".into(), region: name.into(), event: RunEvent::Monitor(event) });
        }
    }
    let closest = samples.iter().filter_map(|s| s.distance_m).min_by(f64::total_cmp);
    let ball = (0..ticks).map(|i| Pose::from_translation(Vec3::new(0.2, 0.9 - 0.1 * tick_s * i as f64, 0.9))).collect();
    Recording {
        cell: "figure 12 demo".into(),
        checksum: "3fa94c0b7de2518896ab".repeat(3),
        tick_s,
        duration_s: end_s,
        end: elbowroom_sim::RunEnd::Finished,
        monitored,
        robots: vec![RobotTrack {
            absent_links: Vec::new(),
            name: "ns16".into(),
            flange: "tool0".into(),
            joints: ["waist", "shoulder", "elbow"].map(String::from).to_vec(),
            parts: vec!["tcp".into()],
            stops: stops(&samples, name, monitored, end_s),
            finished: !monitored,
            stopped_s: if monitored { 1.1 } else { 0.0 },
            min_override: samples.iter().map(|s| s.speed_override).fold(1.0, f64::min),
            samples,
            collisions: if monitored {
                vec![]
            } else {
                vec![Collision { t_s: 3.1, a: "ns16/fore".into(), b: "table".into() }]
            },
            avoidance: None,
            guidance: None,
            perception: None,
            ending: elbowroom_sim::RobotEnding::default(),
        }],
        grids: vec![grid()],
        objects: vec![],
        sensors: vec![],
        virtual_robots: vec![],
        deadlocks: vec![],
        regions: vec![
            RegionTrack {
                name: name.into(),
                kind: RecordedRegionKind::Forbidden,
                life: Life::Permanent,
                guards: Guards::TCP,
                robots: vec![RobotId(0)],
                warning_m,
                shape,
                poses: RegionPoses::Fixed(column_in_world),
                active: vec![(0.0, true)],
                min_distance_m: closest,
                entered: !inside_spans.is_empty(),
                warned_s: warning_spans.iter().map(|s| s.to_s - s.from_s).sum(),
                warning_spans,
                inside_spans,
            },
            RegionTrack {
                name: "drone".into(),
                kind: RecordedRegionKind::Monitored,
                life: Life::Temporary,
                guards: Guards::TCP,
                robots: vec![RobotId(0)],
                warning_m: 0.1,
                shape: Shape::Sphere(Sphere { radius: 0.12 }),
                poses: RegionPoses::Moving(ball),
                active: vec![(0.0, false), (1.0, true), (0.7 * end_s, false)],
                min_distance_m: Some(0.61),
                entered: false,
                warned_s: 0.0,
                warning_spans: vec![],
                inside_spans: vec![],
            },
        ],
        events,
        tick_ns: TickTimes { p50: 2_900, p99: 5_400, max: 21_000, count: ticks },
    }
}
