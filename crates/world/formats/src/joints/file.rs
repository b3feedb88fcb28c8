//! Joints from a TOML file.

use std::path::Path;

use elbowroom_spatial::units::{AngleUnit, LengthUnit};
use toml::de::{DeTable, DeValue};

use super::spec::{JointSpec, JointUnits};
use super::value::{Data, Value};
use crate::Diagnostic;
use crate::location::Location;
use crate::tokens::LineIndex;

type Result<T> = std::result::Result<T, Diagnostic>;

const UNITS: &str = "units = { length = \"mm\", angle = \"deg\" }   (m or mm, rad or deg)";

pub(super) fn parse(content: &str, file: &Path) -> Result<Vec<JointSpec>> {
    let lines = LineIndex::new(content);
    let table = DeTable::parse(content).map_err(|e| {
        let line = e.span().map(|span| lines.line_at(span.start));
        let what = format!("this is not TOML: {}", e.message().trim().replace('\n', ", "));
        Diagnostic::new(file, line, what).hint("key = value, with texts in \"double quotes\"; [joint.NODE] above them")
    })?;
    let table = table.get_ref();
    let units = units(table, &lines, file)?;
    let mut specs = Vec::new();
    for (key, value) in table {
        let line = lines.line_at(key.span().start);
        match (key.get_ref().as_ref(), value.get_ref()) {
            ("units" | "version", _) => {}
            ("joint", DeValue::Table(joints)) => {
                for (node, value) in joints {
                    let line = lines.line_at(node.span().start);
                    let DeValue::Table(entries) = value.get_ref() else {
                        let what = format!("`joint.{}` is not a table", node.get_ref());
                        return Err(Diagnostic::new(file, line, what).hint("[joint.NODE], and below it axis = \"z\""));
                    };
                    specs.push(joint(node.get_ref(), entries, Location { file, line }, &lines, units)?);
                }
            }
            (other, _) => {
                let what = format!("`{other}` is not known here");
                return Err(Diagnostic::new(file, line, what).hint("units, and tables [joint.NODE]"));
            }
        }
    }
    specs.sort_by_key(|s: &JointSpec| s.line);
    Ok(specs)
}

fn units(table: &DeTable<'_>, lines: &LineIndex, file: &Path) -> Result<JointUnits> {
    let Some((key, value)) = table.iter().find(|(key, _)| key.get_ref() == "units") else {
        return Err(Diagnostic::new(file, None, "has no `units`: a guessed unit is a wrong unit").hint(UNITS));
    };
    let wrong = || Diagnostic::new(file, lines.line_at(key.span().start), "`units` is not understood").hint(UNITS);
    let DeValue::Table(entries) = value.get_ref() else { return Err(wrong()) };
    let of = |name: &str| {
        let found = entries.iter().find(|(key, _)| key.get_ref() == name);
        found.and_then(|(_, value)| if let DeValue::String(s) = value.get_ref() { Some(s.as_ref()) } else { None })
    };
    let length = of("length").and_then(LengthUnit::parse).ok_or_else(wrong)?;
    let angle = of("angle").and_then(AngleUnit::parse).ok_or_else(wrong)?;
    Ok(JointUnits { length, angle })
}

fn joint(
    node: &str,
    entries: &DeTable<'_>,
    node_at: Location<'_>,
    lines: &LineIndex,
    units: JointUnits,
) -> Result<JointSpec> {
    let mut spec = JointSpec::new(node, node_at.file, Some(node_at.line), units);
    for (key, value) in entries {
        let data = data(value.get_ref());
        let line = lines.line_at(key.span().start);
        Value { key: key.get_ref(), file: node_at.file, line: Some(line), data }.apply(&mut spec)?;
    }
    spec.check()?;
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
