//! Changed recordings are refused or replayed, and never cause a panic.
#![allow(clippy::print_stdout)]

use std::collections::BTreeMap;
use std::io::Cursor;
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_recording::{CellWriter, RunRecorder, replay};
use elbowroom_sim::run::simulate_observed;
use elbowroom_sim::{PlannedPaths, RunOptions};
use elbowroom_testkit::extent::amount;
use elbowroom_testkit::random::SplitMix;

/// Number of changes: 20,000 with `ELBOWROOM_LONG=1`.
fn changes() -> usize {
    amount(8_000, 20_000)
}

/// Every kind of shape, a source, an exchange region, a tool.
const CELL: &str = r#"
version = 1
name = "small"
units = { length = "mm", angle = "deg" }
tick_ms = 10
[robot.arm]
dh = [
  { a = 300, alpha = 0, d = 200, theta = 0, min = -170, max = 170, speed = 180 },
  { a = 300, alpha = 0, d = 0, theta = 0, min = -170, max = 170, speed = 180 },
]
links = [
  { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } },
  { box = { at = [-150, 0, 0], size = [300, 60, 60] } },
]
[encoder.belt]
direction = [0, 1, 0]
speed = 20
[region.ball]
shape = "sphere"
centre = [0, 500, 200]
radius = 100
warning = 200
[region.post]
shape = "cylinder"
base = [500, 300, 0]
radius = 50
height = 500
kind = "exchange"
warning = 150
[region.cart]
shape = "box"
base = [-500, 0, 0]
size = [100, 100, 500]
warning = 100
follow = { encoder = "belt" }
[region.wall]
shape = "plane"
origin = [0, -500, 0]
x = [1, -500, 0]
y = [0, -500, 1]
kind = "monitored"
slow_to = 50
warning = 100
[monitor]
stopping_distance = true
direction_aware = true
[program.arm]
steps = [{ move = "joint", to = [60, 40], speed = 100 }]
"#;

fn recording() -> Vec<u8> {
    let cell = Cell::parse("small.toml", CELL).unwrap();
    let mut file = Cursor::new(Vec::new());
    let mut recorder = RunRecorder::new(CellWriter::new(&mut file, &cell, 0).unwrap(), &cell);
    simulate_observed(&PlannedPaths::new(&cell), &RunOptions::default(), &mut |_| {}, Some(&mut recorder)).unwrap();
    recorder.finish().unwrap();
    file.into_inner()
}

/// Returns the messages that a replay reads: the configuration and the first ticks.
fn messages(recording: &[u8]) -> Vec<(String, Vec<u8>)> {
    let all = mcap::MessageStream::new(recording).unwrap().map(Result::unwrap);
    let mut messages: Vec<_> = all
        .filter(|m| ["/elbowroom/configuration", "/elbowroom/tick"].contains(&m.channel.topic.as_str()))
        .map(|m| (m.channel.topic.clone(), m.data.to_vec()))
        .collect();
    messages.truncate(12);
    messages
}

fn written(messages: &[(String, Vec<u8>)]) -> Vec<u8> {
    with_options(messages, mcap::WriteOptions::new().compression(None).calculate_chunk_crcs(false))
}

fn with_options(messages: &[(String, Vec<u8>)], options: mcap::WriteOptions) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = options.create(&mut file).unwrap();
    for (topic, payload) in messages {
        let channel = writer.add_channel(0, topic, "cdr", &BTreeMap::new()).unwrap();
        let header = mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, payload).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

fn mutate(bytes: &mut Vec<u8>, random: &mut SplitMix) {
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(5) {
            0 => bytes.truncate(at),
            1 => {
                let number = [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300][random.below(6)].to_le_bytes();
                bytes.iter_mut().skip(at & !3).zip(number).for_each(|(byte, new)| *byte = new);
            }
            2 => {
                let number = [u32::MAX, 0, 1, 7, 1 << 20][random.below(5)].to_le_bytes();
                bytes.iter_mut().skip(at & !3).zip(number).for_each(|(byte, new)| *byte = new);
            }
            _ => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.below(8)),
        }
    }
}

#[test]
fn changed_messages_are_refused_or_replayed() {
    let sound = messages(&recording());
    assert_eq!(replay(&written(&sound)[..]).unwrap().differences, 0);
    let mut random = SplitMix(3);
    let begin = Instant::now();
    let mut kinds = BTreeMap::<String, usize>::new();
    for _ in 0..changes() {
        let mut changed = sound.clone();
        // A changed configuration does not match its checksum, so half of the changes are to ticks.
        let which = if random.below(2) == 0 { 0 } else { 1 + random.below(sound.len() - 1) };
        mutate(&mut changed[which].1, &mut random);
        let kind = match replay(&written(&changed)[..]) {
            Ok(found) if found.differences > 0 => "differs".to_owned(),
            Ok(found) if found.robots[0].skipped > 0 => "skipped".to_owned(),
            Ok(_) => "same".to_owned(),
            Err(e) => e.to_string().split(|c: char| c.is_ascii_digit()).next().unwrap_or_default().to_owned(),
        };
        *kinds.entry(kind).or_default() += 1;
    }
    println!("{} in {:?}: {kinds:#?}", changes(), begin.elapsed());
    assert!(begin.elapsed() < Duration::from_mins(5));
    assert!(kinds["differs"] > 100 && kinds["same"] > 100 && kinds.len() > 10);
}

#[test]
fn changed_files_are_refused_or_replayed() {
    let sound = written(&messages(&recording()));
    let mut random = SplitMix(4);
    let (mut refused, mut read) = (0, 0);
    for _ in 0..changes() {
        let mut changed = sound.clone();
        mutate(&mut changed, &mut random);
        match replay(&changed[..]) {
            Ok(_) => read += 1,
            Err(e) => {
                assert!(!e.to_string().is_empty());
                refused += 1;
            }
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > changes() / 20 && refused > changes() / 20);
}

/// The chunk is not compressed and has a checksum: without the check, a changed number would be replayed as a measured one.
#[test]
fn a_chunk_that_changed_is_refused() {
    let messages = messages(&recording());
    let whole = with_options(&messages, mcap::WriteOptions::new().compression(None));
    let marker = &messages.last().unwrap().1;
    let at = whole.windows(marker.len()).position(|bytes| bytes == marker).unwrap();
    assert_eq!(replay(&whole[..]).unwrap().differences, 0);
    for offset in [0, marker.len() / 2, marker.len() - 1] {
        let mut changed = whole.clone();
        changed[at + offset] ^= 1;
        let error = replay(&changed[..]).expect_err("a changed chunk").to_string();
        assert!(error.contains("checksum"), "{error}");
    }
}
