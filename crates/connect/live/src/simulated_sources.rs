//! Stand-in for those who measure encoders and objects: sends them as the cell file moves them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use elbowroom_cell::{Cell, Follow, Frames, MeasuredSource};

use crate::clock::{Clock, boot_number};
use crate::keys::Keys;
use crate::measured_sources::key_of;
use crate::messages::JointState;
use crate::network::{Network, NetworkError, Publisher, Urgency};

/// Senders of all measured sources of a cell. They end when they are dropped.
pub(crate) struct SimulatedSources {
    is_closed: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl SimulatedSources {
    /// Starts to send each source once per tick; `None` if the cell has none.
    pub(crate) fn start(
        cell: &Arc<Cell>,
        network: &Arc<dyn Network>,
        clock: Clock,
    ) -> Result<Option<Self>, NetworkError> {
        let keys = Keys::new(&cell.name);
        let sender = |source: &MeasuredSource| {
            let publisher = network.publisher(&key_of(&keys, cell, *source), Urgency::RealTime)?;
            Ok((*source, publisher))
        };
        let senders = cell.frame_sources.measured.iter().map(sender).collect::<Result<Vec<_>, NetworkError>>()?;
        if senders.is_empty() {
            return Ok(None);
        }
        let is_closed = Arc::new(AtomicBool::new(false));
        let (cell, closed) = (cell.clone(), is_closed.clone());
        let run = move || send(&cell, senders, clock, &closed);
        let thread = std::thread::Builder::new().name("sources".into()).spawn(run);
        Ok(Some(Self { is_closed, thread: thread.ok() }))
    }
}

impl Drop for SimulatedSources {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn send(cell: &Cell, mut senders: Vec<(MeasuredSource, Box<dyn Publisher>)>, clock: Clock, is_closed: &AtomicBool) {
    let (boot, period) = (boot_number(), Duration::from_secs_f64(cell.timing.tick_s));
    let (mut bytes, mut sequence) = (Vec::new(), 0);
    while !is_closed.load(Ordering::SeqCst) {
        sequence += 1;
        let now = clock.micros();
        for (source, publisher) in &mut senders {
            let state = JointState { boot, sequence, stamp_us: now.0, ..measurement(cell, *source, clock.seconds()) };
            state.encode(&mut bytes);
            publisher.publish(&bytes);
        }
        std::thread::sleep(period);
    }
}

/// What is measured of a source that moves as the cell file says.
fn measurement(cell: &Cell, source: MeasuredSource, t_s: f64) -> JointState {
    match source {
        MeasuredSource::Encoder(index) => {
            let (travel_m, speed) = cell.frame_sources.encoders[index].at(t_s);
            JointState { q: vec![travel_m], qd: vec![speed], ..JointState::default() }
        }
        MeasuredSource::Object(object) => {
            let state = Frames::new(cell).source(&Follow::Object(object), &[], t_s);
            let (pose, motion) = (state.pose, state.motion);
            let parts = [pose.translation.to_array(), motion.velocity.to_array(), motion.angular_velocity.to_array()];
            let [at, velocity, turning] = parts;
            let rotation = pose.rotation.to_quaternion_xyzw();
            let q = at.iter().chain(&rotation).chain(&velocity).chain(&turning).copied().collect();
            JointState { q, ..JointState::default() }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::measured_sources::MeasuredSources;
    use crate::network::LocalNetwork;

    const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
tick_ms = 4
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
[encoder.belt]
direction = [0, 1, 0]
speed = 300
at = 100
wrap = 500
measured = true
[object.parcel]
shape = "box"
size = [100, 100, 100]
at = [2000, 0, 0]
follow = { encoder = "belt" }
[object.cart]
shape = "box"
size = [100, 100, 100]
at = [3000, 0, 0]
motion = { via = [[3000, 9000, 0]], speed = 400, turn = [0, 0, 20] }
measured = true
[object.post]
shape = "box"
size = [100, 100, 100]
at = [4000, 0, 0]
measured = true
"#;

    #[test]
    fn what_is_sent_and_heard_is_what_the_cell_file_says() {
        let cell = Arc::new(Cell::parse("sources.toml", CELL).unwrap_or_else(|e| panic!("{e}")));
        let network: Arc<dyn Network> = Arc::new(LocalNetwork::default());
        let clock = Clock::start();
        let heard = MeasuredSources::start(&cell, &network, clock).expect("keys");
        assert!(heard.states().iter().all(Option::is_none));
        let _sources = SimulatedSources::start(&cell, &network, clock).expect("keys").expect("measured sources");
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_millis(300) {
            std::thread::sleep(Duration::from_millis(7));
            let before_s = clock.seconds();
            let states = heard.states();
            let after_s = clock.seconds();
            let Some(states) = states.into_iter().collect::<Option<Vec<_>>>() else { continue };
            let (said, frames) = (Frames::new(&cell), Frames::with_measured(&cell, &states));
            for object in 0..cell.objects.len() {
                let follow = Follow::Object(elbowroom_robot::ObjectId(object));
                assert!(frames.measured_source(&follow).is_some());
                let found = frames.source(&follow, &[], after_s);
                let now = said.source(&follow, &[], after_s);
                // A message is sent every 4 ms, or later on a busy computer.
                let most_m = 0.5 * (after_s - before_s + 0.1);
                let apart_m = (found.pose.translation - now.pose.translation).length();
                let wrapped_m = (apart_m - 0.5).abs();
                assert!(apart_m.min(wrapped_m) <= most_m, "{object}: {apart_m} m");
                let same_motion = (found.motion.velocity - now.motion.velocity).length() < 1e-9
                    && (found.motion.angular_velocity - now.motion.angular_velocity).length() < 1e-9;
                assert!(same_motion, "{object}");
            }
            return;
        }
        panic!("nothing was heard");
    }
}
