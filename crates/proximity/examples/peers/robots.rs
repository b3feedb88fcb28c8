//! Two arms against each other. One file, so that a faster way can take its place.

use elbowroom_proximity::TriMesh;
use elbowroom_proximity::mesh::{Hint, Landmarks, PlacedLandmarks, Scratch, collide, distance_at, farther, guess};
use elbowroom_spatial::{Aabb, Pose, Vec3};

/// Pairs of links that are guessed at.
const GUESSES: usize = 2;

/// The links' meshes; both arms have the same.
pub struct Arms {
    links: Vec<TriMesh>,
    /// Middle of each link and the farthest that it reaches from there, metres.
    balls: Vec<(Vec3, f64)>,
    landmarks: Vec<Landmarks>,
    scratch: Scratch,
    /// Boxes of all links in the world, first arm first.
    boxes: Vec<Aabb>,
    /// Landmarks of all links, likewise.
    seen: Vec<PlacedLandmarks>,
    /// Squared distance of the boxes, and the links.
    order: Vec<(f64, usize, usize)>,
}

impl Arms {
    pub fn new(links: Vec<TriMesh>) -> Self {
        let ball = |link: &TriMesh| (link.aabb().center(), 0.5 * link.aabb().extent().length());
        let balls = links.iter().map(ball).collect();
        let landmarks = links.iter().map(Landmarks::of).collect();
        Self {
            links,
            balls,
            landmarks,
            scratch: Scratch::new(),
            boxes: Vec::new(),
            seen: Vec::new(),
            order: Vec::new(),
        }
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
            !farther(&links[a], &poses[a], &links[b], &poses[links.len() + b], tolerance, scratch)
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

    /// Metres between the arms: guesses for the pairs whose landmarks are nearest limit all others, which come in the
    /// order of their boxes.
    pub fn distance(&mut self, poses: &[Pose]) -> f64 {
        self.place(poses);
        let links = self.links.len();
        let (mut best, hint, (a, b)) = self.guess(poses);
        best = self.pair(poses, a, b, best, Some(hint));
        self.order.clear();
        for x in 0..links {
            for y in (0..links).filter(|y| (x, *y) != (a, b)) {
                let gap_squared = self.boxes[x].distance_squared(&self.boxes[links + y]);
                if gap_squared < best * best {
                    self.order.push((gap_squared, x, y));
                }
            }
        }
        self.order.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        for i in 0..self.order.len() {
            let (gap_squared, a, b) = self.order[i];
            if best <= 0.0 || gap_squared >= best * best {
                break;
            }
            best = self.pair(poses, a, b, best, None);
        }
        best
    }

    fn pair(&mut self, poses: &[Pose], a: usize, b: usize, limit: f64, hint: Option<Hint>) -> f64 {
        let (of_a, of_b) = (&poses[a], &poses[self.links.len() + b]);
        let found = distance_at(&self.links[a], of_a, &self.links[b], of_b, limit, hint, &mut self.scratch);
        found.map_or(limit, |near| limit.min(near.distance))
    }

    /// An upper bound, and where it was found.
    fn guess(&mut self, poses: &[Pose]) -> (f64, Hint, (usize, usize)) {
        let links = self.links.len();
        self.seen.clear();
        self.seen.extend(self.landmarks.iter().cycle().zip(poses).map(|(marks, pose)| marks.placed(pose)));
        let mut nearest = [(f32::INFINITY, (0, 0)); GUESSES];
        for a in 0..links {
            for b in 0..links {
                let square = self.seen[a].distance_squared(&self.seen[links + b]);
                if square < nearest[GUESSES - 1].0 {
                    nearest[GUESSES - 1] = (square, (a, b));
                    nearest.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
                }
            }
        }
        let mut best = (f64::INFINITY, Hint::default(), nearest[0].1);
        for (square, (a, b)) in nearest {
            if square < f32::INFINITY {
                let (of_a, of_b) = (&poses[a], &poses[links + b]);
                let (metres, hint) = guess(&self.links[a], of_a, &self.links[b], of_b, None, &mut self.scratch);
                if metres < best.0 {
                    best = (metres, hint, (a, b));
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
