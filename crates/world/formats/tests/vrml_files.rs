//! VRML 2: messages with their lines, inlined files, and hostile input.

use std::path::Path;

use crate::vrml::{FACE, HEADER, parse, refused};
use elbowroom_formats::mesh::{self, MeshFormat, UpAxis};
use elbowroom_formats::vrml;
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::LengthUnit;

/// The single warning of a file.
fn warning(body: &str) -> String {
    let loaded = parse(body).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    loaded.warnings[0].to_string()
}

#[test]
fn a_switch_that_shows_nothing_is_a_warning() {
    for which in ["", "whichChoice -1", "whichChoice 7"] {
        let said = warning(&format!("{FACE}\nSwitch {{ {which} choice [ {FACE} ] }}"));
        assert!(
            said.starts_with("a.wrl:3: Switch: whichChoice is") && said.contains("none of its 1 choices"),
            "{said}"
        );
    }
}

#[test]
fn lines_points_scripts_and_routes_are_warnings() {
    let line = "Shape { geometry IndexedLineSet { coord Coordinate { point [ 0 0 0 1 0 0 ] } coordIndex [ 0 1 -1 ] } }";
    for (body, part) in [
        (line, "a.wrl:3: IndexedLineSet: has no surface"),
        ("Shape { geometry PointSet { coord Coordinate { point [ 0 0 0 ] } } }", "a.wrl:3: PointSet: has no surface"),
        ("Shape { geometry Text { string \"a\" } }", "a.wrl:3: Text: has no surface"),
        (
            "Script { url \"javascript:\" eventIn SFTime t eventOut SFBool b field SFFloat x 0.5 }",
            "a.wrl:3: Script: is not run",
        ),
        (
            "DEF t TimeSensor { } ROUTE t.time TO t.set_time\nROUTE t . time TO t .set_time",
            "a.wrl:3: ROUTEs and animations",
        ),
        (
            "PROTO P [ exposedField MFNode children [ ] ] { Group { children IS children } }",
            "a.wrl:3: the prototype P is skipped",
        ),
        ("EXTERNPROTO P [ field SFFloat a ] \"p.wrl\"", "a.wrl:3: the prototype P is skipped"),
        ("EXTERNPROTO P [ ] [ \"p.wrl\" \"q.wrl\" ]", "a.wrl:3: the prototype P is skipped"),
        ("Wheel { teeth 12 colour [ 1 0 0 ] }", "a.wrl:3: Wheel: is no node of VRML 2; it is skipped"),
        ("Transform { translatoin 1 2 3 }", "a.wrl:3: Transform has no field translatoin"),
        ("Transform { scale 1 0 1 }", "a.wrl:3: Transform: scale has a 0"),
        ("Transform { rotation 0 0 0 1 }", "a.wrl:3: Transform: rotation has no axis"),
        ("Shape { geometry IndexedFaceSet { } }", "a.wrl:3: IndexedFaceSet: has no polygon"),
    ] {
        let said = warning(&format!("{FACE}\n{body}"));
        assert!(said.starts_with(part), "{part}: {said}");
    }
}

/// A missing surface would be free space.
#[test]
fn whatever_would_lose_a_surface_is_refused() {
    for (body, part) in [
        ("Wheel { teeth FACE }", "a.wrl:2: Wheel: this node is not read here, and its surface would be missing"),
        ("Wheel { teeth [ Group { children [ FACE ] } ] }", "Wheel: this node is not read here"),
        ("DEF f FACE Wheel { teeth [ USE f ] }", "Wheel: this node is not read here"),
        ("Box { }", "a.wrl:2: Box: this node is not read here"),
        ("Viewpoint { children [ FACE ] }", "a.wrl:2: Viewpoint: has no place for a surface"),
        ("Group {\n childern FACE }", "a.wrl:3: Group has no field childern, and the surface in it would be missing"),
        ("Group { children FACE children FACE }", "Group has a second children"),
        ("Shape { geometry Extrusion { } }", "a.wrl:2: the geometry Extrusion is not read"),
        ("Shape { geometry Gear { } }", "the geometry Gear is not read"),
        ("PROTO P [ ] { Box { } }\nP { }", "a.wrl:3: P: is a node of the prototype of line 2"),
        ("Inline { url \"missing.wrl\" }", "a.wrl:2: Inline: missing.wrl cannot be read"),
        ("Inline { url \"../a.wrl\" }", "Inline: `../a.wrl` leads out of the file's directory"),
        ("Inline { url [ \"http://example.org/a.wrl\" ] }", "leads out of the file's directory"),
        ("Inline { }", "Inline: has no url"),
    ] {
        let message = refused(&body.replace("FACE", FACE));
        assert!(message.contains(part) && message.contains("write:"), "{body}: {message}");
    }
}

