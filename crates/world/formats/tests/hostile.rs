//! Any bytes give a valid model or a message, never a panic.

use std::path::Path;

use crate::common::corpus::{PARSERS, Xorshift, mutate, run, samples};
use elbowroom_formats::{MeshData, stl};
use elbowroom_spatial::Vec3;
use proptest::prelude::*;

#[test]
fn the_samples_are_valid() {
    for parser in PARSERS {
        for (i, sample) in samples(parser).iter().enumerate() {
            let size = run(parser, sample).unwrap_or_else(|e| panic!("{parser} {i}: {e}"));
            assert!(size > 0, "{parser} {i}");
        }
    }
}

/// Every prefix of a valid file.
#[test]
fn truncation_anywhere_does_not_panic() {
    for parser in PARSERS {
        for sample in samples(parser) {
            for length in 0..sample.len() {
                if let Err(e) = run(parser, &sample[..length]) {
                    assert!(!e.message.is_empty());
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..400), text in "[ -~\n]{0,300}") {
        for parser in PARSERS {
            drop(run(parser, &bytes));
            drop(run(parser, text.as_bytes()));
        }
    }

    #[test]
    fn damaged_files_do_not_panic(seed in 1..u64::MAX) {
        let mut random = Xorshift(seed);
        for parser in PARSERS {
            let list = samples(parser);
            let mut bytes = list[random.below(list.len())].clone();
            let other = list[random.below(list.len())].clone();
            mutate(&mut random, &mut bytes, &other);
            if let Ok(size) = run(parser, &bytes) {
                // Polygons with shared corners expand to at most sixteen times the size, a round solid of VRML to 250 KB.
                let round = |w: &[u8]| [&b"Sphere"[..], b"Cylin", b"Cone"].iter().any(|kind| w.starts_with(kind));
                let solids = if parser == "wrl" || parser == "mesh" { bytes.windows(6).filter(|w| round(w)).count() } else { 0 };
                prop_assert!(size <= 65536 + 64 * bytes.len() + 250_000 * solids, "{} bytes became {size}", bytes.len());
            }
        }
    }

    /// After writing and reading, the corners are equal in single precision, in the same order.
    #[test]
    fn binary_stl_survives_a_round_trip(corners in prop::collection::vec(prop::array::uniform3(-1e3..1e3f32), 3..40),
                                        faces in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..60)) {
        let vertices: Vec<Vec3> = corners.iter().map(|c| Vec3::from(c.map(f64::from))).collect();
        let triangles: Vec<[u32; 3]> = faces.iter().map(|f| f.map(|i| i.index(vertices.len()) as u32)).collect();
        let mesh = MeshData { name: "a".into(), vertices, triangles };
        let mut bytes = Vec::new();
        stl::write_binary(&mut bytes, std::slice::from_ref(&mesh)).unwrap();
        let again = stl::parse(&bytes, Path::new("a.stl")).unwrap().meshes.remove(0);
        let unfold = |m: &MeshData| -> Vec<Vec3> { m.triangles.iter().flatten().map(|&i| m.vertices[i as usize]).collect() };
        prop_assert_eq!(unfold(&again), unfold(&mesh));
        let mut distinct: Vec<[u64; 3]> = unfold(&mesh).iter().map(|v| v.to_array().map(|x| (x + 0.0).to_bits())).collect();
        distinct.sort_unstable();
        distinct.dedup();
        prop_assert_eq!(again.vertices.len(), distinct.len());
    }
}

/// Deep nesting must not overflow the stack. Millions of small elements must not use too much memory or time.
#[test]
fn deep_and_wide_trees_are_handled() {
    let deep = 200_000;
    let nested = |open: &str, close: &str| format!("{}{}", open.repeat(deep), close.repeat(deep));
    let robot = format!("<robot><link name=\"a\"/>{}</robot>", nested("<x>", "</x>"));
    assert!(run("urdf", robot.as_bytes()).is_ok());
    let scene = format!(
        "<COLLADA><library_visual_scenes><visual_scene>{}</visual_scene></library_visual_scenes></COLLADA>",
        nested("<node>", "</node>")
    );
    assert!(run("dae", scene.as_bytes()).unwrap_err().message.contains("too deeply"));
    assert!(run("gltf", nested("{\"a\":", "}").as_bytes()).is_err());
    let many = |n: usize, line: &dyn Fn(usize) -> String| (0..n).map(line).collect::<Vec<_>>().concat();
    let crowd = many(50_000, &|i| format!("<link name=\"l{i}\"/>\n"));
    assert!(run("urdf", format!("<robot>{crowd}</robot>").as_bytes()).unwrap_err().message.contains("50000 links"));
    let chain = many(20_000, &|i| {
        let joint = format!(
            "<joint name=\"j{i}\" type=\"continuous\"><parent link=\"l{i}\"/><child link=\"l{}\"/></joint>",
            i + 1
        );
        format!("<link name=\"l{}\"/>{joint}\n", i + 1)
    });
    assert!(run("urdf", format!("<robot><link name=\"l0\"/>{chain}</robot>").as_bytes()).is_ok());
}

/// Nodes that instance the next one twice would expand to 2^40 objects.
#[test]
fn exponential_node_instances_are_refused() {
    let node =
        |i| format!("<node id=\"n{i}\"><instance_node url=\"#n{0}\"/><instance_node url=\"#n{0}\"/></node>", i + 1);
    let nodes = (0..40).map(node).collect::<Vec<_>>().concat();
    let text = format!(
        "<COLLADA><library_nodes>{nodes}<node id=\"n40\"/></library_nodes><library_visual_scenes><visual_scene>\
         <node><instance_node url=\"#n0\"/></node></visual_scene></library_visual_scenes></COLLADA>"
    );
    assert!(run("dae", text.as_bytes()).unwrap_err().message.contains("too deeply"));
    let circle = text.replace("<node id=\"n40\"/>", "<node id=\"n40\"><instance_node url=\"#n0\"/></node>");
    assert!(run("dae", circle.as_bytes()).is_err());
}

/// Small files that declare large contents: each must be refused or read within seconds.
#[test]
fn small_files_that_expand_are_refused_quickly() {
    let started = std::time::Instant::now();
    let attributes: Vec<String> = (0..8_000).map(|i| format!("a{i}=\"\" ")).collect();
    drop(run("urdf", format!("<robot {}/>", attributes.concat()).as_bytes()));
    let corners: Vec<String> = (0..8_000).map(|i| format!("v {} {} 0\n", i % 7, (i * i) % 11)).collect();
    let face: Vec<String> = (1..=8_000).map(|i| format!(" {i}")).collect();
    drop(run("obj", format!("{}f{}\n", corners.concat(), face.concat()).as_bytes()));
    let zeros = "0 ".repeat(30_000);
    let geometry = |i: usize| {
        format!(
            "<geometry id=\"g{i}\"><mesh><triangles><input semantic=\"POSITION\" source=\"#p\" offset=\"0\"/><p>0 1 2</p></triangles></mesh></geometry>"
        )
    };
    let geometries: Vec<String> = (0..5000).map(geometry).collect();
    let dae = format!(
        "<COLLADA><library_geometries><geometry id=\"h\"><mesh><source id=\"p\"><float_array>{zeros}</float_array></source></mesh></geometry>{}\
         </library_geometries></COLLADA>",
        geometries.concat()
    );
    assert!(run("dae", dae.as_bytes()).unwrap_err().message.contains("together"));
    assert!(started.elapsed().as_secs() < 20, "{:?}", started.elapsed());
}

/// Counts near 2^64 must not overflow a sum.
#[test]
fn overflowing_counts_are_refused() {
    let text = String::from_utf8(samples("gltf").remove(0)).unwrap();
    for count in ["18446744073709551615", "9223372036854775808"] {
        assert!(run("gltf", text.replace("\"count\":3", &format!("\"count\":{count}")).as_bytes()).is_err());
    }
}

/// A missing primitive would be free space.
#[test]
fn a_primitive_of_an_unknown_mode_is_refused() {
    let text = String::from_utf8(samples("gltf").remove(0)).unwrap();
    for mode in ["7", "4294967295"] {
        let error = run("gltf", text.replace("\"mode\":5", &format!("\"mode\":{mode}")).as_bytes()).unwrap_err();
        assert!(error.message.contains(&format!("has the mode {mode}, which does not exist")), "{}", error.message);
    }
    assert!(run("gltf", text.replace("\"mode\":5", "\"mode\":1").as_bytes()).is_ok());
}
