//! What a virtual robot carried out, in one sentence.

use elbowroom_sim::{ViewSummary, VirtualRobotSummary};

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
    let hidden = v.view.as_ref().map_or_else(String::new, seen);
    format!("carried out {:.1} % of the desired motion {times}; {stopped}{hidden}", 100.0 * v.carried_share)
}

/// What the camera saw of the work-piece.
fn seen(view: &ViewSummary) -> String {
    let out =
        if view.out_of_view_s > 0.0 { format!(", out of view for {:.2} s", view.out_of_view_s) } else { String::new() };
    match view.largest_hidden_share {
        Some(share) => format!(
            "; hidden from camera {} for {:.2} s, at most {:.0} % of what is in view{out}",
            view.seen_by,
            view.hidden_s,
            100.0 * share
        ),
        None => format!("; never in view of camera {}", view.seen_by),
    }
}
