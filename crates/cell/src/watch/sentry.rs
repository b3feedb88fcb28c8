//! A watch on a thread of its own.

use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, channel, sync_channel};
use std::thread::{Builder, JoinHandle};

use super::{Sighting, Watch, WatchError};

/// A frame on its way to a [`Sentry`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shot {
    /// As the camera sent it.
    pub bytes: Vec<u8>,
    /// What messages call it; its ending tells raw bytes from pictures.
    pub name: PathBuf,
    /// When it was taken, seconds.
    pub stamp_s: f64,
    /// All joint values of the robot at that time, radians or metres.
    pub q: Vec<f64>,
}

/// A [`Watch`] at work on a thread of its own. Neither side ever waits for the other: a frame that comes while another
/// waits already is dropped, and told so; the map is looked at through its [`Reader`](elbowroom_cspace::Reader).
///
/// Dropping it, or [`Sentry::stop`], ends the thread after the frame that it is at.
#[derive(Debug)]
pub struct Sentry {
    /// Gone when the thread is to end.
    shots: Option<SyncSender<Shot>>,
    told: Receiver<Result<Sighting, WatchError>>,
    thread: Option<JoinHandle<Watch>>,
}

impl Sentry {
    /// Puts a watch to work.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn post(mut watch: Watch) -> io::Result<Self> {
        let (shots, incoming) = sync_channel::<Shot>(1);
        let (outgoing, told) = channel();
        let work = move || {
            for shot in incoming {
                let seen = watch.see(&shot.bytes, &shot.name, shot.stamp_s, &shot.q);
                if outgoing.send(seen).is_err() {
                    break;
                }
            }
            watch
        };
        let thread = Builder::new().name("elbowroom watch".into()).spawn(work)?;
        Ok(Self { shots: Some(shots), told, thread: Some(thread) })
    }

    /// Hands over a frame; false where one is waiting already, or the thread has ended: it is dropped then.
    pub fn send(&self, shot: Shot) -> bool {
        match self.shots.as_ref().map(|shots| shots.try_send(shot)) {
            Some(Ok(())) => true,
            Some(Err(TrySendError::Full(_) | TrySendError::Disconnected(_))) | None => false,
        }
    }

    /// What was told since the last call, in order: sightings, and frames that were refused.
    pub fn told(&self) -> impl Iterator<Item = Result<Sighting, WatchError>> + '_ {
        self.told.try_iter()
    }

    /// Ends the thread and gives back the watch; `None` where it had ended by itself.
    pub fn stop(mut self) -> Option<Watch> {
        self.shots = None;
        self.thread.take()?.join().ok()
    }
}

impl Drop for Sentry {
    fn drop(&mut self) {
        self.shots = None;
        if let Some(thread) = self.thread.take() {
            // A thread that ended badly has nothing to give back.
            drop(thread.join());
        }
    }
}
