//! Strangers on the network of a cell: without its key neither their own messages nor recorded ones are accepted.

use std::sync::{Arc, Mutex};

use elbowroom_cell::RegionEdit;
use elbowroom_cell::access::NetworkKey;
use elbowroom_live::network::{
    AuthenticatedNetwork, LocalNetwork, Network, Publisher, Subscription, Urgency, ZenohNetwork, ZenohSettings,
};
use elbowroom_live::{
    Clock, ControllerClient, ControllerState, Keys, RegionTable, ServiceOptions, SwitchRequest, boot_number,
    configuration_number,
};
use elbowroom_status::RobotStatus;
use elbowroom_testkit::network::eventually;
use elbowroom_testkit::random::split_mix;

use crate::common::control_setup::{ControlSetup, rails};

const CELL: &str = concat!(rails!("900", "450, 0, 1900"), "[monitor]\nstale_ms = 200\n");
const PREFIX: &str = "elbowroom/cell";
const KEYS: [&str; 2] = ["elbowroom/cell/a/joint_states", "elbowroom/cell/regions"];
/// Keys of all messages that a stranger receives.
const CABLE: [&str; 4] = [KEYS[0], KEYS[1], "elbowroom/cell/proof/question", "elbowroom/cell/proof/answer"];

type Log = Arc<Mutex<Vec<Vec<u8>>>>;

/// Records all messages of a key.
fn log(network: &dyn Network, key: &str) -> (Log, Subscription) {
    let log = Log::default();
    let entries = log.clone();
    let keep = move |bytes: &[u8]| entries.lock().unwrap().push(bytes.to_vec());
    (log, network.subscribe(key, Box::new(keep)).unwrap())
}

/// A process that sends under both keys and one that listens to both; each may start again.
struct Rig {
    cable: LocalNetwork,
    key: NetworkKey,
    sender: Option<(AuthenticatedNetwork, Vec<Box<dyn Publisher>>)>,
    receiver: Option<(AuthenticatedNetwork, Vec<(Log, Subscription)>)>,
    /// Number of the next message, so that all contents differ.
    next: u64,
    /// Number of the first message since the last start of receiver or sender.
    since: u64,
    state: u64,
}

impl Rig {
    fn process(&self) -> AuthenticatedNetwork {
        AuthenticatedNetwork::new(Arc::new(self.cable.clone()), &self.key, PREFIX, None).unwrap()
    }

    fn below(&mut self, bound: usize) -> usize {
        self.state = split_mix(&mut self.state);
        self.state as usize % bound
    }

    fn start_sender(&mut self) {
        self.sender = None;
        let network = self.process();
        let publishers = KEYS.map(|key| network.publisher(key, Urgency::RealTime).unwrap()).into();
        (self.sender, self.since) = (Some((network, publishers)), self.next);
    }

    /// Starts the receiver again, or only its subscriptions.
    fn start_receiver(&mut self) {
        let network = self.receiver.take().map(|(network, _)| network).filter(|_| self.below(2) == 0);
        let network = network.unwrap_or_else(|| self.process());
        let logs = KEYS.map(|key| log(&network, key)).into();
        (self.receiver, self.since) = (Some((network, logs)), self.next);
    }

    /// Sends a message; returns its number.
    fn send(&mut self, key: usize) -> u64 {
        let number = self.next;
        self.next += 1;
        if let Some((_, publishers)) = &mut self.sender {
            publishers[key].publish(&contents(key, number));
        }
        number
    }

    fn heard(&self, key: usize) -> Vec<Vec<u8>> {
        self.receiver.as_ref().unwrap().1[key].0.lock().unwrap().clone()
    }

    /// Sends everything that a stranger can make from recorded messages.
    fn attack(&mut self, recorded: &[Log], strange: &AuthenticatedNetwork) {
        let (of, under) = (self.below(CABLE.len()), self.below(CABLE.len()));
        let recorded = recorded[of].lock().unwrap().clone();
        let whole: Vec<&Vec<u8>> = recorded.iter().filter(|bytes| !bytes.is_empty()).collect();
        if whole.is_empty() {
            return;
        }
        let mut bytes = whole[self.below(whole.len())].clone();
        match self.below(5) {
            0 => return self.cable.publisher(CABLE[of], Urgency::RealTime).unwrap().publish(&bytes),
            1 => {
                let (at, bit) = (self.below(bytes.len()), self.below(8));
                bytes[at] ^= 1 << bit;
            }
            2 => bytes.truncate(self.below(bytes.len() + 1)),
            3 => bytes = contents(under, self.next),
            _ => return strange.publisher(CABLE[under], Urgency::RealTime).unwrap().publish(&bytes),
        }
        self.cable.publisher(CABLE[under], Urgency::RealTime).unwrap().publish(&bytes);
    }

    /// Checks that no message is accepted under another key, twice, out of order, or from before a start.
    fn check(&self) {
        for key in 0..KEYS.len() {
            let heard = self.heard(key);
            let numbers: Vec<u64> = heard.iter().map(|b| u64::from_le_bytes(b[1..].try_into().unwrap())).collect();
            assert!(
                heard.iter().all(|b| usize::from(b[0]) == key) && numbers.is_sorted_by(|a, b| a < b),
                "{numbers:?}"
            );
        }
    }
}

