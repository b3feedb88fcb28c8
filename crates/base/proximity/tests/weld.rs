//! Mesh repair: welding, orientation and components, compared with simple implementations.

use crate::common::{RandomGeometry, SplitMix};
use elbowroom_proximity::repair::{RepairError, orient, split_components, weld};
use elbowroom_proximity::{ConvexHull, TriMesh};
use elbowroom_spatial::Vec3;
use proptest::prelude::*;

/// The vertices that `weld` must merge, found by comparing every pair.
fn simple_targets(vertices: &[Vec3], tolerance: f64) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    let mut target = Vec::new();
    for (i, v) in vertices.iter().enumerate() {
        let near = kept.iter().copied().map(|k| (vertices[k].distance(*v), k)).filter(|n| n.0 <= tolerance);
        let nearest = near.min_by(|a, b| a.partial_cmp(b).unwrap());
        let to = nearest.map_or(i, |n| n.1);
        if to == i {
            kept.push(i);
        }
        target.push(to);
    }
    target
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn vertices_are_merged_as_by_the_simple_implementation(
        cells in prop::collection::vec(prop::array::uniform3(-6_i32..6), 3..60),
        tolerance in prop::sample::select(vec![0.0, 1e-300, 0.05, 0.11, 0.25, 1.0]),
        far in prop::sample::select(vec![0.0, 1e6]),
    ) {
        let point = |c: &[i32; 3]| Vec3::from(c.map(|x| far + f64::from(x) * 0.1));
        let vertices: Vec<Vec3> = cells.iter().map(point).collect();
        let n = vertices.len() as u32;
        let triangles: Vec<[u32; 3]> = (0..n).map(|i| [i, (i + 1) % n, (i * 7 + 2) % n]).collect();
        let welded = weld(&vertices, &triangles, tolerance).unwrap();
        let target = simple_targets(&vertices, tolerance);
        let merged = target.iter().enumerate().filter(|(i, t)| i != *t).count();
        prop_assert_eq!(welded.report.merged, merged);
        // Vertices move by at most the tolerance, and the remaining vertices are farther apart.
        for (i, v) in welded.vertices.iter().enumerate() {
            prop_assert!(vertices.iter().any(|w| w == v));
            prop_assert!(welded.vertices[..i].iter().all(|w| w.distance(*v) > tolerance));
        }
        let dropped = welded.report.zero_area + welded.report.duplicate;
        prop_assert_eq!(welded.triangles.len() + dropped, triangles.len());
        prop_assert_eq!(welded.report.unused + merged + welded.vertices.len(), vertices.len());
        // Welding again changes nothing.
        let again = weld(&welded.vertices, &welded.triangles, tolerance).unwrap();
        prop_assert_eq!(&again.vertices, &welded.vertices);
        prop_assert!(again.report.merged == 0 && again.report.duplicate == 0);
    }

    #[test]
    fn a_scrambled_solid_is_restored(seed in any::<u64>(), turned in prop::collection::vec(any::<bool>(), 80)) {
        let mut rng = SplitMix(seed);
        let hull = rng.hull();
        let (soup, faces) = scrambled(&hull, &mut rng, &turned);
        let welded = weld(&soup, &faces, 1e-7).unwrap();
        prop_assert_eq!(welded.vertices.len(), hull.vertices().len());
        prop_assert_eq!(welded.triangles.len(), hull.triangles().len());
        let oriented = orient(&welded.vertices, &welded.triangles).unwrap();
        prop_assert_eq!((oriented.report.shells, oriented.report.closed, oriented.report.cavities), (1, 1, 0));
        let mesh = TriMesh::new(welded.vertices, oriented.triangles).unwrap();
        prop_assert!(mesh.report().closed && !mesh.report().inside_out && mesh.report().duplicate == 0);
        prop_assert!((mesh.report().volume - hull.volume()).abs() < 1e-5 * (1.0 + hull.volume()));
    }
}

