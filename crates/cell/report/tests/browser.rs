//! The page in headless Chromium.
//!
//! Its distances are the engine's, its controls work, it fits a narrow screen, and no error reaches the console.
//!
//! Needs Chromium, named by `ELBOWROOM_CHROMIUM`; without it the tests pass with a message.

use std::path::Path;

use elbowroom_cell::{Cell, configure};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Guards, RegionId, RegionSweep};
use elbowroom_proximity::separation;
use elbowroom_report::{HtmlReport, ReportScene};
use elbowroom_sim::{Recording, RunOptions, simulate};
use elbowroom_testkit::random::{split_mix, unit};
use serde_json::{Value, json};

use crate::chromium::{chromium, folder, seen};

/// Tolerance between the page and the engine, m.
const AGREED_M: f64 = 1e-7;
/// Tolerance of a shown number, m: it has three decimals of a millimetre.
const SHOWN_M: f64 = 0.51e-6;
/// Configurations to which the sliders are set.
const CONFIGURATIONS: usize = 40;

/// Every kind of region and of object around the arm of figure 12.
const CELL: &str = r#"
version = 1
name = "shapes"
units = { length = "mm", angle = "deg" }
tick_ms = 4
[robot.arm]
model = "MODELS/ns16/ns16.urdf"
start = [-90, 0, 0, 0, 0, 0]
[object.table]
shape = "box"
at = [1100, 900, 300]
size = [600, 400, 600]
rpy = [0, 0, 20]
[object.barrel]
shape = "cylinder"
at = [-400, 1500, 450]
radius = 300
height = 900
rpy = [30, 10, 0]
[object.pipe]
shape = "capsule"
at = [-900, -900, 1200]
radius = 80
height = 900
rpy = [70, 0, 40]
[object.wedge]
shape = "mesh"
mesh = "wedge.stl"
at = [1500, -900, 200]
[grid.area]
from = [-500, -1500, 0]
to = [1500, 1500, 1800]
cells = [4, 6, 2]
output = 8
[region.post]
shape = "cylinder"
base = [900, 0, 0]
radius = 100
height = 2000
warning = 300
[region.ball]
shape = "sphere"
centre = [400, -1100, 1500]
radius = 250
kind = "monitored"
warning = 100
[region.desk]
shape = "box"
from = [-1200, 300, 0]
to = [-700, 900, 700]
warning = 200
guards = ["tcp"]
[region.wall]
shape = "plane"
origin = [-1500, 0, 0]
x = [-1500, 1, 0]
y = [-1500, 0, 1]
warning = 200
[region.ramp]
shape = "mesh"
mesh = "wedge.stl"
at = [300, 1300, 900]
warning = 150
[region.crystal]
shape = "convex"
mesh = "wedge.stl"
at = [-300, -1500, 600]
warning = 150
[program.arm]
steps = [{ move = "joint", to = [90, 0, 0, 0, 0, 0], speed = 50 }]
"#;

/// A closed tetrahedron, m.
const WEDGE: &str = "solid wedge
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0.5 0 vertex 0.6 0 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0.6 0 0 vertex 0.1 0.1 0.7 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0.1 0.1 0.7 vertex 0 0.5 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 0.6 0 0 vertex 0 0.5 0 vertex 0.1 0.1 0.7 endloop endfacet
endsolid wedge
";

