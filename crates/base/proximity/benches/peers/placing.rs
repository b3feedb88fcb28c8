//! Pairs of meshes, and poses with a given gap.

use std::f64::consts::PI;
use std::path::Path;

use elbowroom_proximity::advanced::{colliding_triangles, mesh_separation};
use elbowroom_proximity::{TriMesh, Workspace};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::SplitMix;

use crate::files::{Outcome, rounded, write_mesh, write_meta, write_poses};
use crate::random::RandomGeometry;
use crate::surfaces::{Tube, trefoil};

const RECORDS: usize = 2000;
/// Rings and sectors of both meshes of each pair.
const PAIRS: [(&str, [usize; 4]); 2] = [("m4k", [50, 40, 80, 25]), ("m23k", [120, 96, 180, 64])];

pub fn generate(folder: &Path) -> Outcome<()> {
    for (tag, [rings_a, sectors_a, rings_b, sectors_b]) in PAIRS {
        let mut random = SplitMix(42);
        let a = rounded(&arm_like(rings_a, sectors_a, &mut random))?;
        let b = rounded(&trefoil(0.16, 0.055, 0.25, rings_b, sectors_b, &mut random))?;
        write_mesh(&folder.join(format!("{tag}_A.stl")), &a)?;
        write_mesh(&folder.join(format!("{tag}_B.stl")), &b)?;
        let size = a.aabb().extent().max_element().max(b.aabb().extent().max_element());
        write_meta(&folder.join(format!("{tag}.meta")), size, 0.05 * size)?;
        let mut placing = Placing { a: &a, b: &b, size, random, workspace: Workspace::new() };
        for band in ["touch", "near", "far"] {
            let poses: Vec<Pose> = (0..RECORDS).flat_map(|_| placing.record(band)).collect();
            write_poses(&folder.join(format!("{tag}_{band}.pose")), 2, &poses)?;
            eprintln!("  {tag}_{band}: {RECORDS} records");
        }
    }
    Ok(())
}

/// A bent link with two flanges.
fn arm_like(rings: usize, sectors: usize, random: &mut SplitMix) -> crate::surfaces::Surface {
    let axis = |s: f64| {
        let t = s - 0.5;
        Vec3::new(0.12 * (PI * s).sin(), 0.03 * (2.0 * PI * s).sin(), 0.58 * t)
    };
    let radius = |s: f64| 0.06 + 0.025 * (2.0 * PI * s).cos();
    let flanges = [[0.22, 0.04, 0.018], [0.76, 0.05, 0.026]];
    Tube { axis: &axis, radius: &radius, flanges: &flanges, ripple: 0.5, rings, sectors }.surface(random)
}

struct Placing<'a> {
    a: &'a TriMesh,
    b: &'a TriMesh,
    size: f64,
    random: SplitMix,
    workspace: Workspace,
}

impl Placing<'_> {
    /// Poses of A and of B with a gap of the band, in a random common frame.
    fn record(&mut self, band: &str) -> [Pose; 2] {
        let b_in_a = loop {
            let found = match band {
                "touch" => self.pushed_in(),
                "near" => {
                    let gap = self.size * self.random.between_decades(0.01, 0.1);
                    self.at_gap(gap, 0.002 * self.size).map(|(pose, _)| pose)
                }
                _ => {
                    let gap = self.size * self.random.between(0.8, 1.2);
                    self.at_gap(gap, 0.01 * self.size).map(|(pose, _)| pose)
                }
            };
            if let Some(pose) = found {
                break pose;
            }
        };
        let a_in_world = Pose::new(self.random.rotation(), self.random.direction());
        [a_in_world, a_in_world * b_in_a]
    }

    /// A pose of B just before first contact, moved 0.15 % to 10 % of the size further, so that the surfaces meet.
    /// `None` if they do not meet.
    fn pushed_in(&mut self) -> Option<Pose> {
        let (mut pose, away) = self.at_gap(0.0005 * self.size, 0.0005 * self.size)?;
        let push = self.size * (0.0015 + self.random.between_decades(0.001, 0.1));
        pose.translation -= away * push;
        colliding_triangles(self.a, &Pose::IDENTITY, self.b, &pose, &mut self.workspace).map(|_| pose)
    }

    /// Moves B in from a distance, so that one of its vertices approaches a vertex of A, until the gap is right. Returns
    /// the pose and the direction from which B came.
    fn at_gap(&mut self, gap: f64, allowed: f64) -> Option<(Pose, Vec3)> {
        let (rotation, away) = (self.random.rotation(), self.random.direction());
        let on_a = self.a.vertices()[self.random.below(self.a.vertices().len())];
        let on_b = rotation * self.b.vertices()[self.random.below(self.b.vertices().len())];
        let mut out = 3.0 * self.size + gap;
        for _ in 0..60 {
            let pose = Pose::new(rotation, on_a - on_b + away * out);
            let left = mesh_separation(self.a, &Pose::IDENTITY, self.b, &pose, &mut self.workspace).distance - gap;
            if left < allowed {
                return (left + gap > 0.0).then_some((pose, away));
            }
            // Points of B approach by at most the step.
            out -= left;
            if out < -3.0 * self.size {
                return None;
            }
        }
        None
    }
}