/// Every face with its own corners, slightly offset, some reversed.
fn scrambled(hull: &ConvexHull, rng: &mut SplitMix, turned: &[bool]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut soup, mut faces) = (vec![], vec![]);
    for (k, t) in hull.triangles().iter().enumerate() {
        let first = soup.len() as u32;
        soup.extend(t.map(|i| hull.vertices()[i as usize] + rng.vec(1e-8)));
        let swap = turned[k % turned.len()];
        faces.push(if swap { [first, first + 2, first + 1] } else { [first, first + 1, first + 2] });
    }
    (soup, faces)
}

fn cube(half: f64, at: Vec3, inward: bool) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |k: u32, bit: u32| if k & bit == 0 { -half } else { half };
    let vertices = (0..8).map(|k| at + Vec3::new(corner(k, 1), corner(k, 2), corner(k, 4))).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    (vertices, faces.map(|[a, b, c]| if inward { [a, c, b] } else { [a, b, c] }).collect())
}

fn join(all: &[(Vec<Vec3>, Vec<[u32; 3]>)]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut vertices, mut faces) = (vec![], vec![]);
    for (v, f) in all {
        let first = vertices.len() as u32;
        vertices.extend(v);
        faces.extend(f.iter().map(|f| f.map(|i| i + first)));
    }
    (vertices, faces)
}

#[test]
fn a_long_chain_of_neighbours_does_not_collapse() {
    let chain: Vec<Vec3> = (0..1000).map(|k| Vec3::X * (f64::from(k) * 0.9)).collect();
    let faces: Vec<[u32; 3]> = (0..998).map(|k| [k, k + 1, k + 2]).collect();
    let welded = weld(&chain, &faces, 1.0).unwrap();
    assert_eq!(welded.report.merged, 500);
    assert!(welded.triangles.is_empty() && welded.report.zero_area == 998);
}

#[test]
fn duplicates_are_removed_and_walls_between_solids_stay() {
    let (mut vertices, mut faces) = cube(1.0, Vec3::ZERO, false);
    let wall = faces[0];
    faces.push([wall[1], wall[2], wall[0]]);
    faces.push([wall[0], wall[2], wall[1]]);
    vertices.push(Vec3::splat(9.0));
    let welded = weld(&vertices, &faces, 0.0).unwrap();
    assert_eq!((welded.report.duplicate, welded.report.unused, welded.triangles.len()), (1, 1, 13));
    // Two cubes that share a side stay closed.
    let two = join(&[cube(1.0, Vec3::ZERO, false), cube(1.0, Vec3::X * 2.0, false)]);
    let welded = weld(&two.0, &two.1, 1e-9).unwrap();
    assert_eq!((welded.vertices.len(), welded.triangles.len()), (12, 24));
    let mesh = TriMesh::new(welded.vertices, welded.triangles).unwrap();
    assert!(mesh.contains(Vec3::splat(0.1)) && mesh.contains(Vec3::X * 2.1));
}

