//! Plans of one cell, and their summary.

use std::path::PathBuf;
use std::time::Duration;

use elbowroom_kinematics::{JointTrajectory, TrajectoryRow};
use elbowroom_scene::Scene;

/// Result of the reference for the paths of a course.
pub struct PathCheck {
    pub points: usize,
    /// Number of paths with a collision.
    pub hits: usize,
    /// Description of the first collision.
    pub first: Option<String>,
}

/// Many starts and goals in one scene.
pub struct Course {
    pub name: String,
    /// URDF from which Pinocchio reads the joints.
    pub urdf: PathBuf,
    pub scene: Scene,
    pub asked: usize,
    pub found: usize,
    /// Number of pairs for which it is proven that no path joins them.
    pub disconnected: usize,
    pub straight: usize,
    /// Time of the whole plan, per pair.
    pub planning: Vec<Duration>,
    /// Times of simplification and of time parametrization, per path.
    pub simplifying: Vec<Duration>,
    pub timing: Vec<Duration>,
    /// Number of corners at which a motion stops, of all corners.
    pub stops: usize,
    pub corners: usize,
    /// Waypoints (with the length so far as the time) and motions of all paths.
    pub paths: Vec<JointTrajectory>,
}

pub const HEAD: &str = "none: proven that no path exists. Times in ms: median and 99th percentile; stops of corners; points checked by Coal, paths on which it finds a collision\n\n\
cell                                      pairs  found   none straight |   plan    p99 | shorten    p99 |   time |  stops/corners |    points  colliding";

impl Course {
    pub fn new(name: &str, urdf: PathBuf, scene: Scene) -> Self {
        let name = name.to_owned();
        let none = Vec::new;
        let [planning, simplifying, timing] = [none(), none(), none()];
        let (paths, [asked, found, disconnected, straight, stops, corners]) = (Vec::new(), [0; 6]);
        Self {
            name,
            urdf,
            scene,
            asked,
            found,
            disconnected,
            straight,
            planning,
            simplifying,
            timing,
            stops,
            corners,
            paths,
        }
    }

    pub fn row(&self, check: &PathCheck) -> String {
        let [plan, shorten, time] = [&self.planning, &self.simplifying, &self.timing].map(|times| spread(times));
        format!(
            "{:<40} {:>6} {:>6} {:>6} {:>8} | {:>6.2} {:>6.1} | {:>7.2} {:>6.1} | {:>6.2} | {:>6}/{:<7} | {:>9}  {:>9}",
            self.name,
            self.asked,
            self.found,
            self.disconnected,
            self.straight,
            plan[0],
            plan[1],
            shorten[0],
            shorten[1],
            time[0],
            self.stops,
            self.corners,
            check.points,
            check.hits
        )
    }

    pub fn json(&self, check: &PathCheck) -> String {
        let [plan, shorten, time] = [&self.planning, &self.simplifying, &self.timing].map(|times| spread(times));
        format!(
            r#"{{"cell":"{}","pairs":{},"found":{},"disconnected":{},"straight":{},"plan_ms":{:.4},"plan_p99_ms":{:.4},"shorten_ms":{:.4},"shorten_p99_ms":{:.4},"time_ms":{:.4},"stops":{},"corners":{},"points":{},"colliding":{}}}"#,
            self.name,
            self.asked,
            self.found,
            self.disconnected,
            self.straight,
            plan[0],
            plan[1],
            shorten[0],
            shorten[1],
            time[0],
            self.stops,
            self.corners,
            check.points,
            check.hits
        )
    }
}

/// Returns median and 99th percentile, ms.
fn spread(times: &[Duration]) -> [f64; 2] {
    let mut times = times.to_vec();
    times.sort_unstable();
    let at = |share: f64| {
        times.get((times.len() as f64 * share) as usize).or(times.last()).map_or(0.0, Duration::as_secs_f64)
    };
    [0.5, 0.99].map(|share| 1e3 * at(share))
}

/// Returns the waypoints, each with the path length up to it.
pub fn along<Q: AsRef<[f64]>>(waypoints: &[Q]) -> JointTrajectory {
    let mut far = 0.0;
    let mut last: Option<&[f64]> = None;
    let mut line = Vec::with_capacity(waypoints.len());
    for q in waypoints {
        let q = q.as_ref();
        far += last.map_or(0.0, |l| l.iter().zip(q).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt());
        line.push(TrajectoryRow { t_s: far, q: q.to_vec() });
        last = Some(q);
    }
    JointTrajectory::new(line)
}
