//! Two arms against each other. One file, so that a faster way can take its place.

use elbowroom_proximity::TriMesh;
use elbowroom_proximity::mesh::{Hint, Scratch, collide, distance_at, within};
use elbowroom_spatial::{Aabb, Pose, Vec3};

/// The links' meshes; both arms have the same.
pub struct Arms {
    links: Vec<TriMesh>,
    /// Middle of each link and the farthest that it reaches from there, metres.
    balls: Vec<(Vec3, f64)>,
    scratch: Scratch,
    /// Boxes of all links in the world, first arm first.
    boxes: Vec<Aabb>,
    /// Squared distance of the boxes, and the links.
    order: Vec<(f64, usize, usize)>,
}

impl Arms {
    pub fn new(links: Vec<TriMesh>) -> Self {
        let ball = |link: &TriMesh| (link.aabb().center(), 0.5 * link.aabb().extent().length());
        let balls = links.iter().map(ball).collect();
        Self { links, balls, scratch: Scratch::new(), boxes: Vec::new(), order: Vec::new() }
    }

    /// Largest extent of a link, metres.
    pub fn size(&self) -> f64 {
        self.links.iter().map(|link| link.aabb().extent().max_element()).fold(0.0, f64::max)
    }

    /// Does any link of one arm touch one of the other?
    pub fn collides(&mut self, poses: &[Pose]) -> bool {
        self.any(poses, 0.0, |links, a, b, poses, scratch| {
            collide(&links[a], &poses[a], &links[b], &poses[links.len() + b], scratch).is_some()
        })
    }

    /// Are any two within `tolerance` metres?
    pub fn within(&mut self, poses: &[Pose], tolerance: f64) -> bool {
        self.any(poses, tolerance, |links, a, b, poses, scratch| {
            within(&links[a], &poses[a], &links[b], &poses[links.len() + b], tolerance, scratch).is_some()
        })
    }

    fn any(
        &mut self,
        poses: &[Pose],
        margin: f64,
        mut close: impl FnMut(&[TriMesh], usize, usize, &[Pose], &mut Scratch) -> bool,
    ) -> bool {
        // The box around each arm, out of balls around its links, spares the boxes of most states.
        let links = self.links.len();
        if !self.around(&poses[..links]).inflated(margin).overlaps(&self.around(&poses[links..])) {
            return false;
        }
        self.place(poses);
        for a in 0..links {
            let box_a = self.boxes[a].inflated(margin);
            for b in 0..links {
                if box_a.overlaps(&self.boxes[links + b]) && close(&self.links, a, b, poses, &mut self.scratch) {
                    return true;
                }
            }
        }
        false
    }

    /// Metres between the arms; the nearest pair of boxes first, what is known so far limits the rest.
    pub fn distance(&mut self, poses: &[Pose]) -> f64 {
        self.place(poses);
        let links = self.links.len();
        self.order.clear();
        for a in 0..links {
            let of_a = (0..links).map(|b| (self.boxes[a].distance_squared(&self.boxes[links + b]), a, b));
            self.order.extend(of_a);
        }
        self.order.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        let mut best = f64::INFINITY;
        for &(gap_squared, a, b) in &self.order {
            if best <= 0.0 || gap_squared >= best * best {
                break;
            }
            let (mesh_a, mesh_b) = (&self.links[a], &self.links[b]);
            let hint: Option<Hint> = None;
            let found = distance_at(mesh_a, &poses[a], mesh_b, &poses[links + b], best, hint, &mut self.scratch);
            best = found.map_or(best, |near| best.min(near.distance));
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
