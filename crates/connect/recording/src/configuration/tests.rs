//! Tests: configurations are the same after writing and reading; changed ones never make a monitor panic.

use elbowroom_cell::{Cell, configure};
use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::elbowroom_msgs::{MonitorConfiguration, MonitorTick, SourceState};
use elbowroom_testkit::random::split_mix;

use super::{decode, encode};
use crate::replayed_monitor::ReplayedMonitor;

fn example(name: &str) -> Cell {
    let examples = elbowroom_testkit::folder::examples();
    Cell::load(examples.join(name).join("cell.toml")).unwrap()
}

#[test]
fn every_example_is_the_same_bit_by_bit() {
    for name in ["conveyor", "exchange", "figure12", "pallet", "tool_box"] {
        for setup in configure::setups(&example(name)).unwrap() {
            let message = encode(3, &setup.configuration);
            let bytes = message.encode();
            let read = decode(&MonitorConfiguration::decode(&bytes).unwrap()).unwrap();
            assert_eq!(encode(3, &read).encode(), bytes, "{name}");
            assert_eq!(read.checksum(), setup.configuration.checksum());
        }
    }
}

/// The checksum is made to match, so that the monitor is built and ticks.
#[test]
fn changed_configurations_are_refused_or_tick() {
    let mut seed = 9;
    let mut below = move |n: usize| split_mix(&mut seed) as usize % n.max(1);
    let mut built = 0;
    for name in ["conveyor", "exchange"] {
        let setup = configure::setups(&example(name)).unwrap().remove(0);
        let joints = setup.configuration.chain().dof();
        let sound = encode(0, &setup.configuration).encode();
        let state = SourceState {
            pose: [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            ..SourceState::default()
        };
        for _ in 0..3000 {
            let mut bytes = sound.clone();
            // Most bytes belong to meshes: change the other bytes more often.
            let span = if below(4) == 0 { bytes.len() } else { bytes.len().min(4096) };
            for _ in 0..=below(2) {
                let at = 4 + below(span - 4);
                let value = [0.0, -1.0, 1e308, 1e-308, f64::NAN, f64::INFINITY, 2.0][below(7)].to_le_bytes();
                match below(3) {
                    0 => bytes.iter_mut().skip(4 + (at & !7)).zip(value).for_each(|(byte, new)| *byte = new),
                    _ => bytes[at] ^= 1 << below(8),
                }
            }
            let Ok(mut message) = MonitorConfiguration::decode(&bytes) else { continue };
            let Ok(configuration) = decode(&message) else { continue };
            message.checksum = configuration.checksum();
            let Ok(mut monitor) = ReplayedMonitor::new(&message) else { continue };
            built += 1;
            for sequence in 0..4 {
                let tick = MonitorTick {
                    sequence,
                    now_s: 0.002 * sequence as f64,
                    stamp_s: 0.002 * sequence as f64,
                    q: vec![0.1; joints],
                    programmed_override: 1.0,
                    sources: vec![state.clone(); configuration.sources().len()],
                    ..MonitorTick::default()
                };
                monitor.tick(&tick).unwrap();
            }
        }
    }
    println!("{built} of 6000 could be built");
    assert!(built > 500);
}
