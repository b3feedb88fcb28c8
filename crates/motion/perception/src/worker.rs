//! A perception pipeline on its own thread.

use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, channel, sync_channel};
use std::thread::{Builder, JoinHandle};

use crate::error::PerceptionError;
use crate::obstacle_update::ObstacleUpdate;
use crate::pipeline::PerceptionPipeline;

/// A frame for a [`PerceptionWorker`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CapturedImage {
    /// The bytes from the camera.
    pub bytes: Vec<u8>,
    /// Name for messages; its extension distinguishes raw bytes from image files.
    pub name: PathBuf,
    /// Time stamp, seconds.
    pub stamp_s: f64,
    /// All joint values of the robot at that time, radians or metres.
    pub q: Vec<f64>,
}

/// Runs a [`PerceptionPipeline`] on its own thread. Neither side blocks: a frame that arrives while another one is
/// queued is dropped, and [`PerceptionWorker::send`] returns false. The map is read through its
/// [`MapReader`](elbowroom_cspace::MapReader).
///
/// Dropping the worker, or [`PerceptionWorker::stop`], ends the thread after the current frame.
#[derive(Debug)]
pub struct PerceptionWorker {
    /// `None` when the thread is to end.
    images: Option<SyncSender<CapturedImage>>,
    updates: Receiver<Result<ObstacleUpdate, PerceptionError>>,
    thread: Option<JoinHandle<PerceptionPipeline>>,
}

impl PerceptionWorker {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system cannot start a thread.
    pub fn spawn(mut pipeline: PerceptionPipeline) -> io::Result<Self> {
        let (images, incoming) = sync_channel::<CapturedImage>(1);
        let (outgoing, updates) = channel();
        let work = move || {
            for image in incoming {
                let result = pipeline.process_image(&image.bytes, &image.name, image.stamp_s, &image.q);
                if outgoing.send(result).is_err() {
                    break;
                }
            }
            pipeline
        };
        let thread = Builder::new().name("perception".into()).spawn(work)?;
        Ok(Self { images: Some(images), updates, thread: Some(thread) })
    }

    /// Queues a frame; false where one is queued already or the thread has ended: then it is dropped.
    pub fn send(&self, image: CapturedImage) -> bool {
        match self.images.as_ref().map(|images| images.try_send(image)) {
            Some(Ok(())) => true,
            Some(Err(TrySendError::Full(_) | TrySendError::Disconnected(_))) | None => false,
        }
    }

    /// Results since the last call, in order: updates, and errors of rejected frames.
    pub fn updates(&self) -> impl Iterator<Item = Result<ObstacleUpdate, PerceptionError>> + '_ {
        self.updates.try_iter()
    }

    /// Ends the thread and returns the pipeline; `None` where the thread panicked.
    pub fn stop(mut self) -> Option<PerceptionPipeline> {
        self.images = None;
        self.thread.take()?.join().ok()
    }
}

impl Drop for PerceptionWorker {
    fn drop(&mut self) {
        self.images = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked returns nothing.
            drop(thread.join());
        }
    }
}
