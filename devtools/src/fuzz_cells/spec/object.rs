//! Objects that move, turn and carry regions.

use std::fmt::Write as _;

use super::text::{Vector, list};

#[derive(Debug, Clone, Default)]
pub struct ObjectSpec {
    pub name: String,
    /// Lines of its shape.
    pub shape: String,
    pub at: Vector,
    pub rpy: Vector,
    pub motion: Option<MotionSpec>,
    /// The belt that it is on.
    pub belt: Option<String>,
}

/// The table `motion` of an object.
#[derive(Debug, Clone)]
pub struct MotionSpec {
    /// Corners of its path; empty for an object that only turns.
    pub via: Vec<Vector>,
    pub speed: f64,
    pub start: f64,
    pub repeat: &'static str,
    /// Rotation, rad/s.
    pub turn: Vector,
}

impl ObjectSpec {
    pub(super) fn write(&self, t: &mut String) {
        let _ = writeln!(t, "[object.{}]\n{}", self.name, self.shape.trim_end());
        let _ = writeln!(t, "at = {}\nrpy = {}", list(&self.at), list(&self.rpy));
        if let Some(motion) = &self.motion {
            motion.write(t);
            // As for belts: it changes nothing in a run.
            let _ = writeln!(t, "measured = {}", motion.repeat != "no");
        }
        if let Some(belt) = &self.belt {
            let _ = writeln!(t, "follow = {{ encoder = \"{belt}\" }}");
        }
        t.push('\n');
    }
}

impl MotionSpec {
    fn write(&self, t: &mut String) {
        let mut keys = Vec::new();
        if !self.via.is_empty() {
            let corners: Vec<String> = self.via.iter().map(|corner| list(corner)).collect();
            keys.push(format!("via = [{}]", corners.join(", ")));
            keys.push(format!("speed = {}, repeat = \"{}\"", self.speed, self.repeat));
        }
        if self.turn != [0.0; 3] {
            keys.push(format!("turn = {}", list(&self.turn)));
        }
        if self.start > 0.0 {
            keys.push(format!("start = {}", self.start));
        }
        let _ = writeln!(t, "motion = {{ {} }}", keys.join(", "));
    }
}
