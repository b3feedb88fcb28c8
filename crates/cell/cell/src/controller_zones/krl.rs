//! Cartesian workspaces of KUKA KRL.
//!
//! `$WORKSPACE[1]` to `[8]`, in `$custom.dat`: a box from `X1,Y1,Z1` to `X2,Y2,Z2` in the frame `X,Y,Z,A,B,C` of the world,
//! where A turns about z, B about the new y, and C about the new x. Programs may write its `MODE`. `$WORKSTATE1` to `8` are
//! signals of `$machine.dat`, on while the mode's condition holds.

use std::fmt::Write as _;

use elbowroom_robot::RobotId;
use elbowroom_spatial::{Rotation, Vec3};

use super::outward::{interval_mm, nearest_mm, text as number, turn_m};
use super::region_zones::RegionZones;
use super::zone::{Side, Zone, ZoneSolid};
use super::zone_frame::ZoneFrame;
use super::zone_text::{head, missing, title};
use crate::Cell;

/// Number of Cartesian workspaces.
const WORKSPACES: usize = 8;

const NOTES: [&str; 3] = [
    "Since KSS 8 the controller watches the flange and, to stop, the wrist as well: it may stop before the tool centre",
    "point is at the border, and a robot that has to stay inside of a workspace needs the flange inside of it, too.",
    "Numbers of workspaces and outputs that the cell uses already have to be changed in this text.",
];
const NOTE_OF_OUTPUTS: &str = "$OUT[N] is output N of the cell file.";

