//! Checkers that stay from one call to the next, for calls of a few rows: to make one takes longer than to answer a row.

use std::sync::{Arc, Mutex, TryLockError};

use elbowroom::query::{QueryChecker, QueryKind, QueryPairs, QueryRow, QueryStates};
use elbowroom::scene::{CheckerOptions, SceneError, SceneState};
use self_cell::self_cell;

use crate::model::Model;

/// A checker with the state that it looks at.
struct Answering<'m> {
    checker: QueryChecker<'m>,
    state: SceneState,
}

self_cell!(
    /// A checker beside the model that it borrows.
    struct OwningChecker {
        owner: Arc<Model>,

        #[not_covariant]
        dependent: Answering,
    }
);

/// A checker of a model, made when it is first needed.
///
/// It has learned from earlier calls which pairs are likely to collide, which changes no distance, and not whether there is a
/// contact; of several contacts it may name another one, so it is for questions without names.
#[derive(Default)]
pub struct KeptChecker(Mutex<Option<OwningChecker>>);

impl KeptChecker {
    /// Answers a query about each state; `None` if another thread uses the checker.
    pub fn rows(
        &self,
        model: &Arc<Model>,
        (options, pairs): (CheckerOptions, &QueryPairs),
        states: &QueryStates,
        kind: QueryKind,
        mut take: impl FnMut(&QueryRow),
    ) -> Option<Result<(), SceneError>> {
        let mut kept = match self.0.try_lock() {
            Ok(kept) => kept,
            Err(TryLockError::Poisoned(poisoned)) => {
                // Its last answer has panicked.
                self.0.clear_poison();
                let mut kept = poisoned.into_inner();
                *kept = None;
                kept
            }
            Err(TryLockError::WouldBlock) => return None,
        };
        let made = kept.get_or_insert_with(|| {
            OwningChecker::new(model.clone(), |model| Answering {
                checker: QueryChecker::new(&model.scene, options, pairs),
                state: model.start.clone(),
            })
        });
        Some(made.with_dependent_mut(|_, Answering { checker, state }| {
            for index in 0..states.len() {
                for (robot, q) in states.of(index) {
                    state.set_q(checker.scene(), robot, q)?;
                }
                take(&checker.row(state, kind));
            }
            Ok(())
        }))
    }
}
