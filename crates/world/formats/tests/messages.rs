//! Messages about URDF and SRDF files: the fault, its line, and what to write instead.

use std::path::Path;

use elbowroom_formats::{Diagnostic, mesh, srdf, urdf};

const HEAD: &str = "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"b\"/>\n";

/// A joint from a to b on lines 5 to 8, before the given text.
fn with_joint(kind: &str, inside: &str, after: &str) -> String {
    format!(
        "{HEAD}<joint name=\"j\" type=\"{kind}\">\n<parent link=\"a\"/>\n<child link=\"b\"/>\n{inside}</joint>\n{after}</robot>\n"
    )
}

fn refused(text: &str) -> Diagnostic {
    urdf::parse(text.as_bytes(), Path::new("arm.urdf")).expect_err(text)
}

#[test]
fn names_are_shown_whole() {
    let name = "left_hand_of_the_second_robot_finger_joint_number_one";
    let error = refused(&with_joint("floating", "", "").replace("\"j\"", &format!("\"{name}\"")));
    assert!(error.message.contains(name), "{error}");
    // A name longer than any real joint name is still shortened.
    let error = refused(&with_joint("floating", "", "").replace("\"j\"", &format!("\"{}\"", "x".repeat(5000))));
    assert!(error.message.len() < 300 && error.message.contains('…'), "{error}");
}

#[test]
fn formats_of_others_are_named_with_what_to_do() {
    let refused = |file: &str, text: &str| {
        let path = Path::new(file);
        let urdf = urdf::parse(text.as_bytes(), path).expect_err(text);
        let mesh = mesh::parse(text.as_bytes(), path, None, mesh::UpAxis::ToZ).expect_err(text);
        [urdf, mesh].map(|e| e.to_string())
    };
    for message in refused("arm.sdf", "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\"/>") {
        assert!(message.contains("is SDF") && message.contains("URDF") && !message.contains("COLLADA"), "{message}");
    }
    for message in refused("cad/part.step", "ISO-10303-21;\nHEADER;\n") {
        assert!(
            message.contains("is STEP") && message.contains("`gmsh cad/part.step -2 -o cad/part.stl`"),
            "{message}"
        );
    }
    for (file, command) in [
        ("my part.STP", "`gmsh 'my part.STP' -2 -o 'my part.stl'`"),
        ("part.stl", "`gmsh part.stl -2 -o part.mesh.stl`"),
    ] {
        for message in refused(file, "ISO-10303-21;\nHEADER;\n") {
            assert!(message.contains(command) && message.contains("--unit mm"), "{message}");
        }
    }
    for message in refused("shelf.scene", "shelf\n.\n") {
        assert!(
            message.contains("[scene.NAME] file = \"shelf.scene\"") && message.contains("convert shelf.scene"),
            "{message}"
        );
    }
    for text in [r#"{"asset":{"version":"1.0"}}"#, r#"{"asset":{"version":"1.1"},"nodes":{"a":{}}}"#] {
        let error = mesh::parse(text.as_bytes(), Path::new("a.gltf"), None, mesh::UpAxis::ToZ).unwrap_err().to_string();
        assert!(error.contains("is glTF of version 1.") && error.contains("exported as glTF 2.0"), "{error}");
    }
    let xacro = "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\">\n<xacro:arm/></robot>";
    for (file, command) in [
        ("arm.urdf.xacro", "`xacro arm.urdf.xacro > arm.urdf`"),
        ("d/arm.xacro", "`xacro d/arm.xacro > d/arm.urdf`"),
        ("arm.urdf", "`xacro arm.urdf > arm.expanded.urdf`"),
        ("my arm.xacro", "`xacro 'my arm.xacro' > 'my arm.urdf'`"),
    ] {
        let message = urdf::parse(xacro.as_bytes(), Path::new(file)).unwrap_err().to_string();
        assert!(message.contains("is a xacro file") && message.contains(command), "{message}");
    }
}

