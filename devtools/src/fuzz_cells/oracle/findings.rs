//! Findings of the oracle in a recording.

/// Depth beyond which a surface counts as crossed, m; rounding errors are smaller.
pub const TOLERANCE_M: f64 = 1e-6;

/// A violation in a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// A robot drove into a forbidden region, coming from outside.
    Entry { robot: usize, region: usize, t_s: f64, speed: f64 },
    /// A robot was in a forbidden region although `check` says that entry is excluded.
    Excluded { robot: usize, region: usize, t_s: f64, speed: f64 },
    /// Two robots were inside one exchange region.
    TwoInside { region: usize, robots: [usize; 2], t_s: f64 },
    /// Robots wait for one another for ever, and the recording does not report it.
    SilentDeadlock { robots: Vec<usize> },
    /// A guided robot was nearer to an object than promised, or inside its shield (negative).
    TooNear { robot: usize, object: usize, t_s: f64, distance_m: f64, least_m: f64 },
    /// The forces of a guided tool gave more energy than they got.
    EnergyMade { robot: usize, t_s: f64, energy_j: f64 },
    /// The shaft of a guided tool left its point of entry, or its depth there, by this distance.
    OffEntry { robot: usize, t_s: f64, off_m: f64 },
    /// The work-piece of a virtual robot moved in the hand that holds it.
    NotHeld { robot: usize, t_s: f64, by_m: f64 },
    /// The work-piece of a virtual robot left its desired path.
    OffPath { t_s: f64, off_m: f64 },
    /// The recorded share of a work-piece that is hidden from a camera, or the time for which it is hidden, is wrong.
    WrongView { t_s: f64, share: f64, recorded: Option<f64> },
    /// A robot touched a box that had stood in view of its sensor from the beginning.
    TouchedSeen { robot: usize, t_s: f64 },
    /// A robot moved although the last picture of its sensor was too old, or none had come yet.
    MovedUnseen { robot: usize, t_s: f64 },
    /// A robot was held for a picture that was not old, or for an obstacle that no picture shows.
    HeldForNothing { robot: usize, t_s: f64 },
    /// A robot of a virtual robot touched something, or one on planned paths an object.
    Touched { robot: usize, t_s: f64 },
    /// An axis of a tool that keeps its direction on a planned move left it.
    Tilted { robot: usize, t_s: f64, off_rad: f64, within_rad: f64 },
    /// The number of a grid is not that of the cell that the robot occupies.
    WrongCell { robot: usize, t_s: f64, number: u64 },
    /// A reading beyond the limits of a joint did not stop its robot, or (`stopped`) one within them did.
    MisreadLimits { robot: usize, joint: usize, t_s: f64, stopped: bool },
    /// A robot in a speed zone had an override above that of the zone.
    TooFastInZone { robot: usize, region: usize, t_s: f64, speed_override: f64, most: f64 },
    /// An output was off while a robot was in the region, or in the warning zone, that switches it on.
    OutputOff { robot: usize, region: usize, t_s: f64, output: u8 },
    /// A robot that plays a recording was off its path, or ahead of its time; behind it is negative.
    OffRecording { robot: usize, t_s: f64, ahead_s: Option<f64> },
    /// A mechanism was slowed down, or a region concerns it.
    Slowed { robot: usize, t_s: f64 },
    /// A joint was faster than it can, by this share of its speed.
    TooFast { robot: usize, t_s: f64, share: f64 },
    /// Something in the cell is not as its file states.
    Misread { table: String, off: f64 },
    /// A move to a pose ended elsewhere, or led elsewhere, by this much (m, rad).
    OffGoal { robot: usize, t_s: f64, off: f64 },
    /// A joint decelerated harder than it can.
    TooHard { robot: usize, joint: usize, t_s: f64, deceleration: f64, limit: f64 },
}

/// Violations, and further counts.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    pub list: Vec<Finding>,
    /// Number of entries that nobody can foresee: into regions that accelerated just before, and by exchanging a tool
    /// into an exchange region if `check` says that this is not excluded.
    pub unforeseen_entries: usize,
    /// Number of sets of robots that wait for one another for ever.
    pub deadlocks: usize,
    pub judged: Judged,
}

/// How much was judged.
#[derive(Debug, Clone, Default)]
pub struct Judged {
    /// Number of pairs of robot and region that were watched for entry.
    pub watched: usize,
    /// Number of pairs of robot and box that a sensor sees, for clouds of points, pictures of depths and cameras.
    pub boxes: [usize; 3],
    /// Number of ticks of robots at which they had to rest because the last picture was too old.
    pub stale_ticks: usize,
    /// Number of times for which robots were held.
    pub holds: usize,
}

impl Judged {
    pub fn add(&mut self, other: &Self) {
        self.watched += other.watched;
        self.boxes.iter_mut().zip(other.boxes).for_each(|(all, more)| *all += more);
        self.stale_ticks += other.stale_ticks;
        self.holds += other.holds;
    }

    /// Whether every kind of sensor was judged.
    pub fn has_all(&self) -> bool {
        self.boxes.iter().all(|boxes| *boxes > 0) && self.stale_ticks > 0 && self.holds > 0
    }
}