fn contents(key: usize, number: u64) -> Vec<u8> {
    [&[key as u8][..], &number.to_le_bytes()].concat()
}

#[test]
fn nothing_is_heard_that_a_stranger_sends_changes_moves_or_repeats() {
    for seed in 0..200_u64 {
        let key = NetworkKey::generate().unwrap();
        let cable = LocalNetwork::default();
        let (logs, _recording): (Vec<Log>, Vec<Subscription>) = CABLE.map(|key| log(&cable, key)).into_iter().unzip();
        let mut rig = Rig { cable, key, sender: None, receiver: None, next: 1, since: 1, state: seed };
        let other = NetworkKey::generate().unwrap();
        let strange = AuthenticatedNetwork::new(Arc::new(rig.cable.clone()), &other, PREFIX, None).unwrap();
        rig.start_sender();
        rig.start_receiver();
        for _ in 0..200 {
            match rig.below(40) {
                0 => rig.start_sender(),
                1 => rig.start_receiver(),
                2 => {
                    // The sender has ended: only its recordings remain.
                    rig.sender = None;
                    rig.start_receiver();
                    (0..40).for_each(|_| rig.attack(&logs, &strange));
                    assert!((0..2).all(|key| rig.heard(key).is_empty()), "seed {seed}");
                    rig.start_sender();
                }
                3..20 => rig.attack(&logs, &strange),
                _ => {
                    let key = rig.below(2);
                    let is_first = rig.next == rig.since;
                    let number = rig.send(key);
                    // A process must prove itself with its first message.
                    let is_heard = rig.heard(key).last() == Some(&contents(key, number));
                    assert!(is_heard || is_first, "seed {seed}: {number} is not heard");
                }
            }
            rig.check();
        }
    }
}

/// Returns whether a region is active in the last received status of the left robot.
fn active(statuses: &Log, region: &str) -> Option<bool> {
    let last = statuses.lock().unwrap().last().cloned()?;
    let status: RobotStatus = serde_json::from_slice(&last).ok()?;
    status.regions.iter().find(|r| r.name == region).map(|r| r.active)
}

/// Starts a service in which programs may switch regions, and a connection to its network.
fn service(network_key: Option<NetworkKey>) -> (ControlSetup, Arc<ZenohNetwork>) {
    let setup = ControlSetup::new(CELL, true, ServiceOptions { network_key, ..ServiceOptions::default() });
    let connect = Some(setup.listen.clone());
    let cable = ZenohNetwork::open(&ZenohSettings { listen: None, connect }).unwrap();
    (setup, Arc::new(cable))
}

/// Controller of the left robot, which does not move.
struct Controller {
    client: ControllerClient,
    clock: Clock,
    publisher: Box<dyn Publisher>,
}

impl Controller {
    fn new(network: &dyn Network, setup: &ControlSetup) -> Self {
        let publisher = network.publisher(&Keys::new("rails").joint_states("left"), Urgency::RealTime).unwrap();
        let client = ControllerClient::new(boot_number(), configuration_number(&setup.cell));
        Self { client, clock: Clock::start(), publisher }
    }

