//! `[avoidance.ROBOT]`: how a robot evades what moves.

use elbowroom_avoidance::{AvoiderSettings, Rules};
use elbowroom_formats::FormatError;

use super::read::{Table, Value};
use super::{robot_of, suggest};
use crate::{AvoidanceSpec, Cell};

type Result<T> = std::result::Result<T, FormatError>;

const KEYS: &[&str] = &["rules", "objects", "speed", "clearance", "return_speed", "patience", "replan"];

pub(super) fn read(root: &Table<'_>, cell: &Cell) -> Result<Vec<Option<AvoidanceSpec>>> {
    let mut all = vec![None; cell.robots.len()];
    for (name, t) in root.named("avoidance")? {
        t.only(KEYS)?;
        let (index, _) = robot_of(name, &t, &cell.robots)?;
        all[index] = Some(spec(&t, cell)?);
    }
    Ok(all)
}

fn spec(t: &Table<'_>, cell: &Cell) -> Result<AvoidanceSpec> {
    let units = cell.units;
    let mut settings = AvoiderSettings::default();
    if let Some(v) = t.get("speed") {
        settings.reflex.speed_m_s = units.positive_length(&v)?;
    }
    if let Some(v) = t.get("clearance") {
        settings.reflex.clearance_m = units.positive_length(&v)?;
    }
    if let Some(v) = t.get("return_speed") {
        settings.return_share = v.percent()?;
        if settings.return_share <= 0.0 {
            return Err(v.error("is 0: the robot would never come back").hint("return_speed = 50   (percent)"));
        }
    }
    if let Some(v) = t.get("patience") {
        settings.patience_s = v.positive()?;
    }
    let rules = t.get("rules").map_or_else(|| Ok(Rules::default()), |v| rules(&v))?;
    let reach = rules.reach_m();
    if settings.reflex.clearance_m >= reach {
        let what = format!(
            "`{}`: the clearance is not less than the {} that the rules look ahead",
            t.name,
            units.show_length(reach)
        );
        return Err(t.error(what).hint("clearance = 50, or rules with a wider range of proximity"));
    }
    let objects = match t.get("objects") {
        None => cell.movers.iter().map(|m| m.object).collect(),
        Some(v) => v.list("objects = [\"cart\"]")?.iter().map(|v| object(v, cell)).collect::<Result<_>>()?,
    };
    Ok(AvoidanceSpec { rules, settings, objects, replan: t.flag_or("replan", true)? })
}

fn object(v: &Value<'_>, cell: &Cell) -> Result<usize> {
    let name = v.text()?;
    cell.objects.iter().position(|o| o.name == name).ok_or_else(|| {
        v.error(format!("names the object \"{name}\", which is not in this cell"))
            .hint(suggest::hint(name, cell.objects.iter().map(|o| o.name.as_str())))
    })
}

/// The rules of the named file, its own errors told with its own lines.
fn rules(v: &Value<'_>) -> Result<Rules> {
    let path = v.file.parent().unwrap_or(v.file).join(v.text()?);
    let text = std::fs::read_to_string(&path).map_err(|e| {
        v.error(format!("names {}, which cannot be read: {e}", path.display()))
            .hint("rules = \"my_rules.toml\", written by `elbowroom rules --write my_rules.toml`")
    })?;
    Rules::from_toml(&text).map_err(|e| FormatError::new(&path, e.line, e.what).hint(e.write_instead))
}
