//! Test that every field of a configuration is in its checksum. A new field fails to compile here until it is named.

use std::collections::HashMap;

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{
    Configuration, GridSpace, Guards, Laws, Life, OutputGrid, OutputGridAxis, Part, Presence, Region, RegionKind,
    SlotId, SourceId, StoppingSettings, Volume,
};

type Change = fn(&mut Configuration);

/// A change that the checksum must show, by name.
type Named = (&'static str, Change);

fn configuration() -> Configuration {
    let joint = |i: usize, mimic| Joint {
        name: format!("j{i}"),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(Vec3::new(0.1, 0.2, 0.3)),
        axis: Vec3::Z,
        limits: Limits { velocity: Some(1.0), acceleration: Some(5.0), effort: Some(9.0), ..Limits::symmetric(2.0) },
        mimic,
    };
    let mimic = Mimic { joint: JointId(0), multiplier: 2.0, offset: 0.5 };
    let links = (0..4).map(|i| format!("l{i}")).collect();
    let joints = vec![joint(0, None), joint(1, None), joint(2, Some(mimic))];
    let ball = Shape::Sphere(Sphere { radius: 0.1 });
    let (name, part, presence) = ("v".into(), Part::Arm, Presence::Always);
    let volume = Volume { name, part, link: LinkId(1), shape: ball.clone(), in_link: Pose::IDENTITY, presence };
    let region = Region {
        follow: Some(SourceId(0)),
        output: Some(1),
        warning_output: Some(2),
        ..Region::sphere("r", Vec3::X, 0.2).warning(0.3).kind(RegionKind::Monitored { slow_to: Some(0.5) })
    };
    let stopping = StoppingSettings {
        reaction_s: 0.01,
        period_s: 0.002,
        joint_deceleration: vec![3.0, 4.0],
        joint_acceleration: vec![5.0, 6.0],
    };
    Configuration {
        robot: "robot".into(),
        base_in_world: Pose::IDENTITY,
        chain: Chain::new("chain", links, joints).unwrap(),
        volumes: vec![volume.clone(), Volume { name: "w".into(), ..volume }],
        regions: vec![region.clone(), Region { name: "s".into(), ..region }],
        sources: vec!["belt".into(), "cart".into()],
        laws: Laws { stopping_distance: Some(stopping), ..Laws::default() },
        grids: vec![grid(GridSpace::Joints(vec![0, 1])), grid(GridSpace::Tcp { frame_in_world: Pose::IDENTITY })],
    }
}

fn grid(space: GridSpace) -> OutputGrid {
    let axis = |count: u32| OutputGridAxis { from: -1.0, to: 1.0, count };
    OutputGrid { name: "g".into(), space, axes: vec![axis(4), axis(3)], output: 8, hysteresis: 0.01 }
}

/// The chain again, with one joint changed.
fn joint(c: &mut Configuration, index: usize, change: impl FnOnce(&mut Joint)) {
    let mut joints = c.chain.joints().to_vec();
    change(&mut joints[index]);
    c.chain = Chain::new(c.chain.name(), c.chain.links().to_vec(), joints).unwrap();
}

fn moved() -> Pose {
    Pose::from_translation(Vec3::Y * 1e-9)
}

fn turned() -> Pose {
    Pose::new(Rotation::from_axis_angle(Vec3::Y, 1e-9), Vec3::ZERO)
}

fn top() -> Vec<Named> {
    // No `..`: a new field of a configuration must be added here, and to the changes below.
    let Configuration { robot: _, base_in_world: _, chain: _, volumes: _, regions: _, sources: _, laws: _, grids: _ } =
        configuration();
    vec![
        ("robot", |c| c.robot.push('x')),
        ("base moved", |c| c.base_in_world = moved()),
        ("base turned", |c| c.base_in_world = turned()),
        ("volume removed", |c| _ = c.volumes.pop()),
        ("volumes in another order", |c| c.volumes.reverse()),
        ("region removed", |c| _ = c.regions.pop()),
        ("regions in another order", |c| c.regions.reverse()),
        ("source removed", |c| _ = c.sources.pop()),
        ("source renamed", |c| c.sources[1].name.push('x')),
        ("source speed", |c| c.sources[1].limits.speed_m_s += 1e-9),
        ("source turn", |c| c.sources[1].limits.turn_rad_s += 1e-9),
        ("source wrap", |c| c.sources[1].limits.wrap_m = Some(Vec3::X)),
        ("names that run together", |c| c.sources = vec!["beltc".into(), "art".into()]),
    ]
}

fn of_chain() -> Vec<Named> {
    let chain = configuration().chain;
    let Joint { name: _, kind: _, parent: _, child: _, origin: _, axis: _, limits, mimic } = chain.joints()[2].clone();
    let Limits { lower: _, upper: _, velocity: _, acceleration: _, effort: _, overshoot_tolerance: _ } = limits;
    let Mimic { joint: _, multiplier: _, offset: _ } = mimic.unwrap();
    vec![
        ("link name", |c| {
            let mut links = c.chain.links().to_vec();
            links[1].push('x');
            c.chain = Chain::new(c.chain.name(), links, c.chain.joints().to_vec()).unwrap();
        }),
        ("joint name", |c| joint(c, 0, |j| j.name.push('x'))),
        ("fixed", |c| joint(c, 1, |j| j.kind = JointKind::Fixed)),
        ("continuous", |c| joint(c, 1, |j| j.kind = JointKind::Continuous)),
        ("prismatic", |c| joint(c, 1, |j| j.kind = JointKind::Prismatic)),
        ("parent", |c| joint(c, 2, |j| j.parent = LinkId(0))),
        ("children exchanged", |c| {
            joint(c, 2, |j| j.parent = LinkId(1));
            let mut joints = c.chain.joints().to_vec();
            (joints[1].child, joints[2].child) = (LinkId(3), LinkId(2));
            c.chain = Chain::new(c.chain.name(), c.chain.links().to_vec(), joints).unwrap();
        }),
        ("origin moved", |c| joint(c, 1, |j| j.origin.translation.z += 1e-9)),
        ("origin turned", |c| joint(c, 1, |j| j.origin = Pose::new(turned().rotation, j.origin.translation))),
        ("axis", |c| joint(c, 1, |j| j.axis = Vec3::X)),
        ("lower", |c| joint(c, 1, |j| j.limits.lower -= 1e-9)),
        ("upper", |c| joint(c, 1, |j| j.limits.upper += 1e-9)),
        ("velocity", |c| joint(c, 1, |j| j.limits.velocity = Some(1.0 + 1e-9))),
        ("velocity unknown", |c| joint(c, 1, |j| j.limits.velocity = None)),
        ("velocity 0", |c| joint(c, 1, |j| j.limits.velocity = Some(0.0))),
        ("overshoot", |c| joint(c, 1, |j| j.limits.overshoot_tolerance = Some(0.05))),
        ("overshoot 0", |c| joint(c, 1, |j| j.limits.overshoot_tolerance = Some(0.0))),
        ("mimic removed", |c| joint(c, 2, |j| j.mimic = None)),
        ("mimic of another", |c| joint(c, 2, |j| j.mimic = j.mimic.map(|m| Mimic { joint: JointId(1), ..m }))),
        ("mimic multiplier", |c| joint(c, 2, |j| j.mimic = j.mimic.map(|m| Mimic { multiplier: 2.1, ..m }))),
        ("mimic offset", |c| joint(c, 2, |j| j.mimic = j.mimic.map(|m| Mimic { offset: 0.6, ..m }))),
    ]
}

fn of_volume() -> Vec<Named> {
    let Volume { name: _, part: _, link: _, shape: _, in_link: _, presence: _ } = configuration().volumes.remove(0);
    vec![
        ("volume name", |c| c.volumes[0].name.push('x')),
        ("volume is the tcp", |c| c.volumes[0].part = Part::Tcp),
        ("volume is a tool", |c| c.volumes[0].part = Part::Tool),
        ("volume link", |c| c.volumes[0].link = LinkId(2)),
        ("volume shape", |c| c.volumes[0].shape = Shape::Sphere(Sphere { radius: 0.1 + 1e-9 })),
        ("volume moved", |c| c.volumes[0].in_link = moved()),
        ("volume turned", |c| c.volumes[0].in_link = turned()),
        ("volume attached at first", |c| c.volumes[0].presence = Presence::Attached),
        ("volume detached at first", |c| c.volumes[0].presence = Presence::Detached),
    ]
}

fn of_region() -> Vec<Named> {
    let Region {
        name: _,
        shape: _,
        anchor: _,
        shape_in_anchor: _,
        kind: _,
        life: _,
        warning_m: _,
        guards,
        follow: _,
        hysteresis_m: _,
        output: _,
        warning_output: _,
    } = configuration().regions.remove(0);
    let Guards { tcp: _, tool: _, arm: _ } = guards;
    vec![
        ("region name", |c| c.regions[0].name.push('x')),
        ("region shape", |c| c.regions[0].shape = Shape::Sphere(Sphere { radius: 0.2 - 1e-9 })),
        ("region moved", |c| c.regions[0].anchor = moved()),
        ("region turned", |c| c.regions[0].anchor = Pose::new(turned().rotation, c.regions[0].anchor.translation)),
        ("shape moved", |c| c.regions[0].shape_in_anchor = moved()),
        ("forbidden", |c| c.regions[0].kind = RegionKind::Forbidden),
        ("slow_to", |c| c.regions[0].kind = RegionKind::Monitored { slow_to: Some(0.6) }),
        ("slow_to 0", |c| c.regions[0].kind = RegionKind::Monitored { slow_to: Some(0.0) }),
        ("not slowed", |c| c.regions[0].kind = RegionKind::Monitored { slow_to: None }),
        ("exchange", |c| c.regions[0].kind = RegionKind::Exchange { slot: SlotId(0) }),
        ("another slot", |c| c.regions[0].kind = RegionKind::Exchange { slot: SlotId(1) }),
        ("life", |c| c.regions[0].life = Life::Temporary),
        ("warning", |c| c.regions[0].warning_m += 1e-9),
        ("guards tcp", |c| c.regions[0].guards.tcp ^= true),
        ("guards tool", |c| c.regions[0].guards.tool ^= true),
        ("guards arm", |c| c.regions[0].guards.arm ^= true),
        ("follow nothing", |c| c.regions[0].follow = None),
        ("follow another", |c| c.regions[0].follow = Some(SourceId(1))),
        ("hysteresis", |c| c.regions[0].hysteresis_m += 1e-9),
        ("output", |c| c.regions[0].output = Some(3)),
        ("no output", |c| c.regions[0].output = None),
        ("warning output", |c| c.regions[0].warning_output = Some(3)),
        ("no warning output", |c| c.regions[0].warning_output = None),
        ("outputs exchanged", |c| (c.regions[0].output, c.regions[0].warning_output) = (Some(2), Some(1))),
        ("the second region", |c| c.regions[1].warning_m += 1e-9),
    ]
}

fn of_grids() -> Vec<Named> {
    let OutputGrid { name: _, space: _, axes: _, output: _, hysteresis: _ } = grid(GridSpace::Joints(vec![]));
    vec![
        ("grid name", |c| c.grids[0].name.push('x')),
        ("grid of another joint", |c| c.grids[0].space = GridSpace::Joints(vec![0, 0])),
        ("grid of joints exchanged", |c| c.grids[0].space = GridSpace::Joints(vec![1, 0])),
        ("grid of the point", |c| c.grids[0].space = c.grids[1].space.clone()),
        ("grid moved", |c| c.grids[1].space = GridSpace::Tcp { frame_in_world: moved() }),
        ("grid from", |c| c.grids[0].axes[1].from += 1e-9),
        ("grid to", |c| c.grids[0].axes[1].to += 1e-9),
        ("grid cells", |c| c.grids[0].axes[1].count += 1),
        ("grid axes exchanged", |c| c.grids[0].axes.reverse()),
        ("grid output", |c| c.grids[0].output += 1),
        ("grid hysteresis", |c| c.grids[0].hysteresis += 1e-9),
        ("grid removed", |c| c.grids.truncate(1)),
        ("no grids", |c| c.grids.clear()),
    ]
}

fn of_laws() -> Vec<Named> {
    fn stopping(c: &mut Configuration) -> &mut StoppingSettings {
        c.laws.stopping_distance.as_mut().unwrap()
    }
    let Laws { direction_aware: _, recovery: _, stopping_distance, override_rate: _, stale_s: _ } =
        configuration().laws;
    let StoppingSettings { reaction_s: _, period_s: _, joint_deceleration: _, joint_acceleration: _ } =
        stopping_distance.unwrap();
    vec![
        ("direction_aware", |c| c.laws.direction_aware ^= true),
        ("recovery", |c| c.laws.recovery += 1e-9),
        ("no stopping distance", |c| c.laws.stopping_distance = None),
        ("reaction", |c| stopping(c).reaction_s += 1e-9),
        ("period", |c| stopping(c).period_s += 1e-9),
        ("acceleration", |c| stopping(c).joint_acceleration[1] += 1e-9),
        ("deceleration", |c| stopping(c).joint_deceleration[1] += 1e-9),
        ("decelerations exchanged", |c| stopping(c).joint_deceleration.reverse()),
        ("override_rate", |c| c.laws.override_rate += 1e-9),
        ("stale", |c| c.laws.stale_s += 1e-9),
    ]
}

/// Every kind of solid, and every number of each.
fn of_shapes() -> Vec<Named> {
    fn shape(c: &mut Configuration, shape: Shape) {
        c.regions[0].shape = shape;
    }
    fn corners(last: f64) -> Vec<Vec3> {
        vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.0, 0.0, last)]
    }
    const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    vec![
        ("capsule", |c| shape(c, Shape::Capsule(Capsule { half_length: 0.3, radius: 0.2 }))),
        ("longer capsule", |c| shape(c, Shape::Capsule(Capsule { half_length: 0.4, radius: 0.2 }))),
        ("thicker capsule", |c| shape(c, Shape::Capsule(Capsule { half_length: 0.3, radius: 0.25 }))),
        ("cylinder", |c| shape(c, Shape::Cylinder(Cylinder { half_length: 0.3, radius: 0.2 }))),
        ("longer cylinder", |c| shape(c, Shape::Cylinder(Cylinder { half_length: 0.4, radius: 0.2 }))),
        ("thicker cylinder", |c| shape(c, Shape::Cylinder(Cylinder { half_length: 0.3, radius: 0.25 }))),
        ("box", |c| shape(c, Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.1, 0.2, 0.3) }))),
        ("box turned", |c| shape(c, Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.3, 0.2, 0.1) }))),
        ("half-space", |c| shape(c, Shape::HalfSpace(HalfSpace))),
        ("hull", |c| shape(c, Shape::Hull(ConvexHull::from_points(&corners(1.0)).unwrap().into()))),
        ("other hull", |c| shape(c, Shape::Hull(ConvexHull::from_points(&corners(1.1)).unwrap().into()))),
        ("mesh", |c| shape(c, Shape::Mesh(TriMesh::new(corners(1.0), FACES.to_vec()).unwrap().into()))),
        ("other vertices", |c| shape(c, Shape::Mesh(TriMesh::new(corners(1.1), FACES.to_vec()).unwrap().into()))),
        ("other faces", |c| shape(c, Shape::Mesh(TriMesh::new(corners(1.0), FACES[..3].to_vec()).unwrap().into()))),
    ]
}

