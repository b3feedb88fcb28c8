//! Paths that are not regular files, and wrong counts.

use elbowroom_formats::mesh;

#[test]
fn announced_counts_are_checked_against_the_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let vertex = "property float x\nproperty float y\nproperty float z\n";
    let cases: [(&str, String, Option<usize>, &str); 7] = [
        ("a.off", "OFF\n99999999 99999999 0\n0 0 0\n".into(), Some(2), "announces 99999999 vertices"),
        (
            "b.ply",
            format!("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n{vertex}end_header\nabc"),
            Some(3),
            "only 3 bytes left",
        ),
        ("c.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\nabc".into(), Some(3), "have no x"),
        ("d.ply", "ply\nformat ascii 1.0\nelement other 4000000000\nend_header\nabc".into(), None, "no faces"),
        ("e.obj", "v 0 0 0\nv 1 0 0\nv nan 0 0\nf 1 2 3\n".into(), Some(3), "not finite"),
        (
            "f.stl",
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n".into(),
            Some(6),
            "`endloop` is missing",
        ),
        ("g.off", "OFF\n1 1 0\n0 0 0\n3 0 0 1\n".into(), Some(4), "the corner `1` does not exist"),
    ];
    for (name, text, line, what) in cases {
        let path = directory.path().join(name);
        std::fs::write(&path, text).unwrap();
        let error = mesh::load(&path, None).unwrap_err();
        assert!(error.message.contains(what), "{error}");
        assert_eq!(error.line, line, "{error}");
        assert_eq!(error.file, path);
    }
}

#[test]
fn directories_and_missing_files_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    assert!(mesh::load(directory.path(), None).unwrap_err().message.contains("not a file"));
    assert!(mesh::load(&directory.path().join("none.stl"), None).unwrap_err().message.contains("cannot be read"));
}

/// Reading a pipe might never end.
#[cfg(unix)]
#[test]
fn devices_are_refused() {
    assert!(mesh::load("/dev/zero".as_ref(), None).unwrap_err().message.contains("not a file"));
}
