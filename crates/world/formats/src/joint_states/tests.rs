use std::path::Path;

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_spatial::{Pose, Vec3};
use proptest::prelude::*;

use super::*;

/// A revolute joint `turn`, a prismatic joint `slide`, a fixed joint, and a joint that follows `turn`.
fn chain() -> Chain {
    let joint = |i: usize, name: &str, kind: JointKind, limits: Limits, mimic: Option<Mimic>| Joint {
        name: name.into(),
        kind,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::IDENTITY,
        axis: Vec3::Z,
        limits,
        mimic,
    };
    let follows = Some(Mimic { joint: JointId(0), multiplier: 1.0, offset: 0.0 });
    let joints = vec![
        joint(0, "turn", JointKind::Revolute, Limits::symmetric(3.0), None),
        joint(1, "plate", JointKind::Fixed, Limits::UNLIMITED, None),
        joint(2, "slide", JointKind::Prismatic, Limits::range(0.0, 0.5), None),
        joint(3, "finger", JointKind::Revolute, Limits::symmetric(3.0), follows),
    ];
    let links = ["base", "a", "b", "c", "d"].map(String::from).to_vec();
    Chain::new("gripper".to_owned(), links, joints).unwrap()
}

fn robot<'a>(name: &'a str, chain: &'a Chain) -> JointStateRobot<'a> {
    JointStateRobot { name, chain, default_q: None }
}

fn parse(text: &str, options: &JointStateOptions<'_>) -> Result<JointStates> {
    JointStates::parse(Path::new("q.csv"), text, options)
}

#[test]
fn columns_may_be_in_any_order_prefixed_and_quoted() {
    let chain = chain();
    let options = JointStateOptions::states(vec![robot("r", &chain)]);
    for text in [
        "turn,slide\n1,0.25\n-1,0.5\n",
        "slide,turn\n0.25,1\n0.5,-1\n",
        "r.slide,turn\n0.25,1\n0.5,-1",
        "\u{feff}\"slide\" , \"turn\"\r\n\r\n\"0.25\",1.0\r\n 0.5 , -1e0\r\n\r\n",
        "index,t_s,turn,slide\n0,,1,0.25\nsecond,x,-1,0.5\n",
    ] {
        let states = parse(text, &options).unwrap();
        assert_eq!((states.len(), states.robots(), states.times_s().len()), (2, 1, 0), "{text}");
        assert_eq!((states.q(0, RobotId(0)), states.q(1, RobotId(0))), (&[1.0, 0.25][..], &[-1.0, 0.5][..]), "{text}");
        assert_eq!(states.warnings, []);
    }
}

#[test]
fn errors_name_line_column_and_remedy() {
    let chain = chain();
    let options = JointStateOptions::states(vec![robot("", &chain)]);
    for (text, part) in [
        ("", "q.csv:1: is empty\n  write: the header turn,slide"),
        ("\u{feff}\n", "q.csv:1: has no column"),
        ("turn\n0\n", "q.csv:1: has no column `slide`; its columns are turn\n  write: the header turn,slide"),
        ("index\n0\n", "q.csv:1: has no column `turn`, `slide`; its columns are index"),
        ("turn;slide\n0;0\n", "q.csv:1: has no column `turn`, `slide`; its columns are turn;slide"),
        ("turn,slide,turn\n0,0,0\n", "q.csv:1: two columns are named `turn`"),
        ("turn,turn\n0,0\n", "q.csv:1: two columns are named `turn`"),
        ("0,0\n1,1\n", "q.csv:1: has numbers where the joint names should be"),
        ("turn,slide,elbow\n0,0,0\n", "q.csv:1: column `elbow` is not a joint"),
        ("turn,slide,plate\n0,0,0\n", "q.csv:1: column `plate` is a fixed joint: it has no value"),
        (
            "turn,slide,finger\n0,0,0\n",
            "q.csv:1: column `finger` is a mimic joint: it follows `turn` and has no column",
        ),
        (
            "turn,slide\n0,0\nNaN,0\n",
            "q.csv:3: column `turn` holds \"NaN\", which is not a finite number\n  write: radians",
        ),
        ("turn,slide\n0,inf\n", "q.csv:2: column `slide` holds \"inf\""),
        ("turn,slide\n0,\n", "q.csv:2: column `slide` holds \"\""),
        ("turn,slide\n0,1,2\n", "q.csv:2: has 3 values for 2 columns\n  write: a number for each of turn,slide"),
        ("turn,slide\n\n0\n", "q.csv:3: has 1 values for 2 columns"),
    ] {
        let message = parse(text, &options).unwrap_err().to_string();
        assert!(message.starts_with(part), "{text:?}: {message}");
    }
}

