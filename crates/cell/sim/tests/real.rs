//! Published robots and a recording, if the data is available.

use std::fmt::Write as _;
use std::time::Instant;

use elbowroom_cell::Cell;
use elbowroom_sim::{RunOptions, simulate};
use elbowroom_testkit::folder;

#[test]
fn the_ns16_runs_guarded_with_its_meshes() {
    let Some(data) = folder::data() else { return };
    let dir = data.join("urdf/comau_ns16arc");
    let text = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n[robot.ns16]\nmodel = \"comau_ns16arc.urdf\"\nstart = [-40, 0, -90, 0, 40, 0]\n\
        [region.column]\nshape = \"cylinder\"\nbase = [1150, 0, 0]\nradius = 150\nheight = 2000\nwarning = 250\n\
        [program.ns16]\nsteps = [{ move = \"joint\", to = [40, 0, -90, 0, 40, 0], speed = 10 }]\n";
    let begin = Instant::now();
    let cell = Cell::parse(dir.join("cell.toml"), text).unwrap_or_else(|e| panic!("{e}"));
    let loaded = begin.elapsed();
    let begin = Instant::now();
    let outcome = simulate(&cell, &RunOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let r = &outcome.recording;
    eprintln!(
        "NS16: loaded in {loaded:?}, {} s simulated in {:?}, tick {:?}",
        r.duration_s,
        begin.elapsed(),
        r.tick_ns
    );
    eprintln!("{:?} min distance {:?}", r.robots[0].collisions, r.regions[0].min_distance_m);
    assert!(!r.robots[0].finished && !r.regions[0].entered && r.robots[0].stopped_s > 0.5);
}

#[test]
fn the_tx40_recording_plays_under_whole_arm_guard_faster_than_real_time() {
    let Some(data) = folder::data() else { return };
    let recording = std::fs::read_to_string(data.join("trajectories/staubli_tx40_real/pos_read_data.csv")).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let urdf = data.join("urdf/staubli_tx40/staubli_tx40.urdf");
    // Degrees at 5 kHz, no time column; every tenth row.
    let mut csv = String::from("t_s,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n");
    for (i, line) in recording.lines().skip(1).enumerate().step_by(10) {
        let q: Vec<String> =
            line.split(',').map(|v| v.trim().parse::<f64>().unwrap().to_radians().to_string()).collect();
        writeln!(csv, "{},{}", i as f64 / 5000.0, q.join(",")).unwrap();
    }
    std::fs::write(dir.path().join("tx40.csv"), csv).unwrap();
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[robot.tx40]\nmodel = \"{}\"\n\
         [region.low]\nshape = \"plane\"\norigin = [0, 0, -300]\nx = [1, 0, -300]\ny = [0, 1, -300]\nwarning = 200\n\
         [region.side]\nshape = \"box\"\nbase = [0, 700, -200]\nsize = [2000, 200, 1000]\nwarning = 300\nkind = \"monitored\"\n\
         [region.post]\nshape = \"cylinder\"\nbase = [-500, -500, -200]\nradius = 60\nheight = 1200\nwarning = 150\nkind = \"monitored\"\nslow_to = 50\n\
         [program.tx40]\ntrajectory = \"tx40.csv\"\n",
        urdf.display()
    );
    let cell = Cell::parse(dir.path().join("cell.toml"), &text).unwrap_or_else(|e| panic!("{e}"));
    let begin = Instant::now();
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    let r = &outcome.recording;
    let took = begin.elapsed().as_secs_f64();
    eprintln!(
        "TX40: {} s recorded and {} s played in {took:.3} s: {:.0} times real time, tick {:?}",
        9.0,
        r.duration_s,
        r.duration_s / took,
        r.tick_ns
    );
    eprintln!(
        "{:?} {:?}",
        r.robots[0].collisions,
        r.regions.iter().map(|g| (g.min_distance_m, g.entered)).collect::<Vec<_>>()
    );
    assert!(r.robots[0].finished, "{:?}", r.robots[0].samples.last());
    assert!(r.duration_s > took);
}
