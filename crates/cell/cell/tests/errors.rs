//! Errors for wrong cell files: the line, what is wrong, what to write.

use crate::common::{HEAD, rail, valid_cell};
use elbowroom_cell::Cell;

#[test]
fn the_valid_cell_is_valid() {
    let cell = Cell::parse("test.toml", &valid_cell()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        (cell.robots.len(), cell.regions.len(), cell.robots.iter().filter(|r| r.map.is_some()).count()),
        (3, 4, 1)
    );
    let warned: Vec<_> =
        cell.regions.iter().map(|r| r.robots.iter().map(|robot| robot.0).collect::<Vec<_>>()).collect();
    assert_eq!(
        warned,
        [vec![0], vec![0, 1, 2], vec![0, 1, 2], vec![0, 1]],
        "a robot is not guarded against a region that follows it"
    );
}

/// Line to replace, replacement, words of the message, words of the hint.
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
        assert!(e.message.contains(what), "`{by}`: {text}");
        let write = e.hint.clone().unwrap_or_default();
        assert!(write.contains(hint) && !write.is_empty(), "`{by}`: {text}");
        // Missing keys are reported at the table's line, other errors at their own line. Text before a match on the
        // same line counts.
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
    assert!(e.message.contains("does not exist"), "{e}");
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
    assert!(e.message.contains("without a joint that moves"), "{e}");
    assert!(e.hint.as_ref().unwrap().contains("[joint.arm]   # on post, origin at [0, 0, 1] m"), "{e}");
    let joints =
        "units = { length = \"mm\", angle = \"deg\" }\n[joint.arm]\naxis = \"z\"\nmin = -90\nmax = 90\nspeed = 45\n";
    std::fs::write(dir.path().join("other.toml"), joints).unwrap();
    let cell = parse("joints = \"other.toml\"\nunit = \"mm\"\n").unwrap();
    let chain = &cell.robots[0].robot.chain;
    assert_eq!((chain.dof(), chain.joints()[0].origin.translation.z), (1, 0.001));
    std::fs::write(dir.path().join("arm.joints.toml"), joints).unwrap();
    assert_eq!(parse("").unwrap().robots[0].robot.chain.dof(), 1);
    let e = parse("joints = \"nowhere.toml\"\n").unwrap_err();
    assert!(e.message.contains("does not exist"), "{e}");
    let e = parse("unit = \"ell\"\n").unwrap_err();
    assert!(e.to_string().contains("mm"), "{e}");
    let e = Cell::parse("t.toml", &format!("{HEAD}[robot.r]\ndh = [{{ a = 1 }}]\nunit = \"mm\"\n")).unwrap_err();
    assert!(e.message.contains("belongs to `model`"), "{e}");
}

#[test]
fn a_checksum_is_verified() {
    let sum = Cell::parse("t.toml", &valid_cell()).unwrap().approval.checksum;
    assert_eq!(sum.len(), 64);
    let pinned = valid_cell().replacen("tick_ms", &format!("checksum = \"{sum}\"\ntick_ms"), 1);
    assert!(Cell::parse("t.toml", &pinned).is_ok());
    let e = Cell::parse("t.toml", &pinned.replace("radius = 150", "radius = 149")).unwrap_err();
    assert!(e.message.contains(&sum), "{e}");
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
    assert!(noted.warnings.iter().any(|w| w.message.contains("column `note` is not a joint of")));
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
        assert!(e.message.contains(what), "{e}");
    }
}

