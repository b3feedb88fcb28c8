//! Replay: runs the monitors of a recording again, with the recorded input, and compares their answers.

use std::collections::BTreeMap;
use std::io::Read;

use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::elbowroom_msgs::{Lost, MonitorConfiguration, MonitorTick};

use crate::bag_reader::{BagMessage, BagReader};
use crate::replay_result::{Replay, RobotReplay};
use crate::replayed_monitor::ReplayedMonitor;
use crate::{BagError, ConfigurationDefect, TickDefect, topics};

/// Most robots of a recording.
const MAX_ROBOTS: usize = 1024;

/// Reads a recording, builds its monitors from the recorded configurations, and ticks them again.
///
/// # Errors
/// [`BagError`] if the file is not such a recording, is damaged, or has no ticks. A file that ends early is not an error:
/// [`Replay::cut_off`].
pub fn replay(file: impl Read) -> Result<Replay, BagError> {
    let mut reader = BagReader::new(file);
    let mut replayer = Replayer::default();
    while let Some(message) = reader.next_message()? {
        replayer.take(&message)?;
    }
    if replayer.robots.is_empty() {
        return Err(BagError::NothingToReplay { messages: reader.messages() });
    }
    let value = |key: &str| {
        let metadata = reader.metadata(topics::METADATA).and_then(|values| values.get(key));
        metadata.cloned().unwrap_or_default()
    };
    let robots: Vec<RobotReplay> = replayer.robots.into_values().map(ReplayedMonitor::finish).collect();
    Ok(Replay {
        cell: value("cell"),
        checksum: value("checksum"),
        messages: reader.messages(),
        ticks: robots.iter().map(|r| r.ticks).sum(),
        differences: robots.iter().map(|r| r.differences).sum(),
        cut_off: reader.is_cut_off(),
        lost_ticks: replayer.lost_ticks,
        robots,
    })
}

#[derive(Default)]
struct Replayer {
    robots: BTreeMap<u32, ReplayedMonitor>,
    lost_ticks: u64,
}

impl Replayer {
    fn take(&mut self, message: &BagMessage) -> Result<(), BagError> {
        match &message.topic[..] {
            topics::CONFIGURATION => self.configure(&decode::<MonitorConfiguration>(message)?),
            topics::TICK => self.tick(&decode::<MonitorTick>(message)?),
            topics::LOST => {
                self.lost_ticks = decode::<Lost>(message)?.ticks;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn configure(&mut self, message: &MonitorConfiguration) -> Result<(), BagError> {
        if let Some(robot) = self.robots.get_mut(&message.robot) {
            return robot.configure(message);
        }
        if self.robots.len() >= MAX_ROBOTS {
            let source = ConfigurationDefect::ManyRobots(MAX_ROBOTS);
            return Err(BagError::Configuration { robot: message.name.clone(), source });
        }
        self.robots.insert(message.robot, ReplayedMonitor::new(message)?);
        Ok(())
    }

    fn tick(&mut self, tick: &MonitorTick) -> Result<(), BagError> {
        let robot = self.robots.get_mut(&tick.robot);
        robot.map_or_else(|| Err(without_configuration(tick)), |robot| robot.tick(tick))
    }
}

fn without_configuration(tick: &MonitorTick) -> BagError {
    let robot = format!("number {}", tick.robot);
    BagError::Tick { robot, sequence: tick.sequence, source: TickDefect::NoConfiguration }
}

fn decode<M: Message>(message: &BagMessage) -> Result<M, BagError> {
    M::decode(&message.payload).map_err(|source| BagError::Message {
        message: message.index,
        topic: message.topic.clone(),
        what: M::NAME,
        source,
    })
}
