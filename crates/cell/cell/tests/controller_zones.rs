//! Regions as zones of a controller: what the text says, read back, is where the regions are.

use crate::common::zone_reader::{ReadZone, into_frame, krl, rapid, rotation};
use crate::common::{ARM, HEAD};
use elbowroom_cell::{Cell, ZoneExport, ZoneFrame, ZoneLanguage, export_zones};
use elbowroom_robot::RobotId;
use elbowroom_testkit::random::SplitMix;

const POINTS: usize = 2_000;
/// A border may be off by this, mm.
const BORDER_MM: f64 = 0.01;
/// Everything that the tool centre point of the arm reaches is as near as this to its base, mm.
const REACH_MM: f64 = 2_300.0;

fn cell(base: &str, tables: &str) -> Cell {
    let text = format!("{HEAD}[robot.arm]\n{base}\n{ARM}{tables}");
    Cell::parse("c.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn export(cell: &Cell, frame: Option<&str>, language: ZoneLanguage) -> ZoneExport {
    let frame = ZoneFrame::new(cell, RobotId(0), frame).unwrap();
    export_zones(cell, RobotId(0), &frame, language)
}

fn read(exported: &ZoneExport, language: ZoneLanguage) -> Vec<ReadZone> {
    let zones = match language {
        ZoneLanguage::Rapid => rapid(&exported.text),
        ZoneLanguage::Krl => krl(&exported.text),
    };
    let named: usize = exported.regions.iter().map(|region| region.zones.len()).sum();
    assert_eq!(named, zones.len(), "{}", exported.text);
    assert!(exported.regions.iter().flat_map(|r| &r.zones).all(|name| zones.iter().any(|zone| zone.name == *name)));
    zones
}

/// A solid in the world; mm and degrees, its rotation by rows.
#[derive(Debug, Clone, Copy)]
enum Solid {
    Sphere { center: [f64; 3], radius: f64 },
    Cylinder { base: [f64; 3], rows: [[f64; 3]; 3], radius: f64, height: f64 },
    Box { base: [f64; 3], rows: [[f64; 3]; 3], size: [f64; 3] },
    Plane { origin: [f64; 3], rows: [[f64; 3]; 3] },
}

impl Solid {
    /// Distance from the border, mm; negative inside.
    fn distance(&self, p: [f64; 3]) -> f64 {
        let beyond = |d: &[f64]| {
            let outside = d.iter().map(|v| v.max(0.0).powi(2)).sum::<f64>().sqrt();
            outside + d.iter().copied().fold(f64::NEG_INFINITY, f64::max).min(0.0)
        };
        match *self {
            Self::Sphere { center, radius } => (0..3).map(|i| (p[i] - center[i]).powi(2)).sum::<f64>().sqrt() - radius,
            Self::Cylinder { base, rows, radius, height } => {
                let q = into_frame(p, base, rows);
                beyond(&[q[0].hypot(q[1]) - radius, -q[2], q[2] - height])
            }
            Self::Box { base, rows, size } => {
                let q = into_frame(p, base, rows);
                beyond(&[q[0].abs() - size[0] / 2.0, q[1].abs() - size[1] / 2.0, -q[2], q[2] - size[2]])
            }
            Self::Plane { origin, rows } => into_frame(p, origin, rows)[2],
        }
    }

    /// Its keys in a cell file. The rotation is that of `rpy` (degrees), with which the rows were made.
    fn keys(&self, rpy: [f64; 3]) -> String {
        match self {
            Self::Sphere { center, radius } => {
                format!("shape = \"sphere\"\ncentre = {center:?}\nradius = {radius:?}\n")
            }
            Self::Cylinder { base, radius, height, .. } => format!(
                "shape = \"cylinder\"\nbase = {base:?}\nradius = {radius:?}\nheight = {height:?}\nrpy = {rpy:?}\n"
            ),
            Self::Box { base, size, .. } => {
                format!("shape = \"box\"\nbase = {base:?}\nsize = {size:?}\nrpy = {rpy:?}\n")
            }
            Self::Plane { origin: [x, y, z], .. } => {
                let (on_x, on_y) = ([x + 100.0, *y, *z], [*x, y + 100.0, *z]);
                format!("shape = \"plane\"\norigin = {:?}\nx = {on_x:?}\ny = {on_y:?}\nrpy = {rpy:?}\n", [x, y, z])
            }
        }
    }
}

/// The signed distance of the region from a point in the world: what is forbidden is negative.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    solid: Solid,
    keeps_inside: bool,
}

