//! The allowed collision matrix of a scene.

use super::field::{Field, Reading};
use super::types::AllowedCollisions;
use crate::Diagnostic;

/// Parses the matrix; empty if the scene has none.
pub(crate) fn parse(scene: &Field<'_>, reading: &mut Reading) -> Result<AllowedCollisions, Diagnostic> {
    let Some(field) = scene.get("allowed_collision_matrix")? else { return Ok(AllowedCollisions::default()) };
    let names = field.names("entry_names")?;
    let rows: Vec<Field<'_>> = field.list("entry_values")?;
    let wrong_count = |at: &Field<'_>, n: usize| {
        let what = format!("has {n} entries for {} names in `entry_names`", names.len());
        at.error(what, "a row per name, and in each row true or false per name")
    };
    if rows.len() != names.len() {
        return Err(wrong_count(&field, rows.len()));
    }
    let mut values = Vec::with_capacity(rows.len());
    for row in &rows {
        let hint = "\"enabled\": [true, false, …], or the list alone";
        let entries = if row.is_list() { row.elements()? } else { row.require("enabled", hint)?.elements()? };
        if entries.len() != names.len() {
            return Err(wrong_count(row, entries.len()));
        }
        values.push(entries.iter().map(Field::flag).collect::<Result<Vec<_>, _>>()?);
    }
    let allowed = symmetric(&field, &values, reading);
    Ok(AllowedCollisions { names, allowed, allowed_by_default: allowed_by_default(&field)? })
}

/// The pairs for which both entries are true.
fn symmetric(field: &Field<'_>, values: &[Vec<bool>], reading: &mut Reading) -> Vec<(usize, usize)> {
    let mut allowed = Vec::new();
    for (i, row) in values.iter().enumerate() {
        for (j, &value) in row.iter().enumerate().skip(i + 1) {
            if value != values[j][i] {
                let what = format!("is not symmetric at [{i}][{j}]: such a pair may not touch");
                reading.once("matrix", field, what, "the same value at [j][i] as at [i][j]");
            } else if value {
                allowed.push((i, j));
            }
        }
    }
    allowed
}

fn allowed_by_default(field: &Field<'_>) -> Result<Vec<String>, Diagnostic> {
    let mut names = Vec::new();
    for (name, value) in field.paired_lists(["default_entry_names", "default_entry_values"])? {
        if value.flag()? {
            names.push(name.name()?.to_owned());
        }
    }
    Ok(names)
}
