//! Two arms of seven links: the links' boxes in the world decide which pairs are queried.

use std::path::Path;
use std::rc::Rc;

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::{self, ClosestPoints};
use parry3d_f64::shape::TriMesh;

use crate::dual::{self, Turned};
use crate::files::{read_mesh, read_poses};
use crate::serve::{Cell, yes};
use crate::{DUAL, LIB};

const LINKS: usize = 7;
const TOLERANCE: f64 = 0.05;

struct Arms(Vec<TriMesh>);

pub fn add(data: &Path, cells: &mut Vec<Cell>) {
    if !data.join("robot_link0.stl").is_file() {
        return;
    }
    let arms = Rc::new(Arms((0..LINKS).map(|k| read_mesh(&data.join(format!("robot_link{k}.stl")))).collect()));
    let size = arms.0.iter().map(|link| link.local_aabb().extents().max_element()).fold(0.0, f64::max);
    for name in ["0.6", "1.0", "1.4", "1.8", "2.2", "hard"] {
        let set = format!("robots_{name}");
        let file = data.join(format!("{set}.pose"));
        if !file.is_file() {
            continue;
        }
        let poses = Rc::new(read_poses(&file));
        let form = Cell { set, size, tolerance: TOLERANCE, ..Cell::default() };
        let mut add = |lib: &str, query, answer: fn(&Arms, &[Pose]) -> f64| {
            let (arms, p) = (arms.clone(), poses.clone());
            let run = Box::new(move |i: usize| answer(&arms, p.record(i)));
            cells.push(form.with(&format!("{lib}+aabb"), query, poses.records(), run));
        };
        add(LIB, "collide", |arms, poses| {
            yes(arms.any(poses, 0.0, |a, pa, b, pb| {
                query::intersection_test(pa, a, pb, b).is_ok_and(|found| found.intersecting)
            }))
        });
        add(LIB, "tolerance", |arms, poses| {
            yes(arms.any(poses, TOLERANCE, |a, pa, b, pb| {
                query::closest_points(pa, a, pb, b, TOLERANCE).is_ok_and(|found| found != ClosestPoints::Disjoint)
            }))
        });
        add(DUAL, "collide", |arms, poses| {
            yes(arms.any(poses, 0.0, |a, pa, b, pb| dual::close(a, b, &pa.inv_mul(pb), 0.0)))
        });
        add(DUAL, "tolerance", |arms, poses| {
            yes(arms.any(poses, TOLERANCE, |a, pa, b, pb| dual::close(a, b, &pa.inv_mul(pb), TOLERANCE)))
        });
        add(LIB, "distance", |arms, poses| arms.least(poses, library_distance));
        add(DUAL, "distance", |arms, poses| {
            arms.least(poses, |a, pa, b, pb, best| dual::distance(a, b, &pa.inv_mul(pb), best))
        });
    }
}

/// Distance by parry's closest points, which prune with a known bound; without a bound, by `distance`.
fn library_distance(a: &TriMesh, pa: &Pose, b: &TriMesh, pb: &Pose, best: f64) -> f64 {
    if best == f64::INFINITY {
        return query::distance(pa, a, pb, b).map_or(f64::NAN, |found| found.distance);
    }
    match query::closest_points(pa, a, pb, b, best) {
        Ok(ClosestPoints::Intersecting) => 0.0,
        Ok(ClosestPoints::WithinMargin(on_a, on_b)) => (on_a - on_b).length(),
        Ok(ClosestPoints::Disjoint) => best,
        Err(_) => f64::NAN,
    }
}

impl Arms {
    fn boxes(&self, poses: &[Pose]) -> [Aabb; 2 * LINKS] {
        std::array::from_fn(|k| {
            let local = self.0[k % LINKS].local_aabb();
            let (middle, half) = Turned::new(&poses[k]).around(local.mins, local.maxs);
            Aabb::new(middle - half, middle + half)
        })
    }

    fn any(&self, poses: &[Pose], margin: f64, close: impl Fn(&TriMesh, &Pose, &TriMesh, &Pose) -> bool) -> bool {
        let boxes = self.boxes(poses);
        let all = (0..LINKS).flat_map(|a| (0..LINKS).map(move |b| (a, b)));
        let mut near = all.filter(|&(a, b)| gap_squared(&boxes[a], &boxes[LINKS + b]) <= margin * margin);
        near.any(|(a, b)| close(&self.0[a], &poses[a], &self.0[b], &poses[LINKS + b]))
    }

    fn least(&self, poses: &[Pose], nearest: impl Fn(&TriMesh, &Pose, &TriMesh, &Pose, f64) -> f64) -> f64 {
        let boxes = self.boxes(poses);
        let mut order: [(f64, usize, usize); LINKS * LINKS] =
            std::array::from_fn(|k| (gap_squared(&boxes[k / LINKS], &boxes[LINKS + k % LINKS]), k / LINKS, k % LINKS));
        order.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        let mut best = f64::INFINITY;
        for (gap, a, b) in order {
            if best <= 0.0 || gap >= best * best {
                break;
            }
            best = best.min(nearest(&self.0[a], &poses[a], &self.0[b], &poses[LINKS + b], best));
        }
        best
    }
}

fn gap_squared(a: &Aabb, b: &Aabb) -> f64 {
    (a.mins - b.maxs).max(b.mins - a.maxs).max(Vector::splat(0.0)).length_squared()
}