/// The lines of the data files, with the names of the zones.
pub(super) fn text(cell: &Cell, robot: RobotId, frame: &ZoneFrame, regions: &mut [RegionZones<'_>]) -> String {
    let mut files = DataFiles::default();
    let mut boxes: Vec<Vec<(Zone, Workspace)>> = regions.iter_mut().map(workspaces).collect();
    // What stops a robot has the first claim to the workspaces.
    for stops in [true, false] {
        for (zones, boxes) in regions.iter_mut().zip(&mut boxes) {
            let now: Vec<_> = boxes.extract_if(.., |(zone, _)| zone.stops == stops).collect();
            let left = WORKSPACES - files.count;
            if now.len() > left {
                let what = match now.len() {
                    1 => format!("it takes a workspace, and none of the {WORKSPACES} is free"),
                    count => format!("it takes {count} workspaces, and {left} of the {WORKSPACES} are free"),
                };
                let part = if stops { "" } else { "outputs" };
                zones.miss(part, &what, Some("fewer regions, or a box that encloses several"));
                continue;
            }
            for (zone, workspace) in now {
                files.add(zones, &zone, &workspace);
            }
        }
    }
    files.text(&head(cell, robot, frame), &missing(regions))
}

/// The zones of a region that workspaces can express; notes the others.
fn workspaces(zones: &mut RegionZones<'_>) -> Vec<(Zone, Workspace)> {
    let mut found = Vec::new();
    for mut zone in std::mem::take(&mut zones.zones) {
        if zone.output == Some(0) {
            zone.output = None;
            zones.miss(&zone.part, "output 0 is not set: the first output is $OUT[1]", Some("an output from 1 to 63"));
            if !zone.stops {
                continue;
            }
        }
        match Workspace::new(&zone) {
            Ok(workspace) => found.push((zone, workspace)),
            Err(reason) => zones.miss(&zone.part, &reason, Some("a box that encloses it, as a region of its own")),
        }
    }
    found
}

/// The numbers of a workspace, in mm and degrees.
#[derive(Debug, Clone, Copy)]
struct Workspace {
    origin: [f64; 3],
    abc: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
}

impl Workspace {
    fn new(zone: &Zone) -> Result<Self, String> {
        let ZoneSolid::Cuboid { in_frame, half_extents } = zone.solid else {
            return Err(format!("a workspace is a box, and this is a {}", zone.solid.name()));
        };
        let [roll, pitch, yaw] = in_frame.rotation.to_rpy();
        let abc = [yaw, pitch, roll].map(|angle| (angle.to_degrees() * 1e6).round() / 1e6);
        let origin = in_frame.translation.to_array().map(nearest_mm);
        let [a, b, c] = abc.map(f64::to_radians);
        let written = Rotation::from_rpy(c, b, a);
        let axes = |rotation: Rotation| [0, 1, 2].map(|i| rotation.axis(i));
        let moved_m = turn_m(half_extents, axes(in_frame.rotation), axes(written))
            + (in_frame.translation - Vec3::from(origin) * 1e-3).length();
        let grown_m = if zone.side == Side::Inside { moved_m } else { -moved_m };
        let along = |i: usize| {
            let half_m = half_extents[i] + grown_m;
            interval_mm(zone.side, -half_m, half_m).ok_or_else(|| "it is too small".to_owned())
        };
        let axes = [along(0)?, along(1)?, along(2)?];
        Ok(Self { origin, abc, low: axes.map(|a| a[0]), high: axes.map(|a| a[1]) })
    }

    fn text(&self, mode: &str) -> String {
        let mut text = String::new();
        let mut fields = |names: [&str; 3], numbers: [String; 3]| {
            for (name, value) in names.iter().zip(numbers) {
                let _ = write!(text, "{name} {value},");
            }
        };
        fields(["X", "Y", "Z"], self.origin.map(number));
        fields(["A", "B", "C"], self.abc.map(|degrees| format!("{:.6}", degrees + 0.0)));
        fields(["X1", "Y1", "Z1"], self.low.map(number));
        fields(["X2", "Y2", "Z2"], self.high.map(number));
        format!("{{{text}MODE {mode}}}")
    }
}

/// The lines of the data files.
#[derive(Debug, Default)]
struct DataFiles {
    custom: String,
    machine: String,
    program: String,
    count: usize,
}

impl DataFiles {
    fn add(&mut self, zones: &mut RegionZones<'_>, zone: &Zone, workspace: &Workspace) {
        self.count += 1;
        let (name, title) = (format!("$WORKSPACE[{}]", self.count), title(zones, zone));
        let mode = match (zone.side, zone.stops) {
            (Side::Inside, true) => "#INSIDE_STOP",
            (Side::Inside, false) => "#INSIDE",
            (Side::Outside, true) => "#OUTSIDE_STOP",
            (Side::Outside, false) => "#OUTSIDE",
        };
        let initial = if zones.is_temporary() { "#OFF" } else { mode };
        let _ = writeln!(self.custom, "; {title}\n{name}={}", workspace.text(initial));
        if let Some(output) = zone.output {
            let _ = writeln!(self.machine, "; {title}\nSIGNAL $WORKSTATE{} $OUT[{output}]", self.count);
        }
        if zones.is_temporary() {
            let _ = writeln!(self.program, "; {title}\n; on: {name}.MODE={mode}\n; off: {name}.MODE=#OFF");
        }
        zones.written.push(name);
    }

    fn text(&self, head: &[String], missing: &[String]) -> String {
        let mut text = String::new();
        let of_outputs = Some(NOTE_OF_OUTPUTS).filter(|_| !self.machine.is_empty());
        let notes = NOTES.into_iter().chain(of_outputs);
        for line in head.iter().map(String::as_str).chain(notes).chain(missing.iter().map(String::as_str)) {
            let _ = writeln!(text, "; {line}");
        }
        let sections = [
            ("In $custom.dat, in place of the lines of these workspaces:", &self.custom),
            ("In $machine.dat, in place of the lines of these signals:", &self.machine),
            ("In programs, to switch temporary regions:", &self.program),
        ];
        for (title, lines) in sections.iter().filter(|(_, lines)| !lines.is_empty()) {
            let _ = write!(text, "\n; {title}\n{lines}");
        }
        text
    }
}
