//! The process that measures: late, out of order, with losses, silences and restarts.

use std::error::Error;
use std::time::Duration;

use elbowroom_live::messages::JointState;
use elbowroom_live::network::{Network, Publisher, Urgency, ZenohNetwork, ZenohSettings};
use elbowroom_live::{Keys, boot_number};
use elbowroom_testkit::random::SplitMix;

use crate::motion::{belt, cell, now_us, since, thing};

/// Interval between two measurements.
const PERIOD: Duration = Duration::from_millis(4);
/// Longest delay of a message, ms.
const JITTER_MS: f64 = 15.0;

/// A message and when it leaves.
struct Waiting {
    due_us: u64,
    source: usize,
    bytes: Vec<u8>,
}

/// Sends until the process is killed.
pub fn send(hub: String, epoch_us: u64, loss: f64) -> Result<(), Box<dyn Error>> {
    let network = ZenohNetwork::open(&ZenohSettings { connect: Some(hub), listen: None })?;
    let keys = Keys::new(&cell()?.name);
    let publishers = [keys.encoder("belt"), keys.object("thing")];
    let mut publishers: Vec<Box<dyn Publisher>> =
        publishers.iter().map(|key| network.publisher(key, Urgency::RealTime)).collect::<Result<_, _>>()?;
    let mut random = SplitMix(now_us());
    let (mut boot, mut sequence) = (boot_number(), 0);
    let mut waiting: Vec<Waiting> = Vec::new();
    loop {
        // About once in eight seconds it is silent, for up to half a second; half of these times it starts again.
        if random.below(2000) == 0 {
            std::thread::sleep(Duration::from_millis(random.below(500) as u64));
            if random.below(2) == 0 {
                (boot, sequence) = (boot_number(), 0);
                waiting.clear();
            }
        }
        sequence += 1;
        for source in 0..publishers.len() {
            if random.between(0.0, 1.0) < loss {
                continue;
            }
            let mut bytes = Vec::new();
            let state = measured(source, since(epoch_us), random.below(4) > 0);
            JointState { boot, sequence, stamp_us: now_us(), ..state }.encode(&mut bytes);
            let due_us = now_us() + (1e3 * random.between(0.0, JITTER_MS)) as u64;
            waiting.push(Waiting { due_us, source, bytes });
        }
        let now = now_us();
        waiting.retain(|message| {
            if message.due_us <= now {
                publishers[message.source].publish(&message.bytes);
            }
            message.due_us > now
        });
        std::thread::sleep(PERIOD);
    }
}

/// What is measured at a time; some messages have no velocity.
fn measured(source: usize, t_s: f64, with_velocity: bool) -> JointState {
    if source == 0 {
        let (travel_m, speed) = belt(t_s);
        let qd = if with_velocity { vec![speed] } else { Vec::new() };
        return JointState { q: vec![travel_m], qd, ..JointState::default() };
    }
    let (pose, motion) = thing(t_s);
    let mut q = pose.translation.to_array().to_vec();
    q.extend(pose.rotation.to_quaternion_xyzw());
    if with_velocity {
        q.extend(motion.velocity.to_array());
        q.extend(motion.angular_velocity.to_array());
    }
    JointState { q, ..JointState::default() }
}
