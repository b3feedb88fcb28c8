//! Motion of the regions, by the oracle's own arithmetic.

use elbowroom_cell::{Cell, CellRegion, Encoder, Follow, Travel};
use elbowroom_sim::Recording;

use super::arm::Arm;
use super::frame::Frame;
use super::track::{Track, way_m};

/// Source that a region follows.
#[derive(Debug)]
pub enum Carrier {
    Nothing,
    Belt(Encoder),
    /// An object, at its recorded poses.
    Object(Track),
    /// Rows of a file: times (s) and frames.
    Poses(Vec<(f64, Frame)>),
    Robot {
        robot: usize,
        link: usize,
        in_link: Frame,
    },
}

impl Carrier {
    /// Creates the carrier of a region. Without a recording objects are at their start.
    pub fn new(cell: &Cell, region: &CellRegion, recording: Option<&Recording>) -> Self {
        match &region.follow {
            None => Self::Nothing,
            Some(Follow::Poses(track)) => {
                let rows = cell.frame_sources.pose_tracks[*track].rows();
                Self::Poses(rows.iter().map(|(t_s, pose)| (*t_s, Frame::of(pose))).collect())
            }
            Some(Follow::Object(object)) => {
                let object = &cell.objects[object.0];
                let seen = recording.and_then(|r| r.objects.iter().find(|o| o.name == object.name));
                let rest = std::slice::from_ref(&object.in_world);
                Self::Object(Track::new(seen.map_or(rest, |o| &o.poses), cell.timing.tick_s))
            }
            Some(Follow::Encoder(e)) => Self::Belt(cell.frame_sources.encoders[*e].clone()),
            Some(Follow::Robot { robot, link, in_link }) => {
                Self::Robot { robot: robot.0, link: link.0, in_link: Frame::of(in_link) }
            }
        }
    }

    /// Returns its frame in the world; `frames` are the frames of all robots' links in the world.
    pub fn at(&self, t_s: f64, frames: &[Vec<Frame>]) -> Frame {
        match self {
            Self::Nothing => Frame::IDENTITY,
            Self::Belt(encoder) => Frame::shift(encoder.direction * travel_of(encoder, t_s).0),
            Self::Object(track) => track.at(t_s),
            Self::Poses(rows) => frame_of(rows, t_s),
            Self::Robot { robot, link, in_link } => frames[*robot][*link].then(in_link),
        }
    }

    /// Upper bound of the motion (m) of a point within `radius_m` of its frame's origin between two times, at which the
    /// robots' joints have these values.
    pub fn travel_m(&self, arms: &[Arm], radius_m: f64, from: (f64, &[Vec<f64>]), to: (f64, &[Vec<f64>])) -> f64 {
        match self {
            Self::Nothing => 0.0,
            Self::Belt(encoder) => (travel_of(encoder, to.0).0 - travel_of(encoder, from.0).0).abs(),
            Self::Object(track) => track.travel_m(from.0, to.0, radius_m),
            Self::Poses(rows) => {
                // Between two rows the motion is straight.
                let within = rows.iter().map(|(t_s, _)| *t_s).filter(|t_s| from.0 < *t_s && *t_s < to.0);
                let times: Vec<f64> = std::iter::once(from.0).chain(within).chain([to.0]).collect();
                let frames: Vec<Frame> = times.iter().map(|t_s| frame_of(rows, *t_s)).collect();
                frames.windows(2).map(|w| way_m(&w[0], &w[1], radius_m)).sum()
            }
            Self::Robot { robot, link, in_link } => {
                let lever_arms = arms[*robot].lever_arms(*link, in_link.at.length() + radius_m);
                lever_arms.iter().zip(&from.1[*robot]).zip(&to.1[*robot]).map(|((l, a), b)| l * (b - a).abs()).sum()
            }
        }
    }

    /// Whether its belt starts, stops or changes its speed between two times.
    pub fn changes_speed(&self, from_s: f64, to_s: f64) -> bool {
        let Self::Belt(encoder) = self else { return false };
        let within = |t: f64| from_s <= t && t <= to_s;
        match &encoder.travel {
            Travel::Constant { start_s, end_s, .. } => (*start_s > 0.0 && within(*start_s)) || within(*end_s),
            Travel::Table(rows) => rows.iter().any(|r| within(r.0)),
        }
    }

    pub fn is_belt(&self) -> bool {
        matches!(self, Self::Belt(_))
    }

    /// Number of times that its belt has begun again at 0.
    pub fn rounds(&self, t_s: f64) -> f64 {
        let Self::Belt(encoder) = self else { return 0.0 };
        travel_of(encoder, t_s).1
    }
}

/// Returns the frame at a time: straight from row to row, by the shortest turn.
fn frame_of(rows: &[(f64, Frame)], t_s: f64) -> Frame {
    let next = rows.partition_point(|row| row.0 <= t_s);
    match (next.checked_sub(1).map(|i| &rows[i]), rows.get(next)) {
        (Some((t0, a)), Some((t1, b))) => a.moved_towards(b, (t_s - t0) / (t1 - t0)),
        (Some((_, frame)), None) | (None, Some((_, frame))) => *frame,
        (None, None) => Frame::IDENTITY,
    }
}

/// Returns the travel of a belt at a time (m), and how often it has begun again at 0.
fn travel_of(encoder: &Encoder, t_s: f64) -> (f64, f64) {
    let travel = match &encoder.travel {
        Travel::Constant { at_m, speed, start_s, end_s } => at_m + speed * (t_s.min(*end_s) - start_s).max(0.0),
        Travel::Table(rows) => interpolated(rows, t_s),
    };
    encoder.wrap_m.map_or((travel, 0.0), |wrap| (travel.rem_euclid(wrap), (travel / wrap).floor()))
}

fn interpolated(rows: &[(f64, f64)], t_s: f64) -> f64 {
    let after = rows.partition_point(|r| r.0 <= t_s);
    match (after.checked_sub(1).map(|i| rows[i]), rows.get(after)) {
        (Some((t0, a)), Some((t1, b))) => a + (b - a) * (t_s - t0) / (t1 - t0),
        (Some((_, a)), None) => a,
        (None, Some((_, b))) => *b,
        (None, None) => 0.0,
    }
}
