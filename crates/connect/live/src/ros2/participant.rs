//! Participation of a live cell's process in ROS 2.

use std::sync::{Arc, Weak};

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use elbowroom_robot::RobotId;
use elbowroom_ros2::msgs::control_msgs::SpeedScalingFactor;
use elbowroom_ros2::rmw_zenoh::{Qos, Topic};

use super::answered_factor::AnsweredFactor;
use super::cell_feed::CellFeed;
use super::cell_publisher::CellPublisher;
use super::controller::{ControllerParts, RosController};
use super::input_report::InputReport;
use super::session::RosSession;
use super::settings::{Ros2Error, Ros2Robot, Ros2Settings};
use super::worker::Worker;
use crate::clock::Clock;
use crate::event_handler::EventHandler;
use crate::keys::Keys;
use crate::network::{Network, NetworkError, Urgency};

/// Name of the node.
const NODE: &str = "elbowroom";

/// Participation of a process in ROS 2. It ends when it is dropped: then the factor of each of its robots is 0.
pub(crate) struct Participant {
    feed: CellFeed,
    publishes: bool,
    _worker: Worker,
}

struct Parts {
    cell: Arc<Cell>,
    settings: Ros2Settings,
    guarded: Vec<RobotId>,
    /// Weak, so that the network can end while the router is waited for.
    network: Weak<dyn Network>,
    clock: Clock,
    on_event: Option<EventHandler>,
}

impl Participant {
    /// Starts, and participates as soon as the router of ROS 2 is there; `None` if the settings request nothing.
    ///
    /// `guarded` are the robots of this process.
    pub(crate) fn start(
        cell: &Arc<Cell>,
        settings: &Ros2Settings,
        guarded: &[RobotId],
        network: &Arc<dyn Network>,
        clock: Clock,
        on_event: Option<EventHandler>,
    ) -> Result<Option<Self>, Ros2Error> {
        settings.check(cell)?;
        if !settings.is_used() {
            return Ok(None);
        }
        let feed = CellFeed::default();
        let parts = Parts {
            cell: cell.clone(),
            settings: settings.clone(),
            guarded: guarded.to_vec(),
            network: Arc::downgrade(network),
            clock,
            on_event: on_event.clone(),
        };
        let statuses = feed.clone();
        let worker = Worker::start(settings, NODE, on_event, move |session| parts.run(session, &statuses));
        Ok(Some(Self { feed, publishes: settings.publish, _worker: worker }))
    }

    /// Feed for the statuses of the cell, if they are published.
    pub(crate) fn feed(&self) -> Option<CellFeed> {
        self.publishes.then(|| self.feed.clone())
    }
}

impl Drop for Participant {
    fn drop(&mut self) {
        self.feed.close();
    }
}

impl Parts {
    fn run(&self, session: &RosSession, statuses: &CellFeed) -> Result<(), NetworkError> {
        let Self { cell, settings, clock, on_event, .. } = self;
        let Some(network) = &self.network.upgrade() else { return Ok(()) };
        let (clock, on_event) = (*clock, on_event.clone());
        let parts = ControllerParts { cell, settings, session, network, clock, on_event };
        let start = |robot| RosController::start(&parts, robot);
        let controllers = settings.robots.iter().map(start).collect::<Result<Vec<_>, _>>()?;
        let (_factors, mut publisher) = if settings.publish {
            let publisher = CellPublisher::start(cell, session, settings.distribution)?;
            (self.answered_factors(session, network)?, Some(publisher))
        } else {
            (Vec::new(), None)
        };
        let inputs: Vec<InputReport> = controllers.iter().map(|c| c.report().clone()).collect();
        let mut status = None;
        while statuses.wait(&mut status) {
            if let (Some(publisher), Some(status)) = (&mut publisher, &status) {
                publisher.publish(status, &inputs, clock.micros());
            }
        }
        Ok(())
    }

    /// Starts the factors of the guarded robots whose controllers do not use ROS 2.
    fn answered_factors(
        &self,
        session: &RosSession,
        network: &Arc<dyn Network>,
    ) -> Result<Vec<AnsweredFactor>, NetworkError> {
        let Self { cell, settings, guarded, clock, .. } = self;
        let (keys, oldest) = (Keys::new(&cell.name), Micros::from_seconds(cell.monitoring.laws.stale_s));
        let names = guarded.iter().map(|robot| &cell.robots[robot.0].name);
        let start = |name: &String| {
            let topic = Topic::of::<SpeedScalingFactor>(&Ros2Robot::of(name).speed_scaling, settings.distribution);
            let publisher = session.publisher(&topic, Qos::latched(), Urgency::RealTime)?;
            AnsweredFactor::start(&**network, &keys.speed_override(name), *clock, oldest, publisher)
        };
        names.filter(|name| settings.robot(name).is_none()).map(start).collect()
    }
}
