//! Joint states from any recording of ROS 2, as a trajectory.

use std::io::{self, Read, Write};

use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::sensor_msgs::JointState;

use crate::{BagError, BagMessage, BagReader};

/// Joint values over time.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRecording {
    /// The topic.
    pub topic: String,
    /// Names of the joints, in the order in which they appeared.
    pub joints: Vec<String>,
    /// Time since the first row (s), and a value per joint (rad or m). The times increase.
    pub rows: Vec<(f64, Vec<f64>)>,
    /// Whether the file ended before the end of its data.
    pub cut_off: bool,
}

impl JointRecording {
    /// Reads the joint states of a topic, or of the only topic that has joint states.
    ///
    /// A message may have only some of the joints, for example if arm and gripper publish on one topic: the others keep
    /// their last value, and the rows begin when every joint has a value. Times are times of measurement, or of
    /// recording if the messages have none; a message that is not later than the one before it replaces its row.
    ///
    /// # Errors
    /// [`BagError::NoJointStates`], [`BagError::SeveralTopics`]; errors of a file that is not an MCAP file, or damaged.
    pub fn read(file: impl Read, topic: Option<&str>) -> Result<Self, BagError> {
        let mut reader = BagReader::new(file);
        let (mut topics, mut states): (Vec<String>, Vec<(i64, JointState)>) = (Vec::new(), Vec::new());
        while let Some(message) = reader.next_message()? {
            if message.message_type != JointState::NAME {
                continue;
            }
            if !topics.contains(&message.topic) {
                topics.push(message.topic.clone());
            }
            if topic.is_none_or(|wanted| wanted == message.topic) {
                states.push(state(&message)?);
            }
        }
        let chosen = match (topic, topics.as_slice()) {
            (Some(wanted), all) if all.iter().any(|t| t == wanted) => wanted.to_owned(),
            (None, [only]) => only.clone(),
            (None, [_, _, ..]) => return Err(BagError::SeveralTopics { found: topics }),
            (wanted, _) => return Err(BagError::NoJointStates { wanted: wanted.map(str::to_owned), found: topics }),
        };
        let (joints, rows) = rows(&states);
        Ok(Self { topic: chosen, joints, rows, cut_off: reader.is_cut_off() })
    }

    /// Writes `t_s` and a column per joint; the numbers read back to the same bits. The `trajectory` of a cell accepts the file.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write_csv(&self, mut out: impl Write) -> io::Result<()> {
        writeln!(out, "t_s,{}", self.joints.join(","))?;
        for (t_s, q) in &self.rows {
            write!(out, "{t_s}")?;
            q.iter().try_for_each(|v| write!(out, ",{v}"))?;
            writeln!(out)?;
        }
        out.flush()
    }
}

/// Reads time (ns) and contents of a message.
fn state(message: &BagMessage) -> Result<(i64, JointState), BagError> {
    let state = JointState::decode(&message.payload).map_err(|source| BagError::Message {
        message: message.index,
        topic: message.topic.clone(),
        what: JointState::NAME,
        source,
    })?;
    let (names, positions) = (state.name.len(), state.position.len());
    if names != positions {
        return Err(BagError::JointStateLength {
            message: message.index,
            topic: message.topic.clone(),
            names,
            positions,
        });
    }
    let stamp = &state.header.stamp;
    let measured_ns = i64::from(stamp.sec) * 1_000_000_000 + i64::from(stamp.nanosec);
    let recorded_ns = i64::try_from(message.time_ns).unwrap_or(i64::MAX);
    Ok((if measured_ns > 0 { measured_ns } else { recorded_ns }, state))
}

/// Collects the joints, and a row per message, starting when every joint has a value.
fn rows(states: &[(i64, JointState)]) -> (Vec<String>, Vec<(f64, Vec<f64>)>) {
    let mut joints: Vec<String> = Vec::new();
    for name in states.iter().flat_map(|(_, state)| &state.name) {
        if !joints.contains(name) {
            joints.push(name.clone());
        }
    }
    let mut values = vec![f64::NAN; joints.len()];
    let mut rows: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut begin_ns = None;
    for (at_ns, state) in states {
        for (name, value) in state.name.iter().zip(&state.position) {
            if let Some(joint) = joints.iter().position(|known| known == name) {
                values[joint] = *value;
            }
        }
        if values.iter().any(|v| v.is_nan()) {
            continue;
        }
        let t_s = at_ns.saturating_sub(*begin_ns.get_or_insert(*at_ns)) as f64 * 1e-9;
        match rows.last_mut() {
            Some((last_s, q)) if t_s <= *last_s => q.clone_from(&values),
            _ => rows.push((t_s, values.clone())),
        }
    }
    (joints, rows)
}
