//! The cell file: TOML in, [`Cell`](crate::Cell) out. `docs/cell-file.md` describes every key.

mod avoidance;
mod follow;
mod guarding;
mod models;
pub(crate) mod node;
mod object;
mod plausible;
mod poses;
mod program;
pub(crate) mod read;
mod region;
pub(crate) mod robot;
pub(crate) mod suggest;
mod words;

use std::path::Path;

use elbowroom_formats::{FormatError, Warning};
use elbowroom_monitor::Laws;

pub use models::NumberTable;
use read::{Table, Value};

use crate::{Cell, CellLaws, CellRobot, MapSpec, Units, configure, seal};

type Result<T> = std::result::Result<T, FormatError>;

/// Largest cell file that is read, bytes.
const MOST_BYTES: u64 = 64 << 20;

const KEYS: &[&str] = &[
    "version",
    "name",
    "units",
    "tick_ms",
    "max_s",
    "checksum",
    "robot",
    "object",
    "region",
    "encoder",
    "monitor",
    "map",
    "avoidance",
    "program",
];

/// A cell file, parsed but not yet resolved: every key and value with its line.
#[derive(Debug, Clone)]
pub struct CellFile {
    pub(crate) file: std::path::PathBuf,
    pub(crate) entries: Vec<node::Entry>,
    /// True where it was read from the disk, and so must be what was sealed there.
    on_disk: bool,
}

impl CellFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`FormatError`] where it cannot be read or is not TOML.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let unreadable = |e: std::io::Error| {
            FormatError::new(path, None, format!("cannot be read: {e}"))
                .hint("the path of a cell file (see docs/cell-file.md)")
        };
        if std::fs::metadata(path).map_err(unreadable)?.len() > MOST_BYTES {
            return Err(FormatError::new(path, None, format!("is larger than {MOST_BYTES} bytes")));
        }
        let bytes = std::fs::read(path).map_err(unreadable)?;
        let text = String::from_utf8(bytes).map_err(|e| {
            let line = String::from_utf8_lossy(&e.as_bytes()[..e.utf8_error().valid_up_to()]).split('\n').count();
            FormatError::new(path, line, "is not UTF-8 text").hint("the file saved as UTF-8")
        })?;
        Ok(Self { on_disk: true, ..Self::parse(path, &text)? })
    }

    /// Parses text as if it stood in the file `path`; files it names are relative to that. What is sealed is the file on the
    /// disk, not this text: no seal is asked for.
    ///
    /// # Errors
    /// [`FormatError`] where it is not TOML.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        let file = path.as_ref().to_owned();
        let entries = node::parse(&file, text)?;
        Ok(Self { file, entries, on_disk: false })
    }

    /// Names of the regions, in file order.
    pub(crate) fn region_names(&self) -> Vec<String> {
        let tables = self.entries.iter().filter(|e| e.key == "region").filter_map(|e| match &e.node.data {
            node::Data::Table(tables) => Some(tables),
            _ => None,
        });
        tables.flatten().map(|e| e.key.clone()).collect()
    }

    /// Looks everything up, reads the files it names, converts to SI. A file that was read from the disk must be as it was
    /// sealed, where it was sealed or has to be: see [`seal`](crate::seal).
    ///
    /// # Errors
    /// [`FormatError`] at the first line that is wrong, or that is not as it was sealed.
    pub fn resolve(&self) -> Result<Cell> {
        let root = Table { file: &self.file, name: String::new(), line: 1, entries: &self.entries };
        root.only(KEYS)?;
        version(&root)?;
        let units = Units::read(&root)?;
        let mut warnings = Vec::new();
        let mut cell = Cell {
            file: self.file.clone(),
            name: name(&root)?,
            units,
            tick_s: root.get("tick_ms").map_or(Ok(2.0), |v| tick_ms(&v))? / 1000.0,
            max_s: root.get("max_s").map_or(Ok(600.0), |v| v.positive())?,
            robots: Vec::new(),
            objects: Vec::new(),
            movers: Vec::new(),
            regions: Vec::new(),
            encoders: Vec::new(),
            pose_tracks: Vec::new(),
            laws: laws(&root, &mut warnings)?,
            programs: Vec::new(),
            avoidance: Vec::new(),
            maps: Vec::new(),
            checksum: String::new(),
            seal: None,
            warnings: Vec::new(),
        };
        for (name, t) in root.named("robot")? {
            cell.robots.push(robot::read(name, &t, units, &mut warnings)?);
        }
        for (name, t) in root.named("encoder")? {
            cell.encoders.push(region::encoder(name, &t, units)?);
        }
        object::read(&root, &mut cell)?;
        regions(&root, &mut cell, &mut warnings)?;
        programs(&root, &mut cell, &mut warnings)?;
        cell.maps = maps(&root, &cell)?;
        cell.avoidance = avoidance::read(&root, &cell)?;
        // Builds what the monitors will be given, so that whatever they refuse is refused here, with its line.
        cell.checksum = configure::checksum(&cell)?;
        if self.on_disk {
            // Before the checksum: a seal tells what differs.
            cell.seal = seal::verify(self, &cell)?;
        }
        check(&root, &cell)?;
        plausible::check(&root, &cell, &mut warnings)?;
        cell.warnings = warnings;
        Ok(cell)
    }
}