impl Drawn {
    fn distance(&self, p: [f64; 3]) -> f64 {
        if self.keeps_inside { -self.solid.distance(p) } else { self.solid.distance(p) }
    }
}

/// Roll, pitch and yaw of a rotation, in the order of `rpy` of a cell file, degrees.
fn rpy(rows: [[f64; 3]; 3]) -> [f64; 3] {
    let pitch = (-rows[2][0]).atan2(rows[0][0].hypot(rows[1][0]));
    [rows[2][1].atan2(rows[2][2]), pitch, rows[1][0].atan2(rows[0][0])].map(f64::to_degrees)
}

fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// A rotation that leaves the axes parallel: RAPID has zones of these only.
fn quarter_turns(random: &mut SplitMix) -> [[f64; 3]; 3] {
    let angle = |random: &mut SplitMix| 90.0 * random.below(4) as f64;
    rotation([angle(random), angle(random), angle(random)])
}

fn draw(random: &mut SplitMix, base_rows: [[f64; 3]; 3], language: ZoneLanguage) -> (Drawn, String) {
    let turn = match language {
        ZoneLanguage::Rapid => quarter_turns(random),
        ZoneLanguage::Krl => rotation(random.within(180.0)),
    };
    let rows = product(base_rows, turn);
    let at: [f64; 3] = random.within(1500.0);
    let between = |random: &mut SplitMix| random.between(20.0, 1500.0);
    let solid = match (language, random.below(4)) {
        (ZoneLanguage::Rapid, 0) => Solid::Sphere { center: at, radius: between(random) },
        (ZoneLanguage::Rapid, 1) => {
            // Upright in the frame of the zones, or upside down, and turned about its axis.
            let flip = rotation([random.between(-180.0, 180.0), 0.0, 180.0 * random.below(2) as f64]);
            let rows = product(base_rows, flip);
            Solid::Cylinder { base: at, rows, radius: between(random), height: between(random) }
        }
        // A plane may be turned about its normal.
        (_, 2) => Solid::Plane { origin: at, rows: product(rows, rotation([random.between(-180.0, 180.0), 0.0, 0.0])) },
        _ => Solid::Box { base: at, rows, size: [between(random), between(random), between(random)] },
    };
    let turned = match solid {
        Solid::Cylinder { rows, .. } | Solid::Box { rows, .. } | Solid::Plane { rows, .. } => rpy(rows),
        Solid::Sphere { .. } => [0.0; 3],
    };
    let keeps_inside = random.below(3) == 0;
    let keep = if keeps_inside { "keep = \"inside\"\n" } else { "" };
    (Drawn { solid, keeps_inside }, format!("{}{keep}", solid.keys(turned)))
}

/// Points near the base and near the border of a region.
fn points(random: &mut SplitMix, drawn: &Drawn, base: [f64; 3]) -> Vec<[f64; 3]> {
    let within_reach = |random: &mut SplitMix| loop {
        let d: [f64; 3] = random.within(REACH_MM);
        if d.iter().map(|v| v * v).sum::<f64>().sqrt() <= REACH_MM {
            return [0, 1, 2].map(|i| base[i] + d[i]);
        }
    };
    let mut points: Vec<_> = (0..POINTS / 2).map(|_| within_reach(random)).collect();
    while points.len() < POINTS {
        // Between a point inside and one outside lies the border; a solid may be far from the robot, or around it.
        let (mut a, mut b) = (within_reach(random), within_reach(random));
        if let Solid::Box { base, .. } | Solid::Cylinder { base, .. } | Solid::Sphere { center: base, .. } = drawn.solid
        {
            a = [0, 1, 2].map(|i| base[i] + random.between(-30.0, 30.0));
        }
        if (drawn.distance(a) < 0.0) == (drawn.distance(b) < 0.0) {
            points.push(a);
            continue;
        }
        for _ in 0..60 {
            let middle = [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]));
            if (drawn.distance(middle) < 0.0) == (drawn.distance(a) < 0.0) { a = middle } else { b = middle }
        }
        let step: [f64; 3] = random.within(0.05);
        points.push([0, 1, 2].map(|i| a[i] + step[i]));
    }
    points
}

