//! The cells of the schedules: rails side by side whose carriages pass through common regions. Their geometry is written
//! twice, as cell file for the service and as numbers for the judge.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use elbowroom_cell::access::{AccessToken, AccessTokens};
use elbowroom_cell::{Cell, EditedRegions};
use elbowroom_monitor::AccessClass;

use crate::cell_versions::CellVersions;
use crate::service_start::stopping_in_time;

/// Length of a rail, and distance between two rails, m.
pub(super) const RAIL_M: f64 = 2.4;
pub(super) const APART_M: f64 = 0.3;
/// Radius of a carriage, m.
pub(super) const CARRIAGE_M: f64 = 0.05;
/// Speed of the carriages, m/s, and the time in which they stop from it, s.
pub(super) const SPEED_M_S: f64 = 1.0;
pub(super) const STOP_TIME_S: f64 = 0.2;
/// Time until a command counts, ms.
pub(super) const REACTION_MS: u64 = 20;
/// Time for which an override counts, ms.
pub(super) const STALE_MS: u64 = 100;
/// Radius of the region that follows the last carriage or the belt, m.
pub(super) const FOLLOWING_M: f64 = 0.34;
/// Radius of the exchange regions, m, and height per region: region k is between the rails k and k + 1.
pub(super) const EXCHANGE_M: f64 = 0.25;
pub(super) const EXCHANGE_AT_M: [f64; 2] = [0.8, 1.6];
/// Rails beside exchange region k.
pub(super) const fn sharing(region: usize) -> [usize; 2] {
    [region, region + 1]
}
/// The region that programs and people switch: on the first rail.
pub(super) const CART_AT_M: f64 = 1.25;
pub(super) const CART_M: f64 = 0.05;
/// A permanent region at the end of the second rail.
pub(super) const WALL_AT_M: f64 = 2.3;
pub(super) const WALL_M: f64 = 0.05;

/// What follows what in a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Follows {
    Nothing,
    /// A region on the last carriage, for the carriage beside it.
    Carriage,
    /// A region on a measured belt along the last rail.
    Belt,
}

/// Height of the belt at a time, m, and its speed, m/s.
pub(super) fn belt(t_s: f64) -> (f64, f64) {
    let rate = 0.7;
    (1.2 + 0.6 * (rate * t_s).sin(), 0.6 * rate * (rate * t_s).cos())
}

/// A cell that was read from a file, with all that its processes share.
pub(super) struct SimulatedCell {
    pub(super) rails: usize,
    pub(super) follows: Follows,
    pub(super) cell: Arc<Cell>,
    pub(super) versions: Arc<CellVersions>,
    /// The same cell with one more region: some processes have this file.
    pub(super) other: Arc<Cell>,
    pub(super) other_versions: Arc<CellVersions>,
    pub(super) tokens: [AccessToken; 3],
}

impl SimulatedCell {
    /// Reads the cell from a file in this folder.
    pub(super) fn new(rails: usize, follows: Follows, folder: &Path) -> Self {
        let text = text(rails, follows);
        let (cell, versions) = read(&folder.join("cell.toml"), &text);
        let more = "[region.pillar]\nshape = \"sphere\"\ncentre = [5, 5, 5]\nradius = 0.1\nwarning = 0.1\n";
        let (other, other_versions) = read(&folder.join("other.toml"), &(text + more));
        let file = folder.join("tokens.toml");
        let classes = [AccessClass::Operator, AccessClass::Programmer, AccessClass::Integrator];
        for class in classes {
            AccessTokens::add(&file, class, class.name()).expect("a token");
        }
        let tokens = AccessTokens::read(&file).expect("tokens").tokens;
        let tokens = tokens.try_into().expect("three tokens");
        Self { rails, follows, cell, versions, other, other_versions, tokens }
    }
}

fn read(file: &Path, text: &str) -> (Arc<Cell>, Arc<CellVersions>) {
    std::fs::write(file, text).expect("a file");
    let cell = Cell::load(file).unwrap_or_else(|e| panic!("{e}"));
    let edited = EditedRegions::read(&cell).expect("regions");
    let cell = Arc::new(stopping_in_time(cell));
    let versions = CellVersions::new(&cell, Some(edited), stopping_in_time);
    (cell, Arc::new(versions))
}

pub(super) fn name(rail: usize) -> String {
    format!("r{rail}")
}

fn text(rails: usize, follows: Follows) -> String {
    let mut text = format!(
        "version = 1\nname = \"rails\"\nunits = {{ length = \"m\", angle = \"rad\" }}\n[monitor]\nstopping_distance = true\n\
         reaction_ms = {REACTION_MS}\nstale_ms = {STALE_MS}\n"
    );
    for rail in 0..rails {
        let _ = write!(
            text,
            "[robot.r{rail}]\ndh = [{{ kind = \"prismatic\", min = 0, max = {RAIL_M}, speed = {SPEED_M_S} }}]\n\
             links = [{{ sphere = {{ radius = {CARRIAGE_M} }} }}]\nbase = {{ at = [{}, 0, 0] }}\nstop_time = {STOP_TIME_S}\n",
            APART_M * rail as f64
        );
    }
    for region in 0..rails - 1 {
        let [a, b] = sharing(region);
        let _ = write!(
            text,
            "[region.shared{region}]\n{}kind = \"exchange\"\nwarning = 0.3\nrobots = [\"r{a}\", \"r{b}\"]\n",
            sphere(APART_M * (region as f64 + 0.5), EXCHANGE_AT_M[region], EXCHANGE_M)
        );
    }
    let _ = write!(
        text,
        "[region.cart]\n{}warning = 0.2\nlife = \"temporary\"\n[region.wall]\n{}warning = 0.2\n",
        sphere(0.0, CART_AT_M, CART_M),
        sphere(APART_M, WALL_AT_M, WALL_M)
    );
    let (last, beside) = (rails - 1, rails - 2);
    match follows {
        Follows::Nothing => {}
        Follows::Carriage => {
            let _ = write!(
                text,
                "[region.carried]\n{}warning = 0.2\nrobots = [\"r{beside}\"]\nfollow = {{ robot = \"r{last}\", frame = \"flange\" }}\n",
                sphere(0.0, 0.0, FOLLOWING_M)
            );
        }
        Follows::Belt => {
            let _ = write!(
                text,
                "[encoder.belt]\ndirection = [0, 0, 1]\nspeed = 0.5\nmeasured = true\n\
                 [region.carried]\n{}warning = 0.2\nrobots = [\"r{beside}\"]\nfollow = {{ encoder = \"belt\", max_speed = 0.5 }}\n",
                sphere(APART_M * last as f64, 0.0, FOLLOWING_M)
            );
        }
    }
    text
}

/// Keys of a sphere.
pub(super) fn sphere(x: f64, z: f64, radius: f64) -> String {
    format!("shape = \"sphere\"\ncentre = [{x}, 0, {z}]\nradius = {radius}\n")
}
