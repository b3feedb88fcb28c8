//! Random cells.

mod any_robot;
mod carried;
mod cooperating;
mod encounter;
mod exchange;
mod extras;
mod faults;
mod goals;
mod grids;
mod gripping;
mod guided;
mod moving;
mod moving_object;
mod planned;
mod rail;
mod rare;
mod recordings;
mod region;
mod robot;
mod sensors;
mod settings;
mod shields;
mod tools;

use super::random::Random;
use super::spec::{CellSpec, Model, ObjectSpec, StepSpec};

pub use settings::Places;
use settings::settings;

/// Tries to make a robot that can plan on a map.
const TRIES: usize = 30;

/// Kind of a random cell: what it tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Forbidden regions, with the stopping distance on.
    Stop,
    /// Exchange regions of 2 to 6 robots, some of them on objects that move and turn.
    Exchange,
    /// Like `Stop`, with faults in the monitors' input.
    Faults,
    /// Regions on objects and robots that move and turn.
    Moving,
    /// Robots that exchange their tools.
    Tools,
    /// Robots that play recordings, or repeat their programs.
    Recordings,
    /// Like `Stop`, with planned moves.
    Planned,
    /// Robots that a person guides into objects, with shields, guides and forces.
    Guided,
    /// Robots that carry a bar as one, among objects and before regions.
    Cooperating,
    /// Robots that grip parts, carry them past regions and put them down.
    Gripping,
}

impl Kind {
    pub const ALL: [Self; 10] = [
        Self::Stop,
        Self::Exchange,
        Self::Faults,
        Self::Moving,
        Self::Tools,
        Self::Recordings,
        Self::Planned,
        Self::Guided,
        Self::Cooperating,
        Self::Gripping,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Stop => "stop",
            Self::Exchange => "exchange",
            Self::Faults => "faults",
            Self::Moving => "moving",
            Self::Tools => "tools",
            Self::Recordings => "recordings",
            Self::Planned => "planned",
            Self::Guided => "guided",
            Self::Cooperating => "cooperating",
            Self::Gripping => "gripping",
        }
    }

    /// Number of cells of this kind in the test suite: each kind takes a few seconds.
    pub fn suite_cells(self) -> usize {
        match self {
            Self::Stop => 80,
            Self::Faults | Self::Moving | Self::Recordings => 35,
            Self::Exchange | Self::Tools | Self::Gripping => 20,
            Self::Planned => 16,
            Self::Cooperating | Self::Guided => 6,
        }
    }

    /// Returns the random numbers of one case. The first cases, as many as the test suite has, have rare features in turn.
    pub fn random(self, seed: u64, case: u64) -> Random {
        let is_first = case < self.suite_cells() as u64;
        self.plain_random(seed, case).with_rare_features(is_first.then_some(case))
    }

    /// Returns the random numbers of one case without rare features.
    pub fn plain_random(self, seed: u64, case: u64) -> Random {
        Random::of_case(seed, case + ((self as u64) << 32))
    }
}

/// Makes a random cell of a kind; equal streams give equal cells.
pub fn cell(kind: Kind, random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = without_grids(kind, random, places);
    // The oracle does not know when a fault of the input holds the outputs.
    let has_grids = matches!(kind, Kind::Stop | Kind::Exchange | Kind::Moving | Kind::Tools | Kind::Planned);
    if has_grids && let Ok(cell) = spec.parse(places.cells) {
        grids::some(&mut spec, &cell, random);
    }
    if random.percent(10) && !matches!(kind, Kind::Guided | Kind::Cooperating) {
        spec.objects.push(floor(random));
    }
    extras::add(&mut spec, random);
    if !matches!(kind, Kind::Faults | Kind::Tools | Kind::Guided | Kind::Cooperating) {
        sensors::some(&mut spec, kind == Kind::Planned, places, random);
    }
    if spec.repeat == 0 && can_repeat(kind, &spec) && (random.percent(10) || random.rare(3, 5, 0).is_some()) {
        spec.repeat = 2;
    }
    // A planned or guided robot has a scene beside it, or none.
    let is_scene_free = !matches!(kind, Kind::Planned | Kind::Guided | Kind::Cooperating);
    rare::rules(&mut spec, random);
    rare::of_cell(&mut spec, is_scene_free, places, random);
    spec
}

/// A floor far below. Only robots, and the parts that they hold, collide with it.
fn floor(random: &mut Random) -> ObjectSpec {
    let at = [0.0, 0.0, random.between(-4.0, -1.0)];
    ObjectSpec { name: "floor".into(), shape: "shape = \"plane\"\n".into(), at, ..ObjectSpec::default() }
}

/// Whether the programs can run again from where they end; a person who guides a robot does not come again.
fn can_repeat(kind: Kind, spec: &CellSpec) -> bool {
    let grips = |step: &StepSpec| matches!(step, StepSpec::Grip(_));
    !matches!(kind, Kind::Guided | Kind::Cooperating)
        && !spec.robots.iter().any(|robot| robot.program.steps.iter().any(grips))
}

fn without_grids(kind: Kind, random: &mut Random, places: &Places<'_>) -> CellSpec {
    match kind {
        Kind::Exchange => exchange::cell(random),
        Kind::Stop => stop(random, places),
        Kind::Faults => {
            let mut spec = stop(random, places);
            faults::add(&mut spec, random, places);
            spec
        }
        Kind::Moving => carried::cell(random, places),
        Kind::Tools => tools::cell(random, places),
        Kind::Recordings => recordings::cell(random, places),
        Kind::Guided => guided::cell(random, places),
        Kind::Cooperating => cooperating::cell(random, places),
        Kind::Gripping => gripping::cell(random, places),
        Kind::Planned => {
            let mut spec = stop(random, places);
            // Each third of the first cells plans on a map, and another keeps an axis, with three joints or more.
            let needs_joints = random.in_turn(3) != 1 && random.is_first();
            for _ in 0..TRIES {
                let robot = &spec.robots[0];
                let has_few = matches!(robot.model, Model::Dh { .. }) && robot.start.len() < planned::MAPPED;
                if !needs_joints || !has_few {
                    break;
                }
                spec = stop(random, places);
            }
            planned::plan(&mut spec, random);
            if let Ok(cell) = spec.parse(places.cells) {
                planned::keep_axes(&mut spec, &cell, random);
            }
            rare::map(&mut spec, random);
            rare::near_scene(&mut spec, places, random);
            spec
        }
    }
}

fn stop(random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = settings(random);
    spec.robots.push(any_robot::any(random, places));
    if random.percent(15) {
        let mut second = robot::small(random);
        second.at = [random.between(-1.5, 1.5), random.between(-1.5, 1.5), random.between(-0.5, 0.5)];
        spec.robots.push(second);
    }
    // Regions come last: they are placed where the robot will come.
    let Ok(cell) = spec.parse(places.cells) else { return spec };
    for i in 0..random.whole(1, 3) {
        if let Some(region) = region::on_the_path(&spec, &cell, &format!("g{i}"), random) {
            spec.regions.push(region);
        }
    }
    moving::some(&mut spec, random);
    rare::goals(&mut spec, &cell, random);
    spec
}
