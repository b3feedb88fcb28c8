//! Cells for tests, with small robots.
#![allow(dead_code)]

pub mod zone_reader;

use elbowroom_cell::Cell;

/// A six-axis arm of the NS16's proportions, with capsules for links.
pub const ARM: &str = r"
dh = [
  { a = 300, alpha = 90, d = 600, theta = 0, min = -180, max = 180, speed = 155 },
  { a = 700, alpha = 0, d = 0, theta = 90, min = -95, max = 95, speed = 155 },
  { a = 185, alpha = 90, d = 0, theta = 0, min = -170, max = 110, speed = 170 },
  { a = 0, alpha = -90, d = 624, theta = 0, min = -200, max = 200, speed = 360 },
  { a = 0, alpha = 90, d = 0, theta = 0, min = -120, max = 120, speed = 350 },
  { a = 0, alpha = 0, d = 120, theta = 0, min = -360, max = 360, speed = 550 },
]
links = [
  { capsule = { from = [0, 0, 0], to = [-300, -200, 0], radius = 110 } },
  { capsule = { from = [0, 0, 0], to = [-700, 0, 0], radius = 80 } },
  { capsule = { from = [0, 0, 0], to = [-185, 0, 0], radius = 80 } },
  { capsule = { from = [0, 0, 0], to = [0, 400, 0], radius = 60 } },
  [],
  { cylinder = { from = [0, 0, -40], to = [0, 0, 0], radius = 40 } },
]
";

pub const HEAD: &str = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\ntick_ms = 4\n";

/// A carriage on a rail along world x that carries a ball; `y` is its offset.
pub fn rail(name: &str, y: f64) -> String {
    format!(
        "[robot.{name}]\nbase = {{ at = [0, {y}, 0], rpy = [0, 90, 0] }}\n\
         dh = [{{ kind = \"prismatic\", min = -2000, max = 2000, speed = 1000, acceleration = 4000 }}]\n\
         links = [{{ sphere = {{ radius = 50 }} }}]\n"
    )
}

/// Two prismatic joints in the plane of world x and y that carry a ball; the second one moves against y.
pub const GANTRY: &str = r#"
[robot.gantry]
base = { at = [0, 0, 0], rpy = [0, 90, 0] }
dh = [
  { kind = "prismatic", alpha = 90, min = -2000, max = 2000, speed = 1000, acceleration = 4000 },
  { kind = "prismatic", min = -2000, max = 2000, speed = 1000, acceleration = 4000 },
]
links = [[], { sphere = { radius = 50 } }]
start = [-1400, 0]
"#;

/// Beside the path along y = 0, from 30 mm off the ball upwards.
pub const WALL: &str = r#"
[region.wall]
shape = "box"
from = [500, 80, -200]
to = [520, 1500, 200]
warning = 20
"#;

/// A valid cell that uses every kind of table; each case of `errors.rs` breaks one line of it.
pub fn valid_cell() -> String {
    format!(
        "{HEAD}name = \"test\"\nmax_s = 20\n{}{}\
         [robot.c]\n{ARM}base = {{ at = [0, 3000, 0] }}\nstart = [0, 0, 0, 0, 40, 0]\nvolumes = \"capsule\"\n\
         [robot.c.tool]\ntcp = {{ at = [0, 0, 250], rpy = [0, 0, 0] }}\nbox = {{ at = [0, 0, 125], size = [80, 80, 250] }}\n\
         [object.table]\nshape = \"box\"\nat = [0, 0, -900]\nsize = [600, 400, 700]\n\
         [object.cart]\nshape = \"sphere\"\nat = [0, 7000, 0]\nradius = 30\n\
         motion = {{ via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }}\n\
         [object.part]\nshape = \"sphere\"\nat = [0, 9500, 0]\nradius = 30\nfollow = {{encoder = \"belt\"}}\n\
         [encoder.belt]\ndirection = [1, 0, 0]\nspeed = 100\n\
         [region.column]\nshape = \"cylinder\"\nbase = [900, 0, 0]\nradius = 150\nheight = 1200\nwarning = 250\n\
         guards = [\"tcp\"]\nrobots = [\"a\"]\n\
         [region.gate]\nshape = \"box\"\nfrom = [0, 5000, 0]\nto = [100, 5100, 100]\nlife = \"temporary\"\nwarning = 10\n\
         [region.ride]\nshape = \"sphere\"\ncentre = [0, 9000, 0]\nradius = 100\nwarning = 10\nkind = \"monitored\"\nslow_to = 30\n\
         follow = {{ encoder = \"belt\" }}\n\
         [region.hand]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 100\nwarning = 10\nfollow = {{ robot = \"c\", frame = \"flange\" }}\n\
         [monitor]\nstale_ms = 20\n\
         [map.c]\njoints = [\"joint_1\"]\nstep = 2\n\
         [program.a]\noverride = 100\nsteps = [\n{{ move = \"joint\", to = [500], speed = 50 }},\n\
         {{ region = \"gate\", active = true }},\n{{ wait = 0.1 }},\n]\n",
        rail("a", 0.0),
        rail("b", 1000.0)
    )
}

pub fn parse(text: &str) -> Cell {
    Cell::parse("test.toml", text).unwrap_or_else(|e| panic!("{e}"))
}