/// Compares a region with its zone, read back from the text, at points. Counts the points inside, outside, near the border.
fn compare(
    random: &mut SplitMix,
    language: ZoneLanguage,
    (at, base_rpy): ([f64; 3], [f64; 3]),
    (drawn, keys): &(Drawn, String),
) -> [usize; 3] {
    let base_rows = rotation([base_rpy[2], base_rpy[1], base_rpy[0]]);
    let base = format!("base = {{ at = {at:?}, rpy = {base_rpy:?} }}");
    let tables = format!("[region.r]\n{keys}warning = 100\nguards = [\"tcp\"]\n");
    let exported = export(&cell(&base, &tables), None, language);
    let text = &exported.text;
    assert!(exported.is_complete(), "{tables}\n{text}");
    let zones = read(&exported, language);
    assert!(zones.len() == 1 && zones[0].stops && zones[0].is_on && zones[0].output.is_none());
    let mut counts = [0; 3];
    for p in points(random, drawn, at) {
        let distance = drawn.distance(p);
        let found = zones[0].contains(into_frame(p, at, base_rows));
        assert!(found || distance > 0.0, "{p:?} is {distance} mm inside, and not in the zone\n{tables}{text}");
        assert!(!found || distance < BORDER_MM, "{p:?} is {distance} mm off, and in the zone\n{tables}{text}");
        counts[usize::from(!found)] += 1;
        counts[2] += usize::from(distance.abs() < 0.05);
    }
    counts
}

#[test]
fn zones_contain_exactly_what_regions_contain() {
    for language in [ZoneLanguage::Rapid, ZoneLanguage::Krl] {
        let mut random = SplitMix(20);
        let mut sum = [0; 3];
        for _ in 0..80 {
            let (at, base_rpy): ([f64; 3], [f64; 3]) = (random.within(2000.0), random.within(180.0));
            let base_rows = rotation([base_rpy[2], base_rpy[1], base_rpy[0]]);
            let drawn = draw(&mut random, base_rows, language);
            let counts = compare(&mut random, language, (at, base_rpy), &drawn);
            sum = [0, 1, 2].map(|i| sum[i] + counts[i]);
        }
        assert!(sum[0] > 30_000 && sum[1] > 30_000 && sum[2] > 20_000, "{language:?}: {sum:?}");
    }
}

/// Where B is a right angle, A and C turn about one axis, and their sum alone is known.
#[test]
fn workspaces_with_a_right_angle_about_y_are_where_their_regions_are() {
    let mut random = SplitMix(22);
    for pitch in [90.0, -90.0, 89.999_999_9, -89.999_99, 90.000_001] {
        for (roll, yaw) in [(0.0, 0.0), (30.0, 20.0), (180.0, -90.0), (-75.0, 179.999_999)] {
            let rows = rotation([yaw, pitch, roll]);
            let solid = Solid::Box { base: [800.0, -300.0, 500.0], rows, size: [700.0, 300.0, 1100.0] };
            let drawn = (Drawn { solid, keeps_inside: false }, solid.keys([roll, pitch, yaw]));
            let counts = compare(&mut random, ZoneLanguage::Krl, ([0.0; 3], [0.0; 3]), &drawn);
            assert!(counts.iter().all(|count| *count > 200), "{counts:?}");
        }
    }
}

#[test]
fn warning_zones_enclose_the_warning_zones_of_regions() {
    const WARNING_MM: f64 = 150.0;
    for language in [ZoneLanguage::Rapid, ZoneLanguage::Krl] {
        let mut random = SplitMix(21);
        let mut written = 0;
        for _ in 0..80 {
            let (at, base_rpy): ([f64; 3], [f64; 3]) = (random.within(2000.0), random.within(180.0));
            let base_rows = rotation([base_rpy[2], base_rpy[1], base_rpy[0]]);
            let (drawn, keys) = draw(&mut random, base_rows, language);
            let base = format!("base = {{ at = {at:?}, rpy = {base_rpy:?} }}");
            let tables = format!(
                "[region.r]\n{keys}kind = \"monitored\"\nwarning = {WARNING_MM}\nwarning_output = 7\nguards = [\"tcp\"]\n"
            );
            let exported = export(&cell(&base, &tables), None, language);
            // What keeps inside of a thin solid has no place outside of its warning zone.
            let zones = read(&exported, language);
            let [zone] = &zones[..] else {
                assert!(drawn.keeps_inside && exported.text.contains("covers all that is free"), "{}", exported.text);
                continue;
            };
            assert!(!zone.stops && zone.output == Some(7) && exported.is_complete());
            written += 1;
            // Outside of a solid the edges are sharp, inside they are.
            let sharp = match drawn.solid {
                Solid::Box { .. } | Solid::Cylinder { .. } if !drawn.keeps_inside => 3.0_f64.sqrt(),
                _ => 1.0,
            };
            for p in points(&mut random, &drawn, at) {
                let distance = drawn.distance(p);
                let found = zone.contains(into_frame(p, at, base_rows));
                assert!(found || distance > WARNING_MM, "{p:?} {distance}\n{tables}{}", exported.text);
                assert!(
                    !found || distance < WARNING_MM * sharp + BORDER_MM,
                    "{p:?} {distance}\n{tables}{}",
                    exported.text
                );
            }
        }
        assert!(written > 60, "{written}");
    }
}

