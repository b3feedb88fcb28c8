//! Reports when other processes of the cell come and go, without messages: Zenoh reports who is connected.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;
use zenoh::Wait as _;
use zenoh::liveliness::LivelinessToken;
use zenoh::sample::SampleKind;

use crate::event_handler::EventHandler;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{NetworkError, Subscription, ZenohNetwork};

/// Time after which missing parts of the cell are reported, once.
const PATIENCE: Duration = Duration::from_secs(3);

/// A part of the cell that runs in some process.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Arbiter,
    Robot(String),
}

impl Part {
    fn key(&self, keys: &Keys) -> String {
        match self {
            Self::Arbiter => keys.presence_of_arbiter(),
            Self::Robot(name) => keys.presence(name),
        }
    }

    fn gone(&self) -> String {
        match self {
            Self::Arbiter => {
                "the arbiter's process is gone: no robot is granted a region, and all stop where regions may be added or moved"
                    .to_owned()
            }
            Self::Robot(name) => format!(
                "robot {name}: its process is gone; it keeps the regions that it holds until it is heard again, or cleared"
            ),
        }
    }

    fn missing(&self) -> String {
        match self {
            Self::Arbiter => "no arbiter is there: start `live CELL --arbiter`".to_owned(),
            Self::Robot(name) => {
                format!(
                    "robot {name}: no process guards it yet: start `live CELL --robots {name}`, or it keeps standing"
                )
            }
        }
    }

    fn here(&self) -> String {
        match self {
            Self::Arbiter => "the arbiter's process is there".to_owned(),
            Self::Robot(name) => format!("robot {name}: its process is there"),
        }
    }
}

/// Shows that this process is present, and reports when others come and go. It ends when it is dropped.
pub(crate) struct PeerWatch {
    _tokens: Vec<LivelinessToken>,
    _subscription: Option<Subscription>,
}

impl PeerWatch {
    /// Starts the watch of a process that guards the robots `own`, and is the arbiter or not.
    pub(crate) fn start(
        cell: &Cell,
        own: &[RobotId],
        is_arbiter: bool,
        network: &ZenohNetwork,
        on_event: Option<EventHandler>,
    ) -> Result<Self, NetworkError> {
        let keys = Keys::new(&cell.name);
        let parts = cell.robots.iter().map(|robot| Part::Robot(robot.name.clone())).chain([Part::Arbiter]);
        let is_own = |i: usize| if i < cell.robots.len() { own.contains(&RobotId(i)) } else { is_arbiter };
        let (mut tokens, mut others) = (Vec::new(), Vec::new());
        for (i, part) in parts.enumerate() {
            if is_own(i) {
                let key = part.key(&keys);
                let token = network.session().liveliness().declare_token(key.clone()).wait();
                tokens.push(token.map_err(|e| NetworkError::Key { key, why: e.to_string() })?);
            } else {
                others.push((part.key(&keys), part));
            }
        }
        // Nobody has to read a mechanism: a region that follows it stops its robots if its joint values are missing.
        others
            .retain(|(_, part)| !cell.robots.iter().any(|r| r.is_mechanism() && *part == Part::Robot(r.name.clone())));
        let subscription = match on_event {
            Some(on_event) if !others.is_empty() => Some(watch(network, &keys, others, on_event)?),
            _ => None,
        };
        Ok(Self { _tokens: tokens, _subscription: subscription })
    }
}

fn watch(
    network: &ZenohNetwork,
    keys: &Keys,
    others: Vec<(String, Part)>,
    on_event: EventHandler,
) -> Result<Subscription, NetworkError> {
    let missing: Arc<Mutex<BTreeSet<Part>>> =
        Arc::new(Mutex::new(others.iter().map(|(_, part)| part.clone()).collect()));
    let remind = (Arc::downgrade(&missing), on_event.clone());
    let callback = move |sample: zenoh::sample::Sample| {
        let Some((_, part)) = others.iter().find(|(key, _)| key == sample.key_expr().as_str()) else { return };
        let mut missing = locked(&missing);
        let is_here = sample.kind() == SampleKind::Put;
        let has_changed = if is_here { missing.remove(part) } else { missing.insert(part.clone()) };
        drop(missing);
        if has_changed {
            on_event(&if is_here { part.here() } else { part.gone() });
        }
    };
    let key = keys.presences();
    let subscriber =
        network.session().liveliness().declare_subscriber(key.clone()).history(true).callback(callback).wait();
    let subscriber = subscriber.map_err(|e| NetworkError::Key { key, why: e.to_string() })?;
    // The thread ends by itself soon; parts that come before that are not missing.
    let _ = std::thread::Builder::new().name("peers".into()).spawn(move || {
        std::thread::sleep(PATIENCE);
        let Some(missing) = remind.0.upgrade() else { return };
        let missing = locked(&missing).clone();
        for part in &missing {
            remind.1(&part.missing());
        }
    });
    Ok(Subscription::new(subscriber))
}
