//! Errors for wrong cell files: the line, what is wrong, what to write.

mod common;

use common::{HEAD, rail, valid_cell};
use elbowroom_cell::Cell;

#[test]
fn the_valid_cell_is_valid() {
    let cell = Cell::parse("test.toml", &valid_cell()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((cell.robots.len(), cell.regions.len(), cell.maps.len()), (3, 4, 1));
    let warned: Vec<_> =
        cell.regions.iter().map(|r| r.robots.iter().map(|robot| robot.0).collect::<Vec<_>>()).collect();
    assert_eq!(
        warned,
        [vec![0], vec![0, 1, 2], vec![0, 1, 2], vec![0, 1]],
        "a robot is not guarded against a region that follows it"
    );
}

/// (line to replace, replacement, words of the message, words of the hint)
const CASES: &[(&str, &str, &str, &str)] = &[
    ("version = 1", "version = 2", "reads version 1", "version = 1"),
    ("volumes = \"capsule\"", "stop_time = 1e300", "no robot brakes for that long", "at most 60"),
    ("volumes = \"capsule\"", "acceleration = 1e200", "no joint is that fast", "at most"),
    (
        "follow = { robot = \"c\", frame = \"flange\" }",
        "follow = { robot = \"c\", max_speed = 1e12 }",
        "no jump would be noticed",
        "at most 1000000 mm/s",
    ),
    (
        "follow = { robot = \"c\", frame = \"flange\" }",
        "follow = { robot = \"c\", max_turn = 1e9 }",
        "no jump would be noticed",
        "at most 500 rad/s",
    ),
    ("version = 1", "version = \"1\"", "must be a number", "version"),
    ("tick_ms = 4", "tick_msec = 4", "no key `tick_msec`", "tick_ms"),
    ("tick_ms = 4", "tick_ms = -4", "above 0", "tick_ms"),
    ("tick_ms = 4", "tick_ms = nan", "NaN", "finite"),
    ("tick_ms = 4", "tick_ms = ", "not TOML", "key = value"),
    ("tick_ms = 4", "checksum = \"00\"", "is 00, but the configuration in this file has another", "approved"),
    (
        "units = { length = \"mm\", angle = \"deg\" }",
        "units = { length = \"feet\", angle = \"deg\" }",
        "cannot be \"feet\"",
        "mm",
    ),
    (
        "units = { length = \"mm\", angle = \"deg\" }",
        "units = { length = \"mm\" }",
        "needs the key `angle`",
        "angle = \"deg\"",
    ),
    ("volumes = \"capsule\"", "volumes = \"capsul\"", "cannot be \"capsul\"", "capsule"),
    ("volumes = \"capsule\"", "flange = \"link_7\"", "link \"link_7\"", "link_6"),
    ("volumes = \"capsule\"", "model = \"x.urdf\"", "contradicts `dh`", "model or dh"),
    ("volumes = \"capsule\"", "acceleration = [1, 2]", "2 values for 6 joints", "one per joint"),
    ("start = [0, 0, 0, 0, 40, 0]", "start = [0, 0, 0, 0, 40]", "5 values for the 6 joints", "joint_1, joint_2"),
    (
        "start = [0, 0, 0, 0, 40, 0]",
        "start = \"hom\"\nstates = { home = [0, 0, 0, 0, 40, 0] }",
        "names the state \"hom\"",
        "home",
    ),
    ("start = [0, 0, 0, 0, 40, 0]", "start = \"home\"", "which robot \"c\" does not have", "define it first"),
    ("start = [0, 0, 0, 0, 40, 0]", "start = true", "must be a list", "[0, 0, 0, 0, 0, 0]"),
    (
        "start = [0, 0, 0, 0, 40, 0]",
        "start = [0, 0, 0, 0, 140, 0]",
        "joint \"joint_5\" to 140 deg",
        "-120 deg to 120 deg",
    ),
    ("start = [0, 0, 0, 0, 40, 0]", "start = [0, 0, 0, 0, \"x\", 0]", "must be a number, not a text", ""),
    ("base = { at = [0, 3000, 0] }", "base = { at = [0, 3000] }", "needs 3 numbers, not 2", "[0, 0, 0]"),
    ("base = { at = [0, 3000, 0] }", "base = { pos = [0, 3000, 0] }", "no key `pos`", "at"),
    ("shape = \"cylinder\"", "shape = \"cilinder\"", "cannot be \"cilinder\"", "cylinder"),
    ("shape = \"cylinder\"", "", "needs the key `shape`", "cylinder"),
    ("radius = 150", "raduis = 150", "no key `raduis`", "radius"),
    ("radius = 150", "radius = 0", "above 0", "radius"),
    ("height = 1200", "", "needs the key `height`", "height = 1200"),
    ("warning = 250", "warning = -1", "0 or more", "warning"),
    ("warning = 250", "kind = \"exchange\"", "warning zone, so it needs one", "warning = 250"),
    ("warning = 250", "slow_to = 30", "this one is not", "monitored"),
    ("warning = 250", "output = 64", "0 to 63", "output"),
    ("guards = [\"tcp\"]", "guards = []", "is empty", "arm"),
    ("guards = [\"tcp\"]", "guards = [\"arms\"]", "cannot be \"arms\"", "arm"),
    ("robots = [\"a\"]", "robots = [\"d\"]", "robot \"d\"", "a, b, c"),
    ("robots = [\"a\"]", "robots = [\"a\", \"a\"]", "named twice", "once"),
    ("life = \"temporary\"", "life = \"forever\"", "cannot be \"forever\"", "permanent"),
    ("to = [100, 5100, 100]", "to = [100, 5000, 100]", "no volume", "differ"),
    ("slow_to = 30", "slow_to = 130", "0 to 100", "slow_to"),
    ("follow = { encoder = \"belt\" }", "follow = { encoder = \"best\" }", "[encoder.best]", "belt"),
    ("follow = { encoder = \"belt\" }", "follow = { }", "nothing to follow", "encoder"),
    (
        "follow = { robot = \"c\", frame = \"flange\" }",
        "follow = { robot = \"c\", frame = \"hand\" }",
        "link \"hand\"",
        "link_6",
    ),
    (
        "follow = { robot = \"c\", frame = \"flange\" }",
        "robots = [\"c\"]\nfollow = { robot = \"c\" }",
        "stop itself",
        "other robots",
    ),
    ("direction = [1, 0, 0]", "direction = [0, 0, 0]", "no length", "[1, 0, 0]"),
    ("speed = 100\n", "\n", "needs the key `speed`", "speed = 200"),
    ("stale_ms = 20", "stale_ms = 0", "above 0", "stale_ms"),
    ("joints = [\"joint_1\"]", "joints = [\"joint_9\"]", "joint \"joint_9\"", "joint_1"),
    ("override = 100", "override = 110", "0 to 100", "override"),
    ("override = 100", "repeat = 1.5", "whole number", "repeat"),
    ("override = 100", "trajectory = \"a.csv\"", "contradicts `steps`", "steps or trajectory"),
    ("[program.a]", "[program.aa]", "robot \"aa\"", "a, b, c"),
    (
        "{ move = \"joint\", to = [500], speed = 50 },",
        "{ move = \"joint\", to = [5000] },",
        "to 5000 mm",
        "-2000 mm to 2000 mm",
    ),
    (
        "{ move = \"joint\", to = [500], speed = 50 },",
        "{ move = \"jiont\", to = [500] },",
        "cannot be \"jiont\"",
        "joint",
    ),
    ("{ move = \"joint\", to = [500], speed = 50 },", "{ to = [500] },", "is not a step", "move"),
    ("{ region = \"gate\", active = true },", "{ region = \"column\", active = true },", "permanent", "temporary"),
    ("{ region = \"gate\", active = true },", "{ region = \"gaat\", active = true },", "region \"gaat\"", "gate"),
    ("{ wait = 0.1 },", "{ wait = -0.1 },", "0 or more", "wait"),
    ("{ wait = 0.1 },", "{ wait = 0.1, speed = 3 },", "no key `speed`", "wait"),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { via = [0, 8000, 0], speed = 500 }",
        "must be a point",
        "via = [[",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { via = [[0, 7000, 0]], speed = 500 }",
        "is already",
        "each point",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { via = [], speed = 500 }",
        "is empty",
        "via = [[",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { via = [[0, 8000]], speed = 500 }",
        "needs 3 numbers",
        "[0, 0, 0]",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { via = [[0, 8000, 0]] }",
        "needs the key `speed`",
        "speed = 500",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { via = [[0, 8000, 0]], speed = 0 }",
        "above 0",
        "speed",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { via = [[0, 8000, 0]], speed = 5, start = -1 }",
        "0 or more",
        "start",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { via = [[0, 8000, 0]], speed = 5, repeat = \"again\" }",
        "cannot be \"again\"",
        "ping-pong",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { path = [[0, 8000, 0]], speed = 5 }",
        "no key `path`",
        "via",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { speed = 5 }",
        "moves nothing",
        "via = [[",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { turn = [0, 0, 9], speed = 5 }",
        "belongs to `via`",
        "via",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = 500",
        "must be a table",
        "via = [[",
    ),
    (
        "motion = { via = [[0, 8000, 0]], speed = 500, start = 0.5, repeat = \"loop\" }",
        "motion = { turn = [0, 0, 9] }\nfollow = { encoder = \"belt\" }",
        "contradicts `follow`",
        "either",
    ),
    ("follow = {encoder = \"belt\"}", "follow = { encoder = \"best\" }", "[encoder.best]", "belt"),
    ("follow = {encoder = \"belt\"}", "follow = { robot = \"a\" }", "`load`", "load = {"),
    ("follow = {encoder = \"belt\"}", "follow = { }", "needs the key `encoder`", "encoder = "),
    ("[object.table]", "[object.a]", "both named \"a\"", "a_2"),
    ("[object.table]", "[object.\"x,y\"]", "is not a name", "comma"),
];

#[test]
fn every_error_names_its_line_and_a_correction() {
    let valid = valid_cell();
    for (line, by, what, hint) in CASES {
        let text = valid.replacen(line, by, 1);
        assert_ne!(text, valid, "the case `{line}` changes nothing");
        let at = valid[..valid.find(line).unwrap()].lines().count();
        let Err(e) = Cell::parse("test.toml", &text) else { panic!("`{by}` passed") };
        let text = e.to_string();
        assert!(e.what.contains(what), "`{by}`: {text}");
        let write = e.write_instead.clone().unwrap_or_default();
        assert!(write.contains(hint) && !write.is_empty(), "`{by}`: {text}");
        // Missing keys are reported at the table's line, all else at its own; text before a match on the same line
        // counts.
        let near = e.line.unwrap().abs_diff(at + 1);
        assert!(
            near <= if what.contains("needs") || what.contains("no volume") { 6 } else { 1 },
            "`{by}` at {at}: {text}"
        );
        assert!(text.starts_with("test.toml:"), "{text}");
    }
}

#[test]
fn missing_tables_and_duplicate_names_are_errors() {
    let e = Cell::parse("t.toml", "version = 1\n").unwrap_err();
    assert!(e.to_string().contains("units = { length"), "{e}");
    let e = Cell::parse("t.toml", "units = { length = \"m\", angle = \"rad\" }\n").unwrap_err();
    assert!(e.to_string().contains("version = 1"), "{e}");
    let twice = format!("{HEAD}{}{}", rail("a", 0.0), rail("a", 0.0));
    let e = Cell::parse("t.toml", &twice).unwrap_err();
    assert!(e.to_string().contains("must differ"), "{e}");
    assert_eq!(e.line, Some(8));
    let e = Cell::load("/nonexistent/cell.toml").unwrap_err();
    assert!(e.to_string().contains("cannot be read"), "{e}");
    let e = Cell::parse("t.toml", &format!("{HEAD}[robot.r]\nmodel = \"arm.urdf\"\n")).unwrap_err();
    assert_eq!(e.line, Some(5));
    assert!(e.what.contains("does not exist"), "{e}");
}

/// A box on a fixed post, as 3DS.
fn static_model() -> Vec<u8> {
    use elbowroom_formats::nodetree::{Node, NodeTree};
    use elbowroom_formats::{MeshData, tds};
    use elbowroom_spatial::{Pose, Vec3};
    let mut tree = NodeTree::new("arm");
    let post = tree.push(Node::new("post", None, Pose::IDENTITY));
    let mut arm = Node::new("arm", Some(post), Pose::from_translation(Vec3::Z));
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    arm.meshes.push(MeshData { name: "arm".into(), vertices, triangles });
    tree.push(arm);
    tds::write(&tree, "arm.3ds".as_ref()).unwrap()
}

#[test]
fn a_3d_model_without_joints_yields_a_template_of_joints_that_is_accepted() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("arm.3ds"), static_model()).unwrap();
    let parse = |more: &str| {
        Cell::parse(dir.path().join("cell.toml"), &format!("{HEAD}[robot.r]\nmodel = \"arm.3ds\"\n{more}"))
    };
    let e = parse("").unwrap_err();
    assert!(e.what.contains("without a joint that moves"), "{e}");
    assert!(e.write_instead.as_ref().unwrap().contains("[joint.arm]   # on post, origin at [0, 0, 1] m"), "{e}");
    let joints =
        "units = { length = \"mm\", angle = \"deg\" }\n[joint.arm]\naxis = \"z\"\nmin = -90\nmax = 90\nspeed = 45\n";
    std::fs::write(dir.path().join("other.toml"), joints).unwrap();
    let cell = parse("joints = \"other.toml\"\nunit = \"mm\"\n").unwrap();
    let chain = &cell.robots[0].robot.chain;
    assert_eq!((chain.dof(), chain.joints()[0].origin.translation.z), (1, 0.001));
    std::fs::write(dir.path().join("arm.joints.toml"), joints).unwrap();
    assert_eq!(parse("").unwrap().robots[0].robot.chain.dof(), 1);
    let e = parse("joints = \"nowhere.toml\"\n").unwrap_err();
    assert!(e.what.contains("does not exist"), "{e}");
    let e = parse("unit = \"ell\"\n").unwrap_err();
    assert!(e.to_string().contains("mm"), "{e}");
    let e = Cell::parse("t.toml", &format!("{HEAD}[robot.r]\ndh = [{{ a = 1 }}]\nunit = \"mm\"\n")).unwrap_err();
    assert!(e.what.contains("belongs to `model`"), "{e}");
}