#[test]
fn several_robots_need_their_prefixes_and_may_stay_at_their_defaults() {
    let chain = chain();
    let (left, right) = (robot("left", &chain), robot("right", &chain));
    let both = JointStateOptions::states(vec![left, right]);
    let text = "right.turn,left.turn,left.slide,right.slide\n1,2,0.1,0.2\n";
    let states = parse(text, &both).unwrap();
    assert_eq!((states.q(0, RobotId(0)), states.q(0, RobotId(1))), (&[2.0, 0.1][..], &[1.0, 0.2][..]));
    let message = |text: &str, options: &JointStateOptions<'_>| parse(text, options).unwrap_err().to_string();
    let semicolons = message("right.turn;left.turn\n0;0\n", &both);
    assert!(semicolons.contains("; commas separate columns"), "{semicolons}");
    let only_left = "left.turn,left.slide\n2,0.1\n";
    assert!(message(only_left, &both).contains("has no column `right.turn`, `right.slide`"));
    assert!(
        message("left.turn,left.slide,right.turn,right.slide,turn\n0,0,0,0,0\n", &both)
            .contains("column `turn` must name the robot: `left.turn`")
    );
    let start = [0.5, 0.25];
    let defaults = [left, right].map(|r| JointStateRobot { default_q: Some(&start), ..r });
    let options = JointStateOptions::states(defaults.to_vec());
    let states = parse(only_left, &options).unwrap();
    assert_eq!((states.q(0, RobotId(0)), states.q(0, RobotId(1))), (&[2.0, 0.1][..], &start[..]));
    assert_eq!(states.warnings.len(), 1);
    assert_eq!(states.warnings[0].message, "has no column for robot `right`, which stays at its start");
    assert!(message("left.turn\n2\n", &options).contains("has no column `left.slide`"));
    assert!(message("index\n2\n", &options).contains("has no column of a joint"));
}

#[test]
fn limit_violations_are_one_warning_or_an_error() {
    let chain = chain();
    let mut options = JointStateOptions::states(vec![robot("", &chain)]);
    let text = "turn,slide\n0,0\n90,0.1\n0,0.6\n3.0000000001,0\n";
    assert_eq!(parse(text, &options).unwrap().warnings, []);
    options.limits = LimitCheck::Warn;
    let states = parse(text, &options).unwrap();
    assert_eq!((states.q(1, RobotId(0)), states.warnings.len()), (&[90.0, 0.1][..], 1));
    assert_eq!(
        states.warnings[0].to_string(),
        "q.csv:3: `turn` is 90, beyond its limits -3.0000 to 3.0000; are these degrees?; 2 of 4 states are beyond limits \
         and are evaluated unchanged"
    );
    options.limits = LimitCheck::Refuse;
    let message = parse(text, &options).unwrap_err().to_string();
    assert_eq!(
        message,
        "q.csv:3: joint `turn` is at 90, outside its limits\n  write: radians (metres for a prismatic joint) from -3 to 3"
    );
    assert!(parse("turn,slide\n3.0000001,0\n", &options).is_ok());
}

#[test]
fn trajectories_need_increasing_times() {
    let chain = chain();
    let options = JointStateOptions::trajectory("r", &chain);
    let states = parse("turn,t_s,slide,note\n0,0,0.1,x\n1,0.5,0.2,y\n", &options).unwrap();
    assert_eq!((states.times_s(), states.q(1, RobotId(0))), (&[0.0, 0.5][..], &[1.0, 0.2][..]));
    assert_eq!(states.warnings.len(), 1);
    assert_eq!(states.warnings[0].message, "column `note` is not a joint of \"gripper\": ignored");
    for (text, part) in [
        (
            "turn,slide\n0,0\n",
            "q.csv:1: has no column `t_s`; its columns are turn, slide\n  write: the header t_s,turn",
        ),
        ("t_s,turn,slide\n0,0,0\n0,0,0\n", "q.csv:3: t_s is 0 after 0"),
        ("t_s,turn,slide\n0,0,0\n-1,0,0\n", "q.csv:3: t_s is -1 after 0"),
        ("t_s,turn,slide\nnan,0,0\n", "q.csv:2: column `t_s` holds \"nan\""),
        ("t_s,turn,slide\n", "q.csv:1: has no rows"),
        ("t_s,turn,slide\n0,9,0\n", "q.csv:2: joint `turn` is at 9, outside its limits"),
    ] {
        let message = parse(text, &options).unwrap_err().to_string();
        assert!(message.starts_with(part), "{text:?}: {message}");
    }
}

#[test]
fn a_file_without_states_is_warned_of_and_a_single_state_needs_no_file() {
    let chain = chain();
    let states = parse("turn,slide\n", &JointStateOptions::states(vec![robot("", &chain)])).unwrap();
    assert!(states.is_empty() && states.warnings[0].message.contains("no state below the header"));
    let single = JointStates::single("cell.toml".as_ref(), [&[1.0, 2.0][..], &[3.0]]);
    assert_eq!((single.len(), single.q(0, RobotId(0)), single.q(0, RobotId(1))), (1, &[1.0, 2.0][..], &[3.0][..]));
}

#[test]
fn files_beyond_the_largest_size_are_refused() {
    let chain = chain();
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), "turn,slide\n0,0\n").unwrap();
    let states = JointStateOptions::states(vec![robot("", &chain)]);
    assert_eq!(JointStates::read(file.path(), &states).unwrap().len(), 1);
    let error = JointStates::read(file.path(), &JointStateOptions { max_bytes: 14, ..states }).unwrap_err();
    assert_eq!(error.message, "has 15 bytes; at most 14 are read");
}

proptest! {
    /// Any text gives a result without a panic; accepted values are finite and complete.
    #[test]
    fn no_input_panics(text in "[a-z_.,\"\n0-9einf -]{0,80}", with_header: bool) {
        let chain = chain();
        let text = if with_header { format!("turn,slide\n{text}") } else { text };
        for limits in [LimitCheck::None, LimitCheck::Warn, LimitCheck::Refuse] {
            let options = JointStateOptions { limits, ..JointStateOptions::states(vec![robot("", &chain)]) };
            if let Ok(states) = parse(&text, &options) {
                prop_assert!((0..states.len()).all(|i| states.q(i, RobotId(0)).iter().all(|x| x.is_finite())));
            }
        }
    }
}
