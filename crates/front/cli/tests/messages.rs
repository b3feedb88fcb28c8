//! Error messages for newcomers: which file, what is wrong there, what to write instead.

use std::fs;
use std::path::Path;

use crate::common::elbowroom;

/// Returns the message of a refused call.
#[track_caller]
fn refused(dir: &Path, args: &[&str]) -> String {
    elbowroom(dir, args).expect(2).stderr
}

#[test]
fn mistakes_of_a_first_hour_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    elbowroom(dir, &["example", "cells"]).expect(0);
    let cell = "cells/exchange/cell.toml";
    fs::write(dir.join("taken"), "").unwrap();
    let said = refused(dir, &["run", cell, "--out", "taken"]);
    assert!(said.contains("taken: cannot be written") && said.contains("write: another name: a file"), "{said}");

    let twice = "\n[region.pallet]\nshape = \"sphere\"\nradius = 100\nwarning = 100\n";
    let text = fs::read_to_string(dir.join(cell)).unwrap();
    fs::write(dir.join("cells/exchange/twice.toml"), text.clone() + twice).unwrap();
    let line = text.lines().count() + 2;
    let said = refused(dir, &["check", "cells/exchange/twice.toml"]);
    assert!(
        said.contains(&format!("twice.toml:{line}: ")) && said.contains("names of robots, objects and regions"),
        "{said}"
    );

    fs::write(dir.join("states.csv"), "left.joint_1;left.joint_2\n0;0\n").unwrap();
    let query = ["query", cell, "--ask", "distance", "--states", "states.csv"];
    let said = refused(dir, &query);
    assert!(said.contains("is several: commas separate columns"), "{said}");

    let parts = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name=\"arm\"><xacro:include filename=\"parts.xacro\"/></robot>";
    fs::write(dir.join("arm.urdf.xacro"), parts).unwrap();
    let said = refused(dir, &["inspect", "arm.urdf.xacro"]);
    assert!(
        said.contains("is a xacro file that is not expanded") && said.contains("run `xacro arm.urdf.xacro > arm.urdf`"),
        "{said}"
    );
}

/// Applies only to users without administrator's rights, as administrators may read everything.
#[test]
#[cfg(unix)]
fn a_file_that_may_not_be_read_is_named_with_the_remedy() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.toml");
    fs::write(&path, "version = 1\n").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o000)).unwrap();
    if fs::read(&path).is_ok() {
        eprintln!("skipped: this account may read every file");
        return;
    }
    let said = refused(folder.path(), &["check", "cell.toml"]);
    assert!(said.contains("cell.toml: cannot be read") && said.contains("chmod u+r"), "{said}");
}
