//! Pictures and clouds that arrive while a cell runs.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use elbowroom_cell::{Cell, CellSensor};
use elbowroom_formats::PngStream;

use crate::clock::Clock;
use crate::event_handler::EventHandler;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, Subscription};
use crate::service_error::ServiceError;

/// So many pictures of one sensor wait to be processed; of more, the oldest ones are dropped.
const WAITING: usize = 4;
/// A named pipe that has ended is opened again after this time.
const REOPENED_AFTER: Duration = Duration::from_millis(200);

/// Where the pictures of a camera come from, in place of the folder of the cell file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FrameInput {
    /// PNG pictures one after another, from standard input.
    StandardInput,
    /// PNG pictures one after another, from a named pipe.
    Pipe(PathBuf),
    /// The messages of the sensor's key only.
    Key,
}

/// A picture or cloud that was sent.
pub(super) struct SentFrame {
    pub sensor: String,
    pub bytes: Vec<u8>,
    /// When it was taken, s: `latency_ms` of the sensor's table before it arrived.
    pub taken_s: f64,
}

/// The pictures and clouds that were sent and not processed yet.
#[derive(Clone)]
struct Waiting {
    frames: Arc<Mutex<VecDeque<SentFrame>>>,
    clock: Clock,
}

impl Waiting {
    fn push(&self, sensor: &str, latency_s: f64, bytes: Vec<u8>) {
        let taken_s = self.clock.seconds() - latency_s;
        let mut frames = locked(&self.frames);
        let mut of_sensor = frames.iter().enumerate().filter(|(_, frame)| frame.sensor == sensor).map(|(i, _)| i);
        if let Some(oldest) = of_sensor.next().filter(|_| of_sensor.count() + 1 >= WAITING) {
            frames.remove(oldest);
        }
        frames.push_back(SentFrame { sensor: sensor.to_owned(), bytes, taken_s });
    }
}

/// Listens to the sensors of a cell: on their keys, and on pipes.
pub(super) struct FrameInputs {
    waiting: Waiting,
    _subscriptions: Vec<Subscription>,
}

impl FrameInputs {
    /// Each sensor that guards a robot has a key; `sources` are those with a pipe.
    ///
    /// # Errors
    /// [`ServiceError`] if a key cannot be used, or a thread not be started.
    pub fn start(
        cell: &Cell,
        sources: &[(String, FrameInput)],
        network: &Arc<dyn Network>,
        clock: Clock,
        on_event: Option<&EventHandler>,
    ) -> Result<Self, ServiceError> {
        let waiting = Waiting { frames: Arc::default(), clock };
        let keys = Keys::new(&cell.name);
        let mut subscriptions = Vec::new();
        for sensor in cell.sensors.iter().filter(|sensor| !sensor.robots.is_empty()) {
            let source = sources.iter().find(|(name, _)| *name == sensor.name).map(|(_, source)| source);
            // What has a folder is heard on its key only if that is asked for.
            if source == Some(&FrameInput::Key) || (source.is_none() && sensor.folder.is_none()) {
                let (waiting, name, latency_s) = (waiting.clone(), sensor.name.clone(), sensor.latency_s);
                let handler = Box::new(move |bytes: &[u8]| waiting.push(&name, latency_s, bytes.to_vec()));
                subscriptions.push(network.subscribe(&keys.frames(&sensor.name), handler)?);
            }
            if let Some(source) = source.filter(|source| **source != FrameInput::Key) {
                read_pipe(sensor, source.clone(), waiting.clone(), on_event.cloned()).map_err(ServiceError::Thread)?;
            }
        }
        Ok(Self { waiting, _subscriptions: subscriptions })
    }

    /// Takes what was sent up to now.
    pub fn take(&self) -> impl Iterator<Item = SentFrame> {
        std::mem::take(&mut *locked(&self.waiting.frames)).into_iter()
    }
}

/// Reads pictures from a pipe, on a thread of its own. A named pipe is opened again when it has ended.
fn read_pipe(
    sensor: &CellSensor,
    source: FrameInput,
    waiting: Waiting,
    on_event: Option<EventHandler>,
) -> io::Result<()> {
    let (name, latency_s) = (sensor.name.clone(), sensor.latency_s);
    let read = move || {
        let push = |picture| waiting.push(&name, latency_s, picture);
        loop {
            let ended = match open(&source).and_then(|input| forward(input, push)) {
                Ok(()) => "there are no more pictures".to_owned(),
                Err(error) => format!("{error} (PNG pictures one after another: ffmpeg … -f image2pipe -c:v png -)"),
            };
            let remedy = match &source {
                FrameInput::Pipe(path) => format!("write pictures to {} again", path.display()),
                FrameInput::StandardInput | FrameInput::Key => "start this process again".to_owned(),
            };
            if let Some(on_event) = &on_event {
                on_event(&format!("sensor {name}: {ended}; the robots that it guards stop\n  help: {remedy}"));
            }
            if !matches!(source, FrameInput::Pipe(_)) {
                return;
            }
            std::thread::sleep(REOPENED_AFTER);
        }
    };
    std::thread::Builder::new().name("pictures".into()).spawn(read).map(|_| ())
}

fn open(source: &FrameInput) -> io::Result<Box<dyn Read>> {
    Ok(match source {
        FrameInput::Pipe(path) => Box::new(io::BufReader::new(File::open(path)?)),
        FrameInput::StandardInput | FrameInput::Key => Box::new(io::stdin().lock()),
    })
}

fn forward(input: Box<dyn Read>, push: impl Fn(Vec<u8>)) -> io::Result<()> {
    let mut stream = PngStream::new(input);
    while let Some(picture) = stream.next_picture()? {
        push(picture);
    }
    Ok(())
}
