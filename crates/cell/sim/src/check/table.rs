//! Results of `check` as text of at most 100 columns.

use std::fmt::Write;

use elbowroom_cell::Cell;
use elbowroom_monitor::RegionKind;

use super::entry_analysis::round_up;
use super::entry_check::EntryCheck;

const WIDTH: usize = 100;
/// Width of names.
const NAME: usize = 22;
const INDENT: &str = "      ";

/// One row per region and robot, followed by the reason.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_sim::check;
/// let cell = Cell::parse("c.toml", "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n")?;
/// assert!(check::table(&cell, &check::check(&cell)?).contains("no region"));
/// # Ok::<(), elbowroom_diagnostic::Diagnostic>(())
/// ```
pub fn table(cell: &Cell, checks: &[EntryCheck]) -> String {
    let mut text = format!("{} · {}\n", shortened(&cell.name, 40), laws(cell));
    if checks.is_empty() {
        text += "\n  There is no region that guards against a robot.\n";
        return text;
    }
    let _ = writeln!(
        text,
        "\n  {:NAME$} {:NAME$} {:10} {:9} {:>12} {:>12}",
        "region", "robot", "kind", "entry", "warning", "needed"
    );
    for check in checks {
        row(&mut text, cell, check);
    }
    let bad = checks.iter().filter(|c| c.is_bad(cell)).count();
    let end = match bad {
        0 => "Entry is excluded for every forbidden and exchange region.".to_owned(),
        1 => "Entry is possible in 1 case.".to_owned(),
        n => format!("Entry is possible in {n} cases."),
    };
    let _ = write!(text, "\n  {end}\n  Not a certified safety device.\n");
    text
}

fn row(text: &mut String, cell: &Cell, check: &EntryCheck) {
    let region = &cell.regions[check.region.0].region;
    let entry = match (region.kind, check.excluded) {
        (RegionKind::Monitored { .. }, _) => "allowed",
        (_, true) => "excluded",
        (_, false) => "POSSIBLE",
    };
    let length = |m: f64| cell.units.show_length(round_up(m));
    let _ = writeln!(
        text,
        "  {:NAME$} {:NAME$} {:10} {:9} {:>12} {:>12}",
        shortened(&region.name, NAME),
        shortened(&cell.robots[check.robot.0].name, NAME),
        region.kind.name(),
        entry,
        length(region.warning_m),
        check.needed_warning_m.map_or_else(|| "–".to_owned(), length),
    );
    paragraph(text, &check.reason);
    if let Some(write) = &check.write_instead {
        paragraph(text, &format!("write: {write}"));
    }
}

fn laws(cell: &Cell) -> String {
    let laws = &cell.monitoring;
    let mut on = vec!["warning zone".to_owned()];
    if laws.stopping_reaction_s.is_some() {
        on.push("stopping distance".into());
    }
    if laws.laws.direction_aware {
        on.push("direction".into());
    }
    if laws.laws.override_rate > 0.0 {
        on.push(format!("override rate {}/s", laws.laws.override_rate));
    }
    format!("laws: {}", on.join(", "))
}

/// Wraps words into lines.
fn paragraph(text: &mut String, words: &str) {
    let mut column = 0;
    for word in words.split_whitespace() {
        let width = word.chars().count();
        if column > 0 && column + 1 + width > WIDTH {
            text.push('\n');
            column = 0;
        }
        if column == 0 {
            text.push_str(INDENT);
            column = INDENT.len();
        } else {
            text.push(' ');
            column += 1;
        }
        text.push_str(word);
        column += width;
    }
    text.push('\n');
}

fn shortened(name: &str, most: usize) -> String {
    if name.chars().count() <= most {
        return name.to_owned();
    }
    name.chars().take(most - 1).chain(['…']).collect()
}