/// Compares the checksum with the one that was approved, where the file names one.
fn check(root: &Table<'_>, cell: &Cell) -> Result<()> {
    let Some(v) = root.get("checksum") else { return Ok(()) };
    let expected = v.text()?;
    if expected.eq_ignore_ascii_case(&cell.checksum) {
        return Ok(());
    }
    // The checksum of what stands here is not told: whoever changed the file would only have to copy it.
    let what =
        format!("is {expected}, but the configuration in this file has another: it was changed since it was approved");
    Err(v.error(what).hint(
        "what was approved; or whoever answers for the change takes the line out, checks the cell and approves it anew",
    ))
}

impl Cell {
    /// Reads and resolves a cell file.
    ///
    /// # Errors
    /// [`FormatError`] names file, line, what is wrong and what to write instead.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        CellFile::read(path)?.resolve()
    }

    /// Resolves text as if it stood in the file `path`.
    ///
    /// # Errors
    /// As for [`Cell::load`].
    ///
    /// ```
    /// let error = elbowroom_cell::Cell::parse("cell.toml", "version = 1\nunit = 5\n").unwrap_err();
    /// assert_eq!(error.line, Some(2));
    /// assert!(error.to_string().contains("units"));
    /// ```
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        CellFile::parse(path, text)?.resolve()
    }

    /// Index of the robot of this name.
    pub fn robot(&self, name: &str) -> Option<usize> {
        self.robots.iter().position(|r| r.name == name)
    }
}

fn version(root: &Table<'_>) -> Result<()> {
    let v = root.need("version", "version = 1")?;
    let number = v.number()?;
    if number == 1.0 {
        return Ok(());
    }
    Err(v.error(format!("is {number}; this program reads version 1")).hint("version = 1"))
}

fn name(root: &Table<'_>) -> Result<String> {
    match root.get("name") {
        Some(v) => v.text().map(str::to_owned),
        None => Ok(root.file.file_stem().map_or_else(|| "cell".into(), |s| s.to_string_lossy().into_owned())),
    }
}

fn tick_ms(v: &Value<'_>) -> Result<f64> {
    let ms = v.positive()?;
    if (0.01..=1000.0).contains(&ms) {
        return Ok(ms);
    }
    Err(v.error(format!("is {ms} ms")).hint("tick_ms = 2   (0.01 to 1000)"))
}

/// Age of input from which on it is not trusted: whoever sets it to seconds has no watchdog.
fn stale_ms(v: &Value<'_>, warnings: &mut Vec<Warning>) -> Result<f64> {
    let ms = v.positive()?;
    if ms > 1000.0 {
        let what = format!("is {ms} ms: for so long a robot would go on by input that nobody has renewed");
        return Err(v.error(what).hint("stale_ms = 20   (at most 1000)"));
    }
    if ms > 100.0 {
        let what = format!("`{}` is {ms} ms: a robot at 1 m/s goes {ms} mm before lost input stops it", v.name);
        warnings.push(Warning::new(v.file, v.line, what).hint("stale_ms = 20   (a few ticks)"));
    }
    Ok(ms)
}

