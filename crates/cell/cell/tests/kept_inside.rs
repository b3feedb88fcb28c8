//! Regions that robots must not leave (`keep = "inside"`) and fences: what a file may say, and what is refused.

use crate::common::{HEAD, rail};
use elbowroom_cell::Cell;
use elbowroom_monitor::Region;
use elbowroom_proximity::{Shape, Sphere, separation};
use elbowroom_spatial::{Pose, Vec3};

fn cell(tables: &str) -> Result<Cell, String> {
    Cell::parse("c.toml", &format!("{HEAD}{}{tables}", rail("a", 0.0))).map_err(|e| e.to_string())
}

/// Distance of a point from the closed side of a region, m.
fn free_m(region: &Region, p: [f64; 3]) -> f64 {
    let point = Shape::Sphere(Sphere { radius: 0.0 });
    let at = region.anchor * region.shape_in_anchor;
    separation(&point, &Pose::from_translation(Vec3::from(p)), &region.shape, &at).distance
}

/// Points at known distances from the border inside, and one that is outside.
type Points = (&'static [([f64; 3], f64)], [f64; 3]);

const SHAPES: &[(&str, Points)] = &[
    (
        "shape = \"box\"\nfrom = [-3000, -1000, -1000]\nto = [3000, 1000, 1500]\n",
        (&[([0.0, 0.0, 1.2], 0.3), ([2.9, 0.0, 0.0], 0.1)], [3.1, 0.0, 0.0]),
    ),
    (
        "shape = \"box\"\nbase = [0, 0, -1000]\nrpy = [0, 0, 90]\nsize = [2000, 6000, 2000]\n",
        (&[([2.9, 0.0, 0.0], 0.1), ([0.0, 0.8, 0.0], 0.2)], [0.0, 1.1, 0.0]),
    ),
    ("shape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 3000\n", (&[([2.5, 0.0, 0.0], 0.5)], [0.0, 0.0, -3.1])),
    (
        "shape = \"cylinder\"\nbase = [0, 0, -500]\nradius = 3000\nheight = 1000\n",
        (&[([0.0, 2.9, 0.0], 0.1), ([0.0, 0.0, 0.3], 0.2)], [0.0, 0.0, 0.6]),
    ),
    (
        "shape = \"capsule\"\nat = [0, 0, 0]\nrpy = [0, 90, 0]\nradius = 500\nheight = 5000\n",
        (&[([2.0, 0.0, 0.3], 0.2), ([2.9, 0.0, 0.0], 0.1)], [3.1, 0.0, 0.0]),
    ),
    // The normal points up: everything below it is inside.
    (
        "shape = \"plane\"\norigin = [0, 0, 500]\nx = [100, 0, 500]\ny = [0, 100, 500]\n",
        (&[([0.0, 0.0, 0.2], 0.3)], [0.0, 0.0, 0.7]),
    ),
];

#[test]
fn what_was_inside_is_free_and_everything_else_is_the_region() {
    for (shape, (inside, outside)) in SHAPES {
        let text = format!("[region.room]\n{shape}keep = \"inside\"\nwarning = 200\n");
        let cell = cell(&text).unwrap_or_else(|e| panic!("{shape}: {e}"));
        // What surrounds the solid is as large as no cell, and no reason to warn.
        assert!(!cell.warnings.iter().any(|w| w.message.contains("large")), "{shape}: {:?}", cell.warnings);
        let region = &cell.regions[0].region;
        for (p, expected) in *inside {
            let found = free_m(region, *p);
            // Curved walls are flat pieces, inside of the solid by 1 mm at most.
            assert!(found <= expected + 1e-9 && found > expected - 1.01e-3, "{shape} {p:?}: {found}");
        }
        assert!(free_m(region, *outside) <= 0.0, "{shape}");
    }
}

#[test]
fn meshes_keep_inside_if_they_are_closed() {
    let dir = tempfile::tempdir().unwrap();
    let corners = "v -3 -1 -1\nv 3 -1 -1\nv 3 1 -1\nv -3 1 -1\nv -3 -1 1\nv 3 -1 1\nv 3 1 1\nv -3 1 1\n";
    let faces = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n";
    std::fs::write(dir.path().join("closed.obj"), format!("{corners}{faces}f 4 1 5 8\n")).unwrap();
    std::fs::write(dir.path().join("open.obj"), format!("{corners}{faces}")).unwrap();
    let load = |shape: &str, mesh: &str| {
        let region = format!(
            "[region.room]\nshape = \"{shape}\"\nat = [0, 0, 0]\nmesh = \"{mesh}\"\nkeep = \"inside\"\nwarning = 200\n"
        );
        std::fs::write(dir.path().join("c.toml"), format!("{HEAD}{}{region}", rail("a", 0.0))).unwrap();
        Cell::load(dir.path().join("c.toml")).map_err(|e| e.to_string())
    };
    for (shape, mesh) in [("mesh", "closed.obj"), ("convex", "closed.obj"), ("convex", "open.obj")] {
        let region = load(shape, mesh).unwrap_or_else(|e| panic!("{e}")).regions.remove(0).region;
        assert!((free_m(&region, [0.0, 0.7, 0.0]) - 0.3).abs() < 1e-9 && free_m(&region, [0.0, 1.1, 0.0]) <= 0.0);
    }
    let e = load("mesh", "open.obj").unwrap_err();
    assert!(e.contains("c.toml:") && e.contains("open") && e.contains("convex"), "{e}");
}

#[test]
fn keeping_inside_is_refused_where_it_has_no_sense_and_where_it_would_not_hold() {
    let region = |more: &str| format!("[region.room]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 3000\n{more}\n");
    for (more, words) in [
        ("keep = \"in\"", ["`region.room.keep`", "inside"]),
        ("keep = 1", ["`region.room.keep`", "inside"]),
        ("keep = \"inside\"\nkind = \"exchange\"\nwarning = 100", ["exchange region", "outside"]),
        ("keep = \"inside\"\nfollow = { encoder = \"belt\" }", ["keeps robots inside", "does not move"]),
    ] {
        let e = cell(&format!("{}[encoder.belt]\nspeed = 1\n", region(more))).unwrap_err();
        assert!(words.iter().all(|word| e.contains(word)) && e.contains("c.toml:"), "{more}: {e}");
    }
    // 80 m from the base: the wall of 50 m ends before it.
    let far = region("keep = \"inside\"").replace("[0, 0, 0]", "[80000, 0, 0]");
    let e = cell(&far).unwrap_err();
    assert!(e.contains("may be beyond it") && e.contains("\"a\""), "{e}");
    // A monitored region tells by its output that the robot has left.
    assert!(cell(&region("keep = \"inside\"\nkind = \"monitored\"\noutput = 3")).is_ok());
}

const FENCE: &str = "[fence.cell]\ncorners = [[-3000, -1000], [3000, -1000], [3000, 1000], [-3000, 1000]]\nheight = 1500\nfloor = -500\nwarning = 300\n";

#[test]
fn a_fence_is_a_region_with_gates() {
    let gates = "gates = [{ from = [3000, -500], to = [3000, 500], top = 400 }]\n";
    let cell =
        cell(&format!("{FENCE}{gates}[region.z]\nshape = \"sphere\"\ncentre = [0, 0, 9000]\nradius = 1\n")).unwrap();
    let names: Vec<&str> = cell.regions.iter().map(|r| r.region.name.as_str()).collect();
    assert_eq!(names, ["z", "cell"]);
    let fence = &cell.regions[1].region;
    assert!((free_m(fence, [2.0, 0.8, 0.0]) - 0.2).abs() < 1e-9);
    assert!(free_m(fence, [3.02, 0.0, 0.2]) > 0.19 && free_m(fence, [3.02, 0.0, 0.5]) <= 0.0);
    assert!((fence.warning_m - 0.3).abs() < 1e-12);
}

#[test]
fn what_is_no_fence_is_refused_with_its_line() {
    for (old, new, line, words) in [
        ("height = 1500\n", "", 1, "height"),
        (
            "[[-3000, -1000], [3000, -1000], [3000, 1000], [-3000, 1000]]",
            "[[0, 0], [1, 1]]",
            2,
            "2 corners, not 3 to 500",
        ),
        ("[3000, -1000], [3000, 1000]", "[3000, 1000], [3000, -1000]", 2, "cross each other"),
        ("warning = 300", "rpy = [0, 0, 1]", 5, "no key `rpy`"),
        ("warning = 300", "keep = \"inside\"", 5, "no key `keep`"),
        ("warning = 300", "gates = [{ from = [0, 0], to = [100, 0] }]", 5, "is on no wall"),
        ("warning = 300", "gates = [{ from = [0, 1000], to = [100, 1000], up = 3 }]", 5, "no key `up`"),
        ("warning = 300", "thickness = 0", 5, "thickness"),
        ("height = 1500", "height = nan", 3, "NaN"),
    ] {
        let head = HEAD.lines().count() + rail("a", 0.0).lines().count();
        let e = cell(&FENCE.replace(old, new)).unwrap_err();
        assert!(e.contains(words) && e.contains(&format!("c.toml:{}", head + line)), "{old} → {new}: {e}");
    }
    let round: Vec<String> = (0..501).map(|i| format!("[{}, {}]", 3000.0 * f64::from(i).cos(), i)).collect();
    let e = cell(&FENCE.replace("[-3000, -1000], [3000, -1000]", &round.join(", "))).unwrap_err();
    assert!(e.contains("503 corners, not 3 to 500"), "{e}");
    let e = cell(&format!("{FENCE}[region.cell]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 1\n")).unwrap_err();
    assert!(e.contains("a fence is a region") && e.contains("another name"), "{e}");
}