#[test]
fn every_error_names_its_line_and_a_remedy() {
    let limit = "<limit lower=\"-1\" upper=\"1\" velocity=\"1\"/>\n";
    let joint_k = |parent: &str, child: &str| {
        format!("<joint name=\"k\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>\n")
    };
    let table: Vec<(String, usize, &str, &str)> = vec![
        (String::new(), 0, "empty", "export"),
        ("version https://git-lfs.github.com/spec/v1\noid sha256:0\n".into(), 1, "Git LFS", "git lfs pull"),
        ("hello".into(), 1, "not XML", "<robot"),
        ("<robot name=\"r\"><link name=\"a\"/>\n\n".into(), 2, "truncated", "closing"),
        ("<sdf version=\"1.9\"/>".into(), 1, "SDF", "URDF"),
        ("<COLLADA/>".into(), 1, "COLLADA", "URDF"),
        ("<robot name=\"r\"/>".into(), 1, "no links", "<link"),
        ("<robot>\n<group name=\"g\"/></robot>".into(), 1, "SRDF", "srdf"),
        ("<robot xmlns:xacro=\"http://ros.org/wiki/xacro\">\n<xacro:arm/>\n<link name=\"a\"/></robot>".into(), 2, "xacro", "xacro arm.urdf > arm.expanded.urdf"),
        ("<robot>\n<xacro:arm/></robot>".into(), 2, "xacro", "xacro arm.urdf > arm.expanded.urdf"),
        ("<robot><link name=\"a\">\n<collision><origin xyz=\"0 0 ${h}\"/></collision></link></robot>".into(), 2, "xacro", "xacro arm.urdf > arm.expanded.urdf"),
        (format!("{HEAD}<link name=\"a\"/></robot>"), 5, "second link `a`; the first is on line 3", "name of its own"),
        (format!("{HEAD}<link/></robot>"), 5, "no name", "name="),
        (format!("{HEAD}</robot>"), 4, "2 links have no parent", "fixed"),
        (with_joint("floating", "", ""), 5, "`floating`", "base pose"),
        (with_joint("planar", "", ""), 5, "`planar`", "prismatic"),
        (with_joint("hinge", "", ""), 5, "`hinge`", "revolute"),
        (with_joint("revolute", "", ""), 5, "no <limit>", "<limit lower="),
        (with_joint("revolute", "<limit velocity=\"1\"/>\n", ""), 8, "neither lower nor upper", "<limit lower="),
        (with_joint("prismatic", "<limit lower=\"2\" upper=\"1\"/>\n", ""), 8, "above", "lower=\"1\" upper=\"2\""),
        (with_joint("prismatic", "<limit lower=\"-inf\" upper=\"1\"/>\n", ""), 8, "not finite", "finite"),
        (with_joint("revolute", &format!("<axis xyz=\"0 0 0\"/>\n{limit}"), ""), 8, "no direction", "0 0 1"),
        (with_joint("revolute", &format!("<axis xyz=\"0 1\"/>\n{limit}"), ""), 8, "2 numbers", "three"),
        (with_joint("fixed", "<origin\n xyz=\"0 nan 0\"/>\n", ""), 9, "not finite", "three finite numbers"),
        (with_joint("fixed", "<origin rpy=\"0 0 1,5\"/>\n", ""), 8, "not made of numbers", "three"),
        (with_joint("revolute", &format!("{limit}<mimic joint=\"x\"/>\n"), ""), 9, "no joint `x`", "name of a joint"),
        (with_joint("revolute", &format!("{limit}<mimic joint=\"j\"/>\n"), ""), 5, "cycle", "without <mimic>"),
        (with_joint("fixed", "", &joint_k("b", "a")), 9, "cycle", "tree"),
        (with_joint("fixed", "", &joint_k("a", "b")), 9, "already the child", "one joint for each child"),
        (with_joint("fixed", "", &joint_k("b", "b")), 9, "itself", "two different"),
        (with_joint("fixed", "", &joint_k("b", "world")), 9, "no link `world`", "<link name=\"world\"/>"),
        (with_joint("fixed", "", "<joint name=\"j\" type=\"fixed\"/>\n"), 9, "second joint `j`; the first is on line 5", "own"),
        (format!("{HEAD}<joint name=\"j\" type=\"fixed\"><child link=\"b\"/></joint></robot>"), 5, "no parent", "<parent link="),
        ("<robot><link name=\"a\"><collision>\n</collision></link></robot>".into(), 1, "no <geometry>", "<box"),
        ("<robot><link name=\"a\"><collision><geometry>\n<cone/></geometry></collision></link></robot>".into(), 2, "<cone>", "<cylinder"),
        ("<robot><link name=\"a\"><collision><geometry>\n<sphere radius=\"-1\"/></geometry></collision></link></robot>".into(), 2, "negative", "radius="),
        ("<robot><link name=\"a\"><collision><geometry>\n<mesh/></geometry></collision></link></robot>".into(), 2, "no filename", "filename="),
        ("<robot xmlns:drake=\"http://drake.mit.edu\"><link name=\"a\"/>\n<drake:joint name=\"s\" type=\"screw\"/></robot>".into(), 2, "extension", "without prefix"),
        ("<!DOCTYPE x [<!ENTITY a \"b\">]><robot/>".into(), 0, "document type", "DOCTYPE"),
        ("<robot><link name=\"<a>\"/></robot>".into(), 1, "`<`", "&lt;"),
    ];
    let mut whats: Vec<String> = Vec::new();
    for (text, line, what, hint) in table {
        let error = refused(&text);
        assert_eq!(error.line.unwrap_or(0), line, "{error}\n{text}");
        assert!(error.message.contains(what), "{error}\nwants: {what}");
        assert!(error.hint.as_ref().is_some_and(|w| w.contains(hint)), "{error}\nwants: {hint}");
        whats.push(error.message);
    }
    whats.sort();
    whats.dedup();
    assert!(whats.len() > 30, "messages tell mistakes apart");
}