/// After all other scripts: acts as a user, and writes what it saw into the document.
const PERSON: &str = "<script>
(async () => {
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  for (let k = 0; k < 400 && !document.documentElement.dataset.ready; k++) await pause(25);
  const seen = { problems, width: innerWidth, scroll: document.documentElement.scrollWidth, steps: [] };
  seen.opens_s = elbowroom.state().t_s;
  seen.play_ends_px = document.getElementById('play').getBoundingClientRect().bottom + scrollY;
  seen.cut = [...document.querySelectorAll('.scroll')].filter((box) => box.scrollWidth > box.clientWidth + 1).map((box) => box.textContent.slice(0, 60));
  const note = () => {
    const rows = [...document.querySelectorAll('#distances tbody tr')].map((row) => ({
      name: row.dataset.name, metres: Number(row.dataset.metres), shown: row.querySelector('.number').textContent,
    }));
    seen.steps.push({ rows, state: elbowroom.state() });
  };
  const press = (key) => document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
  try {
    const scrub = document.getElementById('scrub');
    scrub.value = scrub.max;
    scrub.dispatchEvent(new Event('input', { bubbles: true }));
    note();
    press('Home');
    note();
    press('m');
    for (const q of CONFIGURATIONS) {
      q.forEach((value, k) => {
        const slider = document.getElementById(`joint-0-${k}`);
        slider.value = String(value);
        slider.dispatchEvent(new Event('input', { bubbles: true }));
      });
      note();
    }
    press('m');
    note();
    const text = (id) => document.getElementById(id).getAttribute('aria-label') || document.getElementById(id).textContent;
    seen.unnamed = [...document.querySelectorAll('button, input, select, canvas, .plot')].filter((e) =>
      !(e.getAttribute('aria-label') || e.textContent.trim() || (e.labels && e.labels.length))).map((e) => e.outerHTML);
    seen.play = text('play');
    const wide = [...document.querySelectorAll('main *')].filter((e) =>
      !e.closest('.scroll, .plot, .canvas-box, svg') && e.getBoundingClientRect().right > innerWidth + 1);
    seen.wide = wide.map((e) => e.outerHTML.slice(0, 200));
  } catch (error) {
    problems.push(String(error.stack));
  }
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = btoa(unescape(encodeURIComponent(JSON.stringify(seen))));
  (frameElement ? parent : window).document.body.replaceChildren(out);
})();
</script>";

fn cell(folder: &Path) -> Cell {
    let models = elbowroom_testkit::folder::examples().join("models");
    std::fs::write(folder.join("wedge.stl"), WEDGE).unwrap();
    let file = folder.join("cell.toml");
    std::fs::write(&file, CELL.replace("MODELS", &models.display().to_string())).unwrap();
    Cell::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

fn recording(cell: &Cell, monitored: bool) -> Recording {
    let options = RunOptions { apply_override: monitored, ..RunOptions::default() };
    simulate(cell, &options).unwrap_or_else(|e| panic!("{e}")).recording
}

/// A report to open, and the actions of the user in it.
struct Visit<'a> {
    scene: &'a ReportScene,
    run: &'a Recording,
    planned: &'a Recording,
    /// Joint values to which the sliders are set.
    q: &'a [Vec<f64>],
    /// Width of the screen, px. Headless Chromium has windows of 500 px and more, so a narrow screen is a frame.
    width: u32,
}

/// Opens the report, acts as a user, and returns what was seen.
fn visit(chromium: &Path, folder: &Path, visit: &Visit<'_>) -> Value {
    let Visit { scene, run, planned, q, width } = *visit;
    let mut page = Vec::new();
    HtmlReport::new(scene, &[("monitor on", run)]).planned(planned).write(&mut page).unwrap();
    let page = String::from_utf8(page).unwrap();
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    let person = PERSON.replace("CONFIGURATIONS", &json!(q).to_string());
    seen(chromium, folder, &page.replace("</body>", &format!("{person}</body>")), width)
}

/// The engine's distances of the arm in this configuration: regions by the monitor's own query, objects by the guarded volumes.
fn engine(cell: &Cell, q: &[f64]) -> Vec<(String, f64)> {
    let setup = &configure::setups(cell).unwrap()[0];
    let config = &setup.configuration;
    let mut sweep = RegionSweep::new(config);
    assert!(sweep.advance(config, q, &[], cell.timing.tick_s));
    let regions = cell
        .regions
        .iter()
        .enumerate()
        .map(|(i, r)| (r.region.name.clone(), sweep.distance(config, RegionId(i), f64::INFINITY).unwrap()));
    let mut all: Vec<_> = regions.collect();
    let robot = &cell.robots[0];
    let mut state = ChainState::new(&robot.robot.chain);
    state.q.copy_from_slice(q);
    robot.robot.chain.forward(&mut state);
    for object in &cell.objects {
        let volumes = robot.guarded_volumes();
        let counted = volumes.iter().filter(|v| v.part.counts_for(Guards::default()));
        let each = counted.map(|v| {
            let in_world = robot.base_in_world * state.link_in_root(v.link) * v.in_link;
            separation(&v.shape, &in_world, &object.shape, &object.in_world).distance
        });
        all.push((object.name.clone(), each.fold(f64::INFINITY, f64::min)));
    }
    all
}

