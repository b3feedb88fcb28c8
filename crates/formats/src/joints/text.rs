//! Joints out of TOML, or out of an option.

use std::path::Path;

use elbowroom_kinematics::JointKind;
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::{AngleUnit, LengthUnit};
use toml::de::{DeTable, DeValue};

use super::{AxisFrame, JointSpec};
use crate::FormatError;

type Result<T> = std::result::Result<T, FormatError>;

const KEYS: &str = "axis, in, at, kind, min, max, speed, acceleration, name, mimic";
const AXIS: &str = "axis = \"z\"   (x, y, z, -x, -y, -z, or a vector: [0, 0, 1])";
const EXAMPLE: &str = "--joint \"link_2: axis=y, min=-150, max=20, speed=110\"   (metres and degrees)";
const UNITS: &str = "units = { length = \"mm\", angle = \"deg\" }   (m or mm, rad or deg)";

/// A value, and where it stands.
struct Value<'a> {
    key: &'a str,
    file: &'a Path,
    line: Option<usize>,
    data: Data,
}

enum Data {
    Text(String),
    Number(f64),
    Numbers(Vec<f64>),
    Mimic(String, f64, f64),
    Other,
}

impl Value<'_> {
    fn error(&self, what: &str, write: &str) -> FormatError {
        FormatError::new(self.file, self.line, format!("`{}` {what}", self.key)).hint(write)
    }

    fn number(&self) -> Result<f64> {
        match self.data {
            Data::Number(n) if n.is_finite() => Ok(n),
            _ => Err(self.error("is not a finite number", &format!("{} = 90", self.key))),
        }
    }

    fn positive(&self) -> Result<f64> {
        self.number()
            .ok()
            .filter(|n| *n > 0.0)
            .ok_or_else(|| self.error("is not a number above 0", &format!("{} = 90", self.key)))
    }

    fn vector(&self, write: &str) -> Result<Vec3> {
        match &self.data {
            Data::Numbers(n) if n.len() == 3 && n.iter().all(|x| x.is_finite()) => Ok(Vec3::new(n[0], n[1], n[2])),
            _ => Err(self.error("is not three numbers", write)),
        }
    }

    fn axis(&self) -> Result<Vec3> {
        let named = match &self.data {
            Data::Text(text) => match text.as_str() {
                "x" | "+x" => Some(Vec3::X),
                "y" | "+y" => Some(Vec3::Y),
                "z" | "+z" => Some(Vec3::Z),
                "-x" => Some(-Vec3::X),
                "-y" => Some(-Vec3::Y),
                "-z" => Some(-Vec3::Z),
                "?" => return Err(self.error("is still to be filled in", AXIS)),
                _ => return Err(self.error(&format!("is \"{text}\", which is no axis"), AXIS)),
            },
            _ => None,
        };
        let axis = named.map_or_else(|| self.vector(AXIS), Ok)?;
        if axis.try_normalize().is_none() {
            return Err(self.error("has no direction", AXIS));
        }
        Ok(axis)
    }

    fn word<T: Copy>(&self, words: &[(&str, T)]) -> Result<T> {
        let known = words.iter().map(|w| format!("\"{}\"", w.0)).collect::<Vec<_>>().join(" or ");
        let found = match &self.data {
            Data::Text(text) => words.iter().find(|w| w.0 == text),
            _ => None,
        };
        found.map(|w| w.1).ok_or_else(|| self.error("is unknown", &format!("{} = {known}", self.key)))
    }

    fn text(&self) -> Result<String> {
        match &self.data {
            Data::Text(text) if !text.is_empty() => Ok(text.clone()),
            _ => Err(self.error("is not a text", &format!("{} = \"…\"", self.key))),
        }
    }
}

fn empty(node: &str, file: &Path, line: Option<usize>, (length, angle): (LengthUnit, AngleUnit)) -> JointSpec {
    JointSpec {
        file: file.to_owned(),
        line,
        node: node.to_owned(),
        name: None,
        kind: None,
        axis: None,
        at: None,
        frame: AxisFrame::Node,
        min: None,
        max: None,
        speed: None,
        acceleration: None,
        mimic: None,
        length,
        angle,
    }
}

