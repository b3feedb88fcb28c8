//! Pairs that a planning scene allows to touch, as a file of pairs.

use std::path::Path;

use elbowroom_formats::planning_scene::PlanningScene;
use elbowroom_scene::{PairState, Selection};

use super::{Note, PairFile, PairRow};
use crate::Cell;
use crate::scene_pairs::ScenePairs;

impl PairFile {
    /// The pairs that the allowed collision matrix of a scene allows to touch, as the file `path`; `None` if it allows
    /// none.
    ///
    /// `cell` has the objects of the scene and nothing else. Pairs with links are comments, because the robot has no
    /// name there.
    pub fn of_scene(path: &Path, scene: &PlanningScene, cell: &Cell) -> Option<Self> {
        let pairs = ScenePairs::of(scene, &(0..cell.objects.len()), cell);
        let reason = format!("allowed in {}", scene.file.file_name().unwrap_or_default().to_string_lossy());
        let row = |sides: [String; 2]| PairRow {
            line: 0,
            sides,
            state: PairState::Skipped,
            weight: None,
            note: Note::Reason(reason.clone()),
        };
        let name = |side: Selection| match side {
            Selection::Object(o) => Some(cell.objects[o.0].name.clone()),
            _ => None,
        };
        let named = pairs.rules.iter().filter_map(|rule| Some(row([name(rule.a)?, name(rule.b)?])));
        let rows: Vec<PairRow> = named.collect();
        let comments = comments(scene, |sides| row(sides).to_string());
        (!rows.is_empty() || !comments.is_empty()).then(|| Self { file: path.to_owned(), rows, comments })
    }
}

/// Pairs with a name that is not an object of the scene, each as a row.
fn comments(scene: &PlanningScene, row: impl Fn([String; 2]) -> String) -> Vec<String> {
    let is_object = |name: &str| scene.objects.iter().any(|o| o.id == name);
    let side = |name: &str| if is_object(name) { name.to_owned() } else { format!("ROBOT/{name}") };
    let allowed = &scene.allowed;
    let pairs = allowed.allowed.iter().map(|&(a, b)| [allowed.names[a].as_str(), allowed.names[b].as_str()]);
    let with_links = pairs.filter(|pair| !pair.iter().all(|name| is_object(name)));
    let mut rows: Vec<String> = with_links.map(|[a, b]| row([side(a), side(b)])).collect();
    rows.extend(allowed.allowed_by_default.iter().map(|name| row([side(name), super::ANYTHING.to_owned()])));
    if !rows.is_empty() {
        let what = "Rows to add to the list once the cell has the robot: ROBOT stands for its name.";
        rows.insert(0, what.to_owned());
    }
    rows
}
