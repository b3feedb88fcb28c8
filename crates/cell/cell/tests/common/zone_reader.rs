//! Reads zones back from the text for a controller, with arithmetic of its own.

use std::collections::BTreeMap;

/// A zone as its controller understands it; mm and degrees.
#[derive(Debug, Clone)]
pub struct ReadZone {
    pub name: String,
    pub shape: ReadShape,
    pub is_outside: bool,
    pub stops: bool,
    pub output: Option<u8>,
    pub is_on: bool,
}

#[derive(Debug, Clone, Copy)]
pub enum ReadShape {
    Box {
        low: [f64; 3],
        high: [f64; 3],
    },
    Sphere {
        center: [f64; 3],
        radius: f64,
    },
    /// Upright, from the centre of its bottom.
    Cylinder {
        base: [f64; 3],
        radius: f64,
        height: f64,
    },
    /// A box in a frame.
    Workspace {
        origin: [f64; 3],
        abc: [f64; 3],
        low: [f64; 3],
        high: [f64; 3],
    },
}

/// The rotation `Rz(a)·Ry(b)·Rx(c)` by rows; degrees.
pub fn rotation([a, b, c]: [f64; 3]) -> [[f64; 3]; 3] {
    let [(sa, ca), (sb, cb), (sc, cc)] = [a, b, c].map(|v| v.to_radians().sin_cos());
    [
        [ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc],
        [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc],
        [-sb, cb * sc, cb * cc],
    ]
}

/// A point in the frame at `origin` with these rows of its rotation.
pub fn into_frame(p: [f64; 3], origin: [f64; 3], rows: [[f64; 3]; 3]) -> [f64; 3] {
    let d = [0, 1, 2].map(|i| p[i] - origin[i]);
    [0, 1, 2].map(|i| rows[0][i] * d[0] + rows[1][i] * d[1] + rows[2][i] * d[2])
}

impl ReadZone {
    /// Whether a tool centre point (mm, in the controller's world) is in the zone.
    pub fn contains(&self, p: [f64; 3]) -> bool {
        let within = |p: [f64; 3], low: [f64; 3], high: [f64; 3]| (0..3).all(|i| p[i] >= low[i] && p[i] <= high[i]);
        let is_in_solid = match self.shape {
            ReadShape::Box { low, high } => within(p, low, high),
            ReadShape::Sphere { center, radius } => {
                (0..3).map(|i| (p[i] - center[i]).powi(2)).sum::<f64>().sqrt() <= radius
            }
            ReadShape::Cylinder { base, radius, height } => {
                (p[0] - base[0]).hypot(p[1] - base[1]) <= radius && p[2] >= base[2] && p[2] <= base[2] + height
            }
            ReadShape::Workspace { origin, abc, low, high } => within(into_frame(p, origin, rotation(abc)), low, high),
        };
        is_in_solid != self.is_outside
    }
}

fn numbers(text: &str) -> Vec<f64> {
    let number = |v: &str| v.trim().parse().unwrap_or_else(|e| panic!("{text}: {v}: {e}"));
    text.split(',').map(number).collect()
}