#[test]
fn a_default_namespace_is_accepted() {
    let text = with_joint("fixed", "", "").replace("<robot name", "<robot xmlns=\"http://www.ros.org\" name");
    let model = urdf::parse(text.as_bytes(), Path::new("arm.urdf")).unwrap();
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    assert_eq!(model.joints.len(), 1);
}

#[test]
fn a_missing_speed_is_a_warning_and_unknown() {
    for limit in ["<limit lower=\"-1\" upper=\"1\" velocity=\"0\"/>\n", "<limit lower=\"-1\" upper=\"1\"/>\n"] {
        let model = urdf::parse(with_joint("revolute", limit, "").as_bytes(), Path::new("arm.urdf")).unwrap();
        assert_eq!(model.joints[0].limits.velocity, None);
        assert_eq!(model.warnings.len(), 1);
        assert_eq!(model.warnings[0].line, Some(8));
    }
}

#[test]
fn utf16_and_latin1_are_read() {
    let text = with_joint("fixed", "", "");
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    assert_eq!(urdf::parse(&utf16, Path::new("a.urdf")).unwrap().links.len(), 2);
    let latin1 =
        text.replace("version=\"1.0\"", "version=\"1.0\" encoding=\"ISO-8859-1\"").replace("name=\"r\"", "name=\"r?\"");
    let latin1: Vec<u8> = latin1.into_bytes().into_iter().map(|b| if b == b'?' { 0xe4 } else { b }).collect();
    // Both question marks of the XML declaration were replaced too.
    let mut latin1 = latin1;
    latin1[1] = b'?';
    let end = latin1.iter().position(|&b| b == b'>').unwrap();
    latin1[end - 1] = b'?';
    assert_eq!(urdf::parse(&latin1, Path::new("a.urdf")).unwrap().name, "rä");
}

