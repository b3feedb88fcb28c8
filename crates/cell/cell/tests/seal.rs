//! A seal covers all inputs of the monitors: every number and word of a cell that its checksum depends on.

use crate::common::{ARM, HEAD, rail};
use crate::sealed_cell::sealed;
use elbowroom_cell::Cell;
use elbowroom_cell::seal::history;

/// Every kind of table that affects a monitor.
fn text() -> String {
    format!(
        "{HEAD}{}[robot.c]\n{ARM}base = {{ at = [0, 3000, 0] }}\nstart = [0, 0, 0, 0, 40, 0]\nvolumes = \"capsule\"\nstop_time = 0.2\n\
         [robot.c.tool]\ntcp = {{ at = [0, 0, 250], rpy = [0, 0, 0] }}\nbox = {{ at = [0, 0, 125], size = [80, 80, 250] }}\n\
         [encoder.belt]\ndirection = [1, 0, 0]\nspeed = 100\n\
         [region.column]\nshape = \"cylinder\"\nbase = [900, 0, 0]\nradius = 150\nheight = 1200\nwarning = 250\n\
         guards = [\"tool\"]\nrobots = [\"c\"]\n\
         [region.gate]\nshape = \"box\"\nfrom = [0, 5000, 0]\nto = [100, 5100, 100]\nlife = \"temporary\"\nwarning = 10\n\
         [region.share]\nshape = \"box\"\nfrom = [0, 7000, 0]\nto = [100, 7100, 100]\nkind = \"exchange\"\nwarning = 10\n\
         [region.ride]\nshape = \"sphere\"\ncentre = [0, 9000, 0]\nradius = 100\nwarning = 10\nkind = \"monitored\"\nslow_to = 30\n\
         hysteresis = 2\noutput = 3\nwarning_output = 4\nfollow = {{ encoder = \"belt\" }}\n\
         [monitor]\nstale_ms = 20\nrecovery = 5\noverride_rate = 7\nstopping_distance = true\nreaction_ms = 6\n\
         [program.a]\nsteps = [{{ move = \"joint\", to = [500], speed = 50 }}, {{ wait = 0.1 }}]\n",
        rail("a", 0.0),
    )
}

/// The text with each number increased by one, each quoted word replaced, and each line removed.
fn mutations(text: &str) -> Vec<String> {
    let mut all = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        let length = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        if length > 0 {
            let number: u64 = rest[..length].parse().unwrap();
            all.push(format!("{}{}{}", &text[..at], number + 1, &rest[length..]));
        }
        at += length.max(1);
    }
    let words = [
        ("\"tool\"", "\"arm\""),
        ("\"temporary\"", "\"permanent\""),
        ("\"exchange\"", "\"forbidden\""),
        ("true", "false"),
    ];
    all.extend(words.map(|(from, to)| text.replacen(from, to, 1)));
    all.extend(text.lines().map(|line| text.replacen(&format!("{line}\n"), "", 1)));
    all
}

#[test]
fn whatever_changes_the_checksum_breaks_the_seal() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("cell.toml");
    sealed(dir.path(), &text());
    let checksum = Cell::load(&file).unwrap_or_else(|e| panic!("{e}")).approval.checksum;
    let (mut tried, mut free) = (0, 0);
    for mutated in mutations(&text()) {
        let Ok(cell) = Cell::parse(&file, &mutated) else { continue };
        std::fs::write(&file, &mutated).unwrap();
        if let Err(e) = Cell::load(&file) {
            assert!(e.message.contains("is not as it was sealed"), "{e}");
            assert!(!history(&file).unwrap().unsealed.is_empty());
        } else {
            assert_eq!(cell.approval.checksum, checksum, "not detected:\n{mutated}");
            free += 1;
        }
        tried += 1;
    }
    assert!(tried > 150 && free > 5 && free < 40, "{tried} tried, {free} without effect on a monitor");
}

#[test]
fn text_that_is_no_file_needs_no_seal() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("cell.toml");
    sealed(dir.path(), &text());
    let seal = Cell::load(&file).unwrap().approval.seal.expect("sealed");
    assert_eq!((seal.class.as_str(), seal.name.as_str(), seal.entries), ("integrator", "I", 1));
    assert!(Cell::parse(&file, &text().replace("radius = 150", "radius = 140")).unwrap().approval.seal.is_none());
}

/// An object with its own path.
const OBJECTS: &str = "[object.NAME]\nshape = \"box\"\nsize = [400, 300, 200]\nat = [3000, 1000, 100]\nrpy = [1, 2, 30]\n\
     motion = { via = [[5000, 1000, 100], [5000, 2000, 100]], speed = 500, start = 3, turn = [1, 2, 90], repeat = \"loop\" }\n";