#[test]
fn a_change_of_any_field_changes_the_checksum() {
    let changes = [top(), of_chain(), of_volume(), of_region(), of_laws(), of_grids(), of_shapes()].concat();
    let base = configuration().checksum();
    assert_eq!(base, configuration().checksum());
    let mut by_checksum = HashMap::from([(base, "no change")]);
    for (name, change) in changes {
        let mut changed = configuration();
        change(&mut changed);
        if let Some(other) = by_checksum.insert(changed.checksum(), name) {
            panic!("`{name}` has the checksum of `{other}`");
        }
    }
}

/// Fields of a chain that no law reads: a change of them needs no new approval.
#[test]
fn what_decides_no_override_is_not_in_the_checksum() {
    let neutral: [Named; 4] = [
        ("name of the chain", |c| {
            c.chain = Chain::new("other", c.chain.links().to_vec(), c.chain.joints().to_vec()).unwrap();
        }),
        ("acceleration", |c| joint(c, 1, |j| j.limits.acceleration = None)),
        ("effort", |c| joint(c, 1, |j| j.limits.effort = None)),
        ("-0 for 0", |c| c.laws.override_rate = -0.0),
    ];
    for (name, change) in neutral {
        let mut changed = configuration();
        change(&mut changed);
        assert_eq!(changed.checksum(), configuration().checksum(), "{name}");
    }
}
