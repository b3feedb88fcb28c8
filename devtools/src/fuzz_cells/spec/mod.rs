//! Cell in the form of the fuzzer: simple enough to be shrunk, and written as a cell file.

mod comments;
mod extras;
mod files;
mod grid;
mod guidance;
mod object;
mod recording;
mod region;
mod robot;
mod scene;
mod sensor;
mod text;

use std::fmt::Write as _;
use std::path::Path;

use elbowroom_cell::Cell;
use elbowroom_sim::InputFault;

pub use comments::{read_faults, read_repeat};
pub use extras::{ExtraKey, Extras, Turns};
pub use files::CellFile;
pub use grid::GridSpec;
pub use guidance::{GuidanceSpec, HandRow};
pub use object::{MotionSpec, ObjectSpec};
pub use recording::{RecordingLayout, RecordingSpec};
pub use region::{BeltSpec, BeltTravel, FollowSpec, PoseRow, RegionSpec};
pub use robot::{DhRow, GoalSpec, HandSpec, KeepSpec, Model, ProgramSpec, RobotSpec, SolidSpec, StepSpec, ToolSpec};
pub use scene::{SceneBox, SceneSpec};
pub use sensor::{LensSpec, PictureTimes, SeenBox, SensorSpec, SensorView};
pub use text::{Vector, list};

/// A whole cell; metres, radians, seconds.
#[derive(Debug, Clone, Default)]
pub struct CellSpec {
    pub tick_ms: f64,
    pub max_s: f64,
    pub stopping_distance: bool,
    pub reaction_ms: f64,
    pub direction_aware: bool,
    pub recovery_percent: f64,
    pub robots: Vec<RobotSpec>,
    pub belts: Vec<BeltSpec>,
    pub objects: Vec<ObjectSpec>,
    pub regions: Vec<RegionSpec>,
    pub grids: Vec<GridSpec>,
    pub faults: Vec<InputFault>,
    /// Number of passes of the programs, besides their own `repeat`; 0 is once.
    pub repeat: u32,
    /// Guidance of the first robot.
    pub guidance: Option<GuidanceSpec>,
    pub extras: Extras,
}

impl CellSpec {
    /// Writes the cell file. Settings that no cell file has are in comments.
    pub fn to_toml(&self) -> String {
        let mut t = String::from("version = 1\nunits = { length = \"m\", angle = \"rad\" }\n");
        let _ = writeln!(t, "tick_ms = {}\nmax_s = {}", self.tick_ms, self.max_s);
        self.extras.head.iter().for_each(|line| t.extend([line, "\n"]));
        let _ = writeln!(
            t,
            "\n[monitor]\nstopping_distance = {}\nreaction_ms = {}\ndirection_aware = {}\nrecovery = {}\n",
            self.stopping_distance, self.reaction_ms, self.direction_aware, self.recovery_percent
        );
        self.robots.iter().enumerate().for_each(|(i, robot)| robot.write(&mut t, i));
        self.belts.iter().for_each(|belt| belt.write(&mut t));
        self.objects.iter().for_each(|object| object.write(&mut t));
        self.regions.iter().for_each(|region| region.write(&mut t));
        self.grids.iter().for_each(|grid| grid.write(&mut t));
        for (i, robot) in self.robots.iter().enumerate() {
            robot.program.write(&mut t, i);
            if !robot.evades.is_empty() {
                // Without searches for paths, which take most of the time and are not tested here.
                let _ = writeln!(t, "[avoidance.r{i}]\nobjects = {:?}\nreplan = false\n", robot.evades);
            }
        }
        self.guidance.iter().for_each(|guidance| guidance.write(&mut t));
        self.extras.sensors.iter().for_each(|sensor| sensor.write(&mut t));
        comments::write_repeat(&mut t, self.repeat);
        self.faults.iter().for_each(|f| comments::write_fault(&mut t, f));
        self.extras.tables.iter().for_each(|table| t.extend([table, "\n"]));
        self.extras.scenes.iter().for_each(|scene| scene.write(&mut t));
        self.extras.write_keys(&mut t);
        self.extras.turns.write(&t)
    }

    /// Parses the cell as if read from its file in this folder.
    ///
    /// # Errors
    /// The error of the cell file.
    pub fn parse(&self, folder: &Path) -> Result<Cell, String> {
        self.write_files(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let cell = Cell::parse(folder.join("fuzz.toml"), &self.to_toml()).map_err(|e| e.to_string());
        // The cell has read its files; what a run reads is written with the pictures.
        self.files().for_each(|file| drop(std::fs::remove_file(folder.join(file.name))));
        cell
    }

    /// Writes the files that the cell file names into its folder.
    pub fn write_files(&self, folder: &Path) -> std::io::Result<()> {
        self.files().try_for_each(|file| std::fs::write(folder.join(file.name), file.text))
    }

    fn files(&self) -> impl Iterator<Item = CellFile> {
        let recordings = self.robots.iter().filter_map(|r| r.program.recording.as_ref()).map(RecordingSpec::file);
        let streams = self.guidance.iter().flat_map(|g| g.shields.iter().cloned().chain([g.file()]));
        let belts = self.belts.iter().filter_map(BeltSpec::file);
        let poses = self.regions.iter().filter_map(RegionSpec::file);
        let joints = self.extras.sensors.iter().filter_map(|sensor| sensor.joints.clone());
        let extras = self.extras.files.iter().cloned().chain(self.extras.scenes.iter().map(SceneSpec::file));
        recordings.chain(streams).chain(belts).chain(poses).chain(joints).chain(extras)
    }
}
