//! The cell file: TOML to [`Cell`](crate::Cell). `docs/cell-file.md` describes every key.

mod avoidance;
mod camera;
mod cloud;
mod definitions;
mod document;
mod fence;
mod fixture;
mod fixture_tool;
mod flange;
mod follow;
mod force;
mod goal;
mod grid;
mod guarding;
mod guide;
mod joint_limits;
mod mechanism;
mod models;
mod object;
mod operator;
mod planning_scene;
mod plausibility;
mod poses;
mod program;
mod region;
mod region_list;
mod robot;
mod schema;
mod sensor;
mod tools;
mod units;
mod virtual_robot;

use std::path::Path;

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_monitor::{Laws, RobotSet};
use elbowroom_robot::{GeometryId, RobotId};

pub use document::CellFile;
pub(crate) use document::REGION_TABLES;
pub(crate) use region_list::with_only_region;
use robot::robot_of;
pub use schema::key_reference;
use schema::names;
pub use units::QUATERNION_TOLERANCE;

use crate::{
    Approval, Cell, CellPairRules, CellRegionId, CellRobot, CellSensor, CellTiming, FrameSources, Guidance, MapSpec,
    Monitoring, PairFile, QueryModel, Units, configure, joint_contacts, rest_pose_contacts, seal,
};

type Result<T> = std::result::Result<T, Diagnostic>;

impl CellFile {
    /// Resolves all names, reads the named files, and converts to SI units.
    ///
    /// A file from disk must match its seal, if it has one or needs one: see [`seal`](crate::seal).
    ///
    /// # Errors
    /// [`Diagnostic`] at the first wrong line, or the first line that differs from the seal.
    pub fn resolve(&self) -> Result<Cell> {
        let mut warnings = Vec::new();
        let root = Table { file: &self.file, name: String::new(), line: 1, entries: &self.entries };
        root.only(&names(&[schema::TOP]))?;
        version(&root)?;
        let units = Units::read(&root)?;
        let mut cell = Cell {
            file: self.file.clone(),
            name: name(&root)?,
            units,
            timing: CellTiming {
                tick_s: root.get("tick_ms").map_or(Ok(2.0), |v| tick_ms(&v))? / 1000.0,
                max_s: root.get("max_s").map_or(Ok(600.0), |v| v.positive())?,
            },
            robots: Vec::new(),
            objects: Vec::new(),
            moving_objects: Vec::new(),
            regions: Vec::new(),
            frame_sources: FrameSources::default(),
            monitoring: monitoring(&root, &mut warnings)?,
            sensors: Vec::new(),
            pair_rules: CellPairRules::default(),
            guidance: Guidance::default(),
            approval: Approval::default(),
            warnings: Vec::new(),
        };
        read_robots(&root, &mut cell, &mut warnings)?;
        region::read_encoders(&root, &mut cell)?;
        object::read(&root, &mut cell)?;
        let scenes = planning_scene::read(&root, &mut cell, &mut warnings)?;
        pairs(&root, &mut cell)?;
        let (rules, found) = joint_contacts::of_cell(&cell);
        cell.pair_rules.joint_contacts = rules;
        warnings.extend(found);
        warnings.extend(contacts_at_start(&cell));
        regions(&root, &mut cell, &mut warnings)?;
        grid::read(&root, &mut cell)?;
        programs(&root, &mut cell, &mut warnings)?;
        // After the programs: regions guard the objects that programs grip.
        for (t, index) in region::tables(&root)?.into_iter().zip(0..) {
            guarding::check(&t.table, &cell, CellRegionId(index), &mut warnings)?;
        }
        maps(&root, &mut cell)?;
        avoidance::read(&root, &mut cell)?;
        cell.sensors = sensors(&root, &cell)?;
        guidance(&root, &mut cell)?;
        // Builds the monitors' configurations, so that anything they refuse is refused here, with its line.
        cell.approval.checksum = configure::checksum(&cell)?;
        if self.on_disk {
            // Before the checksum, because the seal names the differences.
            cell.approval.seal = seal::verify(self, &cell)?;
        }
        check(&root, &cell)?;
        plausibility::check(&root, &cell, &scenes, &mut warnings)?;
        cell.warnings = warnings;
        Ok(cell)
    }
}

/// Compares the checksum with the approved one, if the file states one.
fn check(root: &Table<'_>, cell: &Cell) -> Result<()> {
    let Some(v) = root.get("checksum") else { return Ok(()) };
    let expected = v.text()?;
    if expected.eq_ignore_ascii_case(&cell.approval.checksum) {
        return Ok(());
    }
    // The new checksum is not printed: otherwise it could simply be copied into the file.
    let what =
        format!("is {expected}, but the configuration in this file has another: it was changed since it was approved");
    Err(v.error(what).hint(
        "the approved configuration; or the person responsible for the change removes the line, checks the cell and \
         approves it again",
    ))
}

impl Cell {
    /// Reads and resolves a cell file.
    ///
    /// # Errors
    /// [`Diagnostic`] names file, line, what is wrong and what to write instead.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        CellFile::read(path)?.resolve()
    }

    /// Resolves text as the file `path`.
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

    /// The robot of this name.
    pub fn robot(&self, name: &str) -> Option<RobotId> {
        self.robots.iter().position(|r| r.name == name).map(RobotId)
    }
}

