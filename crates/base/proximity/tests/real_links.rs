//! Fits around the collision meshes of real robots; skipped if their descriptions are not installed.
#![allow(clippy::print_stdout, reason = "the test prints how tight the fits are")]

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use elbowroom_proximity::{ConvexHull, fit, project_point};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::folder;

/// Corners of a binary STL; `None` for any other file.
fn corners(path: &Path) -> Option<Vec<Vec3>> {
    let bytes = std::fs::read(path).ok()?;
    let count = u32::from_le_bytes(bytes.get(80..84)?.try_into().ok()?) as usize;
    let records = bytes.get(84..84 + 50 * count)?;
    let coordinate = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let corner = |b: &[u8]| Vec3::new(coordinate(b), coordinate(&b[4..]), coordinate(&b[8..]));
    let mut all: Vec<Vec3> = records.chunks_exact(50).flat_map(|t| [12, 24, 36].map(|at| corner(&t[at..]))).collect();
    all.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap_or(Ordering::Equal));
    all.dedup();
    Some(all)
}

#[test]
fn fits_around_real_links_hold_every_vertex() {
    let Some(root) = folder::data_part("urdf") else { return };
    let mut files = folder::files_below(&root);
    files.retain(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("stl")));
    // Collision meshes of up to 1,200 triangles: the test build is slow.
    let small = |p: &PathBuf| std::fs::metadata(p).is_ok_and(|m| m.len() < 60_000);
    files.retain(|p| p.components().any(|c| c.as_os_str() == "collision") && small(p));
    // Every third file is used, which includes all manufacturers.
    files = files.into_iter().step_by(3).take(24).collect();
    assert!(!files.is_empty(), "no small collision meshes in {}", root.display());
    let mut ratios: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for path in &files {
        let Some(points) = corners(path).filter(|p| p.len() >= 12) else { continue };
        let Ok(hull) = ConvexHull::from_points(&points) else { continue };
        for fit in [fit::capsule(&points), fit::cuboid(&points), fit::tightest(&points)] {
            let fit = fit.unwrap();
            for &p in &points {
                let out = project_point(&fit.shape, &fit.in_frame, p).signed_distance;
                assert!(out <= 0.0, "{}: {p:?} is {out} m outside {fit:?}", path.display());
            }
        }
        let ratio = fit::tightest(&points).unwrap().volume / hull.volume();
        assert!(ratio >= 1.0 - 1e-9, "{}: tighter than the hull, {ratio}", path.display());
        let robot = path.strip_prefix(&root).unwrap().components().next().unwrap();
        ratios.entry(robot.as_os_str().to_string_lossy().into_owned()).or_default().push(ratio);
    }
    for (robot, r) in &ratios {
        let mean = r.iter().sum::<f64>() / r.len() as f64;
        let worst = r.iter().copied().fold(0.0, f64::max);
        println!("{robot:32} {:3} links: tightest fit {mean:.2} times the hull's volume, worst {worst:.2}", r.len());
        assert!(mean < 4.0, "{robot}: fits {mean} times the hull are no fits");
    }
    assert!(!ratios.is_empty());
}