/// Compares a step of the user with the engine; returns the number of contacts.
fn compare(step: &Value, expected: &[(String, f64)]) -> usize {
    let rows = step["rows"].as_array().unwrap();
    assert_eq!(rows.len(), expected.len());
    for (row, (name, metres)) in rows.iter().zip(expected) {
        assert_eq!(row["name"], name.as_str());
        let page = row["metres"].as_f64().unwrap();
        assert!((page - metres).abs() < AGREED_M, "{name}: the page says {page}, the engine {metres}");
        let shown = row["shown"].as_str().unwrap();
        let value =
            if shown.starts_with("contact") { 0.0 } else { shown.split(' ').next().unwrap().parse::<f64>().unwrap() };
        assert!((1e-3 * value - metres).abs() < SHOWN_M, "{name}: shown is {shown}, the engine has {metres}");
    }
    expected.iter().filter(|(_, metres)| *metres == 0.0).count()
}

#[test]
fn moved_joints_show_the_distances_of_the_engine() {
    let Some(chromium) = chromium() else { return };
    let folder = folder("distances");
    let cell = cell(&folder);
    let (run, planned) = (recording(&cell, true), recording(&cell, false));
    let chain = &cell.robots[0].robot.chain;
    let (lower, upper) = (chain.lower(), chain.upper());
    let mut random = 7;
    let mut value = |k: usize| lower[k] + (upper[k] - lower[k]) * unit(split_mix(&mut random));
    let q: Vec<Vec<f64>> = (0..CONFIGURATIONS).map(|_| (0..chain.dof()).map(&mut value).collect()).collect();
    let scene = ReportScene::of_cell(&cell);
    let seen = visit(&chromium, &folder, &Visit { scene: &scene, run: &run, planned: &planned, q: &q, width: 1280 });

    let steps = seen["steps"].as_array().unwrap();
    assert_eq!(steps.len(), CONFIGURATIONS + 3);
    let samples = &run.robots[0].samples;
    let (first, last) = (samples.first().unwrap(), samples.last().unwrap());
    compare(&steps[0], &engine(&cell, &last.q));
    compare(&steps[1], &engine(&cell, &first.q));
    compare(steps.last().unwrap(), &engine(&cell, &first.q));
    // The stop at the post, as the monitor recorded it.
    let post = &steps[0]["state"]["distances"][0];
    assert_eq!((post["name"].as_str(), post["part"].as_str()), (Some("post"), run.robots[0].governing_part(last)));
    assert!((post["distance_m"].as_f64().unwrap() - last.distance_m.unwrap()).abs() < AGREED_M);
    let contacts: usize = steps[2..]
        .iter()
        .zip(&q)
        .map(|(step, q)| {
            assert_eq!(step["state"]["moved"], json!(true));
            compare(step, &engine(&cell, q))
        })
        .sum();
    assert!(contacts > 0, "some configuration touches something");
    assert_eq!(seen["unnamed"], json!([]), "controls without a name");
    assert_eq!(seen["play"], json!("play"));
    // It opens at the stop of the robot, and the play control is visible without scrolling on a screen of 1280 by 800.
    let [opens_s, stopped_s] = [seen["opens_s"].as_f64().unwrap(), run.robots[0].stops[0].from_s];
    assert!((opens_s - stopped_s).abs() < 1e-6, "{opens_s} {stopped_s}");
    assert!(seen["play_ends_px"].as_f64().unwrap() < 650.0, "{}", seen["play_ends_px"]);
}

