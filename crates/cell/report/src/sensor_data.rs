//! What sensors saw in a run, for the scripts of the page.

use elbowroom_query::watch::{WatchRecord, WatchStatus, WatchedObstacle};
use elbowroom_sim::SensorTrack;
use serde_json::{Value, json};

/// Steps of outlines in a metre.
const STEPS_PER_M: f64 = 1e3;
/// Most corners of all outlines of a sensor: some hundred kilobytes.
const MOST_CORNERS: usize = 20_000;

/// Observations of a sensor: per accepted picture or cloud that changed something, the time from which it was used, and its
/// obstacles. If the page would be too large, every Nth of them (`every`).
pub fn sensor(track: &SensorTrack) -> Value {
    let accepted = track.records.iter().filter(|r| r.status == WatchStatus::Accepted);
    let mut records: Vec<(&WatchRecord, Value)> = Vec::new();
    for record in accepted {
        let obstacles: Value = record.obstacles.iter().map(obstacle).collect();
        if records.last().is_none_or(|(_, before)| *before != obstacles) {
            records.push((record, obstacles));
        }
    }
    let corners: Vec<usize> =
        records.iter().map(|(record, _)| record.obstacles.iter().map(|o| o.outline_m.len()).sum()).collect();
    let ids = |i: usize| records[i].0.obstacles.iter().map(|o| o.id).collect::<Vec<_>>();
    let appears: Vec<bool> = (0..records.len()).map(|i| i == 0 || ids(i) != ids(i - 1)).collect();
    let (every, kept) = kept(&corners, &appears, MOST_CORNERS);
    let shown = kept.iter().map(|i| {
        let (record, obstacles) = &records[*i];
        json!({ "t": record.t_s + track.latency_s, "obstacles": obstacles })
    });
    json!({ "name": track.name, "every": every, "records": shown.collect::<Vec<_>>() })
}

fn obstacle(o: &WatchedObstacle) -> Value {
    let rounded = |v: f64| (v * STEPS_PER_M).round() / STEPS_PER_M;
    let outline: Vec<[f64; 2]> = o.outline_m.iter().map(|p| p.map(rounded)).collect();
    json!({
        "id": o.id, "kind": o.kind, "seen": o.seen, "outline": outline, "bottom": rounded(o.bottom_m),
        "height": rounded(o.height_m),
    })
}

/// The records that the page has, by index, and one in how many: as many as have this number of corners at most.
///
/// Records in which obstacles appear or disappear stay as long as they fit.
fn kept(corners: &[usize], appears: &[bool], most: usize) -> (usize, Vec<usize>) {
    let steps =
        || std::iter::successors(Some(1_usize), |step| Some(step * 2)).take_while(|step| *step <= corners.len());
    for keeps_changes in [true, false] {
        for step in steps() {
            let is_kept = |i: &usize| i.is_multiple_of(step) || (keeps_changes && appears[*i]);
            let kept: Vec<usize> = (0..corners.len()).filter(is_kept).collect();
            if kept.iter().map(|i| corners[*i]).sum::<usize>() <= most {
                return (step, kept);
            }
        }
    }
    (corners.len().max(1), Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_recording_is_thinned_and_keeps_when_obstacles_come_and_go() {
        let appears: Vec<bool> = (0..1000).map(|i| i % 333 == 7).collect();
        assert_eq!(kept(&[20; 1000], &appears, 20_000), (1, (0..1000).collect()));
        let (step, thin) = kept(&[20; 1000], &appears, 19_999);
        assert_eq!((step, thin.len()), (2, 502));
        assert!([7, 340, 673].iter().all(|i| thin.contains(i)));
        let (step, thin) = kept(&[20; 1000], &appears, 200);
        assert!(step == 256 && thin.len() <= 10 && thin.contains(&340), "{step} {thin:?}");
        // Everything changes all the time: the bound counts.
        let (_, thin) = kept(&[20; 1000], &[true; 1000], 200);
        assert!(!thin.is_empty() && thin.len() <= 10, "{thin:?}");
        // One record alone is too large, or there is none.
        assert_eq!(kept(&[300, 300], &[true; 2], 200).1, [] as [usize; 0]);
        assert_eq!(kept(&[], &[], 200), (1, Vec::new()));
    }
}
