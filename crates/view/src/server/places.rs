//! A limited number of places, of which the oldest is vacated for a newcomer.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::oneshot;

/// Whoever hangs cannot keep others out: a newcomer takes the place of the oldest.
#[derive(Debug, Clone)]
pub(crate) struct Places {
    limit: usize,
    taken: Arc<Mutex<Taken>>,
}

#[derive(Debug, Default)]
struct Taken {
    next: u64,
    by_age: BTreeMap<u64, oneshot::Sender<()>>,
}

/// A place, until it is dropped or vacated.
#[derive(Debug)]
pub(crate) struct Place {
    id: u64,
    taken: Arc<Mutex<Taken>>,
    vacated: oneshot::Receiver<()>,
}

impl Places {
    pub(crate) fn new(limit: usize) -> Self {
        Self { limit: limit.max(1), taken: Arc::default() }
    }

    pub(crate) fn enter(&self) -> Place {
        let (vacate, vacated) = oneshot::channel();
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        while taken.by_age.len() >= self.limit {
            // Dropping the sender wakes the holder.
            taken.by_age.pop_first();
        }
        let id = taken.next;
        taken.next += 1;
        taken.by_age.insert(id, vacate);
        Place { id, taken: self.taken.clone(), vacated }
    }
}

impl Place {
    /// Ends when a newcomer needs the place.
    pub(crate) async fn vacated(&mut self) {
        let _ = (&mut self.vacated).await;
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner).by_age.remove(&self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_newcomer_takes_the_place_of_the_oldest() {
        let places = Places::new(2);
        let (mut first, mut second) = (places.enter(), places.enter());
        let _third = places.enter();
        first.vacated().await;
        assert!(second.vacated.try_recv().is_err_and(|e| e == oneshot::error::TryRecvError::Empty));
        drop(second);
        let _fourth = places.enter();
        assert_eq!(places.taken.lock().unwrap().by_age.keys().copied().collect::<Vec<_>>(), [2, 3]);
    }
}