/// Reads what a person guides.
fn guidance(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    fixture::read(root, cell)?;
    operator::read(root, cell)?;
    force::read(root, cell)?;
    virtual_robot::read(root, cell)
}

/// Reads the file of pairs that the cell names.
fn pairs(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    let Some(v) = root.get("pairs") else { return Ok(()) };
    // After the rules of planning scenes, because the file takes precedence.
    let rules = PairFile::read(models::path(&v)?)?.rules(&QueryModel::without_rules(cell))?;
    cell.pair_rules.given.extend(rules);
    Ok(())
}

/// Warnings for links that touch at the start, without a link with collision geometry between them.
fn contacts_at_start(cell: &Cell) -> Vec<Diagnostic> {
    let of_robot = |(i, r): (usize, &CellRobot)| {
        let link = |link| GeometryId::Link { robot: RobotId(i), link };
        let rules = cell.pair_rules.all();
        let is_new = move |a, b| rules.skipped(link(a), link(b)).is_none();
        let warnings = rest_pose_contacts::warnings(&r.robot, &r.start, Some(&r.name), is_new);
        warnings.map(|(what, hint)| Diagnostic::new(&cell.file, r.line, what).hint(hint)).collect::<Vec<_>>()
    };
    cell.robots.iter().enumerate().flat_map(of_robot).collect()
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

/// Age above which input is not trusted; a large value would disable the watchdog.
fn stale_ms(v: &Value<'_>, warnings: &mut Vec<Diagnostic>) -> Result<f64> {
    let ms = v.positive()?;
    if ms > 1000.0 {
        let what = format!("is {ms} ms: for so long a robot would move with outdated input");
        return Err(v.error(what).hint("stale_ms = 20   (at most 1000)"));
    }
    if ms > 100.0 {
        let what = format!("`{}` is {ms} ms: a robot at 1 m/s moves {ms} mm before lost input stops it", v.name);
        warnings.push(Diagnostic::new(v.file, v.line, what).hint("stale_ms = 20   (a few ticks)"));
    }
    Ok(ms)
}

fn monitoring(root: &Table<'_>, warnings: &mut Vec<Diagnostic>) -> Result<Monitoring> {
    // Default reaction time: one tick.
    let tick_s = root.get("tick_ms").map_or(Ok(2.0), |v| tick_ms(&v))? / 1000.0;
    let Some(v) = root.get("monitor") else {
        return Ok(Monitoring { reaction_s: tick_s, ..Monitoring::default() });
    };
    let t = v.table("[monitor]")?;
    t.only(&names(&[schema::MONITOR]))?;
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
    Ok(Monitoring {
        laws,
        reaction_s,
        stopping_reaction_s: stopping.then_some(reaction_s),
        reaction_delay_s: if t.get("reaction_ms").is_some() { reaction_s } else { 0.0 },
        grids: Vec::new(),
    })
}

fn regions(root: &Table<'_>, cell: &mut Cell, warnings: &mut Vec<Diagnostic>) -> Result<()> {
    (cell.regions, cell.frame_sources.pose_tracks) = region_list::read(root, cell, warnings)?;
    Ok(())
}

/// Cameras, then sources of point clouds.
fn sensors(root: &Table<'_>, cell: &Cell) -> Result<Vec<CellSensor>> {
    let viewing = virtual_robot::cameras(root)?;
    let cameras =
        root.named("camera")?.into_iter().map(|(name, t)| camera::read(name, &t, cell, viewing.contains(&name)));
    let clouds = root.named("cloud")?.into_iter().map(|(name, t)| cloud::read(name, &t, cell));
    cameras.chain(clouds).collect()
}

fn programs(root: &Table<'_>, cell: &mut Cell, warnings: &mut Vec<Diagnostic>) -> Result<()> {
    for (name, t) in root.named("program")? {
        let (id, robot) = robot_of(name, &t, &cell.robots)?;
        let program = program::read(&t, cell, robot, warnings)?;
        cell.robots[id.0].program = Some(program);
    }
    Ok(())
}

fn maps(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    for (name, t) in root.named("map")? {
        t.only(&names(&[schema::MAP]))?;
        let (id, robot) = robot_of(name, &t, &cell.robots)?;
        mechanism::refuse_table(&t, robot, "plans no paths around the cells of a map")?;
        let names = robot.joint_names();
        let default = MapSpec::of(robot);
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
        cell.robots[id.0].map = Some(MapSpec { line: t.line, joints, step, others_at_start });
    }
    Ok(())
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

/// The tables `[robot.NAME]`.
fn read_robots(root: &Table<'_>, cell: &mut Cell, warnings: &mut Vec<Diagnostic>) -> Result<()> {
    let mut models = models::RobotModels::default();
    for (name, t) in root.named("robot")? {
        if cell.robots.len() == RobotSet::CAPACITY {
            let what =
                format!("has more than {} robots: deadlocks among others would not be found", RobotSet::CAPACITY);
            return Err(t.error(what).hint("two cells, each with the robots that share regions"));
        }
        cell.robots.push(robot::read(name, &t, cell.units, &mut models, warnings)?);
    }
    Ok(())
}