#[test]
fn a_sliver_that_closes_a_surface_stays() {
    // The edge from 0 to 1 of a tetrahedron is split on one side: a face without area fills the seam.
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::X * 0.5];
    let faces = vec![[0, 2, 4], [4, 2, 1], [0, 4, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let closed = weld(&vertices, &faces, 1e-9).unwrap();
    assert_eq!((closed.report.slivers_kept, closed.report.zero_area), (1, 0));
    assert!(TriMesh::new(closed.vertices, closed.triangles).unwrap().report().closed);
    let open = weld(&vertices, &faces[1..], 1e-9).unwrap();
    assert_eq!((open.report.slivers_kept, open.report.zero_area), (0, 1));
}

#[test]
fn cavities_stay_and_solids_face_outward() {
    let outer = |inward| cube(3.0, Vec3::ZERO, inward);
    let inner = |inward| cube(1.0, Vec3::splat(0.2), inward);
    let beside = |inward| cube(1.0, Vec3::X * 9.0, inward);
    let core = |inward| cube(0.5, Vec3::splat(0.2), inward);
    // Each case is the given orientation, and whether the shell bounds a cavity: outer, inner, core, beside.
    let cases = [
        ([false, true, false, false], [false, true, false, false]),
        ([true, false, true, true], [false, true, false, false]),
        ([false, false, false, true], [false, false, false, false]),
        ([false, true, true, true], [false, true, false, false]),
    ];
    for (given, cavity) in cases {
        let (v, f) = join(&[outer(given[0]), inner(given[1]), core(given[2]), beside(given[3])]);
        let oriented = orient(&v, &f).unwrap();
        let components = split_components(&v, &oriented.triangles).unwrap();
        let inside_out: Vec<bool> = components
            .into_iter()
            .map(|p| TriMesh::new(p.vertices, p.triangles).unwrap().report().inside_out)
            .collect();
        assert_eq!(inside_out, cavity, "{given:?}");
        assert_eq!(oriented.report.cavities, cavity.iter().filter(|c| **c).count());
    }
}

#[test]
fn a_strip_with_one_side_is_left_as_it_is() {
    let n = 12_u32;
    let at = |k: u32, side: f64| {
        let (turn, half) =
            (f64::from(k) * std::f64::consts::TAU / f64::from(n), f64::from(k) * std::f64::consts::PI / f64::from(n));
        let out = Vec3::new(turn.cos(), turn.sin(), 0.0);
        out * (3.0 + side * half.cos()) + Vec3::Z * (side * half.sin())
    };
    let vertices: Vec<Vec3> = (0..n).flat_map(|k| [at(k, -1.0), at(k, 1.0)]).collect();
    let mut faces = vec![];
    for k in 0..n {
        let next = if k + 1 == n { [1, 0] } else { [2 * k + 2, 2 * k + 3] };
        faces.extend([[2 * k, 2 * k + 1, next[0]], [next[0], 2 * k + 1, next[1]]]);
    }
    let oriented = orient(&vertices, &faces).unwrap();
    assert_eq!((oriented.report.one_sided, oriented.report.closed), (1, 0));
    assert_eq!(oriented.triangles, faces);
}

#[test]
fn components_are_in_the_order_of_their_triangles() {
    let (v, f) =
        join(&[cube(1.0, Vec3::ZERO, false), cube(1.0, Vec3::X * 5.0, false), cube(1.0, Vec3::X * 2.0, false)]);
    let components = split_components(&v, &f).unwrap();
    // The first and the third share corners by their coordinates.
    assert_eq!(
        components.iter().map(|p| (p.vertices.len(), p.triangles.len())).collect::<Vec<_>>(),
        [(16, 24), (8, 12)]
    );
    assert_eq!(components[1].from, (12..24).collect::<Vec<u32>>());
    for p in &components {
        let mesh = TriMesh::new(p.vertices.clone(), p.triangles.clone()).unwrap();
        assert!((mesh.report().volume - p.triangles.len() as f64 / 12.0 * 8.0).abs() < 1e-12);
    }
}

#[test]
fn invalid_input_is_refused_with_a_reason_and_nan_is_left_alone() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for bad in [f64::NAN, -1e-9, f64::INFINITY] {
        assert!(matches!(weld(&corners, &[[0, 1, 2]], bad), Err(RepairError::Tolerance(_))));
    }
    let wrong = RepairError::IndexOutOfRange { triangle: 1, index: 3, vertices: 3 };
    assert_eq!(weld(&corners, &[[0, 1, 2], [0, 1, 3]], 0.1).unwrap_err(), wrong);
    assert_eq!(orient(&corners, &[[0, 1, 2], [0, 1, 3]]).unwrap_err(), wrong);
    assert_eq!(split_components(&corners, &[[0, 1, 2], [0, 1, 3]]).unwrap_err(), wrong);
    let nan = [Vec3::ZERO, Vec3::X, Vec3::new(f64::NAN, 0.0, 0.0), Vec3::new(f64::INFINITY, 0.0, 0.0)];
    let welded = weld(&nan, &[[0, 1, 2], [0, 1, 3]], 10.0).unwrap();
    assert_eq!(welded.report.merged, 1);
    assert!(orient(&nan, &[[0, 1, 2], [0, 1, 3]]).is_ok());
    assert!(weld(&[], &[], 0.0).unwrap().triangles.is_empty());
    assert!(orient(&[], &[]).unwrap().triangles.is_empty() && split_components(&[], &[]).unwrap().is_empty());
}