#[test]
fn faults_are_named_with_their_line() {
    let set = |points: &str, index: &str| {
        format!(
            "Shape {{ geometry IndexedFaceSet {{\n coord Coordinate {{ point [\n{points} ] }}\n coordIndex [ 0\n{index} ] }} }}"
        )
    };
    for (body, part) in [
        (set("0 0 0 1 0 0 0 1", "1 2"), "point has 8 numbers, which are not three per point"),
        (set("0 0 0 1 0 0\n0 1e999 0", "1 2"), "a.wrl:5: `1e999` in point is not a finite number"),
        (set("0 0 0 1 0 0 0 1 0", "1 3"), "a.wrl:6: `3` in coordIndex is no point: the coordinates have 3"),
        (set("0 0 0 1 0 0 0 1 0", "1 -2"), "a.wrl:6: `-2` in coordIndex is no point"),
        (set("0 0 0 1 0 0 0 1 0", "1 1.5"), "a.wrl:6: `1.5` in coordIndex is no point"),
        (set("0 0 0 1 0 0 0 nan 0", "1 2"), "a.wrl:4: the list of point of line 3 is interrupted: `nan` is no number"),
        ("Transform {\n translation 1 2 }".into(), "a.wrl:3: translation of Transform is not made of 3 numbers"),
        ("Transform {\n translation 1 2 3 4 }".into(), "a.wrl:3: translation of Transform is not made of 3 numbers"),
        ("Transform {\n translation \"1\" 2 3 }".into(), "a.wrl:3: `\"` in translation is not a finite number"),
        ("Transform {\n translation\n rotation 0 0 1 0 }".into(), "a.wrl:4: `rotation` is no node: no `{` follows"),
        ("Transform {\n translation }".into(), "a.wrl:3: the field translation has no value"),
        ("Transform { translation Group { } }".into(), "translation of Transform is a node"),
        ("Group { children [ ] ]".into(), "a.wrl:2: `]` without its `[`"),
        ("Group { } }".into(), "a.wrl:2: `}` without its `{`"),
        ("Group {\n children [ Group { }".into(), "a.wrl:3: the file ends inside the node Group of line 2"),
        ("WorldInfo {\n title \"a }".into(), "a.wrl:3: a text has no end"),
        ("Switch { whichChoice 0.5 }".into(), "whichChoice of Switch is not made of 1 number"),
        ("Shape { geometry Cylinder { top 1 } }".into(), "top of Cylinder is neither TRUE nor FALSE"),
        ("Shape { geometry Sphere { radius 0 } }".into(), "radius of Sphere is 0"),
        ("Shape { geometry Box { size 1 -1 1 } }".into(), "Box: has the size -1"),
        ("ROUTE a.b c.d".into(), "a ROUTE without `TO`"),
        ("PROTO P [ } ] {".into(), "the prototype of line 2 is not complete"),
        ("PROTO Sound [ ] { Shape { } }".into(), "a.wrl:2: the prototype Sound has the name of a node"),
    ] {
        let message = refused(&body);
        assert!(message.contains(part) && message.contains("write:"), "{body}: {message}");
    }
}

#[test]
fn other_versions_are_refused_with_what_to_do() {
    for (text, part) in [
        ("#VRML V1.0 ascii\nSeparator { }\n", "a.wrl:1: is VRML 1.0"),
        ("#VRML V2.0 binary\n", "a.wrl:1: begins with `#VRML V2.0 binary`"),
        ("Group { }\n", "a.wrl:1: begins with `Group { }`, not with the header of VRML 2"),
        ("\n\n#VRML\n", "a.wrl:3: begins with `#VRML`"),
    ] {
        let message = mesh::parse(text.as_bytes(), Path::new("a.wrl"), None, UpAxis::ToZ).unwrap_err().to_string();
        assert!(message.starts_with(part) && message.contains("write:"), "{message}");
    }
}

#[test]
fn the_kind_is_told_by_content() {
    let text = format!("{HEADER}{FACE}");
    let marked = format!("\u{feff}{text}");
    for (name, bytes) in [("a", text.as_bytes()), ("a.obj", text.as_bytes()), ("b.wrl", marked.as_bytes())] {
        assert_eq!(mesh::detect(bytes, Path::new(name)).unwrap(), MeshFormat::Vrml, "{name}");
        let loaded = mesh::parse(bytes, Path::new(name), None, UpAxis::ToZ).unwrap();
        assert_eq!(loaded.meshes[0].vertices[2], Vec3::Y, "+y stays up");
    }
    let packed = mesh::parse(&[0x1f, 0x8b, 8, 0], Path::new("a.wrz"), None, UpAxis::ToZ).unwrap_err().to_string();
    assert!(packed.contains("is compressed with gzip") && packed.contains("gunzip"), "{packed}");
    let mm = mesh::parse(text.as_bytes(), Path::new("a.wrl"), Some(LengthUnit::Millimetre), UpAxis::ToZ).unwrap();
    assert!(mm.aabb().max.x == 1.0 && mm.warnings[0].message.contains("states its own unit"));
    let empty = mesh::parse(HEADER.as_bytes(), Path::new("a.wrl"), None, UpAxis::ToZ).unwrap_err();
    assert!(empty.message.contains("no triangles"));
}

