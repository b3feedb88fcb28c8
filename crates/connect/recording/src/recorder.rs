//! Recorder of a live service: records the ticks of several threads without delaying them.

use std::io::{Seek, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use elbowroom_monitor::{Configuration, Monitor, RegionId, Snapshot, TickReport, VolumeId};
use elbowroom_ros2::msgs::elbowroom_msgs::{Lost, MonitorConfiguration, MonitorTick, SourceState};
use elbowroom_spatial::Pose;
use elbowroom_status::CellStatus;

use crate::tick_writer::TickWriter;
use crate::{BagError, CellWriter, configuration};

/// Capacity of the queue to the file, in items.
const QUEUE: usize = 8192;
/// Capacity for ticks of one robot that wait for the file: two seconds at 500 Hz.
const TICKS_PER_ROBOT: usize = 1024;
/// Interval at which the writer polls: if it waited in the queue, the tick would have to wake it.
const POLL: Duration = Duration::from_millis(5);

/// Records a live service. A separate thread writes; ticks that arrive faster than it can write are omitted and counted.
pub struct Recorder {
    queue: SyncSender<Item>,
    shared: Arc<Shared>,
    thread: JoinHandle<Result<(), BagError>>,
}

#[derive(Debug, Default)]
struct Shared {
    lost_ticks: AtomicU64,
    lost_statuses: AtomicU64,
    /// Ticks that wait for the file.
    waiting: AtomicU64,
    stop: AtomicBool,
}

enum Item {
    Tick(Box<TickBuffer>),
    Status(Box<CellStatus>),
    Configuration(Box<MonitorConfiguration>, f64),
}

/// A tick for the file, and the queue to which its buffer returns.
struct TickBuffer {
    tick: MonitorTick,
    back: SyncSender<Box<TickBuffer>>,
}

/// Records the ticks of one robot; it belongs to the thread of its monitor.
pub struct TickRecorder {
    ticks: TickWriter,
    queue: SyncSender<Item>,
    free: Receiver<Box<TickBuffer>>,
    shared: Arc<Shared>,
    robot: u32,
}

impl Recorder {
    /// Begins a recording.
    ///
    /// `on_error` is called once, at the first error, after which nothing is recorded: without it the error would be
    /// known only at [`Self::finish`], days later.
    ///
    /// # Errors
    /// [`BagError::Io`] if the thread cannot be started.
    pub fn start<W: Write + Seek + Send + 'static>(
        writer: CellWriter<W>,
        on_error: impl FnOnce(&BagError) + Send + 'static,
    ) -> Result<Self, BagError> {
        let (queue, items) = sync_channel(QUEUE);
        let shared = Arc::new(Shared::default());
        let of_thread = shared.clone();
        let thread = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || write_all(writer, &items, &of_thread).inspect_err(on_error))
            .map_err(|source| BagError::Io { file: "the recorder's thread".into(), source })?;
        Ok(Self { queue, shared, thread })
    }

    /// Creates the recorder of a robot (`robot` is its index in the cell), and records its monitor's configuration.
    ///
    /// All memory of its ticks is allocated here.
    pub fn robot(&self, robot: u32, monitor: &Monitor, t_s: f64) -> TickRecorder {
        let (back, free) = sync_channel(TICKS_PER_ROBOT);
        for _ in 0..TICKS_PER_ROBOT {
            let buffer = TickBuffer { tick: empty_tick(monitor.configuration()), back: back.clone() };
            // The queue has room for all buffers.
            let _ = back.try_send(Box::new(buffer));
        }
        let (queue, shared) = (self.queue.clone(), self.shared.clone());
        let recorder = TickRecorder { ticks: TickWriter::new(robot), queue, free, shared, robot };
        recorder.configuration(monitor, t_s);
        recorder
    }

    /// Records the status of the cell; its time is on the clock of the ticks. Never waits.
    pub fn status(&self, status: CellStatus) {
        if self.queue.try_send(Item::Status(Box::new(status))).is_err() {
            self.shared.lost_statuses.fetch_add(1, Relaxed);
        }
    }

    /// Number of omitted ticks.
    pub fn lost_ticks(&self) -> u64 {
        self.shared.lost_ticks.load(Relaxed)
    }

    /// Number of ticks that wait for the file.
    pub fn waiting_ticks(&self) -> u64 {
        self.shared.waiting.load(Relaxed)
    }

    /// Writes all waiting items, and the index of the file.
    ///
    /// # Errors
    /// The first error of the recording.
    pub fn finish(self) -> Result<(), BagError> {
        self.shared.stop.store(true, Relaxed);
        drop(self.queue);
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl TickRecorder {
    /// Records that a region of the monitor was switched.
    pub fn switched(&mut self, region: RegionId, active: bool) {
        self.ticks.switched(region, active);
    }

    /// Records that a volume was attached to the robot.
    pub fn attached(&mut self, volume: VolumeId, in_link: &Pose) {
        self.ticks.attached(volume, in_link);
    }

    /// Records that a volume was detached from the robot.
    pub fn detached(&mut self, volume: VolumeId) {
        self.ticks.detached(volume);
    }

    /// Records that the monitor has forgotten its robot's position ([`Monitor::forget_position`]).
    pub fn forgot_position(&mut self) {
        self.ticks.forgot_position();
    }

    /// Records that the monitor was built again, from another configuration. Not part of the tick: it allocates.
    pub fn configuration(&self, monitor: &Monitor, t_s: f64) {
        let message = Box::new(configuration::of_monitor(self.robot, monitor));
        if self.queue.try_send(Item::Configuration(message, t_s)).is_err() {
            // Without the configuration, later ticks cannot be replayed.
            self.shared.lost_ticks.fetch_add(1, Relaxed);
        }
    }

    /// Records a tick of the monitor, at `t_s` of the recording's clock, which statuses and all robots share.
    ///
    /// `report` is the monitor's own. Never waits, and does not allocate.
    pub fn tick(&mut self, t_s: f64, snapshot: &Snapshot<'_>, report: &TickReport, monitor: &Monitor) {
        let Ok(mut buffer) = self.free.try_recv() else {
            self.ticks.skip();
            self.shared.lost_ticks.fetch_add(1, Relaxed);
            return;
        };
        self.ticks.write(&mut buffer.tick, t_s, snapshot, report, monitor);
        self.shared.waiting.fetch_add(1, Relaxed);
        if self.queue.try_send(Item::Tick(buffer)).is_err() {
            self.shared.waiting.fetch_sub(1, Relaxed);
            self.shared.lost_ticks.fetch_add(1, Relaxed);
        }
    }
}

/// Creates a tick with memory for everything that a tick of this monitor has.
fn empty_tick(configuration: &Configuration) -> MonitorTick {
    let (joints, sources) = (configuration.chain().dof(), configuration.sources().len());
    MonitorTick {
        q: Vec::with_capacity(joints),
        qd: Vec::with_capacity(joints),
        qdd: Vec::with_capacity(joints),
        intent: Vec::with_capacity(joints),
        sources: Vec::<SourceState>::with_capacity(sources),
        granted: Vec::with_capacity(configuration.regions().len()),
        halted: Vec::with_capacity(configuration.regions().len()),
        switched: Vec::with_capacity(configuration.regions().len()),
        attached: Vec::with_capacity(configuration.volumes().len()),
        ..MonitorTick::default()
    }
}

fn write_all<W: Write + Seek>(
    mut writer: CellWriter<W>,
    items: &Receiver<Item>,
    shared: &Shared,
) -> Result<(), BagError> {
    let mut known = Lost::default();
    let mut now_s = 0.0;
    loop {
        let item = items.try_recv();
        let may_end = matches!(item, Err(TryRecvError::Disconnected)) || item.is_err() && shared.stop.load(Relaxed);
        match item {
            Ok(Item::Tick(buffer)) => {
                now_s = buffer.tick.t_s;
                let written = writer.tick(&buffer.tick);
                let back = buffer.back.clone();
                let _ = back.try_send(buffer);
                shared.waiting.fetch_sub(1, Relaxed);
                written?;
                continue;
            }
            Ok(Item::Status(status)) => {
                writer.status(&status)?;
                continue;
            }
            Ok(Item::Configuration(message, t_s)) => {
                writer.configuration_message(&message, t_s)?;
                continue;
            }
            Err(_) => {}
        }
        let lost = Lost { ticks: shared.lost_ticks.load(Relaxed), statuses: shared.lost_statuses.load(Relaxed) };
        if lost != known {
            writer.lost(&lost, now_s)?;
            known = lost;
        }
        if may_end {
            return writer.finish();
        }
        writer.flush_if_due()?;
        std::thread::sleep(POLL);
    }
}
