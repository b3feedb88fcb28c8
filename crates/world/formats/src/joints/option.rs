//! Joints from command-line options.

use std::path::Path;

use elbowroom_spatial::units::{AngleUnit, LengthUnit};

use super::spec::{JointSpec, JointUnits};
use super::value::{Data, Value};
use crate::Diagnostic;

const EXAMPLE: &str = "--joint \"link_2: axis=y, min=-150, max=20, speed=110\"   (metres and degrees)";

pub(super) fn parse(option: &str) -> Result<JointSpec, Diagnostic> {
    let file = Path::new("--joint");
    let wrong = |what: String| Diagnostic::new(file, None, what).hint(EXAMPLE);
    let Some((node, rest)) = option.rsplit_once(':') else {
        return Err(wrong(format!("`{option}` names no node before a colon")));
    };
    let units = JointUnits { length: LengthUnit::Metre, angle: AngleUnit::Degree };
    let mut spec = JointSpec::new(node.trim(), file, None, units);
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
        Value { key: key.trim(), file, line: None, data }.apply(&mut spec)?;
    }
    spec.check()?;
    Ok(spec)
}
