//! The header declares what the library exports, with the same types.

use std::collections::BTreeMap;
use std::path::Path;

const RUST: &str = include_str!("../src/exports.rs");
const HEADER: &str = include_str!("../include/elbowroom.h");

/// Types of the parameters in C, and of the result.
type Signature = (Vec<String>, String);

/// The type in C of a type of `exports.rs`.
fn in_c(rust: &str) -> String {
    let handles = [("ModelHandle", "elbowroom_model"), ("StateChecker", "elbowroom_checker")];
    let records = [
        ("c_char", "char"),
        ("c_int", "int"),
        ("usize", "size_t"),
        ("f64", "double"),
        ("Status", "elbowroom_status"),
        ("Answer", "elbowroom_answer"),
        ("PoseRecord", "elbowroom_pose"),
        ("RobotFile", "elbowroom_robot_file"),
    ];
    let rest = |prefix: &str, suffix: &str| rust.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(suffix));
    if let Some((_, c)) = handles.iter().chain(&records).find(|(name, _)| *name == rust) {
        return (*c).to_owned();
    }
    if let Some(inner) = rest("Option<Box<", ">>").or_else(|| rest("Option<&mut ", ">")) {
        return format!("{} *", in_c(inner));
    }
    if let Some(inner) = rest("Option<&", ">").or_else(|| rest("*const ", "")) {
        return format!("const {} *", in_c(inner)).replace("* *", "**");
    }
    if let Some(inner) = rest("Out<'_, ", ">").or_else(|| rest("*mut ", "")) {
        return format!("{} *", in_c(inner)).replace("* *", "**");
    }
    panic!("the type `{rust}` has no counterpart in this test");
}

/// Splits at commas that are not inside of `<>`.
fn parameters(text: &str) -> Vec<&str> {
    let (mut depth, mut start, mut found) = (0, 0, Vec::new());
    for (i, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' => depth -= 1,
            ',' if depth == 0 => {
                found.push(text[start..i].trim());
                start = i + 1;
            }
            _ => {}
        }
    }
    found.push(text[start..].trim());
    found.retain(|parameter| !parameter.is_empty());
    found
}

/// The functions of `exports.rs`.
fn exported() -> BTreeMap<String, Signature> {
    let functions = RUST.split("#[unsafe(no_mangle)]").skip(1).map(|text| {
        let (_, text) = text.split_once("extern \"C\" fn ").expect("an exported function");
        let (name, text) = text.split_once('(').expect("parameters");
        let (inside, text) = text.split_once(')').expect("the end of the parameters");
        let (result, _) = text.split_once('{').expect("a body");
        let result = result.trim().strip_prefix("-> ").map_or_else(|| "void".to_owned(), in_c);
        let types = parameters(inside).into_iter().map(|p| in_c(p.split_once(": ").expect("a type").1)).collect();
        (name.to_owned(), (types, result))
    });
    functions.collect()
}

/// The functions of the header.
fn declared() -> BTreeMap<String, Signature> {
    let mut code = String::new();
    for part in HEADER.split("/*") {
        code.push_str(part.split_once("*/").map_or(part, |(_, code)| code));
    }
    let lines: Vec<&str> = code.lines().filter(|line| !line.starts_with('#')).collect();
    let code = lines.join("\n");
    let declarations = code.split(';').map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "));
    let functions = declarations.filter(|text| text.ends_with(')')).map(|text| {
        let (head, inside) = text.trim_end_matches(')').split_once('(').expect("parameters");
        let start = head.rfind("elbowroom_").expect("a name");
        let type_of = |parameter: &str| {
            let end = parameter.trim_end_matches(|c: char| c.is_alphanumeric() || c == '_').len();
            parameter[..end].trim().to_owned()
        };
        let types = if inside == "void" { Vec::new() } else { parameters(inside).into_iter().map(type_of).collect() };
        (head[start..].to_owned(), (types, head[..start].trim().to_owned()))
    });
    functions.collect()
}

#[test]
fn functions_have_the_same_types_in_the_header_and_in_the_library() {
    let (exported, declared) = (exported(), declared());
    assert!(exported.len() > 25, "only {} functions were found", exported.len());
    for (name, signature) in &exported {
        assert_eq!(Some(signature), declared.get(name), "{name}: the library, and the header");
    }
    let names = |of: &BTreeMap<String, Signature>| of.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&exported), names(&declared));
}

#[test]
fn every_function_is_called_by_the_test_in_c() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/c");
    let calls = std::fs::read_to_string(folder.join("calls.c")).expect("the test in C");
    let missing: Vec<String> = exported().into_keys().filter(|name| !calls.contains(&format!("{name}("))).collect();
    assert_eq!(missing, Vec::<String>::new());
}

#[test]
fn a_block_is_that_of_the_command() {
    assert!(HEADER.contains(&format!("#define ELBOWROOM_BLOCK {}\n", elbowroom::query::BLOCK)));
}
