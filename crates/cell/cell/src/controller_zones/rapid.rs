//! World Zones of ABB RAPID.
//!
//! A shape is stored with `WZBoxDef`, `WZCylDef` or `WZSphDef`; `WZLimSup` stops the robot in it, `WZDOSet` sets a signal. A
//! stationary zone is defined in a routine of the event POWER ON; a temporary one by the program, which can disable it.

use std::fmt::Write as _;

use elbowroom_robot::RobotId;
use elbowroom_spatial::{Rotation, Vec3};

use super::outward::{interval_mm, nearest_mm, radius_mm, text as number, turn_m};
use super::region_zones::RegionZones;
use super::zone::{Side, Zone, ZoneSolid};
use super::zone_frame::ZoneFrame;
use super::zone_text::{head, missing, title};
use crate::Cell;

/// How far a solid may be turned against the axes, m at its corners: a right angle with four digits is, in most cells.
const TURN_M: f64 = 5e-5;
/// Shortest side of a box and height of a cylinder, and smallest radius, mm.
const LEAST_SIDE_MM: f64 = 10.0;
const LEAST_RADIUS_MM: f64 = 5.0;
/// Longest identifier.
const LONGEST_NAME: usize = 32;

/// The module, with the names of the zones.
pub(super) fn text(cell: &Cell, robot: RobotId, frame: &ZoneFrame, regions: &mut [RegionZones<'_>]) -> String {
    let mut module = Module::default();
    for zones in &mut *regions {
        for zone in std::mem::take(&mut zones.zones) {
            match definition(&zone) {
                Ok(definition) => module.add(zones, &zone, &definition),
                Err(reason) => {
                    let hint = "--frame, if the controller's world is turned as the region is; or a parallel box that encloses it";
                    zones.miss(&zone.part, &reason, Some(hint));
                }
            }
        }
    }
    module.text(&head(cell, robot, frame), &missing(regions))
}

/// The parts of a module.
#[derive(Debug, Default)]
struct Module {
    variables: String,
    stationary: String,
    temporary: String,
    zones: usize,
    sets_outputs: bool,
}

impl Module {
    fn add(&mut self, zones: &mut RegionZones<'_>, zone: &Zone, definition: &str) {
        let is_temporary = zones.is_temporary();
        self.sets_outputs |= zone.output.is_some();
        let (data, switch) = if is_temporary { ("wztemporary", "Temp") } else { ("wzstationary", "Stat") };
        let body = if is_temporary { &mut self.temporary } else { &mut self.stationary };
        let mut line = |text: String| {
            let _ = writeln!(body, "        {text}");
        };
        line(format!("! {}", title(zones, zone)));
        line(definition.to_owned());
        let output = zone.output.map(|output| format!("\\Inside, shape, doElbowroom{output}, 1"));
        let actions =
            [zone.stops.then(|| ("WZLimSup", ", shape".to_owned())), output.map(|o| ("WZDOSet", format!(" {o}")))];
        for (instruction, arguments) in actions.into_iter().flatten() {
            self.zones += 1;
            let name = variable(self.zones, zones.name());
            if is_temporary {
                // A zone is not defined again before it is erased, and `main` runs in cycles.
                line(format!("WZFree {name};"));
            }
            let _ = writeln!(self.variables, "    VAR {data} {name};");
            line(format!("{instruction} \\{switch}, {name}{arguments};"));
            if is_temporary {
                line(format!("WZDisable {name};"));
            }
            zones.written.push(name);
        }
    }

    fn text(&self, head: &[String], missing: &[String]) -> String {
        let mut text = "MODULE ElbowroomZones\n".to_owned();
        let notes = [
            Some(NOTE_OF_OPTION),
            Some(NOTE_OF_STATIONARY).filter(|_| !self.stationary.is_empty()),
            Some(NOTE_OF_TEMPORARY).filter(|_| !self.temporary.is_empty()),
            Some(NOTE_OF_OUTPUTS).filter(|_| self.sets_outputs),
        ];
        let (head, missing) = (head.iter().map(String::as_str), missing.iter().map(String::as_str));
        for line in head.chain(notes.into_iter().flatten()).chain(missing) {
            let _ = writeln!(text, "    ! {line}");
        }
        let _ = write!(text, "\n{}", self.variables);
        for (name, body) in [("ElbowroomPowerOn", &self.stationary), ("ElbowroomTemporaryZones", &self.temporary)] {
            if !body.is_empty() {
                let _ = write!(text, "\n    PROC {name}()\n        VAR shapedata shape;\n{body}    ENDPROC\n");
            }
        }
        text.push_str("ENDMODULE\n");
        text
    }
}

const NOTE_OF_OPTION: &str = "Needs the option World Zones.";
const NOTE_OF_STATIONARY: &str = "Connect ElbowroomPowerOn with the system event POWER ON, and restart.";
const NOTE_OF_TEMPORARY: &str =
    "Call ElbowroomTemporaryZones at the start of main: its zones are off until the program enables them (WZEnable).";
const NOTE_OF_OUTPUTS: &str =
    "doElbowroomN is output N of the cell file: a digital output whose access level is read-only for RAPID.";

/// A name that no other zone has: the number makes it unique.
fn variable(number: usize, region: &str) -> String {
    let name = region.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' });
    format!("wz{number}_{}", name.collect::<String>()).chars().take(LONGEST_NAME).collect()
}

/// The instruction that stores the shape of a zone.
///
/// # Errors
/// Why there is none.
fn definition(zone: &Zone) -> Result<String, String> {
    let side = match zone.side {
        Side::Inside => "Inside",
        Side::Outside => "Outside",
    };
    let turned = || "it is turned against the axes of the frame, and world zones are parallel to them".to_owned();
    let vanishes = || "it is too small".to_owned();
    let point = |[x, y, z]: [f64; 3]| format!("[{},{},{}]", number(x), number(y), number(z));
    match zone.solid {
        ZoneSolid::Cuboid { in_frame, half_extents } => {
            let half_extents = along_axes(in_frame.rotation, half_extents, zone.side).ok_or_else(turned)?;
            let (low, high) = (in_frame.translation - half_extents, in_frame.translation + half_extents);
            let along = |i: usize| interval_mm(zone.side, low[i], high[i]).ok_or_else(vanishes);
            let axes = [along(0)?, along(1)?, along(2)?];
            large_enough("sides", LEAST_SIDE_MM, axes.map(|[low, high]| high - low))?;
            Ok(format!("WZBoxDef \\{side}, shape, {}, {};", point(axes.map(|a| a[0])), point(axes.map(|a| a[1]))))
        }
        ZoneSolid::Sphere { center, radius_m } => {
            let radius = radius_mm(zone.side, radius_m).ok_or_else(vanishes)?;
            large_enough("radii", LEAST_RADIUS_MM, [radius])?;
            let center = point(center.to_array().map(nearest_mm));
            Ok(format!("WZSphDef \\{side}, shape, {center}, {};", number(radius)))
        }
        ZoneSolid::Cylinder { in_frame, radius_m, half_length_m } => {
            let axis = in_frame.rotation.z_axis();
            let turn_m = (axis - Vec3::Z * axis.z.signum()).length() * (radius_m + half_length_m);
            if !(turn_m <= TURN_M) {
                return Err(turned());
            }
            let grown_m = if zone.side == Side::Inside { turn_m } else { -turn_m };
            let radius = radius_mm(zone.side, radius_m + grown_m).ok_or_else(vanishes)?;
            let (half_m, center) = (half_length_m + grown_m, in_frame.translation);
            let [low, high] = interval_mm(zone.side, center.z - half_m, center.z + half_m).ok_or_else(vanishes)?;
            large_enough("radii", LEAST_RADIUS_MM, [radius])?;
            large_enough("heights", LEAST_SIDE_MM, [high - low])?;
            let base = point([nearest_mm(center.x), nearest_mm(center.y), low]);
            Ok(format!("WZCylDef \\{side}, shape, {base}, {}, {};", number(radius), number(high - low)))
        }
    }
}

/// Whether the controller takes a solid of these sizes, mm; else why not.
fn large_enough<const N: usize>(what: &str, least: f64, sizes: [f64; N]) -> Result<(), String> {
    match sizes.into_iter().find(|size| *size < least) {
        Some(size) => Err(format!("it has {} mm, and world zones have {what} of {least} mm or more", number(size))),
        None => Ok(()),
    }
}

/// Half extents along the axes of the frame, m: outwards from the box for its inside, else inwards. `None` if the box is
/// not parallel to them.
fn along_axes(rotation: Rotation, half_extents: Vec3, side: Side) -> Option<Vec3> {
    let axes = [0, 1, 2].map(|i| rotation.axis(i));
    let units = [Vec3::X, Vec3::Y, Vec3::Z];
    let largest = |axis: Vec3| (0..3).max_by(|i, j| axis[*i].abs().total_cmp(&axis[*j].abs())).unwrap_or(0);
    let nearest = axes.map(largest);
    let parallel = [0, 1, 2].map(|i| units[nearest[i]] * axes[i][nearest[i]].signum());
    let turned_m = turn_m(half_extents, axes, parallel);
    let are_different = nearest[0] != nearest[1] && nearest[1] != nearest[2] && nearest[2] != nearest[0];
    if !(turned_m <= TURN_M && are_different) {
        return None;
    }
    let mut along = [if side == Side::Inside { turned_m } else { -turned_m }; 3];
    for (half_extent, axis) in half_extents.to_array().into_iter().zip(nearest) {
        along[axis] += half_extent;
    }
    Some(Vec3::from(along))
}