#[test]
fn srdf_errors_name_their_line() {
    let parse = |text: &str| srdf::parse(text.as_bytes(), Path::new("arm.srdf"));
    let error = parse("<robot>\n<disable_collisions link1=\"a\"/>\n</robot>").unwrap_err();
    assert_eq!((error.line, error.message.contains("link2")), (Some(2), true));
    assert_eq!(parse("<robot>\n<disable_collisions").unwrap_err().line, Some(2));
    assert!(parse("<sdf/>").unwrap_err().message.contains("<sdf>"));
}

#[test]
fn an_srdf_has_groups_states_and_tools_and_is_written_back() {
    let text = r#"<robot name="arm">
<group name="arm"><chain base_link="base" tip_link="flange"/></group>
<group name="hand"><link name="palm"/><joint name="grip"/></group>
<group name="all"><group name="arm"/><group name="hand"/></group>
<group_state name="home" group="arm"><joint name="j1" value="0.1"/><joint name="j2" value="-1e-7"/></group_state>
<end_effector name="tool" parent_link="flange" group="hand" parent_group="arm"/>
<virtual_joint name="world" type="fixed" parent_frame="map &amp; odom" child_link="base"/>
<passive_joint name="spring"/>
<link_sphere_approximation link="base"/>
<disable_collisions link1="base" link2="palm" reason="Never"/>
</robot>"#;
    let read = |text: &str| srdf::parse(text.as_bytes(), Path::new("arm.srdf")).unwrap();
    let first = read(text);
    assert!(first.warnings.is_empty(), "{:?}", first.warnings);
    assert_eq!(first.groups[0].chains, [["base".to_owned(), "flange".to_owned()]]);
    assert_eq!(first.groups[2].subgroups, ["arm", "hand"]);
    assert_eq!(first.end_effectors[0].parent_group.as_deref(), Some("arm"));
    assert_eq!(
        (first.virtual_joints[0].parent_frame.as_str(), first.passive_joints[0].as_str()),
        ("map & odom", "spring")
    );
    let second = read(&first.text(&["one -- two".to_owned()]));
    assert_eq!((&first.robot, &first.groups, &first.states), (&second.robot, &second.groups, &second.states));
    assert_eq!((&first.end_effectors, &first.virtual_joints), (&second.end_effectors, &second.virtual_joints));
    assert_eq!(
        (first.passive_joints, first.disabled[0].reason.as_str()),
        (second.passive_joints, second.disabled[0].reason.as_str())
    );
}

#[test]
fn incomplete_and_unknown_elements_of_an_srdf_are_left_out_with_their_line() {
    let cases = [
        ("<group/>", "<group> has no name: ignored", "tip_link"),
        ("<group name=\"g\"><chain base_link=\"a\"/></group>", "<chain> has no tip_link", "base_link=\"base_link\""),
        ("<end_effector name=\"e\" group=\"g\"/>", "<end_effector> has no parent_link", "parent_link=\"tool0\""),
        ("<virtual_joint name=\"v\" type=\"fixed\" child_link=\"a\"/>", "<virtual_joint> has no parent_frame", "world"),
        ("<passive_joint/>", "<passive_joint> has no name", "joint_7"),
        ("<group_state group=\"g\"/>", "<group_state> has no name", "home"),
        ("<group_tcps group=\"g\"/>", "<group_tcps> is ignored", "<virtual_joint>"),
        ("<disable_default_collisions link=\"a\"/>", "<disable_default_collisions> is ignored", "for each pair"),
    ];
    for (element, what, hint) in cases {
        let text =
            format!("<robot name=\"r\">\n{element}{}\n</robot>", if element.contains("tcps") { element } else { "" });
        let srdf = srdf::parse(text.as_bytes(), Path::new("arm.srdf")).unwrap();
        let [warning] = &srdf.warnings[..] else { panic!("{element}: {:?}", srdf.warnings) };
        assert!(warning.line == Some(2) && warning.message.contains(what), "{warning}");
        assert!(warning.hint.as_ref().unwrap().contains(hint), "{warning}");
    }
}