#[test]
fn every_number_of_an_object_that_a_region_follows_breaks_the_seal() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("cell.toml");
    let region = "[region.cart]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 10\n\
                  follow = { object = \"cart\" }\n";
    let rest = format!("{}{region}", text());
    let (cart, free) = (OBJECTS.replace("NAME", "cart"), OBJECTS.replace("NAME", "free"));
    sealed(dir.path(), &format!("{rest}{cart}{free}"));
    let (mut noticed, mut of_no_concern) = (0, 0);
    let all = |object: &str| mutations(object).into_iter().chain([object.replace("loop", "ping-pong")]);
    for mutated in all(&cart).filter(|m| m.contains("[object.cart]")) {
        let changed = format!("{rest}{mutated}{free}");
        if mutated == cart || Cell::parse(&file, &changed).is_err() {
            continue;
        }
        std::fs::write(&file, &changed).unwrap();
        let e = Cell::load(&file).expect_err(&mutated);
        assert!(e.message.contains("is not as it was sealed") && e.message.contains("object.cart."), "{e}");
        noticed += 1;
    }
    for mutated in all(&free) {
        if Cell::parse(&file, &format!("{rest}{cart}{mutated}")).is_ok() {
            std::fs::write(&file, format!("{rest}{cart}{mutated}")).unwrap();
            Cell::load(&file).unwrap_or_else(|e| panic!("{e}"));
            of_no_concern += 1;
        }
    }
    assert!(noticed > 15 && of_no_concern > 15, "{noticed} detected, {of_no_concern} without effect");
}

/// A file, its contents, and the words of the error if it differs: empty if no region follows what is read from the
/// file.
const FILES: &[(&str, &str, &[&str])] = &[
    (
        "poses.csv",
        "t_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,3,0,0,10,20,30\n5,4,0,0,10,20,30\n",
        &["`region.poses`", "poses from \"poses.csv\""],
    ),
    ("belt.csv", "t_s,travel_m\n0,0\n5,1\n", &["`region.belt`", "encoder travel from \"belt.csv\""]),
    ("cart.csv", "t_s,travel_m\n0,0\n5,1\n", &["`region.cart`", "object cart from \"cart.obj\" and \"cart.csv\""]),
    (
        "cart.obj",
        "v 0 0 0\nv 500 0 0\nv 500 250 0\nv 100 100 300\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
        &["`region.cart`", "object cart from \"cart.obj\" and \"cart.csv\""],
    ),
    ("free.csv", "t_s,travel_m\n0,0\n5,1\n", &[]),
];

#[test]
fn the_files_of_the_source_of_a_region_are_sealed() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("cell.toml");
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    for (name, text, _) in FILES {
        write(name, text);
    }
    let region = |name: &str, follow: &str| {
        format!(
            "[region.{name}]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 10\nfollow = {{ {follow} }}\n"
        )
    };
    let encoder = |name: &str, file: &str| format!("[encoder.{name}]\nfile = \"{file}\"\n");
    let cart = "[object.cart]\nshape = \"mesh\"\nmesh = \"cart.obj\"\nmesh_unit = \"mm\"\nat = [4000, 4000, 0]\n\
                follow = { encoder = \"cart\" }\n";
    let regions = [
        region("poses", "poses = \"poses.csv\""),
        region("belt", "encoder = \"travel\""),
        region("cart", "object = \"cart\""),
    ];
    let encoders = [encoder("travel", "belt.csv"), encoder("cart", "cart.csv"), encoder("free", "free.csv")];
    sealed(dir.path(), &format!("{HEAD}{}{}{}{cart}", rail("a", 0.0), encoders.concat(), regions.concat()));
    Cell::load(&file).unwrap_or_else(|e| panic!("{e}"));
    for (name, text, words) in FILES {
        let mut tried = 0;
        for mutated in mutations(text).into_iter().filter(|m| m != text) {
            write(name, &mutated);
            if let Err(e) = Cell::load(&file) {
                if e.message.contains("is not as it was sealed") {
                    assert!(words.iter().all(|w| e.message.contains(w)) && !words.is_empty(), "{name}: {e}\n{mutated}");
                    assert_eq!(history(&file).unwrap().unsealed.len(), 1);
                    tried += 1;
                }
            } else {
                assert!(words.is_empty(), "{name}: not detected:\n{mutated}");
                tried += 1;
            }
        }
        assert!(tried >= 3, "{name}: {tried} tried");
        write(name, text);
        Cell::load(&file).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}