#[test]
fn a_fence_is_a_zone_per_part_of_its_walls() {
    let fence = "[fence.cell]\ncorners = [[-1200, -1800], [1900, -1800], [1900, 900], [-1200, 900]]\nheight = 2000\n\
                 gates = [{ from = [1900, -450], to = [1900, 450], top = 1000 }]\nwarning = 200\nguards = [\"tcp\"]\n";
    let cell = cell("base = { at = [300, 200, 100], rpy = [0, 0, 90] }", fence);
    for (language, parts) in [(ZoneLanguage::Rapid, 6), (ZoneLanguage::Krl, 6)] {
        let exported = export(&cell, None, language);
        assert!(exported.is_complete(), "{}", exported.text);
        let zones = read(&exported, language);
        assert_eq!(zones.len(), parts, "{}", exported.text);
        let is_in_wall = |p: [f64; 3]| {
            let q = into_frame(p, [300.0, 200.0, 100.0], rotation([90.0, 0.0, 0.0]));
            zones.iter().any(|zone| zone.stops && zone.contains(q))
        };
        assert!(
            is_in_wall([1925.0, -1000.0, 10.0])
                && is_in_wall([1925.0, 0.0, 1100.0])
                && is_in_wall([0.0, 949.9, 1999.0])
        );
        assert!(
            !is_in_wall([1925.0, 0.0, 990.0])
                && !is_in_wall([1899.9, -1000.0, 10.0])
                && !is_in_wall([0.0, 950.1, 10.0])
        );
    }
}

/// The comment of each wall names the direction to the inside, in the frame of the controller.
#[test]
fn the_walls_of_a_fence_say_which_side_is_inside() {
    let corners = [[-1200.0, -1800.0], [1900.0, -1800.0], [1900.0, 900.0], [-1200.0, 900.0]];
    for (turned_deg, reversed) in [(90.0, false), (90.0, true), (30.0, false)] {
        let mut corners = corners.to_vec();
        if reversed {
            corners.reverse();
        }
        let fence = format!("[fence.cell]\ncorners = {corners:?}\nheight = 2000\nwarning = 200\nguards = [\"tcp\"]\n");
        let cell = cell(&format!("base = {{ at = [300, 200, 100], rpy = [0, 0, {turned_deg:?}] }}"), &fence);
        let exported = export(&cell, None, ZoneLanguage::Krl);
        let zones = read(&exported, ZoneLanguage::Krl);
        let titles = exported.text.lines().filter(|line| line.contains("of its walls ("));
        let named: Vec<&str> =
            titles.map(|line| line.split_once("is towards ").unwrap().1.split_once(')').unwrap().0).collect();
        assert_eq!((zones.len(), named.len()), (4, 4), "{}", exported.text);
        for (name, zone) in named.iter().zip(&zones) {
            let axes = [("+X", [1.0, 0.0]), ("-X", [-1.0, 0.0]), ("+Y", [0.0, 1.0]), ("-Y", [0.0, -1.0])];
            let listed = || {
                let inner = name.trim_matches(['[', ']']).split(',');
                let numbers: Vec<f64> = inner.map(|n| n.parse().unwrap()).collect();
                [numbers[0], numbers[1]]
            };
            let inwards = axes.iter().find(|(axis, _)| axis == name).map_or_else(listed, |(_, v)| *v);
            // The middle of the area within, and the middle of the wall, both in the frame of the controller.
            let place = |p: [f64; 3]| into_frame(p, [300.0, 200.0, 100.0], rotation([turned_deg, 0.0, 0.0]));
            let middle = place([350.0, -450.0, 1000.0]);
            let is_of_wall = |i: usize| {
                let (a, b) = (corners[i], corners[(i + 1) % 4]);
                let wall = place([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 1000.0]);
                let step = |mm: f64| [wall[0] + mm * inwards[0], wall[1] + mm * inwards[1], wall[2]];
                let towards = (middle[0] - wall[0]) * inwards[0] + (middle[1] - wall[1]) * inwards[1];
                towards > 1000.0 && zone.contains(step(-25.0)) && !zone.contains(step(25.0))
            };
            assert_eq!((0..4).filter(|i| is_of_wall(*i)).count(), 1, "{name}: {}", exported.text);
        }
        assert!(exported.text.contains("The zones of a fence are its walls"), "{}", exported.text);
    }
    let without =
        export(&cell("", "[region.r]\nshape = \"box\"\nbase = [0, 0, 0]\nsize = [9, 9, 9]\n"), None, ZoneLanguage::Krl);
    assert!(!without.text.contains("fence"), "{}", without.text);
}

