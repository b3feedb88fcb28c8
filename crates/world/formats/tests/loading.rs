//! Loading robots from tasks of the thread pool, as programs do that load many cells at once.

use std::sync::mpsc;
use std::time::Duration;

use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_formats::{MeshData, stl};
use elbowroom_proximity::tessellate::tessellate;
use elbowroom_proximity::{Shape, Sphere};
use rayon::prelude::*;

/// A pool whose tasks all load robots has no thread left: loading must not wait for another thread of its own that waits
/// for the pool.
#[test]
fn robots_are_loaded_by_every_task_of_the_pool() {
    let dir = tempfile::tempdir().unwrap();
    let mut links = Vec::new();
    for i in 0..4 {
        // So fine that its tree is built by several tasks.
        let (vertices, triangles) = tessellate(&Shape::Sphere(Sphere { radius: 0.1 }), 1e-6);
        let mesh = MeshData { name: "ball".into(), vertices, triangles };
        let mut bytes = Vec::new();
        stl::write_binary(&mut bytes, &[mesh]).unwrap();
        std::fs::write(dir.path().join(format!("{i}.stl")), bytes).unwrap();
        let mesh = format!("<mesh filename=\"{i}.stl\"/>");
        links.push(format!("<link name=\"l{i}\"><collision><geometry>{mesh}</geometry></collision></link>"));
    }
    let joint = |i: usize| {
        format!("<joint name=\"j{i}\" type=\"fixed\"><parent link=\"l{}\"/><child link=\"l{i}\"/></joint>", i - 1)
    };
    let joints: String = (1..4).map(joint).collect();
    let urdf = dir.path().join("balls.urdf");
    std::fs::write(&urdf, format!("<robot name=\"balls\">{}{joints}</robot>", links.concat())).unwrap();
    let (done, waits) = mpsc::channel();
    std::thread::spawn(move || {
        let load = |_| robot::load(&urdf, &LoadOptions::default()).unwrap().robot.colliders.len();
        let loaded: Vec<usize> =
            (0..4 * rayon::current_num_threads()).into_par_iter().with_max_len(1).map(load).collect();
        let _ = done.send(loaded);
    });
    let loaded = waits.recv_timeout(Duration::from_mins(2)).expect("loading ends");
    assert!(loaded.iter().all(|links| *links == 4));
}
