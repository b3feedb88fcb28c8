//! Limited number of places for connections without a token, of which the oldest is closed for a newcomer.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::watch;

/// Places for connections: a newcomer takes the place of the oldest, so connections that hang cannot block others.
#[derive(Debug, Clone)]
pub(crate) struct Places {
    limit: usize,
    taken: Arc<Mutex<Taken>>,
}

#[derive(Debug, Default)]
struct Taken {
    next: u64,
    by_age: BTreeMap<u64, watch::Sender<()>>,
}

/// A place, held until its last clone is dropped or it is vacated.
///
/// Its age counts from the acceptance of its connection, whoever holds it later.
#[derive(Debug, Clone)]
pub struct Place(Arc<Held>);

#[derive(Debug)]
struct Held {
    id: u64,
    taken: Arc<Mutex<Taken>>,
    vacated: watch::Receiver<()>,
    /// Sender of a kept place.
    kept: Mutex<Option<watch::Sender<()>>>,
}

impl Places {
    pub(crate) fn new(limit: usize) -> Self {
        Self { limit: limit.max(1), taken: Arc::default() }
    }

    pub(crate) fn enter(&self) -> Place {
        let (vacate, vacated) = watch::channel(());
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        while taken.by_age.len() >= self.limit {
            // Dropping the sender wakes the holders.
            taken.by_age.pop_first();
        }
        let id = taken.next;
        taken.next += 1;
        taken.by_age.insert(id, vacate);
        Place(Arc::new(Held { id, taken: self.taken.clone(), vacated, kept: Mutex::default() }))
    }
}

impl Place {
    /// Keeps the place, as its holder has a token: it is never vacated for a newcomer, and no longer counts towards the
    /// limit.
    pub fn keep(&self) {
        let sender = self.0.taken.lock().unwrap_or_else(PoisonError::into_inner).by_age.remove(&self.0.id);
        if sender.is_some() {
            *self.0.kept.lock().unwrap_or_else(PoisonError::into_inner) = sender;
        }
    }

    /// Waits until a newcomer needs the place.
    pub(crate) async fn vacated(&self) {
        let mut vacated = self.0.vacated.clone();
        while vacated.changed().await.is_ok() {}
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner).by_age.remove(&self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ages(places: &Places) -> Vec<u64> {
        places.taken.lock().unwrap().by_age.keys().copied().collect()
    }

    #[tokio::test]
    async fn a_newcomer_takes_the_place_of_the_oldest() {
        let places = Places::new(2);
        let (first, second) = (places.enter(), places.enter());
        let _third = places.enter();
        first.vacated().await;
        assert!(second.0.vacated.has_changed().is_ok());
        drop(second);
        let _fourth = places.enter();
        assert_eq!(ages(&places), [2, 3]);
    }

    #[tokio::test]
    async fn whoever_has_a_token_keeps_the_place() {
        let places = Places::new(2);
        let known = places.enter();
        known.keep();
        let strangers: Vec<Place> = (0..10).map(|_| places.enter()).collect();
        assert_eq!(ages(&places), [9, 10]);
        assert!(known.0.vacated.has_changed().is_ok() && strangers[9].0.vacated.has_changed().is_ok());
        strangers[7].vacated().await;
        // Too late: another connection has its place already.
        strangers[0].keep();
        strangers[0].vacated().await;
    }

    #[tokio::test]
    async fn a_place_is_as_old_as_its_first_holder_and_is_taken_until_its_last() {
        let places = Places::new(2);
        let connection = places.enter();
        let newer = places.enter();
        let session = connection.clone();
        drop(connection);
        assert_eq!(ages(&places), [0, 1]);
        let _newest = places.enter();
        session.vacated().await;
        assert!(newer.0.vacated.has_changed().is_ok());
        drop(newer);
        assert_eq!(ages(&places), [2]);
    }
}