/// Reads a RAPID module: every line has to be one that a module of world zones has.
pub fn rapid(text: &str) -> Vec<ReadZone> {
    assert!(text.is_ascii() && text.starts_with("MODULE ElbowroomZones\n") && text.ends_with("ENDMODULE\n"), "{text}");
    let mut declared = BTreeMap::new();
    let (mut routine, mut shape): (Option<String>, Option<(ReadShape, bool)>) = (None, None);
    let mut zones: Vec<ReadZone> = Vec::new();
    for line in text.lines().map(str::trim) {
        if line.starts_with('!') || line.is_empty() || ["MODULE ElbowroomZones", "ENDMODULE"].contains(&line) {
            continue;
        }
        if let Some(name) = line.strip_prefix("PROC ") {
            routine = Some(name.to_owned());
            continue;
        }
        if line == "ENDPROC" {
            assert!(routine.take().is_some(), "{text}");
            continue;
        }
        let line = line.strip_suffix(';').unwrap_or_else(|| panic!("no end: {line}"));
        let (word, rest) = line.split_once(' ').unwrap_or_else(|| panic!("{line}"));
        let arguments: Vec<&str> = rest.split(", ").collect();
        match (word, &arguments[..]) {
            ("VAR", ["shapedata shape"]) => assert!(routine.is_some()),
            ("VAR", [data]) => {
                let (data, name) = data.split_once(' ').unwrap();
                assert!(routine.is_none() && name.len() <= 32 && declared.insert(name, data).is_none(), "{line}");
            }
            ("WZBoxDef" | "WZSphDef" | "WZCylDef", [side, "shape", given @ ..]) => {
                let given: Vec<Vec<f64>> =
                    given.iter().map(|v| numbers(v.trim_start_matches('[').trim_end_matches(']'))).collect();
                let point = |i: usize| [given[i][0], given[i][1], given[i][2]];
                let read = match word {
                    "WZBoxDef" => ReadShape::Box { low: point(0), high: point(1) },
                    "WZSphDef" => ReadShape::Sphere { center: point(0), radius: given[1][0] },
                    _ => ReadShape::Cylinder { base: point(0), radius: given[1][0], height: given[2][0] },
                };
                assert!(["\\Inside", "\\Outside"].contains(side), "{line}");
                shape = Some((read, *side == "\\Outside"));
            }
            ("WZLimSup" | "WZDOSet", [life, action @ ..]) => {
                let (shape, is_outside) = shape.unwrap();
                let (name, stops, output) = match (word, action) {
                    ("WZLimSup", [name, "shape"]) => (*name, true, None),
                    ("WZDOSet", [name, "shape", output, "1"]) => {
                        let output = output.strip_prefix("doElbowroom").unwrap().parse().unwrap();
                        (name.strip_suffix(" \\Inside").unwrap(), false, Some(output))
                    }
                    _ => panic!("{line}"),
                };
                let (data, of_routine) = match *life {
                    "\\Stat" => ("wzstationary", "ElbowroomPowerOn()"),
                    "\\Temp" => ("wztemporary", "ElbowroomTemporaryZones()"),
                    _ => panic!("{line}"),
                };
                assert_eq!((declared.get(name), routine.as_deref()), (Some(&data), Some(of_routine)), "{line}");
                zones.push(ReadZone { name: name.to_owned(), shape, is_outside, stops, output, is_on: true });
            }
            ("WZFree", [name]) => {
                assert_eq!(declared.get(name), Some(&"wztemporary"), "{line}");
                assert!(zones.iter().all(|zone| zone.name != *name), "erased before it is defined: {line}");
            }
            ("WZDisable", [name]) => {
                assert_eq!(declared.get(name), Some(&"wztemporary"), "{line}");
                zones.iter_mut().find(|zone| zone.name == *name).unwrap().is_on = false;
            }
            _ => panic!("not an instruction of world zones: {line}"),
        }
    }
    assert_eq!(zones.len(), declared.len(), "every variable is used once");
    zones
}

/// Reads lines of `$custom.dat` and `$machine.dat`: every line has to be one of a workspace.
pub fn krl(text: &str) -> Vec<ReadZone> {
    assert!(text.is_ascii());
    let mut zones: Vec<ReadZone> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with(';') && !line.is_empty()) {
        if let Some(signal) = line.strip_prefix("SIGNAL $WORKSTATE") {
            let (number, output) = signal.split_once(" $OUT[").unwrap();
            let output: u8 = output.strip_suffix(']').unwrap().parse().unwrap();
            let zone = &mut zones[number.parse::<usize>().unwrap() - 1];
            assert!(output > 0 && zone.output.replace(output).is_none(), "{line}");
            continue;
        }
        let (name, fields) = line.split_once("={").unwrap_or_else(|| panic!("not a line of a workspace: {line}"));
        assert_eq!(name, format!("$WORKSPACE[{}]", zones.len() + 1));
        let fields: BTreeMap<&str, &str> =
            fields.strip_suffix('}').unwrap().split(',').map(|field| field.split_once(' ').unwrap()).collect();
        let three = |names: [&str; 3]| names.map(|name| fields[name].parse::<f64>().unwrap());
        let shape = ReadShape::Workspace {
            origin: three(["X", "Y", "Z"]),
            abc: three(["A", "B", "C"]),
            low: three(["X1", "Y1", "Z1"]),
            high: three(["X2", "Y2", "Z2"]),
        };
        assert_eq!(fields.len(), 13, "{line}");
        let on = format!("; on: {name}.MODE=");
        let mode = match fields["MODE"] {
            "#OFF" => text.lines().find_map(|line| line.strip_prefix(&on)).unwrap(),
            mode => mode,
        };
        let (is_outside, stops) = match mode {
            "#INSIDE" => (false, false),
            "#INSIDE_STOP" => (false, true),
            "#OUTSIDE" => (true, false),
            "#OUTSIDE_STOP" => (true, true),
            _ => panic!("{line}"),
        };
        let is_on = fields["MODE"] != "#OFF";
        zones.push(ReadZone { name: name.to_owned(), shape, is_outside, stops, output: None, is_on });
    }
    assert!(zones.len() <= 8);
    zones
}
