//! What sensors see, in the scene of the report while it is played: the prisms are the outlines that the robots knew of.

use elbowroom_cell::Cell;
use elbowroom_query::watch::{WatchRecord, WatchStatus, WatchedObstacle};
use elbowroom_report::{HtmlReport, ReportScene};
use elbowroom_sim::{Recording, RunOptions, simulate};
use serde_json::{Value, json};

use crate::chromium::{chromium, folder, seen};
use crate::page_data;

/// Outlines of the page are rounded to 1 mm; prisms have single precision.
const ROUNDED_M: f64 = 0.6e-3;

/// Goes to each of some times, and notes what is known, drawn and told.
const PERSON: &str = "<script>
(async () => {
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  for (let k = 0; k < 400 && !document.documentElement.dataset.ready; k++) await pause(25);
  const seen = { problems, steps: [] };
  try {
    for (const t of TIMES) {
      elbowroom.seek(t);
      const { t_s, perceived, drawn } = elbowroom.state();
      seen.steps.push({ t_s, perceived, drawn, told: document.getElementById('perceived').textContent });
    }
  } catch (error) {
    problems.push(String(error.stack));
  }
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = btoa(unescape(encodeURIComponent(JSON.stringify(seen))));
  document.body.replaceChildren(out);
})();
</script>";

/// The example `crate`, in which a crate drives into the way twice.
fn crate_run() -> (Cell, Recording) {
    let cell = Cell::load(elbowroom_testkit::folder::examples().join("crate/cell.toml")).unwrap();
    let recording = simulate(&cell, &RunOptions::default()).unwrap().recording;
    (cell, recording)
}

fn page(cell: &Cell, run: &Recording) -> String {
    let mut page = Vec::new();
    HtmlReport::new(&ReportScene::of_cell(cell), &[("monitor on", run)]).write(&mut page).unwrap();
    String::from_utf8(page).unwrap()
}

/// The record that the robots knew at a time.
fn known(run: &Recording, t_s: f64) -> Option<&WatchRecord> {
    let sensor = &run.sensors[0];
    let usable = |r: &&WatchRecord| r.status == WatchStatus::Accepted && r.t_s + sensor.latency_s <= t_s + 1e-9;
    sensor.records.iter().rfind(usable)
}

/// Lowest and highest corner of the prism of an obstacle, m.
fn corners(o: &WatchedObstacle) -> [[f64; 3]; 2] {
    let range = |axis: usize| {
        let each = o.outline_m.iter().map(|p| p[axis]);
        each.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let ((x0, x1), (y0, y1)) = (range(0), range(1));
    [[x0, y0, o.bottom_m], [x1, y1, o.bottom_m + o.height_m]]
}

fn are_near(found: &Value, exact: [f64; 3]) -> bool {
    (0..3).all(|i| (found[i].as_f64().unwrap() - exact[i]).abs() <= ROUNDED_M)
}

#[test]
fn the_scene_shows_what_the_camera_saw_while_it_saw_it() {
    let Some(chromium) = chromium() else { return };
    let (cell, run) = crate_run();
    let times: Vec<f64> = (0..1000).map(|i| 0.05 + 0.35 * f64::from(i)).take_while(|t| *t < run.duration_s).collect();
    let person = PERSON.replace("TIMES", &json!(times).to_string());
    let page = page(&cell, &run).replace("</body>", &format!("{person}</body>"));
    let seen = seen(&chromium, &folder("perceived"), &page, 1280);
    let steps = seen["steps"].as_array().unwrap();
    assert_eq!(steps.len(), times.len());
    let (mut with, mut without, mut hidden) = (0, 0, 0);
    for step in steps {
        let t_s = step["t_s"].as_f64().unwrap();
        let obstacles = known(&run, t_s).map_or(&[][..], |record| &record.obstacles);
        let [perceived, drawn] = ["perceived", "drawn"].map(|key| step[key].as_array().unwrap());
        assert_eq!((perceived.len(), drawn.len()), (obstacles.len(), obstacles.len()), "{t_s}: {step}");
        for ((o, page), prism) in obstacles.iter().zip(perceived).zip(drawn) {
            assert_eq!((&page["name"], &page["kind"]), (&json!(format!("above#{}", o.id)), &json!(o.kind)), "{t_s}");
            let [low, high] = corners(o);
            let is_right = are_near(&prism["from_m"], low) && are_near(&prism["to_m"], high);
            assert!(is_right && prism["name"] == page["name"], "{t_s}: {prism}, not {low:?} to {high:?}");
            let told = step["told"].as_str().unwrap();
            assert!(told.contains(&format!("above#{}", o.id)) && told.contains("m high"), "{t_s}: {told}");
            assert_eq!((prism["opacity"] == 0.35, told.contains("hidden")), (o.seen, !o.seen), "{t_s}: {told}");
            hidden += usize::from(!o.seen);
        }
        with += usize::from(!obstacles.is_empty());
        without += usize::from(obstacles.is_empty());
        assert_eq!(step["told"] == "no obstacle is seen", obstacles.is_empty(), "{step}");
    }
    eprintln!("{with} times with obstacles, {without} without, {hidden} hidden");
    assert!(with > 5 && with + without == times.len());
}

#[test]
fn pictures_that_change_nothing_and_many_corners_do_not_enlarge_the_page() {
    let (cell, mut run) = crate_run();
    let records = |run: &Recording| {
        let data = page_data::block(&page(&cell, run), "scene-data");
        data["runs"][0]["sensors"][0]["records"].as_array().unwrap().clone()
    };
    let first = records(&run);
    assert!(first.windows(2).all(|pair| pair[0]["obstacles"] != pair[1]["obstacles"]));
    let corners = |records: &[Value]| -> usize {
        let all = records.iter().flat_map(|r| r["obstacles"].as_array().unwrap());
        all.map(|o| o["outline"].as_array().unwrap().len()).sum()
    };
    // A day of pictures of a crate that trembles.
    let template = known(&run, run.duration_s).unwrap().clone();
    let template = run.sensors[0].records.iter().find(|r| !r.obstacles.is_empty()).cloned().unwrap_or(template);
    for i in 0..20_000 {
        let mut record = template.clone();
        record.t_s = run.duration_s + 0.1 * f64::from(i);
        for o in &mut record.obstacles {
            o.outline_m.iter_mut().for_each(|p| p[0] += 0.01 * f64::from(i % 7));
        }
        run.sensors[0].records.push(record);
    }
    let many = records(&run);
    assert!(corners(&many) <= 20_000 && many.len() > 100, "{} {}", corners(&many), many.len());
}
