//! The cache of covers: the same covers with and without it, for any contents of its files.

use elbowroom_proximity::{Cuboid, Cylinder, Shape};
use elbowroom_query::CoverCache;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_validity::{CoverSource, SphereCover};

fn files(directory: &std::path::Path) -> Vec<std::path::PathBuf> {
    std::fs::read_dir(directory).into_iter().flatten().map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn covers_come_back_and_damaged_files_are_written_again() {
    let directory = tempfile::tempdir().unwrap();
    let cache = CoverCache::in_directory(&directory.path().join("made/later"));
    // Large enough to be worth keeping.
    let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.2, 0.15, 0.1) });
    let shapes = [(&shape, Pose::IDENTITY)];
    let built = SphereCover::new(&shapes, 0.003).unwrap();
    assert_eq!(cache.cover(&shapes, 0.003).as_ref(), Some(&built));
    let kept = files(&directory.path().join("made/later"));
    let [file] = &kept[..] else { panic!("{kept:?}") };
    let bytes = std::fs::read(file).unwrap();
    for wrong in [&[], &bytes[..bytes.len() / 2], b"elbowroom cover\x02 of the future"] {
        std::fs::write(file, wrong).unwrap();
        assert_eq!(cache.cover(&shapes, 0.003).as_ref(), Some(&built));
        assert_eq!(std::fs::read(file).unwrap(), bytes, "written again");
    }
    assert_eq!(cache.cover(&shapes, 0.003).as_ref(), Some(&built), "from the file");
    // Another slack, shape or pose gives other covers.
    let other = Shape::Cylinder(Cylinder { half_length: 0.2, radius: 0.1 });
    assert_eq!(cache.cover(&shapes, 0.004), SphereCover::new(&shapes, 0.004));
    let moved = [(&shape, Pose::from_translation(Vec3::X))];
    assert_eq!(cache.cover(&moved, 0.003), SphereCover::new(&moved, 0.003));
    assert_eq!(cache.cover(&[(&other, Pose::IDENTITY)], 0.003), SphereCover::new(&[(&other, Pose::IDENTITY)], 0.003));
    assert_eq!(files(&directory.path().join("made/later")).len(), 4, "no unfinished files");
}

#[test]
fn a_directory_that_cannot_be_made_is_done_without() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let cache = CoverCache::in_directory(&file.path().join("below a file"));
    let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.2, 0.15, 0.1) });
    let shapes = [(&shape, Pose::IDENTITY)];
    assert_eq!(cache.cover(&shapes, 0.004), SphereCover::new(&shapes, 0.004));
}