/// Replaces line `number` (from 1) of `text` and expects an error there: number, replacement, line, message, hint.
///
/// All cases are tried before failures are reported.
fn refused(file: &std::path::Path, text: &str, cases: &[(usize, &str, usize, &str, &str)]) {
    assert!(Cell::parse(file, text).is_ok(), "{}", Cell::parse(file, text).unwrap_err());
    let mut wrong = Vec::new();
    for &(number, by, line, what, hint) in cases {
        let mut lines: Vec<&str> = text.lines().collect();
        lines[number - 1] = by;
        match Cell::parse(file, &lines.join("\n")) {
            Ok(_) => wrong.push(format!("`{by}` passed")),
            Err(e) => {
                let write = e.hint.as_deref().unwrap_or_default();
                let is_taught = e.message.contains(what) && write.contains(hint) && !write.is_empty();
                if e.line != Some(line) || !is_taught {
                    wrong.push(format!("`{by}`, expected line {line}, `{what}`, `{hint}`:\n  {e}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

const CAMERA: &str = r#"[camera.above]
size = [320, 240]
focal_px = 300
centre_px = [160, 120]
distortion = [0, 0, 0]
pose = { at = [0, 0, 5000], rpy = [180, 0, 0] }
area = [[-1000, -1000], [1000, -1000], [1000, 1000], [-1000, 1000]]
floor = 0
learning_frames = 30
uncertainty = 30
max_speed = 2000
shadows = false
prediction = 0.5
mask_margin = 30
robot = "r"
frames = "pictures"
templates = [{ name = "crate", size = [600, 400], height = 300, tolerance = 50, height_tolerance = 10 }]
"#;

#[test]
fn each_key_of_a_camera_is_refused_at_its_line() {
    let template = |keys: &str| format!("templates = [{{ {keys} }}]");
    let of_template: Vec<(String, &str, &str)> = [
        ("size = [600, 400], height = 300", "needs the key `name`", "name = \"crate\""),
        ("name = 3, size = [600, 400], height = 300", "must be a text", "name = "),
        ("name = \"a\", size = [600], height = 300", "needs 2 numbers, not 1", "size = [600, 400]"),
        ("name = \"a\", size = [600, 0], height = 300", "must be two lengths above 0", "size = [600, 400]"),
        ("name = \"a\", size = 600, height = 300", "must be a list", "size = [600, 400]"),
        ("name = \"a\", height = 300", "either `size` or `diameter`", "size = "),
        ("name = \"a\", size = [600, 400], diameter = 9, height = 300", "either `size` or `diameter`", "size = "),
        ("name = \"a\", diameter = 0, height = 300", "above 0", "diameter"),
        ("name = \"a\", diameter = [9], height = 300", "must be a number", "diameter"),
        ("name = \"a\", size = [600, 400]", "needs the key `height`", "height = 320"),
        ("name = \"a\", size = [600, 400], height = -3", "above 0", "height"),
        ("name = \"a\", size = [600, 400], height = nan", "is NaN", "finite"),
        ("name = \"a\", size = [600, 400], height = 300, tolerance = -1", "0 or more", "tolerance"),
        ("name = \"a\", size = [600, 400], height = 300, tolerance = \"9\"", "must be a number", "tolerance"),
        ("name = \"a\", size = [600, 400], height = 300, tolerance = inf", "is inf", "finite"),
        ("name = \"a\", size = [600, 400], height = 300, height_tolerance = -1", "0 or more", "height_tolerance"),
        (
            "name = \"a\", size = [600, 400], height = 300, height_tolerance = [1]",
            "must be a number",
            "height_tolerance",
        ),
        (
            "name = \"a\", size = [600, 400], height = 300, hight_tolerance = 1",
            "no key `hight_tolerance`",
            "height_tolerance",
        ),
    ]
    .map(|(keys, what, hint)| (template(keys), what, hint))
    .into();
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("bad.csv"), "").unwrap();
    let mut cases = vec![
        (9, "", 8, "needs the key `size`", "size = [640, 480]"),
        (9, "size = 320", 9, "must be a list", "size = [640, 480]"),
        (9, "size = [320]", 9, "needs 2 numbers, not 1", "size = [640, 480]"),
        (9, "size = [320, 4]", 9, "whole number from 8 to 16384", "= 8"),
        (10, "", 8, "needs the key `focal_px`", "focal_px = [600, 600]"),
        (10, "focal_px = 0", 10, "above 0", "focal_px"),
        (10, "focal_px = [600]", 10, "needs 2 numbers, not 1", "focal_px = [600, 600]"),
        (10, "focal_px = [600, -600]", 10, "focal lengths must be positive", "calibration"),
        (11, "centre_px = 160", 11, "must be a list", "centre_px = [320, 240]"),
        (11, "centre_px = [160, 120, 0]", 11, "needs 2 numbers, not 3", "centre_px = [320, 240]"),
        (11, "centre_px = [160, nan]", 11, "is NaN", "finite"),
        (12, "center_px = [160, 120]", 12, "contradicts `centre_px`", "one of the two"),
        (12, "distortion = 0.1", 12, "must be a list", "k1, k2, k3"),
        (12, "distortion = [0, 0, 0, 1]", 12, "has 4 coefficients", "k1, k2, k3"),
        (12, "distortion = [-90]", 12, "folds the picture over", "calibration"),
        (13, "", 8, "needs the key `pose`", "z looks along the view"),
        (13, "pose = [0, 0, 5000]", 13, "must be a table", "at = "),
        (13, "pose = { at = [0, 0, 5000], rpy = [90, 0, 0] }", 13, "does not show the floor", "rpy = [180, 0, 0]"),
        (13, "pose = { at = [0, 5000], rpy = [180, 0, 0] }", 13, "needs 3 numbers, not 2", "at = "),
        (14, "area = [[-1000, -1000], [1000, -1000]]", 14, "has 2 corners", "area = [["),
        (14, "area = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]", 14, "needs 2 numbers, not 3", "area = [["),
        (14, "area = \"all\"", 14, "must be a list", "area = [["),
        (15, "floor = \"0\"", 15, "must be a number", "floor"),
        (15, "floor = inf", 15, "is inf", "finite"),
        (15, "floor = 6000", 13, "does not show the floor", "pose = "),
        (16, "learning_frames = 1", 16, "whole number from 2 to 10000", "learning_frames"),
        (16, "learning_frames = 2.5", 16, "whole number", "learning_frames"),
        (16, "learning_frames = true", 16, "must be a number", "learning_frames"),
        (17, "uncertainty = -1", 17, "0 or more", "uncertainty"),
        (17, "uncertainty = 1e6", 17, "out of its range", "0 to 10 metres"),
        (17, "uncertainty = \"30\"", 17, "must be a number", "uncertainty"),
        (18, "max_speed = 0", 18, "above 0", "max_speed"),
        (18, "max_speed = 1e9", 18, "out of its range", "metres per second"),
        (18, "max_speed = [1]", 18, "must be a number", "max_speed"),
        (19, "shadows = 1", 19, "must be true or false", "shadows = true"),
        (19, "shadows = \"yes\"", 19, "must be true or false", "shadows = true"),
        (19, "shadow = true", 19, "no key `shadow`", "shadows"),
        (20, "prediction = -1", 20, "0 or more", "prediction"),
        (20, "prediction = inf", 20, "is inf", "finite"),
        (20, "prediction = {}", 20, "must be a number", "prediction"),
        (21, "mask_margin = -1", 21, "0 or more", "mask_margin"),
        (21, "mask_margin = \"a\"", 21, "must be a number", "mask_margin"),
        (21, "mask_margin = nan", 21, "is NaN", "finite"),
        (22, "robot = \"kuka\"", 22, "robot \"kuka\"", "r"),
        (22, "robot = 1", 22, "must be a text", "robot"),
        (22, "robot = [\"r\"]", 22, "must be a text", "robot"),
        (23, "frames = 3", 23, "must be a text", "frames"),
        (23, "frames = \"\"", 23, "names no folder", "frames = \"frames\""),
        (23, "frames = [\"a.png\"]", 23, "must be a text", "frames"),
        (23, "joints = \"none.csv\"", 23, "does not exist", "relative to"),
        (23, "joints = \"\"", 23, "names no file", "relative to"),
        (23, "joints = 3", 23, "must be a text", "joints"),
        (24, "templates = {}", 24, "must be a list", "templates = [{"),
        (24, "templates = [3]", 24, "must be a table", "templates = [{"),
    ];
    cases.extend(of_template.iter().map(|(by, what, hint)| (24, &by[..], 24, *what, *hint)));
    refused(&dir.path().join("cell.toml"), &format!("{HEAD}{}{CAMERA}", rail("r", 0.0)), &cases);
}

#[test]
fn each_key_of_a_recording_is_refused_at_its_line() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("log.csv"), "t;Joint_1\n0;0\n100;0,1\n").unwrap();
    let keys = |keys: &str| format!("trajectory = {{ {keys} }}");
    let cases = [
        ("time = \"t\"", 9, "needs the key `file`", "file = \"log.csv\""),
        ("file = 3", 9, "must be a text", "file"),
        ("file = \"none.csv\", time = \"t\"", 9, "does not exist", "relative to"),
        ("file = \"log.csv\", time = \"t\", angle = \"grad\"", 9, "cannot be \"grad\"", "rad"),
        ("file = \"log.csv\", time = \"t\", angle = 3", 9, "must be one of", "angle = \"rad\""),
        ("file = \"log.csv\", time = \"t\", angle = \"degrees\"", 9, "cannot be \"degrees\"", "deg"),
        ("file = \"log.csv\", time = \"t\", length = \"ell\"", 9, "cannot be \"ell\"", "mm"),
        ("file = \"log.csv\", time = \"t\", length = 1", 9, "must be one of", "length = \"m\""),
        ("file = \"log.csv\", time = \"t\", length = \"km\"", 9, "cannot be \"km\"", "cm"),
        ("file = \"log.csv\", time = 3", 9, "must be a text", "time"),
        (
            "file = \"log.csv\", time = \"zeit\"",
            1,
            "no column `zeit` of the time; its columns are t, Joint_1",
            "time = \"COLUMN\"",
        ),
        ("file = \"log.csv\"", 1, "no column `t_s`", "period_ms = 4"),
        ("file = \"log.csv\", time = \"t\", time_unit = \"min\"", 9, "cannot be \"min\"", "ms"),
        ("file = \"log.csv\", time = \"t\", time_unit = 1", 9, "must be one of", "time_unit = \"s\""),
        ("file = \"log.csv\", period_ms = 4, time_unit = \"ms\"", 9, "contradicts `period_ms`", "time = "),
        ("file = \"log.csv\", period_ms = 0", 9, "above 0", "period_ms"),
        ("file = \"log.csv\", period_ms = \"4\"", 9, "must be a number", "period_ms"),
        ("file = \"log.csv\", period_ms = 4, time = \"t\"", 9, "contradicts `time`", "one of the two"),
        ("file = \"log.csv\", time = \"t\", columns = { joint_9 = \"A\" }", 9, "no key `joint_9`", "joint_1"),
        ("file = \"log.csv\", time = \"t\", columns = 3", 9, "must be a table", "columns = { joint_1 = \"A1\" }"),
        ("file = \"log.csv\", time = \"t\", columns = { joint_1 = 3 }", 9, "must be a text", "joint_1"),
        (
            "file = \"log.csv\", time = \"t\", columns = { joint_1 = \"A9\" }",
            1,
            "no column `A9` for `joint_1`",
            "a column of the file",
        ),
        ("file = \"log.csv\", time = \"t\", offset = -1", 9, "0 or more", "offset"),
        ("file = \"log.csv\", time = \"t\", offset = \"1\"", 9, "must be a number", "offset"),
        ("file = \"log.csv\", time = \"t\", offset = inf", 9, "is inf", "finite"),
        ("file = \"log.csv\", time = \"t\", delay = 1", 9, "no key `delay`", "offset"),
    ];
    let cases = cases.map(|(by, line, what, hint)| (keys(by), line, what, hint));
    let cases: Vec<_> = cases.iter().map(|(by, line, what, hint)| (9, &by[..], *line, *what, *hint)).collect();
    let good = keys(
        "file = \"log.csv\", time = \"t\", time_unit = \"ms\", length = \"m\", columns = { joint_1 = \"Joint_1\" }, offset = 1",
    );
    let text = format!("{HEAD}{}[program.r]\n{good}\n", rail("r", 0.0));
    refused(&dir.path().join("cell.toml"), &text, &cases);
}

#[test]
fn states_steps_quaternions_and_ignored_pairs_are_refused_at_their_line() {
    let robot = rail("r", 0.0);
    let text = format!(
        "{HEAD}{robot}states = {{ left = [-1000] }}\nignore = [[\"base\", \"link_1\"]]\n[object.part]\nshape = \"sphere\"\nradius = 30\n\
         quaternion = [0, 0, 0, 1]\n[object.floor]\nshape = \"plane\"\nat = [0, 0, -9000]\n[program.r]\nsteps = [\n\
         {{ move = \"planned\", to = \"left\", speed = 50 }},\n{{ grip = \"part\" }},\n{{ release = \"part\" }},\n]\n"
    );
    let line = |number: usize| text.lines().nth(number - 1).unwrap();
    assert!(line(13).starts_with("quaternion") && line(19).contains("planned") && line(21).contains("release"));
    let cases = [
        (8, "states = 3", 8, "must be a table", "states = { home = "),
        (8, "states = { left = [1, 2] }", 8, "has 2 values for the 1 joints", "joint_1"),
        (8, "states = { left = [5000] }", 8, "brings joint \"joint_1\" to 5000 mm", "-2000 mm to 2000 mm"),
        (8, "states = { left = \"up\" }", 8, "must be a list", "[0]"),
        (9, "ignore = \"base\"", 9, "must be a list", "ignore = [["),
        (9, "ignore = [[\"base\"]]", 9, "names 1 links, not two", "ignore = [["),
        (9, "ignore = [[\"base\", \"link_2\"]]", 9, "link \"link_2\"", "link_1"),
        (9, "ignore = [[\"base\", \"base\"]]", 9, "names one link twice", "ignore = [["),
        (13, "quaternion = [0, 0, 1]", 13, "needs 4 numbers, not 3", "x, y, z, w"),
        (13, "quaternion = [0, 0, 0, 2]", 13, "has the length 2", "x, y, z, w"),
        (13, "quaternion = [0, 0, nan, 1]", 13, "is NaN", "finite"),
        (13, "quaternion = \"up\"", 13, "must be a list", "x, y, z, w"),
        (13, "quaternion = [0, 0, 0, 1]\nrpy = [0, 0, 0]", 13, "contradicts `rpy`", "one of the two"),
        (19, "{ move = \"planned\" },", 19, "needs the key `to`", "to = ["),
        (19, "{ move = \"planned\", to = \"lefft\" },", 19, "names the state \"lefft\"", "left"),
        (19, "{ move = \"planned\", to = \"left\", speed = 0 },", 19, "above 0", "speed"),
        (19, "{ move = \"planned\", to = \"left\", speed = 120 },", 19, "0 to 100, not 120", "speed"),
        (19, "{ move = \"planned\", to = \"left\", planner = \"gird\" },", 19, "cannot be \"gird\"", "grid"),
        (
            19,
            "{ move = \"joint\", to = \"left\", planner = \"grid\" },",
            19,
            "is of planned moves only",
            "move = \"planned\"",
        ),
        (19, "{ move = \"planned\", to = 3 },", 19, "is neither joint values, a pose, nor the name", "to = ["),
        (19, "{ move = \"planned\", to = \"left\", via = 1 },", 19, "no key `via`", "to"),
        (20, "{ grip = 3 },", 20, "must be a text", "grip"),
        (20, "{ grip = \"prat\" },", 20, "names the object \"prat\"", "part"),
        (20, "{ grip = \"floor\" },", 20, "a plane, which is unbounded", "another shape"),
        (20, "{ grip = \"part\", speed = 3 },", 20, "no key `speed`", "grip"),
        (21, "{ release = [\"part\"] },", 21, "must be a text", "release"),
        (21, "{ release = \"r\" },", 21, "names the object \"r\"", "part"),
        (21, "{ release = \"part\", wait = 1 },", 21, "several steps in one", "one of"),
        (21, "{ relase = \"part\" },", 21, "no key `relase`", "release"),
    ];
    refused("test.toml".as_ref(), &text, &cases);
}

#[test]
fn a_cell_has_at_most_as_many_robots_as_deadlocks_are_found_among() {
    let robot = |i: usize| format!("[robot.r{i}]\ndh = [{{ a = 1, min = -1, max = 1, speed = 1 }}]\n");
    let with = |count: usize| {
        let robots: String = (0..count).map(robot).collect();
        Cell::parse("many.toml", &format!("version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\n{robots}"))
    };
    assert_eq!(with(128).unwrap().robots.len(), 128);
    let refused = with(129).unwrap_err();
    assert_eq!(refused.line, Some(259));
    assert!(refused.to_string().contains("more than 128 robots"), "{refused}");
}
