//! Regions, and their carriers.

use std::fmt::Write as _;

use super::text::{Vector, list};

#[derive(Debug, Clone)]
pub struct BeltSpec {
    pub name: String,
    pub direction: Vector,
    pub speed: f64,
    pub start: f64,
}

#[derive(Debug, Clone)]
pub struct RegionSpec {
    pub name: String,
    /// Lines of shape and place.
    pub shape: String,
    pub kind: &'static str,
    pub warning: f64,
    pub guards: Vec<&'static str>,
    /// Indices of robots; empty for all.
    pub robots: Vec<usize>,
    pub temporary: bool,
    /// Whether its table is one of a fence.
    pub is_fence: bool,
    pub follow: Option<FollowSpec>,
}

#[derive(Debug, Clone)]
pub enum FollowSpec {
    Belt(String),
    Object(String),
    Robot { robot: usize, frame: &'static str },
}

impl BeltSpec {
    pub(super) fn write(&self, t: &mut String) {
        let Self { name, direction, speed, start } = self;
        let _ = writeln!(t, "[encoder.{name}]\ndirection = {}\nspeed = {speed}\nstart = {start}\n", list(direction));
    }
}

impl RegionSpec {
    pub(super) fn write(&self, t: &mut String) {
        let table = if self.is_fence { "fence" } else { "region" };
        let _ = writeln!(t, "[{table}.{}]\n{}", self.name, self.shape.trim_end());
        let guards: Vec<String> = self.guards.iter().map(|g| format!("\"{g}\"")).collect();
        let _ = writeln!(t, "kind = \"{}\"\nwarning = {}\nguards = [{}]", self.kind, self.warning, guards.join(", "));
        if self.temporary {
            t.push_str("life = \"temporary\"\n");
        }
        if !self.robots.is_empty() {
            let names: Vec<String> = self.robots.iter().map(|r| format!("\"r{r}\"")).collect();
            let _ = writeln!(t, "robots = [{}]", names.join(", "));
        }
        if let Some(follow) = &self.follow {
            let _ = match follow {
                FollowSpec::Belt(name) => writeln!(t, "follow = {{ encoder = \"{name}\" }}"),
                FollowSpec::Object(name) => writeln!(t, "follow = {{ object = \"{name}\" }}"),
                FollowSpec::Robot { robot, frame } => {
                    writeln!(t, "follow = {{ robot = \"r{robot}\", frame = \"{frame}\" }}")
                }
            };
        }
        t.push('\n');
    }
}
