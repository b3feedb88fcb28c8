//! Cameras and sensors of points, and the boxes that they see.

use std::fmt::Write as _;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use elbowroom_spatial::{Pose, Vec3};

use super::files::CellFile;
use super::text::{Vector, list};

/// A sensor of which a folder beside the cell file has the pictures or clouds.
#[derive(Debug, Clone)]
pub struct SensorSpec {
    pub name: &'static str,
    pub view: SensorView,
    pub at: Vector,
    pub rpy: Vector,
    /// Height of the floor, m.
    pub floor: f64,
    /// The robot whose map has the obstacles.
    pub mapped: usize,
    /// The robots that avoid what it sees.
    pub avoiding: Vec<usize>,
    pub latency_ms: f64,
    pub stale_ms: f64,
    pub pictures: PictureTimes,
    pub boxes: Vec<SeenBox>,
    /// Joint values while the empty cell is learnt.
    pub joints: Option<CellFile>,
    /// Lines of its table that its pictures need.
    pub needed: Vec<String>,
    /// Further lines of its table.
    pub lines: Vec<String>,
}

/// When a sensor takes pictures.
#[derive(Debug, Clone)]
pub struct PictureTimes {
    /// Number of pictures of the empty cell, the first ones.
    pub learning: usize,
    /// Times of the pictures, s.
    pub times: Vec<f64>,
    /// Indices of pictures that cannot be used.
    pub unusable: Vec<usize>,
}

/// How a sensor sees.
#[derive(Debug, Clone)]
pub enum SensorView {
    /// Points this far apart, m, in files of one of two formats.
    Points { spacing: f64, is_ply: bool },
    /// Pictures of depths; a depth of 1 is so many metres.
    Depths { lens: LensSpec, step: f64 },
    /// Pictures of a camera.
    Camera { lens: LensSpec },
}

/// Size of a picture and focal length, pixels.
#[derive(Debug, Clone, Copy)]
pub struct LensSpec {
    pub columns: usize,
    pub rows: usize,
    pub focal: f64,
}

/// An upright box that no cell file names.
#[derive(Debug, Clone)]
pub struct SeenBox {
    /// The middle of its lower side.
    pub at: Vector,
    pub size: Vector,
    pub yaw: f64,
    /// It is there from this time on, s.
    pub from_s: f64,
    pub to_s: f64,
    /// Velocity from then on, world x and y, m/s.
    pub velocity: [f64; 2],
    /// Whether it is there already while the empty cell is learnt, and ignored later.
    pub is_learnt: bool,
}

impl SeenBox {
    /// The middle of its lower side at a time; `None` while it is not there.
    pub fn at_time(&self, t_s: f64) -> Option<Vector> {
        let [x, y, z] = self.at;
        let moved = |by: f64| if by == 0.0 { 0.0 } else { by * (t_s - self.from_s) };
        let is_there = self.is_learnt || (self.from_s..self.to_s).contains(&t_s);
        is_there.then(|| [x + moved(self.velocity[0]), y + moved(self.velocity[1]), z])
    }

    /// A point given in its own frame, whose origin is the middle of its lower side, `at`.
    pub fn to_world(&self, at: Vector, own: Vec3) -> Vec3 {
        let (sin, cos) = self.yaw.sin_cos();
        Vec3::new(at[0] + cos * own.x - sin * own.y, at[1] + sin * own.x + cos * own.y, at[2] + own.z)
    }

    /// A direction of the world in its own frame.
    pub fn to_own(&self, v: Vec3) -> Vec3 {
        let (sin, cos) = self.yaw.sin_cos();
        Vec3::new(cos * v.x + sin * v.y, -sin * v.x + cos * v.y, v.z)
    }

    /// Whether it stands in its place all the time.
    pub fn stands(&self) -> bool {
        self.velocity == [0.0; 2] && self.from_s == f64::NEG_INFINITY && self.to_s == f64::INFINITY
    }
}

impl SensorSpec {
    fn table(&self) -> &'static str {
        if matches!(self.view, SensorView::Camera { .. }) { "camera" } else { "cloud" }
    }

    pub fn pose(&self) -> Pose {
        Pose::from_xyz_rpy(self.at, self.rpy)
    }

    /// Name of its folder: made from what is in it, so that cells do not share it.
    pub fn folder(&self) -> String {
        let mut hasher = DefaultHasher::new();
        format!("{self:?}").hash(&mut hasher);
        format!("seen-{:016x}", hasher.finish())
    }

    /// Whether the picture with this index shows the empty cell.
    pub fn is_learning(&self, index: usize) -> bool {
        index < self.pictures.learning
    }

    /// The boxes in the picture with this index, with the middle of their lower sides.
    pub fn shown(&self, index: usize) -> impl Iterator<Item = (&SeenBox, Vector)> {
        let is_learning = self.is_learning(index);
        let there = self.boxes.iter().filter(move |b| b.is_learnt || !is_learning);
        there.filter_map(move |b| Some((b, b.at_time(self.pictures.times[index])?)))
    }

    pub(super) fn write(&self, t: &mut String) {
        let names = |robots: &[usize]| -> Vec<String> { robots.iter().map(|robot| format!("r{robot}")).collect() };
        let _ = writeln!(t, "[{}.{}]", self.table(), self.name);
        let _ = writeln!(t, "pose = {{ at = {}, rpy = {} }}", list(&self.at), list(&self.rpy));
        let _ =
            writeln!(t, "floor = {}\nrobot = \"r{}\"\nrobots = {:?}", self.floor, self.mapped, names(&self.avoiding));
        let _ = writeln!(t, "latency_ms = {}\nstale_ms = {}", self.latency_ms, self.stale_ms);
        let (folder, learning) = (self.folder(), self.pictures.learning);
        match &self.view {
            SensorView::Points { .. } => {
                let _ = writeln!(t, "clouds = \"{folder}\"\nlearning_clouds = {learning}");
            }
            SensorView::Depths { lens, step } => {
                let _ = writeln!(t, "clouds = \"{folder}\"\nlearning_clouds = {learning}");
                let _ = writeln!(t, "depth = {{ {}, step = {step} }}", lens.keys(", "));
            }
            SensorView::Camera { lens } => {
                let _ = writeln!(t, "frames = \"{folder}\"\nlearning_frames = {learning}\n{}", lens.keys("\n"));
            }
        }
        if let Some(joints) = &self.joints {
            let _ = writeln!(t, "joints = \"{}\"", joints.name);
        }
        self.needed.iter().chain(&self.lines).for_each(|line| t.extend([line, "\n"]));
        t.push('\n');
    }
}

impl LensSpec {
    fn keys(&self, between: &str) -> String {
        format!("size = [{}, {}]{between}focal_px = {}", self.columns, self.rows, self.focal)
    }
}
