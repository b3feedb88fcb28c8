//! Speed scaling of a robot whose controller does not use ROS 2: the answer of its node, for observers.

use std::sync::{Arc, Mutex};

use elbowroom_interlock::Micros;

use super::session::RosPublisher;
use super::speed_scaling::{SpeedScaling, Wake};
use crate::clock::Clock;
use crate::locked::locked;
use crate::messages::OverrideAnswer;
use crate::network::{Network, NetworkError, Subscription};

/// Publishes the override that a node answers to its controller.
pub(super) struct AnsweredFactor {
    // In the order in which the parts end.
    _answers: Subscription,
    _speed_scaling: SpeedScaling,
}

impl AnsweredFactor {
    /// Starts to publish. `key` is the key of the node's answers; an answer is valid until its age is `oldest`.
    pub(super) fn start(
        network: &dyn Network,
        key: &str,
        clock: Clock,
        oldest: Micros,
        publisher: RosPublisher,
    ) -> Result<Self, NetworkError> {
        let last: Arc<Mutex<Option<(f64, Micros)>>> = Arc::default();
        let wake = Wake::default();
        let answers = {
            let (last, wake) = (last.clone(), wake.clone());
            let handler = Box::new(move |bytes: &[u8]| {
                if let Ok(answer) = OverrideAnswer::decode(bytes) {
                    let heard = (answer.speed_override, clock.micros());
                    *locked(&last) = Some(heard);
                    wake.notify();
                }
            });
            network.subscribe(key, handler)?
        };
        let factor = move || {
            let last = *locked(&last);
            last.filter(|(_, at)| clock.micros() - *at <= oldest).map_or(0.0, |(factor, _)| factor)
        };
        let speed_scaling = SpeedScaling::start(publisher, wake, Box::new(factor));
        Ok(Self { _answers: answers, _speed_scaling: speed_scaling })
    }
}