#[test]
fn a_narrow_screen_does_not_scroll_sideways() {
    let Some(chromium) = chromium() else { return };
    let folder = folder("narrow");
    let cell = cell(&folder);
    let (run, planned) = (recording(&cell, true), recording(&cell, false));
    let scene = ReportScene::of_cell(&cell);
    let seen = visit(&chromium, &folder, &Visit { scene: &scene, run: &run, planned: &planned, q: &[], width: 390 });
    assert_eq!(seen["width"], json!(390));
    assert_eq!(seen["wide"], json!([]), "reaches beyond {} px", seen["width"]);
    assert_eq!(seen["cut"], json!([]), "a part of these tables is out of sight");
    assert!(seen["scroll"].as_u64() <= seen["width"].as_u64(), "{} > {}", seen["scroll"], seen["width"]);
}

/// An arm that grips a part and comes to rest with it near a wall.
const CARRY: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
tick_ms = 4
[robot.arm]
dh = [{ a = 500, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [{ capsule = { from = [-500, 0, 0], to = [0, 0, 0], radius = 30 } }, { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 20 } }]
[object.part]
shape = "box"
at = [870, 0, 0]
size = [80, 60, 60]
rpy = [0, 0, 10]
[region.wall]
shape = "box"
from = [-1000, 950, -500]
to = [1000, 1100, 500]
warning = 300
[program.arm]
steps = [{ grip = "part" }, { move = "joint", to = [80, 0], speed = 30 }]
"#;

#[test]
fn what_a_robot_holds_counts_in_the_page_as_in_the_monitor() {
    let Some(chromium) = chromium() else { return };
    let folder = folder("held");
    let cell = Cell::parse("carry.toml", CARRY).unwrap_or_else(|e| panic!("{e}"));
    let (run, planned) = (recording(&cell, true), recording(&cell, false));
    let q = vec![vec![0.3, -0.4], vec![1.2, 0.5], vec![-2.0, 1.0]];
    let scene = ReportScene::of_cell(&cell);
    let seen = visit(&chromium, &folder, &Visit { scene: &scene, run: &run, planned: &planned, q: &q, width: 1280 });
    let steps = seen["steps"].as_array().unwrap();
    let robot = &run.robots[0];
    let last = robot.samples.last().unwrap();
    let wall = |step: &Value| step["state"]["distances"][0].clone();
    assert_eq!(wall(&steps[0])["part"], "part");
    assert_eq!(robot.governing_part(last), Some("part"));
    assert!((wall(&steps[0])["distance_m"].as_f64().unwrap() - last.distance_m.unwrap()).abs() < AGREED_M);

    let at = &cell.robots[0];
    let link = |q: &[f64], link| {
        let mut state = ChainState::new(&at.robot.chain);
        state.q.copy_from_slice(q);
        at.robot.chain.forward(&mut state);
        at.base_in_world * state.link_in_root(link)
    };
    let part = &cell.objects[0];
    let part_in_link = link(&at.start, at.flange).inverse_mul(&part.in_world);
    let region = &cell.regions[0].region;
    let region_in_world = region.anchor * region.shape_in_anchor;
    for (step, q) in steps[2..].iter().zip(&q) {
        let mut volumes: Vec<_> = at.guarded_volumes();
        volumes.retain(|v| v.part.counts_for(region.guards));
        let own = volumes.iter().map(|v| (v.shape.clone(), link(q, v.link) * v.in_link));
        let held = (part.shape.clone(), link(q, at.flange) * part_in_link);
        let each =
            own.chain([held]).map(|(shape, pose)| separation(&shape, &pose, &region.shape, &region_in_world).distance);
        let metres = each.fold(f64::INFINITY, f64::min);
        let page = wall(step)["distance_m"].as_f64().unwrap();
        assert!((page - metres).abs() < AGREED_M, "{q:?}: the page says {page}, the engine {metres}");
    }
}
