//! Check of every path by Pinocchio and Coal, in a separate Python.

use std::path::Path;
use std::process::Command;

use super::course::{Course, PathCheck};
use crate::cross_validation::{reference, world};

/// Checks this many points of each path, evenly spread over its times.
pub fn check(python: &Path, folder: &Path, course: &Course, points: usize) -> Result<PathCheck, String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let pairs = world::by_rule(&course.scene);
    let (text, binary, _) = reference::job(&course.urdf, &course.scene, &[], &pairs, false)?;
    let mut paths = Vec::new();
    for path in &course.paths {
        paths.extend((path.rows().len() as f64).to_le_bytes());
        paths.extend(
            path.rows().iter().flat_map(|row| std::iter::once(&row.t_s).chain(&row.q)).flat_map(|v| v.to_le_bytes()),
        );
    }
    let files: [(&str, &[u8]); 5] = [
        ("job.txt", text.as_bytes()),
        ("job.bin", &binary),
        ("paths.bin", &paths),
        ("pin_coal.py", reference::SCRIPT),
        ("path_coal.py", include_bytes!("path_coal.py")),
    ];
    for (name, bytes) in files {
        std::fs::write(folder.join(name), bytes).map_err(|e| format!("{name}: {e}"))?;
    }
    let output = Command::new(python).arg(folder.join("path_coal.py")).arg(folder).arg(points.to_string()).output();
    let output = output.map_err(|e| format!("cannot start {}: {e}", python.display()))?;
    let printed = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(format!("the reference failed: {}", String::from_utf8_lossy(&output.stderr)));
    }
    let words: Vec<&str> = printed.trim().splitn(3, '\t').collect();
    let number = |i: usize| words.get(i).and_then(|w| w.parse().ok()).ok_or("the reference printed no numbers");
    let first = words.get(2).filter(|w| !w.is_empty()).map(|w| (*w).to_owned());
    Ok(PathCheck { points: number(0)?, hits: number(1)?, first })
}
