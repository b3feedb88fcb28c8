//! parry's runner of `cargo xtask peers`: parry's own queries, and queries built on its public tree.

mod arms;
mod dual;
mod files;
mod serve;

use std::path::Path;
use std::rc::Rc;

use parry3d_f64::query::{self, ClosestPoints};
use parry3d_f64::shape::TriMesh;

use files::{Poses, read_mesh, read_meta, read_poses};
use serve::{Cell, yes};

pub const LIB: &str = "parry-f64";
pub const DUAL: &str = "parry-f64+dual";

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [data, extra] = &args[..] else {
        eprintln!("usage: peer-parry DIR EXTRA");
        std::process::exit(2);
    };
    let (data, extra) = (Path::new(data), Path::new(extra));
    let mut cells = Vec::new();
    for tag in ["m4k", "m23k"] {
        add_pairs(tag, data, extra, &mut cells);
    }
    arms::add(data, &mut cells);
    serve::serve(cells);
}

fn add_pairs(tag: &str, data: &Path, extra: &Path, cells: &mut Vec<Cell>) {
    let meta = data.join(format!("{tag}.meta"));
    if !meta.is_file() {
        return;
    }
    let [size, tolerance] = read_meta(&meta);
    let mesh = |side| Rc::new(read_mesh(&data.join(format!("{tag}_{side}.stl"))));
    let (a, b) = (mesh("A"), mesh("B"));
    for band in ["touch", "near", "far", "random", "near_path", "far_path"] {
        let set = format!("{tag}_{band}");
        let folder = if matches!(band, "touch" | "near" | "far") { data } else { extra };
        let file = folder.join(format!("{set}.pose"));
        if file.is_file() {
            let cell = Cell { set, size, tolerance, ..Cell::default() };
            add_set(&cell, band, [&a, &b], Rc::new(read_poses(&file)), cells);
        }
    }
}

fn add_set(form: &Cell, band: &str, meshes: [&Rc<TriMesh>; 2], poses: Rc<Poses>, cells: &mut Vec<Cell>) {
    let tolerance = form.tolerance;
    // Every question has its own handles on the meshes and poses.
    let own = || (meshes[0].clone(), meshes[1].clone(), poses.clone());
    let mut add = |lib: &str, query, run| cells.push(form.with(lib, query, poses.records(), run));
    let path = band.ends_with("_path");
    if !path {
        let (a, b, p) = own();
        add(DUAL, "collide", Box::new(move |i| yes(dual::close(&a, &b, &p.between(i), 0.0))));
        let (a, b, p) = own();
        add(DUAL, "tolerance", Box::new(move |i| yes(dual::close(&a, &b, &p.between(i), tolerance))));
    }
    if band == "random" {
        return;
    }
    let (a, b, p) = own();
    add(DUAL, "distance", Box::new(move |i| dual::distance(&a, &b, &p.between(i), f64::INFINITY)));
    if path {
        return;
    }
    let (a, b, p) = own();
    let touches = move |i| query::intersection_test(p.one(2 * i), &*a, p.one(2 * i + 1), &*b);
    add(LIB, "collide", Box::new(move |i| touches(i).map_or(f64::NAN, |answer| yes(answer.intersecting))));
    let (a, b, p) = own();
    let points = move |i| query::closest_points(p.one(2 * i), &*a, p.one(2 * i + 1), &*b, tolerance);
    add(LIB, "tolerance", Box::new(move |i| points(i).map_or(f64::NAN, |found| yes(found != ClosestPoints::Disjoint))));
    let (a, b, p) = own();
    let contact = move |i| query::contact(p.one(2 * i), &*a, p.one(2 * i + 1), &*b, tolerance);
    add("parry-f64+contact", "tolerance", Box::new(move |i| contact(i).map_or(f64::NAN, |found| yes(found.is_some()))));
    let (a, b, p) = own();
    let distance = move |i| query::distance(p.one(2 * i), &*a, p.one(2 * i + 1), &*b);
    add(LIB, "distance", Box::new(move |i| distance(i).map_or(f64::NAN, |found| found.distance)));
}
