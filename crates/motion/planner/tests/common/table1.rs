//! Table 1 of the joint-space paper, with both of its arms: an upright cube, transformed by each model, and paths planned on
//! the result.

use elbowroom_cspace::{
    ConvexObstacle, Grid, GridAxis, Layer, ObstacleModel, OccupancyBitmap, PlanarArm, PlanarMapBuilder,
};
use elbowroom_planner::{GridPlanner, GridPlannerSettings};
use elbowroom_spatial::{Pose, Vec3};

use super::Random;

/// The models of the table, the paper's four first.
pub const MODELS: [ObstacleModel; 7] = [
    ObstacleModel::Sphere,
    ObstacleModel::Spheres(2),
    ObstacleModel::Box,
    ObstacleModel::Slices,
    ObstacleModel::Spheres(4),
    ObstacleModel::Spheres(8),
    ObstacleModel::Exact,
];

/// Pairs of ends between which paths are planned.
const PAIRS: usize = 200;

/// An arm, a grid and a cube.
pub struct Setting {
    pub name: &'static str,
    pub arm: PlanarArm,
    pub grid: Grid,
    /// Centre of the cube in the base frame, m.
    pub centre: Vec3,
    /// Edge of the cube, m.
    pub edge_m: f64,
}

impl Setting {
    /// The cube, shifted.
    pub fn cube(&self, by: Vec3) -> ConvexObstacle {
        let half = Vec3::splat(0.5 * self.edge_m);
        ConvexObstacle::cuboid(Pose::from_translation(self.centre + by), half).expect("a cube")
    }

    pub fn builder(&self) -> PlanarMapBuilder {
        PlanarMapBuilder::new(self.arm, &self.grid).expect("a small grid")
    }

    /// The cells that a model of the cube blocks.
    pub fn blocked(&self, model: ObstacleModel) -> OccupancyBitmap {
        let (mut layer, mut occupancy) = (Layer::new(), OccupancyBitmap::new(self.grid.shape()));
        model.build_layer(&mut self.builder(), &self.cube(Vec3::ZERO), &mut layer);
        occupancy.add(&layer);
        occupancy
    }
}

/// The paper's arm at 5 and 2 degrees, and an arm of a KR125's size.
///
/// The paper states neither its step nor the size and place of its cube. Its limits, θ2 ≥ −30° and θ3 ≥ 90°, are in the
/// angles of [`PlanarArm`].
pub fn settings() -> [Setting; 3] {
    let grid = |step: f64, ranges: [[f64; 2]; 3]| {
        let axis =
            |i: usize, name: &str| GridAxis::from_degrees(name, ranges[i][0], ranges[i][1], step).expect("an axis");
        Grid::new([axis(0, "base"), axis(1, "shoulder"), axis(2, "elbow")]).expect("a small grid")
    };
    let of_paper = [[-150.0, 150.0], [-40.0, 120.0], [-90.0, 0.0]];
    let (small, large) = ((Vec3::new(0.22, 0.0, 0.05), 0.1), (Vec3::new(1.4, 0.0, 0.9), 0.5));
    let setting = |name, arm, grid, (centre, edge_m)| Setting { name, arm, grid, centre, edge_m };
    [
        setting("the paper's arm, 5°", PlanarArm::PAPER, grid(5.0, of_paper), small),
        setting("the paper's arm, 2°", PlanarArm::PAPER, grid(2.0, of_paper), small),
        setting(
            "KR125-sized, 2°",
            PlanarArm::KR125_SIZED,
            grid(2.0, [[-170.0, 170.0], [-90.0, 90.0], [-120.0, 150.0]]),
            large,
        ),
    ]
}

/// What the maps of a setting block, and the paths on them.
pub struct Table {
    /// Cells that each model blocks.
    pub blocked: Vec<usize>,
    /// Share of the pairs, whose ends the exact map leaves free, between which a path was found.
    pub found: Vec<f64>,
    /// Mean length of the paths between the pairs that are connected on all maps, rad.
    pub length_rad: Vec<f64>,
}

impl Table {
    pub fn of(setting: &Setting) -> Self {
        let maps: Vec<OccupancyBitmap> = MODELS.iter().map(|&model| setting.blocked(model)).collect();
        let pairs = pairs(setting, maps.last().expect("the exact map"));
        let lengths: Vec<Vec<Option<f64>>> = maps.iter().map(|map| lengths(setting, map, &pairs)).collect();
        let is_common = |pair: usize| lengths.iter().all(|of_map| of_map[pair].is_some());
        let common: Vec<usize> = (0..PAIRS).filter(|&pair| is_common(pair)).collect();
        let mean = |of_map: &Vec<Option<f64>>| {
            common.iter().filter_map(|&pair| of_map[pair]).sum::<f64>() / common.len() as f64
        };
        Self {
            blocked: maps.iter().map(OccupancyBitmap::blocked).collect(),
            found: lengths.iter().map(|all| all.iter().flatten().count() as f64 / PAIRS as f64).collect(),
            length_rad: lengths.iter().map(mean).collect(),
        }
    }
}

/// Random ends in cells that are free, on both sides of the cube: paths have to lead past it.
pub fn pairs(setting: &Setting, free: &OccupancyBitmap) -> Vec<[[f64; 3]; 2]> {
    let mut random = Random(3);
    let axes = setting.grid.axes();
    let mut side = |sign: f64| loop {
        let q: [f64; 3] = std::array::from_fn(|i| random.between(axes[i].min(), axes[i].max()));
        let q = [sign * q[0].abs(), q[1], q[2]];
        if setting.grid.cell(q).is_some_and(|cell| !free.is_blocked(cell)) {
            return q;
        }
    };
    (0..PAIRS).map(|_| [side(-1.0), side(1.0)]).collect()
}

/// Lengths of the paths on a map, rad; `None` where none was found.
pub fn lengths(setting: &Setting, map: &OccupancyBitmap, pairs: &[[[f64; 3]; 2]]) -> Vec<Option<f64>> {
    let mut planner = GridPlanner::new(&setting.grid, map).expect("a planner");
    let settings = GridPlannerSettings::default();
    pairs.iter().map(|[from, to]| planner.plan(*from, *to, &settings).ok().map(|path| path.length_rad)).collect()
}
