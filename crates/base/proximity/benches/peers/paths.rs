//! Additions to any workload: paths of small steps, and many random poses on which answers are compared.

use std::path::Path;

use elbowroom_proximity::advanced::mesh_separation;
use elbowroom_proximity::{TriMesh, Workspace};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;

use crate::files::{Outcome, read_mesh, read_meta, read_poses, write_poses};
use crate::random::RandomGeometry;

pub const TAGS: [&str; 2] = ["m4k", "m23k"];
/// Number of records in one path.
pub const STEPS: usize = 200;
const PATHS: usize = 10;
/// Random records per pair. Together with the records of the bands and the robots, they give more than 200,000
/// yes-or-no answers.
const RANDOM: [usize; 2] = [45_000, 30_000];

/// Reads the pairs in `data`, writes `{tag}_{near,far}_path.pose` and `{tag}_random.pose` to `extra`.
pub fn extend(data: &Path, extra: &Path) -> Outcome<()> {
    for (tag, records) in TAGS.into_iter().zip(RANDOM) {
        if !data.join(format!("{tag}.meta")).is_file() {
            continue;
        }
        let [size, _] = read_meta(&data.join(format!("{tag}.meta")))?;
        let (a, b) = (read_mesh(&data.join(format!("{tag}_A.stl")))?, read_mesh(&data.join(format!("{tag}_B.stl")))?);
        let mut walk = RandomWalk { a: &a, b: &b, size, random: SplitMix(3), workspace: Workspace::new() };
        for (band, gaps) in [("near", [0.005, 0.15]), ("far", [0.6, 1.4])] {
            let file = data.join(format!("{tag}_{band}.pose"));
            if !file.is_file() {
                continue;
            }
            let starts = read_poses(&file)?;
            let start = |path: usize| starts.record(path * starts.len() / PATHS);
            let all: Vec<Pose> = (0..PATHS).flat_map(|path| walk.path(start(path), gaps.map(|g| g * size))).collect();
            write_poses(&extra.join(format!("{tag}_{band}_path.pose")), 2, &all)?;
        }
        let all: Vec<Pose> = (0..records).flat_map(|_| walk.anywhere()).collect();
        write_poses(&extra.join(format!("{tag}_random.pose")), 2, &all)?;
    }
    Ok(())
}

struct RandomWalk<'a> {
    a: &'a TriMesh,
    b: &'a TriMesh,
    size: f64,
    random: SplitMix,
    workspace: Workspace,
}

impl RandomWalk<'_> {
    /// A path of alternating steps of 0.5 % of the size and of 1°, as straight as possible with the gap within `gaps`
    /// (metres).
    fn path(&mut self, start: &[Pose], gaps: [f64; 2]) -> Vec<Pose> {
        let (a_in_world, mut b_in_world) = (start[0], start[1]);
        let (mut heading, mut axis) = (self.random.direction(), self.random.direction());
        let mut poses = vec![a_in_world, b_in_world];
        for step in 1..STEPS {
            let mut next = b_in_world;
            for _ in 0..100 {
                next = self.step(&b_in_world, step, heading, axis);
                let gap = mesh_separation(self.a, &a_in_world, self.b, &next, &mut self.workspace).distance;
                if (gaps[0]..gaps[1]).contains(&gap) {
                    break;
                }
                (heading, axis) = (self.random.direction(), self.random.direction());
            }
            b_in_world = next;
            poses.extend([a_in_world, b_in_world]);
        }
        poses
    }

    fn step(&self, from: &Pose, step: usize, heading: Vec3, axis: Vec3) -> Pose {
        if step % 2 == 1 {
            return Pose::new(from.rotation, from.translation + heading * (0.005 * self.size));
        }
        // The rotation is about the centre of B.
        let middle = self.b.aabb().center();
        let rotation = Rotation::from_axis_angle(axis, 1_f64.to_radians()) * from.rotation;
        Pose::new(rotation, from.transform_point(middle) - rotation * middle)
    }

    /// Poses with centres up to 1.1 sizes apart: some touch, some are near, some are far.
    fn anywhere(&mut self) -> [Pose; 2] {
        let a_in_world = Pose::new(self.random.rotation(), self.random.direction());
        let rotation = self.random.rotation();
        let between = self.random.direction() * (self.random.between(0.15, 1.1) * self.size);
        let middle = a_in_world.transform_point(self.a.aabb().center()) + between;
        [a_in_world, Pose::new(rotation, middle - rotation * self.b.aabb().center())]
    }
}
