//! The zones that the regions of a robot ask for, in no particular language.

use elbowroom_monitor::{Guards, Region, RegionKind};
use elbowroom_proximity::Shape;
use elbowroom_robot::RobotId;
use elbowroom_spatial::Vec3;

use super::region_zones::RegionZones;
use super::zone::{ReachBall, Side, Zone, ZoneSolid};
use super::zone_frame::ZoneFrame;
use crate::reach::Reach;
use crate::{Cell, CellRegion, CellRegionId, FenceWall, Follow, RegionSolid, Units};

/// By how much boxes of planes exceed the reach of the robot, m: a longer tool of the controller is covered, too.
const BEYOND_REACH_M: f64 = 1.0;
/// The hysteresis of a region whose table states none, m. It is less than a controller's cycle resolves.
const DEFAULT_HYSTERESIS_M: f64 = 1e-3;

/// The zones of all regions that guard against a robot.
pub(super) fn requested_zones<'c>(cell: &'c Cell, robot: RobotId, frame: &ZoneFrame) -> Vec<RegionZones<'c>> {
    let reach = Reach::of(&cell.robots[robot.0], true);
    let ball = ReachBall {
        center: frame.in_world.inverse_transform_point(reach.base),
        radius_m: reach.radius_m + BEYOND_REACH_M,
    };
    let concerned = cell.regions.iter().enumerate().filter(|(_, region)| region.robots.contains(&robot));
    let mut all: Vec<_> = concerned
        .map(|(index, region)| {
            let mut zones = RegionZones::new(CellRegionId(index), region, &cell.file);
            request(&mut zones, cell, frame, ball);
            zones
        })
        .collect();
    drop_shared_outputs(&mut all);
    all
}

fn request(zones: &mut RegionZones<'_>, cell: &Cell, frame: &ZoneFrame, ball: ReachBall) {
    let region = &zones.region.region;
    if let Some(follow) = zones.region.follow {
        zones.miss("", &format!("it follows {}, and zones of a controller do not move", source(cell, follow)), None);
        return;
    }
    let stops = region.kind == RegionKind::Forbidden;
    let has_output = region.output.is_some() || region.warning_output.is_some();
    if matches!(region.kind, RegionKind::Exchange { .. }) {
        let what = "it is open to one robot at a time, and a zone of a controller asks for no grant";
        zones.miss("", what, Some("a handshake of the controllers beside its outputs, if it has any"));
    }
    if !stops && !has_output {
        if matches!(region.kind, RegionKind::Monitored { .. }) {
            zones.miss(
                "",
                "it has neither `output` nor `warning_output`, so that a zone has nothing to do",
                Some("output = 1"),
            );
        }
        return;
    }
    miss_keys(zones, has_output, cell.units);
    for RequestedSolid { part, solid, side, inwards } in solids(zones.region, frame, ball) {
        match solid {
            Ok(solid) => request_solid(zones, &Zone { solid, side, stops, output: None, part, inwards }),
            Err(reason) => zones.miss(&part, &reason, Some("a box that encloses it, as a region of its own")),
        }
    }
}

/// The zones of a solid of a region, which is given as a zone without output: itself, and its warning zone.
fn request_solid(zones: &mut RegionZones<'_>, of: &Zone) {
    let region = &zones.region.region;
    if of.stops || region.output.is_some() {
        zones.zones.push(Zone { output: region.output, ..of.clone() });
    }
    let Some(output) = region.warning_output else { return };
    let part = if of.part.is_empty() { "warning zone".to_owned() } else { format!("warning zone of {}", of.part) };
    let by_m = match of.side {
        Side::Inside => region.warning_m,
        Side::Outside => -region.warning_m,
    };
    let Some(solid) = of.solid.grown(by_m) else {
        zones.miss(&part, "it covers all that is free: its output would always be on", Some("a smaller `warning`"));
        return;
    };
    zones.zones.push(Zone { solid, stops: false, output: Some(output), part, ..of.clone() });
}

