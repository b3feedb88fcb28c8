//! Subscriptions to the measured sources of a cell, for those who show or answer where things are.

use std::sync::{Arc, Mutex};

use elbowroom_cell::{Cell, MeasuredSource};
use elbowroom_interlock::Micros;
use elbowroom_monitor::SourceState;

use crate::clock::Clock;
use crate::configuration_number::configuration_number;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, NetworkError, Subscription};
use crate::node::{Heard, MeasuredFrame};

/// Age up to which a region on a source is where the measurement says.
const FRESH: Micros = Micros(50_000);

/// Key of the messages of a measured source.
pub(crate) fn key_of(keys: &Keys, cell: &Cell, source: MeasuredSource) -> String {
    match source {
        MeasuredSource::Encoder(index) => keys.encoder(&cell.frame_sources.encoders[index].name),
        MeasuredSource::Object(object) => keys.object(&cell.objects[object.0].name),
    }
}

/// The last messages of all measured sources of a cell.
pub(crate) struct MeasuredSources {
    heard: Arc<Mutex<Vec<(Heard, MeasuredFrame)>>>,
    cell: Arc<Cell>,
    clock: Clock,
    _subscriptions: Vec<Subscription>,
}

impl MeasuredSources {
    /// Listens to all measured sources.
    pub(crate) fn start(cell: &Arc<Cell>, network: &Arc<dyn Network>, clock: Clock) -> Result<Self, NetworkError> {
        let checksum = configuration_number(cell);
        let frames = MeasuredFrame::all(cell).into_iter().map(|frame| (Heard::of_source(checksum), frame));
        let heard = Arc::new(Mutex::new(frames.collect::<Vec<_>>()));
        let keys = Keys::new(&cell.name);
        let subscribe = |(i, source): (usize, &MeasuredSource)| {
            let (heard, of_cell) = (heard.clone(), cell.clone());
            let handler = Box::new(move |bytes: &[u8]| {
                let now = clock.micros();
                let (heard, frame) = &mut locked(&heard)[i];
                heard.take(bytes, now);
                frame.take(heard, &of_cell, now);
            });
            network.subscribe(&key_of(&keys, cell, *source), handler)
        };
        let subscriptions = cell.frame_sources.measured.iter().enumerate().map(subscribe).collect::<Result<_, _>>()?;
        Ok(Self { heard, cell: cell.clone(), clock, _subscriptions: subscriptions })
    }

    /// State per measured source; `None` if it is not heard.
    #[cfg(test)]
    pub(crate) fn states(&self) -> Vec<Option<SourceState>> {
        self.states_within(Micros(500_000))
    }

    /// State per measured source; `None` if it was not heard lately.
    pub(crate) fn fresh_states(&self) -> Vec<Option<SourceState>> {
        self.states_within(FRESH)
    }

    /// The last state per measured source, however old it is; `None` if it was never heard.
    pub(crate) fn last_states(&self) -> Vec<Option<SourceState>> {
        self.states_within(Micros(u64::MAX))
    }

    fn states_within(&self, oldest: Micros) -> Vec<Option<SourceState>> {
        let now = self.clock.micros();
        let fresh = |(heard, frame): &mut (Heard, MeasuredFrame)| {
            frame.take(heard, &self.cell, now);
            frame.state(&self.cell).filter(|_| frame.age.is_some_and(|age| age <= oldest))
        };
        locked(&self.heard).iter_mut().map(fresh).collect()
    }
}
