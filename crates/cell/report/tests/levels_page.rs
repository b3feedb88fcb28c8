//! The page of resolution levels in headless Chromium.
//!
//! Its levels are chosen by keys, its box of L1 is that of queries at any joint values, and it fits a narrow screen. Needs
//! Chromium, named by `ELBOWROOM_CHROMIUM`; without it the test passes with a message.

use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_inspect::box_levels;
use elbowroom_report::levels_page;
use elbowroom_robot::{Robot, RobotId};
use elbowroom_scene::{Level, Scene, SceneState};
use elbowroom_spatial::{Aabb, Pose, Vec3};
use elbowroom_testkit::random::Random;
use serde_json::json;

use crate::chromium::{chromium, folder, seen};

/// Acts as a user, and writes what it saw into the document.
const PERSON: &str = "<script>
(async () => {
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  for (let k = 0; k < 400 && !document.documentElement.dataset.ready; k++) await pause(25);
  const seen = { problems, width: innerWidth, scroll: document.documentElement.scrollWidth, levels: [], wholes: [] };
  const press = (key) => document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
  try {
    press('ArrowLeft');
    press('ArrowLeft');
    for (const row of document.querySelectorAll('#levels tr')) {
      seen.levels.push([elbowroom.state().level, elbowroom.state().shown, row.getAttribute('aria-current')]);
      press('ArrowRight');
    }
    document.querySelector('#levels tr').click();
    for (const q of CONFIGURATIONS) {
      q.forEach((value, k) => {
        const slider = document.getElementById(`joint-${k}`);
        slider.value = String(value);
        slider.dispatchEvent(new Event('input', { bubbles: true }));
      });
      seen.wholes.push(elbowroom.state().whole);
    }
    seen.moved = elbowroom.state().shown;
    const wide = [...document.querySelectorAll('main *')].filter((e) =>
      !e.closest('.scroll, .canvas-box') && e.getBoundingClientRect().right > innerWidth + 1);
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

/// The box of queries around the robot.
fn whole(robot: &Robot, q: &[f64]) -> Aabb {
    let mut builder = Scene::builder();
    builder.robot("robot", robot.clone(), Pose::IDENTITY);
    let scene = builder.build().unwrap();
    let mut state = SceneState::new(&scene);
    state.set_q(&scene, RobotId(0), q).unwrap();
    state.robot_box(&scene, RobotId(0)).unwrap()
}

#[test]
fn levels_are_chosen_by_keys_and_the_box_of_the_robot_is_that_of_queries() {
    let Some(chromium) = chromium() else { return };
    let urdf = elbowroom_testkit::folder::model("ns16");
    let robot = robot::load(&urdf, &LoadOptions::default()).unwrap().robot;
    let levels = box_levels(&robot).unwrap();
    let mut r = Random(4);
    let bounds: Vec<_> = robot.chain.lower().into_iter().zip(robot.chain.upper()).collect();
    let q: Vec<Vec<f64>> = (0..6).map(|_| bounds.iter().map(|(low, high)| r.between(*low, *high)).collect()).collect();
    let mut page = Vec::new();
    levels_page::write(&mut page, "<arm>", &robot, &levels).unwrap();
    let page = String::from_utf8(page).unwrap();
    assert!(page.len() < 1_500_000 && page.contains("&lt;arm&gt;"), "{} bytes", page.len());
    let page = page.replace("</body>", &format!("{}</body>", PERSON.replace("CONFIGURATIONS", &json!(q).to_string())));
    for width in [1280, 390] {
        let seen = seen(&chromium, &folder(&format!("levels-{width}")), &page, width);
        let names: Vec<String> = levels.iter().map(|l| l.level).chain([Level::L3]).map(|l| l.to_string()).collect();
        let shown = seen["levels"].as_array().unwrap();
        assert_eq!(shown.len(), names.len());
        for (name, row) in names.iter().zip(shown) {
            assert_eq!((row[0].as_str(), row[2].as_str()), (Some(name.as_str()), Some("true")), "{row}");
        }
        assert_eq!(seen["levels"][2][1].as_str().map(|t| t.starts_with("L2:1: 14 boxes, protruding ")), Some(true));
        for (q, corners) in q.iter().zip(seen["wholes"].as_array().unwrap()) {
            let exact = whole(&robot, q);
            let corner = |k: usize| Vec3::from([0, 1, 2].map(|axis| corners[k][axis].as_f64().unwrap()));
            let (low, high) = (corner(0), corner(7));
            assert!(low.distance(exact.min) < 1e-5 && high.distance(exact.max) < 1e-5, "{low:?} {high:?} {exact:?}");
        }
        assert_eq!(seen["moved"], json!("L1: 1 box"), "its figure holds at rest only");
        assert_eq!((&seen["width"], &seen["wide"]), (&json!(width), &json!([])));
        assert!(seen["scroll"].as_u64() <= seen["width"].as_u64(), "{} > {}", seen["scroll"], seen["width"]);
    }
}
