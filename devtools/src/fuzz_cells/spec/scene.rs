//! Planning scenes: boxes in a file beside the cell.

use std::fmt::Write as _;

use serde_json::json;

use super::files::CellFile;
use super::text::{Vector, list};

/// Boxes of a planning scene, and where the scene is.
#[derive(Debug, Clone)]
pub struct SceneSpec {
    pub name: String,
    pub at: Vector,
    pub rpy: Vector,
    /// The frame of the scene that is placed; `None` for its world.
    pub frame: Option<String>,
    pub boxes: Vec<SceneBox>,
    /// Pairs of names that may touch by the scene's matrix, and whether the cell heeds it.
    pub allowed: Vec<[String; 2]>,
    pub heeds_allowed: Option<bool>,
}

/// A box of a planning scene.
#[derive(Debug, Clone)]
pub struct SceneBox {
    pub name: String,
    pub size: Vector,
    /// Its place in the frame of the object.
    pub at: Vector,
    /// Components x, y, z, w.
    pub turn: [f64; 4],
    /// The frame that it is in: the one that is placed, or a link of a robot.
    pub frame: String,
}

impl SceneSpec {
    pub(super) fn write(&self, t: &mut String) {
        let Self { name, at, rpy, .. } = self;
        let _ = writeln!(t, "[scene.{name}]\nfile = \"{}\"\nat = {}\nrpy = {}", self.file().name, list(at), list(rpy));
        if let Some(frame) = &self.frame {
            let _ = writeln!(t, "frame = \"{frame}\"");
        }
        if let Some(heeds) = self.heeds_allowed {
            let _ = writeln!(t, "allowed_collisions = {heeds}");
        }
        t.push('\n');
    }

    /// A message of type `moveit_msgs/PlanningScene`.
    pub(super) fn file(&self) -> CellFile {
        let of = |b: &SceneBox| {
            let position = json!({ "x": b.at[0], "y": b.at[1], "z": b.at[2] });
            let orientation = json!({ "x": b.turn[0], "y": b.turn[1], "z": b.turn[2], "w": b.turn[3] });
            json!({
                "id": b.name,
                "header": { "frame_id": b.frame },
                "primitives": [{ "type": 1, "dimensions": b.size }],
                "primitive_poses": [{ "position": position, "orientation": orientation }],
            })
        };
        let objects: Vec<serde_json::Value> = self.boxes.iter().map(of).collect();
        let mut names: Vec<&String> = self.allowed.iter().flatten().collect();
        names.sort();
        names.dedup();
        let may_touch = |a: &String, b: &String| self.allowed.iter().any(|[x, y]| (x, y) == (a, b) || (x, y) == (b, a));
        let rows: Vec<Vec<bool>> = names.iter().map(|a| names.iter().map(|b| may_touch(a, b)).collect()).collect();
        let entries: Vec<serde_json::Value> = rows.iter().map(|enabled| json!({ "enabled": enabled })).collect();
        let mut scene = json!({ "name": self.name, "world": { "collision_objects": objects } });
        if !names.is_empty() {
            scene["allowed_collision_matrix"] = json!({ "entry_names": names, "entry_values": entries });
        }
        CellFile::new("scene", "json", scene.to_string())
    }
}
