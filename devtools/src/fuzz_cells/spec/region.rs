//! Regions, and their carriers.

use std::fmt::Write as _;

use elbowroom_spatial::Rotation;

use super::files::CellFile;
use super::text::{Vector, list};

#[derive(Debug, Clone)]
pub struct BeltSpec {
    pub name: String,
    pub direction: Vector,
    pub travel: BeltTravel,
    /// Travel after which it begins again at 0.
    pub wrap: Option<f64>,
}

#[derive(Debug, Clone)]
pub enum BeltTravel {
    Constant {
        speed: f64,
        start: f64,
    },
    /// Rows of time and travel.
    Table(Vec<(f64, f64)>),
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
    /// Largest plausible speed and turn of what it follows.
    pub limits: Option<(f64, f64)>,
}

#[derive(Debug, Clone)]
pub enum FollowSpec {
    Belt(String),
    Object(String),
    Robot {
        robot: usize,
        frame: &'static str,
    },
    /// Rows of a file of poses.
    Poses {
        rows: Vec<PoseRow>,
        in_quaternions: bool,
    },
}

/// A pose at a time.
#[derive(Debug, Clone, Copy)]
pub struct PoseRow {
    pub t_s: f64,
    pub at: Vector,
    pub rpy: Vector,
}

impl BeltSpec {
    pub(super) fn write(&self, t: &mut String) {
        let Self { name, direction, travel, wrap } = self;
        let _ = writeln!(t, "[encoder.{name}]\ndirection = {}", list(direction));
        let _ = match travel {
            BeltTravel::Constant { speed, start } => writeln!(t, "speed = {speed}\nstart = {start}"),
            BeltTravel::Table(rows) => writeln!(t, "file = \"{}\"", table_file(rows).name),
        };
        if let Some(wrap) = wrap {
            // `run` moves what a live cell measures as the file says. Without a draw, so that seeds keep their cells.
            let _ = writeln!(t, "wrap = {wrap}\nmeasured = true");
        }
        t.push('\n');
    }

    pub(super) fn file(&self) -> Option<CellFile> {
        match &self.travel {
            BeltTravel::Constant { .. } => None,
            BeltTravel::Table(rows) => Some(table_file(rows)),
        }
    }
}

fn table_file(rows: &[(f64, f64)]) -> CellFile {
    CellFile::csv("belt", "t_s,travel_m", rows.iter().map(|(t_s, travel_m)| vec![*t_s, *travel_m]))
}

fn poses_file(rows: &[PoseRow], in_quaternions: bool) -> CellFile {
    let turn = if in_quaternions { "qx,qy,qz,qw" } else { "roll,pitch,yaw" };
    let row = |PoseRow { t_s, at, rpy: [roll, pitch, yaw] }: &PoseRow| {
        let mut row = [&[*t_s], &at[..]].concat();
        if in_quaternions {
            row.extend(Rotation::from_rpy(*roll, *pitch, *yaw).to_quaternion_xyzw());
        } else {
            row.extend([roll, pitch, yaw]);
        }
        row
    };
    CellFile::csv("poses", &format!("t_s,x,y,z,{turn}"), rows.iter().map(row))
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
            let source = match follow {
                FollowSpec::Belt(name) => format!("encoder = \"{name}\""),
                FollowSpec::Object(name) => format!("object = \"{name}\""),
                FollowSpec::Robot { robot, frame } => format!("robot = \"r{robot}\", frame = \"{frame}\""),
                FollowSpec::Poses { rows, in_quaternions } => {
                    format!("poses = \"{}\"", poses_file(rows, *in_quaternions).name)
                }
            };
            let limits = self.limits.map(|(speed, turn)| format!(", max_speed = {speed}, max_turn = {turn}"));
            let _ = writeln!(t, "follow = {{ {source}{} }}", limits.unwrap_or_default());
        }
        t.push('\n');
    }

    pub(super) fn file(&self) -> Option<CellFile> {
        match &self.follow {
            Some(FollowSpec::Poses { rows, in_quaternions }) => Some(poses_file(rows, *in_quaternions)),
            _ => None,
        }
    }
}
