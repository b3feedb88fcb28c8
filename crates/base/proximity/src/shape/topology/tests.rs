//! Comparison of the edge counts with a simple implementation with maps.

use std::collections::{HashMap, HashSet};

use elbowroom_spatial::Vec3;
use proptest::prelude::*;

use super::*;

struct Simple {
    open: Vec<bool>,
    all_twice: bool,
    duplicates: usize,
}

fn simple(faces: &[[u32; 3]], component_of: &[u32]) -> Simple {
    let mut uses: HashMap<(u32, u32), usize> = HashMap::new();
    let mut open = vec![true; component_of.len()];
    for f in faces.iter().filter(|f| is_proper(f)) {
        open[component_of[f[0] as usize] as usize] = false;
        for k in 0..3 {
            let (a, b) = (f[k], f[(k + 1) % 3]);
            *uses.entry((a.min(b), a.max(b))).or_default() += 1;
        }
    }
    for ((a, _), _) in uses.iter().filter(|(_, n)| **n % 2 == 1) {
        open[component_of[*a as usize] as usize] = true;
    }
    let mut seen = HashSet::new();
    let duplicates = faces.iter().filter(|f| {
        let mut sorted = **f;
        sorted.sort_unstable();
        !seen.insert(sorted)
    });
    Simple { open, all_twice: uses.values().all(|n| *n == 2), duplicates: duplicates.count() }
}

/// Components, found by propagating the smallest index until nothing changes.
fn simple_components(count: usize, faces: &[[u32; 3]]) -> Vec<u32> {
    let mut of: Vec<u32> = (0..count as u32).collect();
    loop {
        let before = of.clone();
        for f in faces {
            let least = f.map(|v| of[v as usize]).into_iter().min().unwrap();
            for &v in f {
                of[v as usize] = least;
            }
        }
        if of == before {
            return of;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn edges_duplicates_and_components_match_the_simple_implementation(
        faces in prop::collection::vec(prop::array::uniform3(0_u32..9), 1..30),
    ) {
        let component_of = components(9, &faces);
        prop_assert_eq!(&component_of, &simple_components(9, &faces));
        let (found, expected) = (examine_edges(9, &faces, &component_of), simple(&faces, &component_of));
        prop_assert_eq!(found.open, expected.open);
        prop_assert_eq!(found.all_twice, expected.all_twice);
        prop_assert_eq!(found.duplicates + degenerate_duplicates(&faces), expected.duplicates);
    }

    #[test]
    fn equal_vertices_map_to_the_first(
        cells in prop::collection::vec(prop::array::uniform3(-2_i8..3), 0..200), negative_zero in any::<bool>(),
    ) {
        let zero = if negative_zero { -0.0 } else { 0.0 };
        let point = |c: &[i8; 3]| Vec3::from(c.map(|x| if x == 0 { zero } else { f64::from(x) * 0.3 }));
        let mut vertices: Vec<Vec3> = cells.iter().map(point).collect();
        vertices.push(Vec3::ZERO);
        for (i, first) in first_of_equal(&vertices).into_iter().enumerate() {
            let expected = vertices.iter().position(|v| *v == vertices[i]);
            prop_assert_eq!(Some(first as usize), expected);
        }
    }
}

#[test]
fn a_fan_around_one_vertex_is_not_quadratic() {
    let n = 100_000;
    let faces: Vec<[u32; 3]> = (1..n).map(|i| [0, i, i % (n - 1) + 1]).collect();
    let component_of = components(n as usize, &faces);
    let report = examine_edges(n as usize, &faces, &component_of);
    assert!(report.open[0] && !report.all_twice && report.duplicates == 0);
}

#[test]
#[ignore = "measures; cargo test --release -p elbowroom-proximity --lib -- --ignored million --nocapture"]
fn a_million_triangles_take_well_under_a_second() {
    let (rings, around) = (500_u32, 1000_u32);
    let point = |i: u32, j: u32| {
        let (u, v) = (f64::from(i) / f64::from(rings), f64::from(j % around) / f64::from(around));
        let (su, cu) = (u * std::f64::consts::TAU).sin_cos();
        let (sv, cv) = (v * std::f64::consts::TAU).sin_cos();
        Vec3::new((2.0 + cu) * cv, (2.0 + cu) * sv, su)
    };
    let vertices: Vec<Vec3> = (0..rings * around).map(|k| point(k / around, k % around)).collect();
    let at = |i: u32, j: u32| (i % rings) * around + j % around;
    let quad = |i, j| [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]];
    let triangles: Vec<[u32; 3]> = (0..rings * around).flat_map(|k| quad(k / around, k % around)).collect();
    let soup: Vec<Vec3> = triangles.iter().flatten().map(|&v| vertices[v as usize]).collect();
    let own: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    // The worst order for the cache: vertices and triangles shuffled.
    let shuffle = |k: u32, n: u32| (u64::from(k) * 618_033 % u64::from(n)) as u32;
    let n = vertices.len() as u32;
    let mut shuffled = vec![Vec3::ZERO; vertices.len()];
    (0..n).for_each(|k| shuffled[shuffle(k, n) as usize] = vertices[k as usize]);
    let m = triangles.len() as u32;
    let shuffled_triangles: Vec<[u32; 3]> =
        (0..m).map(|k| triangles[shuffle(k, m) as usize].map(|v| shuffle(v, n))).collect();
    for (name, v, t) in
        [("indexed", &vertices, &triangles), ("soup", &soup, &own), ("shuffled", &shuffled, &shuffled_triangles)]
    {
        let start = std::time::Instant::now();
        let found = examine(v, t);
        let took = start.elapsed();
        println!("{name}: {} triangles, {took:?}", t.len());
        assert!(found.report.closed && found.component_vertices.len() == 1 && found.report.duplicate == 0, "{name}");
        assert!(took.as_secs_f64() < 1.0, "{name}: {took:?}");
    }
}
