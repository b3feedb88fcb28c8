//! Queries on two arms: broad phase by boxes and capsules, narrow phase by meshes.

use std::sync::Arc;

use elbowroom_proximity::advanced::{
    GroupWorkspace, Landmarks, MeshGroup, PlacedLandmarks, distance_upper_bound, is_farther_than, mesh_separation_with,
};
use elbowroom_proximity::{DistanceSettings, Shape, TriMesh, WarmStart, Workspace, fit, separation_within};
use elbowroom_spatial::{Aabb, Pose, Vec3};

/// Number of pairs of links for which an upper bound is computed first.
const FIRST_PAIRS: usize = 2;

/// The links' meshes, which are the same for both arms.
pub struct Arms {
    links: Vec<Arc<TriMesh>>,
    /// The same meshes, for collisions.
    group: MeshGroup,
    group_workspace: GroupWorkspace,
    /// Centre and radius of the bounding sphere of each link, metres.
    balls: Vec<(Vec3, f64)>,
    landmarks: Vec<Landmarks>,
    /// A capsule around each link, and its pose in the link.
    capsules: Vec<Option<(Shape, Pose)>>,
    workspace: Workspace,
    /// Boxes of all links in the world, first arm first.
    boxes: Vec<Aabb>,
    /// Landmarks of all links in the world, first arm first.
    placed_landmarks: Vec<PlacedLandmarks>,
    /// Lower bound of the distance, and the links.
    order: Vec<(f64, usize, usize)>,
}

impl Arms {
    pub fn new(links: Vec<TriMesh>) -> Self {
        let links: Vec<_> = links.into_iter().map(Arc::new).collect();
        let ball = |link: &Arc<TriMesh>| (link.aabb().center(), 0.5 * link.aabb().extent().length());
        let balls = links.iter().map(ball).collect();
        let landmarks = links.iter().map(|link| Landmarks::of(link)).collect();
        let around = |link: &Arc<TriMesh>| fit::capsule(link.vertices()).map(|fit| (fit.shape, fit.in_frame));
        let capsules = links.iter().map(around).collect();
        Self {
            group: MeshGroup::new(links.clone()),
            group_workspace: GroupWorkspace::new(),
            links,
            balls,
            landmarks,
            capsules,
            workspace: Workspace::new(),
            boxes: Vec::new(),
            placed_landmarks: Vec::new(),
            order: Vec::new(),
        }
    }

    /// Largest extent of a link, metres.
    pub fn size(&self) -> f64 {
        self.links.iter().map(|link| link.aabb().extent().max_element()).fold(0.0, f64::max)
    }

    /// True if a link of one arm touches a link of the other.
    pub fn collides(&mut self, poses: &[Pose]) -> bool {
        let (one, other) = poses.split_at(self.links.len());
        self.group.collides(one, &self.group, other, &mut self.group_workspace)
    }

    /// True if two links are within `tolerance` metres.
    pub fn within(&mut self, poses: &[Pose], tolerance: f64) -> bool {
        self.any(poses, tolerance, |links, a, b, poses, workspace| {
            !is_farther_than(&links[a], &poses[a], &links[b], &poses[links.len() + b], tolerance, workspace)
        })
    }

    fn any(
        &mut self,
        poses: &[Pose],
        margin: f64,
        mut close: impl FnMut(&[Arc<TriMesh>], usize, usize, &[Pose], &mut Workspace) -> bool,
    ) -> bool {
        // The box around each arm, from the spheres around its links, excludes most configurations at once.
        let links = self.links.len();
        if !self.around(&poses[..links]).inflated(margin).overlaps(&self.around(&poses[links..])) {
            return false;
        }
        self.place(poses);
        for a in 0..links {
            let box_a = self.boxes[a].inflated(margin);
            for b in 0..links {
                if box_a.overlaps(&self.boxes[links + b])
                    && self.capsules_gap(poses, a, b, margin).is_some()
                    && close(&self.links, a, b, poses, &mut self.workspace)
                {
                    return true;
                }
            }
        }
        false
    }

