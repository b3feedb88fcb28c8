//! Smallest robot that a monitor can watch: a linear axis with a TCP, in front of a sphere.

use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
use elbowroom_monitor::{
    Configuration, ConfigurationParts, Guards, Laws, Monitor, Region, Snapshot, TickReport, Volume,
};
use elbowroom_spatial::{Pose, Vec3};

/// Time between ticks, s.
pub const TICK_S: f64 = 0.002;
/// Position at which the sphere's surface meets the axis, m.
const BORDER_M: f64 = 1.5;

/// The axis under its monitor, in simulated time.
pub struct Rail {
    monitor: Monitor,
    ticks: u32,
    /// Distance of the TCP from the sphere, negative inside, m.
    pub distance_m: f64,
}

impl Rail {
    /// Creates a rail whose sphere has this warning zone and hysteresis (m); channel 0 is on in the warning zone.
    pub fn new(laws: Laws, warning_m: f64, hysteresis_m: f64, distance_m: f64) -> Result<Self, String> {
        let axis = Joint {
            name: "rail".into(),
            kind: JointKind::Prismatic,
            parent: LinkId(0),
            child: LinkId(1),
            origin: Pose::IDENTITY,
            axis: Vec3::X,
            limits: Limits::range(0.0, 2.0),
            mimic: None,
        };
        let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![axis]);
        let mut ball = Region::sphere("ball", Vec3::X * (BORDER_M + 0.5), 0.5).warning(warning_m).guards(Guards::TCP);
        ball.hysteresis_m = hysteresis_m;
        ball.warning_output = Some(0);
        let config = ConfigurationParts {
            robot: "rail".into(),
            base_in_world: Pose::IDENTITY,
            chain: chain.map_err(|e| e.to_string())?,
            volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)],
            regions: vec![ball],
            sources: vec![],
            grids: vec![],
            laws,
        };
        let config = Configuration::new(config).map_err(|e| e.to_string())?;
        let monitor = Monitor::new(config, None).map_err(|e| e.to_string())?;
        Ok(Self { monitor, ticks: 0, distance_m })
    }

    /// Time, s.
    pub fn time_s(&self) -> f64 {
        f64::from(self.ticks) * TICK_S
    }

    /// Computes the speed override of the monitor for a stationary robot whose program moves at `intent` (m/s) at
    /// override 1.
    pub fn override_at_rest(&mut self, intent: f64) -> f64 {
        let (q, intent) = ([BORDER_M - self.distance_m], [intent]);
        let stationary = Snapshot::stationary(self.time_s(), &q);
        self.monitor.tick(&Snapshot { qd: &[0.0], intent: Some(&intent), ..stationary }).speed_override
    }

    /// Runs one tick, then one step of the program, which requests `intent` (m/s, positive towards the sphere) at
    /// override 1.
    pub fn step(&mut self, intent: f64) -> TickReport {
        let (q, intent) = ([BORDER_M - self.distance_m], [intent]);
        let report = self.monitor.tick(&Snapshot { intent: Some(&intent), ..Snapshot::stationary(self.time_s(), &q) });
        self.distance_m -= report.speed_override * intent[0] * TICK_S;
        self.ticks += 1;
        report
    }
}
