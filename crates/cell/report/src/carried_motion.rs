//! What a virtual robot carried out, in one sentence.

use elbowroom_sim::VirtualRobotSummary;

/// What a virtual robot carried out.
pub fn carried(v: &VirtualRobotSummary) -> String {
    let times = match v.hand_overs.len() {
        0 => "without a hand-over".to_owned(),
        1 => "with one hand-over".to_owned(),
        n => format!("with {n} hand-overs"),
    };
    // The longest stop says most.
    let longest = v.stops.iter().max_by(|a, b| (a.to_s - a.from_s).total_cmp(&(b.to_s - b.from_s)));
    let stopped = longest.map_or_else(
        || "it never stood".to_owned(),
        |stop| format!("it stood for {:.2} s, longest from {:.2} s on: {}", v.stopped_s, stop.from_s, stop.reason),
    );
    format!("carried out {:.1} % of the desired motion {times}; {stopped}", 100.0 * v.carried_share)
}