/// Notes the keys of a region that no zone has.
fn miss_keys(zones: &mut RegionZones<'_>, has_output: bool, units: Units) {
    let region = &zones.region.region;
    if let Some(parts) = unguarded(region.guards) {
        let what = format!("a zone watches the tool centre point, and does not guard {parts}");
        zones.miss("", &what, Some("a larger region for the controller, with guards = [\"tcp\"]"));
    }
    if let RegionKind::Monitored { slow_to: Some(slow_to) } = region.kind {
        let what = format!("`slow_to` has no counterpart: a zone does not limit the override to {} %", slow_to * 100.0);
        zones.miss("", &what, None);
    }
    if has_output && (region.hysteresis_m - DEFAULT_HYSTERESIS_M).abs() > 1e-12 {
        let shown = units.show_length(region.hysteresis_m);
        zones.miss(
            "",
            &format!("`hysteresis` has no counterpart: an output falls at the border, not {shown} beyond"),
            None,
        );
    }
}

/// The guarded parts beside the tool centre point.
fn unguarded(guards: Guards) -> Option<&'static str> {
    match (guards.tool, guards.arm) {
        (false, false) => None,
        (true, false) => Some("the tool"),
        (false, true) => Some("the arm"),
        (true, true) => Some("the tool and the arm"),
    }
}

/// A solid of a region in the frame of the zones.
struct RequestedSolid {
    /// Which part of the region it is; empty for the whole of it.
    part: String,
    /// The solid, or why no controller has such a zone.
    solid: Result<ZoneSolid, String>,
    side: Side,
    /// For a wall of a fence: the direction to the inside.
    inwards: Option<Vec3>,
}

/// The solids of a region in the frame of the zones.
fn solids(region: &CellRegion, frame: &ZoneFrame, ball: ReachBall) -> Vec<RequestedSolid> {
    let Region { shape, anchor, shape_in_anchor, .. } = &region.region;
    let in_frame = frame.in_world.inverse_mul(&(*anchor * *shape_in_anchor));
    let whole = |shape: &Shape, side| {
        let solid = ZoneSolid::new(shape, in_frame, ball);
        vec![RequestedSolid { part: String::new(), solid, side, inwards: None }]
    };
    match &region.solid {
        RegionSolid::Shape => whole(shape, Side::Inside),
        RegionSolid::AllBut(kept_in) => whole(kept_in, Side::Outside),
        RegionSolid::Walls(walls) => {
            let wall = |(index, wall): (usize, &FenceWall)| RequestedSolid {
                part: format!("part {} of its walls", index + 1),
                solid: ZoneSolid::new(&Shape::Cuboid(wall.solid), frame.in_world.inverse_mul(&wall.in_world), ball),
                side: Side::Inside,
                inwards: Some(frame.in_world.inverse_transform_vector(-wall.outwards)),
            };
            walls.iter().enumerate().map(wall).collect()
        }
    }
}

fn source(cell: &Cell, follow: Follow) -> String {
    match follow {
        Follow::Robot { robot, .. } => format!("robot \"{}\"", cell.robots[robot.0].name),
        Follow::Encoder(i) => format!("encoder \"{}\"", cell.frame_sources.encoders[i].name),
        Follow::Object(id) => format!("object \"{}\"", cell.objects[id.0].name),
        Follow::Poses(_) => "a file of poses".to_owned(),
    }
}

/// Takes away outputs that several zones would set: each would lower it while the robot is still in another one, and an
/// output that is wrongly off reads as free.
fn drop_shared_outputs(all: &mut [RegionZones<'_>]) {
    let mut uses = [0_usize; 256];
    for zone in all.iter().flat_map(|zones| &zones.zones) {
        if let Some(output) = zone.output {
            uses[usize::from(output)] += 1;
        }
    }
    for zones in all {
        let mut dropped = Vec::new();
        for zone in &mut zones.zones {
            if let Some(output) = zone.output.filter(|output| uses[usize::from(*output)] > 1) {
                zone.output = None;
                dropped.push(output);
            }
        }
        zones.zones.retain(|zone| zone.stops || zone.output.is_some());
        dropped.sort_unstable();
        dropped.dedup();
        for output in dropped {
            let count = uses[usize::from(output)];
            let what = format!(
                "output {output} is not set: {count} zones have it, and each would lower it while the robot is in another one"
            );
            let hint = "an output for each zone: for each region, and `warning_output` beside `output`; one box, not the walls of a fence";
            zones.miss("", &what, Some(hint));
        }
    }
}