#[test]
fn inlined_files_are_placed_and_cycles_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, body: &str| {
        let path = dir.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, format!("{HEADER}{body}")).unwrap();
        path
    };
    write("parts/left hand.wrl", &format!("DEF finger Transform {{ translation 0 0 1 children {FACE} }}"));
    write(
        "parts/both.wrl",
        "Inline { url \"left%20hand.wrl\" }\nTransform { translation 0 9 0 children Inline { url \"left hand.wrl\" } }",
    );
    write("parts/more.wrl", FACE);
    let top = write(
        "top.wrl",
        "Transform { scale 2 2 2 children DEF hands Inline { url [ \"none.wrl\", \"./parts/both.wrl\" ] } } Inline { url \"parts\\\\more.wrl\" }",
    );
    let read = |path: &Path| vrml::parse_tree(&std::fs::read(path).unwrap(), path);
    let tree = read(&top).unwrap();
    let names: Vec<&str> = tree.nodes.iter().map(|n| n.name.as_str()).collect();
    assert_eq!(names, ["node_0", "hands", "left hand", "finger", "node_2", "left hand", "finger", "more", "more"]);
    let place = |i: usize| tree.in_world()[i].transform_point(tree.nodes[i].meshes[0].vertices[1]);
    assert!(
        place(3).distance(Vec3::new(2.0, 0.0, 2.0)) < 1e-12 && place(6).distance(Vec3::new(2.0, 18.0, 2.0)) < 1e-12
    );
    assert_eq!(mesh::load(&top, None).unwrap().meshes.len(), 3);
    write("parts/loop.wrl", "Inline { url \"loop.wrl\" }");
    let message = read(&dir.path().join("parts/loop.wrl")).unwrap_err().to_string();
    assert!(message.contains("loop.wrl:2: Inline:") && message.contains("inlines itself"), "{message}");
    let broken = write("parts/broken.wrl", "Shape { geometry Sphere { radius x } }");
    let message = read(&write("outer.wrl", "Inline { url \"parts/broken.wrl\" }")).unwrap_err();
    assert_eq!((message.file.as_path(), message.line), (broken.as_path(), Some(2)), "{message}");
}

/// Files that inline the next one twice would expand to 2^16 copies.
#[test]
fn inlined_files_expand_within_limits() {
    let dir = tempfile::tempdir().unwrap();
    for i in 0..15 {
        let next = format!("Inline {{ url \"{}.wrl\" }}\n", i + 1);
        std::fs::write(dir.path().join(format!("{i}.wrl")), format!("{HEADER}{}", next.repeat(4))).unwrap();
    }
    std::fs::write(dir.path().join("15.wrl"), format!("{HEADER}{FACE}")).unwrap();
    let top = dir.path().join("0.wrl");
    let message = vrml::parse(&std::fs::read(&top).unwrap(), &top).unwrap_err().to_string();
    assert!(message.contains("too deeply or too often"), "{message}");
}

#[test]
fn deep_wide_and_repeated_nodes_are_limited_in_time_and_memory() {
    let started = std::time::Instant::now();
    let deep = "Group { children [ ".repeat(200_000);
    assert!(refused(&deep).contains("the file ends before the value of children"));
    assert!(refused(&format!("{deep}Group {{ }}")).contains("the file ends inside the node Group"));
    assert!(refused(&format!("{deep}{}", "] } ".repeat(200_000))).contains("too deeply or too often"));
    assert!(refused(&format!("WorldInfo {{ info {}", "[ ".repeat(200_000))).contains("has no value"));
    assert!(refused(&format!("PROTO P {}", "[ ".repeat(200_000))).contains("is not complete"));
    let twice = |i: usize| format!("DEF g{i} Group {{ children [ USE g{0} USE g{0} ] }}\n", i - 1);
    let doubled = (1..40).map(twice).collect::<Vec<_>>().concat();
    assert!(refused(&format!("DEF g0 {FACE} {doubled}")).contains("too deeply or too often"));
    // A large grid, used again and again.
    let grid = format!(
        "DEF g Shape {{ geometry ElevationGrid {{ xDimension 300 zDimension 300 height [ {} ] }} }}",
        "0 ".repeat(90_000)
    );
    let message = refused(&format!("{grid}{}", "USE g ".repeat(200)));
    assert!(message.contains("expands to more than 20000000 vertices and triangles"), "{message}");
    // Many face sets that refer to the same many points.
    let points = format!(
        "Shape {{ geometry IndexedFaceSet {{ coord DEF c Coordinate {{ point [ {} ] }} }} }}",
        "0 ".repeat(300_000)
    );
    let message = refused(&format!("{points}{}", "Shape { geometry IndexedFaceSet { coord USE c } }".repeat(2500)));
    assert!(message.contains("refer to more than 200000000 points together"), "{message}");
    let comment = format!("DEF t Transform {{ translation 1 #{}\n 2 3 }}", "x".repeat(5000));
    assert!(refused(&comment).contains("without a long comment"), "{}", refused(&comment));
    assert!(started.elapsed().as_secs() < 20, "{:?}", started.elapsed());
}
