//! Every query on every set of poses, addressed by number.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use elbowroom_proximity::advanced::{colliding_triangles, mesh_separation, mesh_separation_with, triangles_within};
use elbowroom_proximity::{DistanceSettings, TriMesh, WarmStart, Workspace};

use crate::arm::{DISTANCES, LINKS};
use crate::files::{Outcome, Poses, read_mesh, read_meta, read_poses};
use crate::paths::{STEPS, TAGS};
use crate::robots::Arms;

const LIB: &str = "elbowroom";
const ROBOT_TOLERANCE: f64 = 0.05;

/// One query on the poses of one set.
pub struct Cell {
    pub lib: String,
    pub set: String,
    pub query: &'static str,
    pub records: usize,
    /// Largest extent of a mesh, metres.
    pub size: f64,
    pub tolerance: f64,
    pub query_records: Box<dyn Query>,
}

/// The answer for a record: 0 or 1, or metres. The loop is inside, so that the dynamic call is made once per round.
pub trait Query {
    fn answer(&mut self, record: usize) -> f64;
    /// Queries the first `records` records, `passes` times; returns the sum of the answers.
    fn pass(&mut self, records: usize, passes: usize) -> f64;
}

impl<F: FnMut(usize) -> f64> Query for F {
    fn answer(&mut self, record: usize) -> f64 {
        self(record)
    }

    fn pass(&mut self, records: usize, passes: usize) -> f64 {
        let mut sum = 0.0;
        for _ in 0..passes {
            for record in 0..records {
                sum += self(record);
            }
        }
        sum
    }
}

/// All cells of `data` and of `extra`; sets whose file is missing are skipped.
pub fn all(data: &Path, extra: &Path) -> Outcome<Vec<Cell>> {
    let mut cells = Vec::new();
    for tag in TAGS {
        if !data.join(format!("{tag}.meta")).is_file() {
            continue;
        }
        let [size, tolerance] = read_meta(&data.join(format!("{tag}.meta")))?;
        let mesh = |side| Ok::<_, String>(Rc::new(read_mesh(&data.join(format!("{tag}_{side}.stl")))?));
        let pair = MeshPair { a: mesh("A")?, b: mesh("B")?, size, tolerance };
        for band in ["touch", "near", "far", "random", "near_path", "far_path"] {
            let set = format!("{tag}_{band}");
            let folder = if matches!(band, "touch" | "near" | "far") { data } else { extra };
            let file = folder.join(format!("{set}.pose"));
            if file.is_file() {
                pair.add(&set, read_poses(&file)?, &mut cells);
            }
        }
    }
    add_arms(data, &mut cells)?;
    Ok(cells)
}

struct MeshPair {
    a: Rc<TriMesh>,
    b: Rc<TriMesh>,
    size: f64,
    tolerance: f64,
}

impl MeshPair {
    fn add(&self, set: &str, poses: Poses, cells: &mut Vec<Cell>) {
        let poses = Rc::new(poses);
        let mut add = |lib: &str, query, query_records| {
            let (lib, set, records) = (lib.to_owned(), set.to_owned(), poses.len());
            cells.push(Cell { lib, set, query, records, size: self.size, tolerance: self.tolerance, query_records });
        };
        if !set.ends_with("_path") {
            add(LIB, "collide", self.colliding_triangles(&poses));
            add(LIB, "tolerance", self.within(&poses));
        }
        add(LIB, "distance", self.distance(&poses));
        if set.ends_with("_path") {
            add("elbowroom+warm", "distance", self.warm(&poses));
        }
    }

    fn colliding_triangles(&self, poses: &Rc<Poses>) -> Box<dyn Query> {
        let (a, b, poses, mut workspace) = (self.a.clone(), self.b.clone(), poses.clone(), Workspace::new());
        Box::new(move |i| {
            let p = poses.record(i);
            f64::from(u8::from(colliding_triangles(&a, &p[0], &b, &p[1], &mut workspace).is_some()))
        })
    }

    fn within(&self, poses: &Rc<Poses>) -> Box<dyn Query> {
        let (a, b, poses, mut workspace) = (self.a.clone(), self.b.clone(), poses.clone(), Workspace::new());
        let tolerance = self.tolerance;
        Box::new(move |i| {
            let p = poses.record(i);
            f64::from(u8::from(triangles_within(&a, &p[0], &b, &p[1], tolerance, &mut workspace).is_some()))
        })
    }

    fn distance(&self, poses: &Rc<Poses>) -> Box<dyn Query> {
        let (a, b, poses, mut workspace) = (self.a.clone(), self.b.clone(), poses.clone(), Workspace::new());
        Box::new(move |i| {
            let p = poses.record(i);
            mesh_separation(&a, &p[0], &b, &p[1], &mut workspace).distance
        })
    }

    /// Every step warm-starts the next; a path starts cold.
    fn warm(&self, poses: &Rc<Poses>) -> Box<dyn Query> {
        let (a, b, poses, mut workspace) = (self.a.clone(), self.b.clone(), poses.clone(), Workspace::new());
        let mut warm_start = WarmStart::default();
        Box::new(move |i| {
            let p = poses.record(i);
            if i % STEPS == 0 {
                warm_start = WarmStart::default();
            }
            let settings = DistanceSettings { warm_start: Some(&mut warm_start), ..DistanceSettings::default() };
            let near = mesh_separation_with(&a, &p[0], &b, &p[1], settings, &mut workspace);
            // Without a limit the answer is always `Some`; a NaN would be counted as a disagreement.
            near.map_or(f64::NAN, |near| near.distance)
        })
    }
}

fn add_arms(data: &Path, cells: &mut Vec<Cell>) -> Outcome<()> {
    if !data.join("robot_link0.stl").is_file() {
        return Ok(());
    }
    let links: Outcome<Vec<TriMesh>> =
        (0..LINKS).map(|k| read_mesh(&data.join(format!("robot_link{k}.stl")))).collect();
    let arms = Arms::new(links?);
    let (size, arms) = (arms.size(), Rc::new(RefCell::new(arms)));
    for name in DISTANCES.into_iter().chain(["hard"]) {
        let file = data.join(format!("robots_{name}.pose"));
        if !file.is_file() {
            continue;
        }
        let poses = Rc::new(read_poses(&file)?);
        if poses.bodies != 2 * LINKS {
            return Err(format!("{}: {} bodies a record, not {}", file.display(), poses.bodies, 2 * LINKS));
        }
        let mut add = |query, query_records| {
            let (lib, set, records) = (LIB.to_owned(), format!("robots_{name}"), poses.len());
            cells.push(Cell { lib, set, query, records, size, tolerance: ROBOT_TOLERANCE, query_records });
        };
        let (shared, p) = (arms.clone(), poses.clone());
        add("collide", Box::new(move |i| f64::from(u8::from(shared.borrow_mut().collides(p.record(i))))));
        let (shared, p) = (arms.clone(), poses.clone());
        let within = move |i| shared.borrow_mut().within(p.record(i), ROBOT_TOLERANCE);
        add("tolerance", Box::new(move |i| f64::from(u8::from(within(i)))));
        let (shared, p) = (arms.clone(), poses.clone());
        add("distance", Box::new(move |i| shared.borrow_mut().distance(p.record(i))));
    }
    Ok(())
}
