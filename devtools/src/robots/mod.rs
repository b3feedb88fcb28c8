//! Generated example robots: dimensions in, URDF or 3DS, SRDF and meshes out. One file per robot.

mod arm;
mod kr125;
mod kr150;
mod model;
mod ns16;
mod parts;
mod rx60b;
mod srdf;
pub mod tools;
mod tree;
mod urdf;
pub mod work_pieces;

pub use model::File;
use model::{Form, Robot};

use crate::solid::binary_stl;

/// Returns every generated robot.
pub fn all() -> Vec<Robot> {
    vec![ns16::robot(), rx60b::robot(), kr125::robot(), kr150::robot()]
}

impl Robot {
    /// Returns the model and its SRDF; an error if a solid is not closed.
    pub fn files(&self) -> Result<Vec<File>, String> {
        let name = self.name;
        let solids = || self.links.iter().filter_map(|l| Some((l.name, l.solid.as_ref()?)));
        for (link, solid) in solids() {
            solid.check().map_err(|e| format!("{name}, {link}: {e}"))?;
        }
        let mut files = vec![(format!("{name}/{name}.srdf"), srdf::text(self).into_bytes())];
        match self.form {
            Form::Tds => files.extend(tree::files(self)?),
            Form::Urdf => {
                files.push((format!("{name}/{name}.urdf"), urdf::text(self).into_bytes()));
                files.extend(solids().map(|(link, solid)| (format!("{name}/meshes/{link}.stl"), binary_stl(solid))));
            }
        }
        Ok(files)
    }
}