fn laws(root: &Table<'_>, warnings: &mut Vec<Warning>) -> Result<CellLaws> {
    // By default the reaction is the time until the next tick obeys.
    let tick_s = root.get("tick_ms").map_or(Ok(2.0), |v| tick_ms(&v))? / 1000.0;
    let Some(v) = root.get("monitor") else {
        return Ok(CellLaws { reaction_s: tick_s, ..CellLaws::default() });
    };
    let t = v.table("[monitor]")?;
    t.only(&["direction_aware", "recovery", "stopping_distance", "reaction_ms", "override_rate", "stale_ms"])?;
    let mut laws = Laws { direction_aware: t.flag_or("direction_aware", false)?, ..Laws::default() };
    if let Some(v) = t.get("recovery") {
        laws.recovery = v.percent()?;
    }
    if let Some(v) = t.get("override_rate") {
        laws.override_rate = v.not_negative()?;
    }
    if let Some(v) = t.get("stale_ms") {
        laws.stale_s = stale_ms(&v, warnings)? / 1000.0;
    }
    let reaction_s = t.get("reaction_ms").map_or(Ok(tick_s), |v| v.not_negative().map(|ms| ms / 1000.0))?;
    let stopping = t.flag_or("stopping_distance", false)?;
    Ok(CellLaws {
        laws,
        reaction_s,
        stopping_reaction_s: stopping.then_some(reaction_s),
        obeyed_after_s: if t.get("reaction_ms").is_some() { reaction_s } else { 0.0 },
    })
}

fn regions(root: &Table<'_>, cell: &mut Cell, warnings: &mut Vec<Warning>) -> Result<()> {
    let mut known = region::Known {
        robots: &cell.robots,
        encoders: &cell.encoders,
        objects: &cell.objects,
        movers: &cell.movers,
        pose_tracks: Vec::new(),
    };
    let mut regions = Vec::new();
    for (name, t) in root.named("region")? {
        let region = region::read(name, &t, cell.units, &mut known, warnings)?;
        guarding::check(&t, &region, &cell.robots, warnings)?;
        regions.push(region);
    }
    cell.pose_tracks = known.pose_tracks;
    cell.regions = regions;
    Ok(())
}

/// The robot that a table `[map.NAME]` or `[program.NAME]` is about.
fn robot_of<'a>(name: &str, t: &Table<'_>, robots: &'a [CellRobot]) -> Result<(usize, &'a CellRobot)> {
    robots.iter().enumerate().find(|(_, r)| r.name == name).ok_or_else(|| {
        t.error(format!("`{}` is about the robot \"{name}\", which is not in this cell", t.name))
            .hint(suggest::hint(name, robots.iter().map(|r| r.name.as_str())))
    })
}

fn programs(root: &Table<'_>, cell: &mut Cell, warnings: &mut Vec<Warning>) -> Result<()> {
    let mut programs = vec![None; cell.robots.len()];
    for (name, t) in root.named("program")? {
        let (index, robot) = robot_of(name, &t, &cell.robots)?;
        programs[index] = Some(program::read(&t, cell.units, robot, &cell.regions, warnings)?);
    }
    cell.programs = programs;
    Ok(())
}

fn maps(root: &Table<'_>, cell: &Cell) -> Result<Vec<MapSpec>> {
    let mut maps = Vec::new();
    for (name, t) in root.named("map")? {
        t.only(&["joints", "step", "others"])?;
        let (index, robot) = robot_of(name, &t, &cell.robots)?;
        let names = robot.joint_names();
        let default = MapSpec::of(index, robot);
        let joints = match t.get("joints") {
            None => default.joints,
            Some(v) => {
                v.list("joints = [\"joint_1\"]")?.iter().map(|v| map_joint(v, &names)).collect::<Result<Vec<_>>>()?
            }
        };
        let step = match t.get("step") {
            None => joints.iter().map(|j| MapSpec::default_step(robot, *j)).collect(),
            Some(v) => map_steps(&v, &joints, |j, x| cell.units.joint(robot.slides(j), x))?,
        };
        let others_at_start = t.get("others").map_or(Ok(false), |v| v.word(&[("any", false), ("start", true)]))?;
        maps.push(MapSpec { robot: index, line: t.line, joints, step, others_at_start });
    }
    Ok(maps)
}

fn map_joint(v: &Value<'_>, names: &[String]) -> Result<usize> {
    let name = v.text()?;
    names.iter().position(|n| n == name).ok_or_else(|| {
        v.error(format!("names the joint \"{name}\", which the robot does not have"))
            .hint(suggest::hint(name, names.iter().map(String::as_str)))
    })
}

fn map_steps(v: &Value<'_>, joints: &[usize], convert: impl Fn(usize, f64) -> f64) -> Result<Vec<f64>> {
    if v.is_number() {
        let step = v.positive()?;
        return Ok(joints.iter().map(|j| convert(*j, step)).collect());
    }
    let list = v.list("step = 2")?;
    if list.len() != joints.len() {
        let what = format!("has {} values for {} joints", list.len(), joints.len());
        return Err(v.error(what).hint("one number, or one per joint"));
    }
    list.iter().zip(joints).map(|(v, j)| v.positive().map(|x| convert(*j, x))).collect()
}