fn set(spec: &mut JointSpec, value: &Value<'_>) -> Result<()> {
    match value.key {
        "axis" => spec.axis = Some(value.axis()?),
        "at" => {
            let at = value.vector("at = [0, 0, 0.5]")?;
            spec.at = Some(Vec3::from(at.to_array().map(|x| spec.length.to_metres(x))));
        }
        "in" => {
            let frames = [("node", AxisFrame::Node), ("parent", AxisFrame::Parent), ("world", AxisFrame::World)];
            spec.frame = value.word(&frames)?;
        }
        "kind" => {
            spec.kind = Some(value.word(&[
                ("revolute", JointKind::Revolute),
                ("prismatic", JointKind::Prismatic),
                ("continuous", JointKind::Continuous),
                ("fixed", JointKind::Fixed),
            ])?);
        }
        "min" => spec.min = Some(value.number()?),
        "max" => spec.max = Some(value.number()?),
        "speed" => spec.speed = Some(value.positive()?),
        "acceleration" => spec.acceleration = Some(value.positive()?),
        "name" => spec.name = Some(value.text()?),
        "mimic" => match &value.data {
            Data::Mimic(joint, multiplier, offset) => spec.mimic = Some((joint.clone(), *multiplier, *offset)),
            _ => return Err(value.error("names no joint", "mimic = { joint = \"NAME\", multiplier = 1, offset = 0 }")),
        },
        _ => return Err(value.error("is not known here", KEYS)),
    }
    Ok(())
}

fn check(spec: &JointSpec) -> Result<()> {
    let bounds = (spec.min, spec.max);
    if let (Some(min), Some(max)) = bounds
        && min > max
    {
        let what = format!("`{}` has min = {min} above max = {max}", spec.node);
        return Err(spec.error(what).hint(format!("min = {max}, max = {min}")));
    }
    Ok(())
}

/// Lines by byte offsets.
struct Lines(Vec<usize>);

impl Lines {
    fn at(&self, offset: usize) -> usize {
        self.0.partition_point(|&start| start <= offset).max(1)
    }
}

pub(super) fn file(content: &str, file: &Path) -> Result<Vec<JointSpec>> {
    let newlines = content.bytes().enumerate().filter(|b| b.1 == b'\n').map(|b| b.0 + 1);
    let lines = Lines(std::iter::once(0).chain(newlines).collect());
    let table = DeTable::parse(content).map_err(|e| {
        let line = e.span().map(|span| lines.at(span.start));
        let what = format!("this is not TOML: {}", e.message().trim().replace('\n', ", "));
        FormatError::new(file, line, what).hint("key = value, with texts in \"double quotes\"; [joint.NODE] above them")
    })?;
    let table = table.get_ref();
    let units = units(table, &lines, file)?;
    let mut specs = Vec::new();
    for (key, value) in table {
        let line = lines.at(key.span().start);
        match (key.get_ref().as_ref(), value.get_ref()) {
            ("units" | "version", _) => {}
            ("joint", DeValue::Table(joints)) => {
                for (node, value) in joints {
                    let line = lines.at(node.span().start);
                    let DeValue::Table(entries) = value.get_ref() else {
                        let what = format!("`joint.{}` is not a table", node.get_ref());
                        return Err(FormatError::new(file, line, what).hint("[joint.NODE], and below it axis = \"z\""));
                    };
                    specs.push(joint(node.get_ref(), entries, (file, line), &lines, units)?);
                }
            }
            (other, _) => {
                let what = format!("`{other}` is not known here");
                return Err(FormatError::new(file, line, what).hint("units, and tables [joint.NODE]"));
            }
        }
    }
    specs.sort_by_key(|s: &JointSpec| s.line);
    Ok(specs)
}