/// Angles of a cell file are rounded: a box may be turned by what no one means.
#[test]
fn a_turn_of_micrometres_is_enclosed_and_a_larger_one_is_refused() {
    let text = |turn_deg: f64, more: &str| {
        let table = format!(
            "[region.r]\nshape = \"box\"\nbase = [0, 0, 0]\nsize = [1000, 1000, 1000]\nrpy = [0, 0, {turn_deg:?}]\n"
        );
        export(&cell("", &format!("{table}{more}warning = 100\nguards = [\"tcp\"]\n")), None, ZoneLanguage::Rapid).text
    };
    // 40 micrometres at the corners, on either side of a right angle.
    for turn_deg in [90.0 + 3.99e-5_f64.to_degrees(), 90.0 - 3.99e-5_f64.to_degrees()] {
        let line = "WZBoxDef \\Inside, shape, [-500.044,-500.044,-0.044], [500.044,500.044,1000.044];";
        assert!(text(turn_deg, "").contains(line), "{}", text(turn_deg, ""));
        let line = "WZBoxDef \\Outside, shape, [-499.956,-499.956,0.044], [499.956,499.956,999.956];";
        assert!(text(turn_deg, "keep = \"inside\"\n").contains(line), "{}", text(turn_deg, "keep = \"inside\"\n"));
    }
    assert!(text(90.0 + 6e-5_f64.to_degrees(), "").contains("it is turned against the axes"));
    assert!(text(45.0, "").contains("it is turned against the axes"));
}

#[test]
fn the_frame_is_the_root_a_fixed_link_or_the_world() {
    let lamp =
        "[region.lamp]\nshape = \"sphere\"\ncentre = [500, 0, 900]\nradius = 80\nwarning = 100\nguards = [\"tcp\"]\n";
    let turned = cell("base = { at = [1000, 0, 0], rpy = [0, 0, 90] }", lamp);
    let text = |frame| export(&turned, frame, ZoneLanguage::Rapid).text;
    assert!(text(None).contains("WZSphDef \\Inside, shape, [0.000,500.000,900.000], 80.005;"), "{}", text(None));
    assert_eq!(text(None), text(Some("base")));
    assert!(text(Some("world")).contains("WZSphDef \\Inside, shape, [500.000,0.000,900.000], 80.005;"));
    assert!(text(Some("world")).contains("Millimetres and degrees in the world of the cell file"));
    let wrong = |name: &str| ZoneFrame::new(&turned, RobotId(0), Some(name)).unwrap_err().to_string();
    assert_eq!(
        wrong("link_2"),
        "c.toml:4: joints move the link \"link_2\", and zones have a fixed frame\n  write: base, or world"
    );
    assert!(
        wrong("bases").contains("has no link \"bases\"") && wrong("bases").contains("write: base"),
        "{}",
        wrong("bases")
    );
}