    /// Distance between the arms, metres. Upper bounds of the pairs with the nearest landmarks limit all other pairs,
    /// which follow in the order of their capsules.
    pub fn distance(&mut self, poses: &[Pose]) -> f64 {
        self.place(poses);
        let links = self.links.len();
        let (mut best, warm_start, (a, b)) = self.upper_bound(poses);
        best = self.pair(poses, a, b, best, warm_start);
        self.order.clear();
        for x in 0..links {
            for y in (0..links).filter(|y| (x, *y) != (a, b)) {
                let boxes = self.boxes[x].distance_squared(&self.boxes[links + y]);
                if boxes < best * best
                    && let Some(capsules) = self.capsules_gap(poses, x, y, best)
                {
                    self.order.push((capsules, x, y));
                }
            }
        }
        self.order.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        for i in 0..self.order.len() {
            let (gap, a, b) = self.order[i];
            if best <= 0.0 || gap >= best {
                break;
            }
            best = self.pair(poses, a, b, best, WarmStart::default());
        }
        best
    }

    /// Lower bound of the distance of two links, by the capsules around them; `None` if it exceeds `limit`.
    fn capsules_gap(&self, poses: &[Pose], a: usize, b: usize, limit: f64) -> Option<f64> {
        let (Some((x, x_in_a)), Some((y, y_in_b))) = (&self.capsules[a], &self.capsules[b]) else { return Some(0.0) };
        let (in_a, in_b) = (poses[a] * *x_in_a, poses[self.links.len() + b] * *y_in_b);
        separation_within(x, &in_a, y, &in_b, limit).map(|near| near.lower_bound)
    }

    fn pair(&mut self, poses: &[Pose], a: usize, b: usize, limit: f64, mut warm_start: WarmStart) -> f64 {
        let (of_a, of_b) = (&poses[a], &poses[self.links.len() + b]);
        let settings = DistanceSettings { limit, warm_start: Some(&mut warm_start), ..DistanceSettings::default() };
        let found = mesh_separation_with(&self.links[a], of_a, &self.links[b], of_b, settings, &mut self.workspace);
        found.map_or(limit, |near| limit.min(near.distance))
    }

    /// An upper bound, and where it was found.
    fn upper_bound(&mut self, poses: &[Pose]) -> (f64, WarmStart, (usize, usize)) {
        let links = self.links.len();
        self.placed_landmarks.clear();
        self.placed_landmarks.extend(self.landmarks.iter().cycle().zip(poses).map(|(marks, pose)| marks.placed(pose)));
        let mut nearest = [(f32::INFINITY, (0, 0)); FIRST_PAIRS];
        for a in 0..links {
            for b in 0..links {
                if self.boxes[a].distance_squared(&self.boxes[links + b]) >= f64::from(nearest[FIRST_PAIRS - 1].0) {
                    continue;
                }
                let square = self.placed_landmarks[a].distance_squared(&self.placed_landmarks[links + b]);
                if square < nearest[FIRST_PAIRS - 1].0 {
                    nearest[FIRST_PAIRS - 1] = (square, (a, b));
                    nearest.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
                }
            }
        }
        let mut best = (f64::INFINITY, WarmStart::default(), nearest[0].1);
        for (square, (a, b)) in nearest {
            if square < f32::INFINITY {
                let (of_a, of_b) = (&poses[a], &poses[links + b]);
                let mut warm_start = WarmStart::default();
                let (link_a, link_b) = (&self.links[a], &self.links[b]);
                let metres = distance_upper_bound(link_a, of_a, link_b, of_b, &mut warm_start, &mut self.workspace);
                if metres < best.0 {
                    best = (metres, warm_start, (a, b));
                }
            }
        }
        best
    }

    fn around(&self, poses: &[Pose]) -> Aabb {
        let balls =
            self.balls.iter().zip(poses).map(|((middle, radius), pose)| (pose.transform_point(*middle), *radius));
        balls.fold(Aabb::EMPTY, |all, (c, radius)| {
            let r = Vec3::splat(radius);
            Aabb { min: all.min.min(c - r), max: all.max.max(c + r) }
        })
    }

    fn place(&mut self, poses: &[Pose]) {
        let all = self.links.iter().cycle().zip(poses);
        self.boxes.clear();
        self.boxes.extend(all.map(|(link, pose)| link.aabb().transformed(pose)));
    }
}