fn units(table: &DeTable<'_>, lines: &Lines, file: &Path) -> Result<(LengthUnit, AngleUnit)> {
    let Some((key, value)) = table.iter().find(|(key, _)| key.get_ref() == "units") else {
        return Err(FormatError::new(file, None, "has no `units`: a guessed unit is a wrong unit").hint(UNITS));
    };
    let wrong = || FormatError::new(file, lines.at(key.span().start), "`units` is not understood").hint(UNITS);
    let DeValue::Table(entries) = value.get_ref() else { return Err(wrong()) };
    let of = |name: &str| {
        let found = entries.iter().find(|(key, _)| key.get_ref() == name);
        found.and_then(|(_, value)| if let DeValue::String(s) = value.get_ref() { Some(s.as_ref()) } else { None })
    };
    let (length, angle) = (of("length").and_then(LengthUnit::parse), of("angle").and_then(AngleUnit::parse));
    length.zip(angle).ok_or_else(wrong)
}

fn joint(
    node: &str,
    entries: &DeTable<'_>,
    (file, line): (&Path, usize),
    lines: &Lines,
    units: (LengthUnit, AngleUnit),
) -> Result<JointSpec> {
    let mut spec = empty(node, file, Some(line), units);
    for (key, value) in entries {
        let data = data(value.get_ref());
        let line = lines.at(key.span().start);
        set(&mut spec, &Value { key: key.get_ref(), file, line: Some(line), data })?;
    }
    check(&spec)?;
    Ok(spec)
}

fn data(value: &DeValue<'_>) -> Data {
    match value {
        DeValue::String(text) => Data::Text(text.to_string()),
        DeValue::Integer(_) | DeValue::Float(_) => number(value).map_or(Data::Other, Data::Number),
        DeValue::Array(list) => {
            list.iter().map(|v| number(v.get_ref())).collect::<Option<_>>().map_or(Data::Other, Data::Numbers)
        }
        DeValue::Table(entries) => mimic(entries).unwrap_or(Data::Other),
        _ => Data::Other,
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(i) => i.as_str().replace('_', "").parse().ok(),
        DeValue::Float(f) => f.as_str().replace('_', "").parse().ok(),
        _ => None,
    }
}

fn mimic(entries: &DeTable<'_>) -> Option<Data> {
    let (mut joint, mut multiplier, mut offset) = (None, 1.0, 0.0);
    for (key, value) in entries {
        match (key.get_ref().as_ref(), value.get_ref()) {
            ("joint", DeValue::String(text)) => joint = Some(text.to_string()),
            ("multiplier", value) => multiplier = number(value)?,
            ("offset", value) => offset = number(value)?,
            _ => return None,
        }
    }
    joint.map(|joint| Data::Mimic(joint, multiplier, offset))
}

pub(super) fn option(option: &str) -> Result<JointSpec> {
    let file = Path::new("--joint");
    let wrong = |what: String| FormatError::new(file, None, what).hint(EXAMPLE);
    let Some((node, rest)) = option.rsplit_once(':') else {
        return Err(wrong(format!("`{option}` names no node before a colon")));
    };
    let mut spec = empty(node.trim(), file, None, (LengthUnit::Metre, AngleUnit::Degree));
    for pair in rest.split(',').map(str::trim).filter(|p| !p.is_empty()) {
        let Some((key, value)) = pair.split_once('=') else {
            return Err(wrong(format!("`{pair}` is not key=value")));
        };
        let value = value.trim().trim_matches('"');
        let numbers: Option<Vec<f64>> = value.split_whitespace().map(|w| w.parse().ok()).collect();
        let data = match numbers {
            Some(numbers) if numbers.len() == 1 => Data::Number(numbers[0]),
            Some(numbers) if !numbers.is_empty() => Data::Numbers(numbers),
            _ => Data::Text(value.to_owned()),
        };
        set(&mut spec, &Value { key: key.trim(), file, line: None, data })?;
    }
    check(&spec)?;
    Ok(spec)
}
