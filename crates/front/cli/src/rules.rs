//! `elbowroom rules`: reads, prints and writes the fuzzy rules of avoidance.

use std::fmt::Write;
use std::path::Path;

use elbowroom::avoidance::fuzzy::Surface;
use elbowroom::avoidance::{DEFAULT_RULES, Rules};
use elbowroom::cell::parse_rules;
use serde::Serialize;

use crate::args::RulesArgs;
use crate::output::{ExitStatus, Failure, cannot_write, print, print_json};
use crate::output_file::write_bytes;

/// Distances (m) and speeds of approach (m/s) of the table.
const DISTANCES_M: [f64; 7] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8];
const SPEEDS_M_S: [f64; 6] = [0.0, 0.1, 0.25, 0.5, 1.0, 1.5];
/// Values of each input in a picture.
const STEPS: usize = 41;

#[derive(Serialize)]
struct Answer {
    rules: usize,
    surfaces: Vec<SurfaceAnswer>,
}

#[derive(Serialize)]
struct SurfaceAnswer {
    output: String,
    unit: &'static str,
    proximity_m: Vec<f64>,
    speed_m_s: Vec<f64>,
    /// One row per speed.
    values: Vec<Vec<f64>>,
}

pub(crate) fn rules(args: &RulesArgs) -> Result<ExitStatus, Failure> {
    if let Some(path) = &args.write {
        if path.exists() {
            return Err(Failure::Wrong(format!(
                "{} is there already\n  write: --write with another name",
                path.display()
            )));
        }
        write_bytes(path, DEFAULT_RULES)?;
    }
    let rules = match &args.file {
        None => Rules::default(),
        Some(path) => read(path)?,
    };
    let surfaces = rules.surfaces(STEPS);
    if let Some(dir) = &args.picture {
        std::fs::create_dir_all(dir).map_err(cannot_write(dir))?;
        for surface in &surfaces {
            let path = dir.join(format!("{}.svg", surface.z_name));
            write_bytes(&path, surface.to_svg())?;
        }
    }
    if args.json {
        let answer = |s: Surface| SurfaceAnswer {
            unit: if s.units[2].is_empty() { "1" } else { s.units[2] },
            output: s.z_name,
            proximity_m: s.x,
            speed_m_s: s.y,
            values: s.z,
        };
        let surfaces = surfaces.into_iter().map(answer).collect();
        print_json(&Answer { rules: rules.controller().rules().len(), surfaces })?;
    } else {
        print(&table(&rules))?;
    }
    Ok(ExitStatus::Success)
}

fn read(path: &Path) -> Result<Rules, Failure> {
    let text = std::fs::read_to_string(path).map_err(|e| Failure::Wrong(format!("{}: {e}", path.display())))?;
    Ok(parse_rules(path, &text)?)
}

fn table(rules: &Rules) -> String {
    let count = rules.controller().rules().len();
    let head = format!("{count} rules. Size of the correction (%) / its direction (deg; 0: straight away, 90: aside)");
    let mut text = format!("{head}\n\n  speed     distance (m)\n   (m/s) ");
    for distance in DISTANCES_M {
        _ = write!(text, "{distance:>9.2}");
    }
    for speed in SPEEDS_M_S {
        _ = write!(text, "\n{speed:8.2} ");
        for distance in DISTANCES_M {
            _ = write!(text, "{:>9}", cell(rules, distance, speed));
        }
    }
    text + "\n"
}

fn cell(rules: &Rules, distance_m: f64, speed_m_s: f64) -> String {
    let c = rules.correction(distance_m, speed_m_s);
    if c.size > 0.0 { format!("{:.0}/{:.0}", 100.0 * c.size, c.direction_rad.to_degrees()) } else { "-".into() }
}
