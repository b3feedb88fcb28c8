//! A camera above a KR125: what enters is seen, becomes blocked cells, and the arm goes around.
//!
//! `cargo run --release -p elbowroom --example around`
#![expect(clippy::print_stdout, reason = "a program for people")]

mod judge;
mod run;
mod station;
mod things;

use station::Failure;

fn main() -> Result<(), Failure> {
    let mut station = station::build()?;
    let things = things::things();
    let record = run::run(&mut station, &things, 37.0)?;
    let mut last = String::new();
    for row in &record.ticks {
        let word = format!("{} {:?}", row.step.doing.word(), row.step.doing.reason().map(ToString::to_string));
        if row.step.doing.word() != last {
            println!("{:7.3} {word}  d={:.3}", row.t_s, row.distance_m);
            last = row.step.doing.word().into();
        }
    }
    for row in &record.frames {
        let prisms: Vec<String> = row.sighting.iter().flat_map(|s| &s.prisms)
            .map(|p| format!("{} {:?} ({:.2},{:.2}) v({:.2},{:.2}) n{} {:.1}", p.id, p.kind, p.centre_m.x, p.centre_m.y, p.velocity_mps.x, p.velocity_mps.y, p.footprint_m.len(), p.z_to_m)).collect();
        let o = row.outlook.as_ref();
        if o.is_some_and(|o| o.was_blocked || o.how != Some(elbowroom::planner::How::Kept)) || row.error.is_some() || (row.t_s / 0.04) as usize % 12 == 0 {
            println!("{:7.3} took {:?} {:?} blocked {:?} {prisms:?} {:?} {:?}", row.t_s, row.took,
                row.sighting.as_ref().map(|s| s.sight), row.sighting.as_ref().map(|s| (s.blocked, s.freed)), o.map(|o| (o.how, o.was_blocked, o.in_motion, o.reason.clone(), o.times)), row.error);
        }
    }
    println!("hits {} {:?} least {:?} arrivals {}", record.hits.len(), record.hits.first(), record.least, record.arrivals);
    Ok(())
}