#[test]
fn a_checksum_is_verified() {
    let sum = Cell::parse("t.toml", &valid_cell()).unwrap().checksum;
    assert_eq!(sum.len(), 64);
    let pinned = valid_cell().replacen("tick_ms", &format!("checksum = \"{sum}\"\ntick_ms"), 1);
    assert!(Cell::parse("t.toml", &pinned).is_ok());
    let e = Cell::parse("t.toml", &pinned.replace("radius = 150", "radius = 149")).unwrap_err();
    assert!(e.what.contains(&sum), "{e}");
}

#[test]
fn errors_of_trajectories_name_the_line() {
    let dir = tempfile::tempdir().unwrap();
    let cell = |csv: &str| {
        std::fs::write(dir.path().join("t.csv"), csv).unwrap();
        let text = format!("{HEAD}{}[program.r]\ntrajectory = \"t.csv\"\n", rail("r", 0.0));
        Cell::parse(dir.path().join("cell.toml"), &text)
    };
    assert!(cell("joint_1,t_s\n0,0\n0.1,1\n").is_ok());
    let noted = cell("r.joint_1,note,t_s\n0,up,0\n0.1,,1\n").unwrap();
    assert!(noted.warnings.iter().any(|w| w.what.contains("column `note` is not a joint of")));
    for (csv, line, what) in [
        ("t_s,joint_2\n0,0\n", 1, "no column `joint_1`"),
        ("t_s,joint_1\n0,0\n0,0.1\n", 3, "t_s is 0 after 0"),
        ("t_s,joint_1\n0,0\n1,x\n", 3, "not a finite number"),
        ("t_s,joint_1\n0,0\n\n1,nan\n", 4, "not a finite number"),
        ("t_s,joint_1\n0,0\n1\n", 3, "1 values for 2 columns"),
        ("t_s,joint_1\n0,0\n1,5\n", 3, "outside its limits"),
        ("t_s,joint_1\n", 1, "no rows"),
        ("", 1, "is empty"),
    ] {
        let e = cell(csv).unwrap_err();
        assert_eq!(e.line, Some(line), "{e}");
        assert!(e.what.contains(what), "{e}");
    }
}