    /// Sends the joint state, and waits for 20 ms.
    fn step(&mut self) {
        let state = ControllerState { q: &[0.1], qd: &[0.0], programmed_override: 1.0, ..ControllerState::default() };
        self.publisher.publish(self.client.joint_state(self.clock.micros(), &state));
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
}

fn publish(network: &dyn Network, key: &str, message: &impl serde::Serialize) {
    network.publisher(key, Urgency::RealTime).unwrap().publish(&serde_json::to_vec(message).unwrap());
}

fn is_on(setup: &ControlSetup) -> bool {
    setup.region("cart").unwrap()["active"] == true
}

/// Documented in `docs/security.md`: a hostile process on the cell's network.
#[test]
fn a_stranger_on_the_network_switches_no_region() {
    let key = NetworkKey::generate().unwrap();
    let keys = Keys::new("rails");
    let on = SwitchRequest { robot: "left".into(), region: "cart".into(), active: true };
    // A table that claims to be the newest: without the key every node accepts it.
    let newest = |setup: &ControlSetup| {
        let table = RegionTable { revision: (u64::MAX / 2, 1), ..RegionTable::initial(&setup.cell).all_on() };
        table.message(&setup.cell)
    };
    for network_key in [None, Some(key)] {
        let is_open = network_key.is_none();
        let (setup, stranger) = service(network_key.clone());
        let friend: Arc<dyn Network> = match &network_key {
            None => stranger.clone(),
            Some(key) => Arc::new(AuthenticatedNetwork::new(stranger.clone(), key, &keys.prefix(), None).unwrap()),
        };
        let (statuses, _subscription) = log(&*friend, &keys.status("left"));
        let mut controller = Controller::new(&*friend, &setup);
        eventually("the node hears the table", || {
            controller.step();
            active(&statuses, "cart") == Some(false)
        });
        for _ in 0..20 {
            publish(&*stranger, &keys.switch(), &on);
            publish(&*stranger, &keys.regions(), &newest(&setup));
            controller.step();
        }
        assert_eq!(is_on(&setup), is_open);
        assert_eq!(active(&statuses, "cart"), Some(is_open));
        let is_reported = || setup.events.lock().unwrap().iter().any(|e| e.contains("a stranger is on its network"));
        assert_eq!(is_reported(), !is_open);
        if is_open {
            continue;
        }
        // A process with the key is accepted; a recording of its messages is of no use.
        let (recorded, _subscription) = log(&*stranger, &keys.switch());
        eventually("a program with the key switches", || {
            publish(&*friend, &keys.switch(), &on);
            std::thread::sleep(std::time::Duration::from_millis(20));
            is_on(&setup)
        });
        assert_eq!(switch_off(&setup), 200);
        let recorded = recorded.lock().unwrap().clone();
        assert!(!recorded.is_empty());
        let mut publisher = stranger.publisher(&keys.switch(), Urgency::RealTime).unwrap();
        recorded.iter().cycle().take(20).for_each(|bytes| publisher.publish(bytes));
        std::thread::sleep(std::time::Duration::from_millis(300));
        assert!(!is_on(&setup), "a recording was obeyed");
    }
}

/// Without a key a stranger can forge many messages, but never switch off, move or remove a permanent region.
#[test]
fn a_permanent_region_stays_whatever_anybody_says() {
    let (setup, stranger) = service(None);
    let keys = Keys::new("rails");
    let (statuses, _subscription) = log(&*stranger, &keys.status("left"));
    let mut controller = Controller::new(&*stranger, &setup);
    eventually("the node hears the table", || {
        controller.step();
        active(&statuses, "cart") == Some(false)
    });
    let off = SwitchRequest { robot: "left".into(), region: "wall".into(), active: false };
    let table = |revision: u64, edits: Vec<RegionEdit>| {
        let mut table =
            RegionTable { revision: (u64::MAX / 2, revision), ..RegionTable::initial(&setup.cell).all_on() };
        table.is_editable = !edits.is_empty();
        table.edits = edits;
        let mut message = table.message(&setup.cell);
        message.regions.iter_mut().filter(|(name, _)| name == "wall").for_each(|(_, on)| *on = false);
        message
    };
    let removed = RegionEdit { name: "wall".into(), table: None };
    let moved = RegionEdit { name: "wall".into(), table: Some(FAR.into()) };
    for (revision, edits) in [Vec::new(), vec![removed], vec![moved]].into_iter().enumerate() {
        for _ in 0..20 {
            publish(&*stranger, &keys.switch(), &off);
            publish(&*stranger, &keys.regions(), &table(revision as u64, edits.clone()));
            controller.step();
            assert_eq!(active(&statuses, "wall"), Some(true), "{edits:?}");
        }
    }
    assert_eq!(setup.region("wall").unwrap()["active"], true);
}

/// Keys of a region far from all robots.
const FAR: &str = "shape = \"sphere\"\ncentre = [0, 9000, 9000]\nradius = 100\nwarning = 100\n";

/// Anybody may send a datagram: joint values are accepted from datagrams, tables of regions are not.
#[test]
fn no_datagram_says_which_regions_there_are() {
    let udp = elbowroom_testkit::network::free_address();
    let key = NetworkKey::generate().unwrap();
    let options =
        ServiceOptions { network_key: Some(key.clone()), udp: Some(udp.clone()), ..ServiceOptions::default() };
    let setup = ControlSetup::new(CELL, false, options);
    let (keys, connect) = (Keys::new("rails"), Some(setup.listen.clone()));
    let cable = Arc::new(ZenohNetwork::open(&ZenohSettings { listen: None, connect }).unwrap());
    let friend = AuthenticatedNetwork::new(cable, &key, &keys.prefix(), None).unwrap();
    let (statuses, _subscription) = log(&friend, &keys.status("left"));
    let mut controller = Controller::new(&friend, &setup);
    eventually("the node hears the table", || {
        controller.step();
        active(&statuses, "cart") == Some(false)
    });
    let table = RegionTable { revision: (u64::MAX / 2, 1), ..RegionTable::initial(&setup.cell).all_on() };
    let (key, table) = (keys.regions(), serde_json::to_vec(&table.message(&setup.cell)).unwrap());
    let datagram = [&b"EU\x01\x02"[..], &[key.len() as u8], key.as_bytes(), &table].concat();
    let stranger = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    for _ in 0..20 {
        stranger.send_to(&datagram, &udp).unwrap();
        controller.step();
        assert_eq!(active(&statuses, "cart"), Some(false), "a datagram was believed");
    }
}

fn switch_off(setup: &ControlSetup) -> u16 {
    let request = serde_json::json!({ "region": "cart", "active": false });
    setup.change(crate::common::control_setup::PROGRAMMER, "/switch", &request).0
}