/// A forbidden box with an output, a monitored box that programs switch, and a region that the robot must not leave.
const THREE: &str = "[region.press]
shape = \"box\"
from = [500, -200, 0]
to = [900, 200, 700]
warning = 100
output = 3
guards = [\"tcp\"]
[region.cart]
shape = \"box\"
base = [0, 900, 0]
size = [400, 600, 800]
kind = \"monitored\"
life = \"temporary\"
warning = 50
output = 4
warning_output = 5
guards = [\"tcp\"]
[region.room]
shape = \"box\"
from = [-2000, -2000, -100]
to = [2000, 2000, 2500]
keep = \"inside\"
warning = 100
guards = [\"tcp\"]
";

#[test]
fn a_rapid_module_has_routines_for_power_on_and_for_temporary_zones() {
    let exported = export(&cell("", THREE), None, ZoneLanguage::Rapid);
    let code: Vec<_> = exported.text.lines().filter(|line| !line.trim_start().starts_with('!')).collect();
    let expected = r"MODULE ElbowroomZones

    VAR wzstationary wz1_press;
    VAR wzstationary wz2_press;
    VAR wztemporary wz3_cart;
    VAR wztemporary wz4_cart;
    VAR wzstationary wz5_room;

    PROC ElbowroomPowerOn()
        VAR shapedata shape;
        WZBoxDef \Inside, shape, [499.996,-200.004,-0.004], [900.004,200.004,700.004];
        WZLimSup \Stat, wz1_press, shape;
        WZDOSet \Stat, wz2_press \Inside, shape, doElbowroom3, 1;
        WZBoxDef \Outside, shape, [-1999.996,-1999.996,-99.996], [1999.996,1999.996,2499.996];
        WZLimSup \Stat, wz5_room, shape;
    ENDPROC

    PROC ElbowroomTemporaryZones()
        VAR shapedata shape;
        WZBoxDef \Inside, shape, [-200.004,599.996,-0.004], [200.004,1200.004,800.004];
        WZFree wz3_cart;
        WZDOSet \Temp, wz3_cart \Inside, shape, doElbowroom4, 1;
        WZDisable wz3_cart;
        WZBoxDef \Inside, shape, [-250.004,549.996,-50.004], [250.004,1250.004,850.004];
        WZFree wz4_cart;
        WZDOSet \Temp, wz4_cart \Inside, shape, doElbowroom5, 1;
        WZDisable wz4_cart;
    ENDPROC
ENDMODULE";
    assert_eq!(code.join("\n"), expected);
    assert!(exported.text.contains("    ! All regions of the robot are expressed.\n") && exported.is_complete());
    assert!(exported.text.contains("        ! region \"cart\", warning zone: monitored, temporary\n"));
    let zones = read(&exported, ZoneLanguage::Rapid);
    assert_eq!(zones.iter().map(|zone| zone.is_on).collect::<Vec<_>>(), [true, true, true, false, false]);
}

#[test]
fn krl_lines_have_a_workspace_per_zone_stops_first() {
    let exported = export(&cell("", THREE), None, ZoneLanguage::Krl);
    let code: Vec<_> = exported.text.lines().filter(|line| !line.starts_with(';')).collect();
    let expected = "
$WORKSPACE[1]={X 700.000,Y 0.000,Z 350.000,A 0.000000,B 0.000000,C 0.000000,X1 -200.004,Y1 -200.004,Z1 -350.004,X2 200.004,Y2 200.004,Z2 350.004,MODE #INSIDE_STOP}
$WORKSPACE[2]={X 0.000,Y 0.000,Z 1200.000,A 0.000000,B 0.000000,C 0.000000,X1 -1999.996,Y1 -1999.996,Z1 -1299.996,X2 1999.996,Y2 1999.996,Z2 1299.996,MODE #OUTSIDE_STOP}
$WORKSPACE[3]={X 0.000,Y 900.000,Z 400.000,A 0.000000,B 0.000000,C 0.000000,X1 -200.004,Y1 -300.004,Z1 -400.004,X2 200.004,Y2 300.004,Z2 400.004,MODE #OFF}
$WORKSPACE[4]={X 0.000,Y 900.000,Z 400.000,A 0.000000,B 0.000000,C 0.000000,X1 -250.004,Y1 -350.004,Z1 -450.004,X2 250.004,Y2 350.004,Z2 450.004,MODE #OFF}

SIGNAL $WORKSTATE1 $OUT[3]
SIGNAL $WORKSTATE3 $OUT[4]
SIGNAL $WORKSTATE4 $OUT[5]
";
    assert_eq!(code.join("\n"), expected);
    assert!(exported.text.contains("; on: $WORKSPACE[3].MODE=#INSIDE\n; off: $WORKSPACE[3].MODE=#OFF\n"));
    assert_eq!(read(&exported, ZoneLanguage::Krl).len(), 4);
}
