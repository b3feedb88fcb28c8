//! Operator who switches the temporary regions at random, and the condition under which a region counts as on.

use std::error::Error;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use elbowroom_live::network::{Network, Publisher, Subscription, Urgency};
use elbowroom_live::{Keys, RegionTableMessage, SwitchRequest};
use elbowroom_testkit::random::{split_mix, unit};

use crate::cell::{cart, name};

/// Shortest and longest time for which a region is on, and off, s.
const ON_S: [f64; 2] = [0.5, 6.0];
const OFF_S: [f64; 2] = [3.0, 20.0];
/// Interval at which a request is repeated until the table shows it.
const REPEAT: Duration = Duration::from_millis(100);
/// Time after the table shows a region as on: a node that has not received it guards against all regions after a
/// second, and its robot stops within 0.2 s, after 0.14 s without news.
const SURELY_ON: Duration = Duration::from_millis(1500);

/// Requests and received state of the temporary region of one robot.
#[derive(Debug, Clone, Copy, Default)]
struct Cart {
    is_wanted: bool,
    is_on: bool,
    /// Time since which the table shows it as on; `None` from the request to switch it off.
    on_since: Option<Instant>,
}

/// The temporary regions, one per robot.
pub struct Switches {
    carts: Arc<Mutex<Vec<Cart>>>,
    requests: Mutex<Box<dyn Publisher>>,
    _table: Subscription,
}

fn lock(carts: &Mutex<Vec<Cart>>) -> MutexGuard<'_, Vec<Cart>> {
    carts.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Switches {
    pub fn listen(keys: &Keys, robots: usize, network: &dyn Network) -> Result<Self, Box<dyn Error>> {
        // Until the table is received the regions may be on.
        let carts = Arc::new(Mutex::new(vec![Cart { is_on: true, ..Cart::default() }; robots]));
        let heard = carts.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            let Ok(table) = serde_json::from_slice::<RegionTableMessage>(bytes) else { return };
            for (robot, cart_now) in lock(&heard).iter_mut().enumerate() {
                let Some((_, is_on)) = table.regions.iter().find(|(region, _)| *region == cart(robot)) else {
                    continue;
                };
                cart_now.is_on = *is_on;
                let since = cart_now.on_since.unwrap_or_else(Instant::now);
                cart_now.on_since = (*is_on && cart_now.is_wanted).then_some(since);
            }
        });
        let requests = Mutex::new(network.publisher(&keys.switch(), Urgency::RealTime)?);
        Ok(Self { carts, requests, _table: network.subscribe(&keys.regions(), handler)? })
    }

    /// Whether the temporary region of this robot has been on for so long that no fault excuses an entry.
    pub fn is_surely_on(&self, robot: usize) -> bool {
        lock(&self.carts)[robot].on_since.is_some_and(|since| since.elapsed() > SURELY_ON)
    }

    /// Switches until the time is over; returns how often regions were requested to be on.
    pub fn run(&self, time: Duration, seed: u64) -> u64 {
        let (began, mut random, mut count) = (Instant::now(), seed ^ 0x5eed, 0);
        let mut between = |[shortest, longest]: [f64; 2]| {
            Duration::from_secs_f64(shortest + (longest - shortest) * unit(split_mix(&mut random)))
        };
        let robots = lock(&self.carts).len();
        let mut next: Vec<Instant> = (0..robots).map(|_| began + between(OFF_S)).collect();
        while began.elapsed() < time {
            for (robot, next) in next.iter_mut().enumerate().filter(|(_, next)| Instant::now() >= **next) {
                let is_wanted = self.flip(robot);
                count += u64::from(is_wanted);
                *next = Instant::now() + between(if is_wanted { ON_S } else { OFF_S });
            }
            self.request();
            std::thread::sleep(REPEAT);
        }
        count
    }

    fn flip(&self, robot: usize) -> bool {
        let cart = &mut lock(&self.carts)[robot];
        (cart.is_wanted, cart.on_since) = (!cart.is_wanted, None);
        cart.is_wanted
    }

    /// Sends the requests that are not obeyed yet.
    fn request(&self) {
        let carts = lock(&self.carts).clone();
        for (robot, Cart { is_wanted, .. }) in carts.iter().enumerate().filter(|(_, c)| c.is_wanted != c.is_on) {
            let request = SwitchRequest { robot: name(robot), region: cart(robot), active: *is_wanted };
            if let Ok(json) = serde_json::to_vec(&request) {
                self.requests.lock().unwrap_or_else(PoisonError::into_inner).publish(&json);
            }
        }
    }
}
