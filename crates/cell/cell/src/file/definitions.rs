//! The definitions that a region may refer to, and their lookup by name.

use elbowroom_formats::toml_tables::Value;
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_robot::RobotId;
use elbowroom_scene::Object;

use crate::moving_object::{Encoder, MovingObject};
use crate::{CellRobot, PoseTrack};

type Result<T> = std::result::Result<T, Diagnostic>;

/// The definitions that a region may refer to.
pub(super) struct Definitions<'a> {
    pub robots: &'a [CellRobot],
    pub encoders: &'a [Encoder],
    pub objects: &'a [Object],
    pub moving_objects: &'a [MovingObject],
    /// Pose files, read with the regions that follow them.
    pub pose_tracks: Vec<PoseTrack>,
}

pub(super) fn robot_id(v: &Value<'_>, robots: &[CellRobot]) -> Result<RobotId> {
    let name = v.text()?;
    robots.iter().position(|r| r.name == name).map(RobotId).ok_or_else(|| {
        v.error(format!("names the robot \"{name}\", which is not in this cell"))
            .hint(suggest::hint(name, robots.iter().map(|r| r.name.as_str())))
    })
}

pub(super) fn encoder_index(v: &Value<'_>, encoders: &[Encoder]) -> Result<usize> {
    let name = v.text()?;
    let names = || encoders.iter().map(|e| e.name.as_str());
    names().position(|n| n == name).ok_or_else(|| {
        let what = format!("names the encoder \"{name}\", which has no table [encoder.{name}]");
        v.error(what).hint(suggest::hint(name, names()))
    })
}
