//! Reports robots that are silent, and pauses of the arbiter itself: reasons why grants pause.

use elbowroom_interlock::Micros;
use elbowroom_monitor::RobotSlot;

/// Time without a message after which a robot is reported as silent.
const SILENT: Micros = Micros(1_000_000);
/// Interval between looks above which the arbiter itself was held up.
const HELD_UP: Micros = Micros(300_000);
/// Like [`SILENT`], for a robot without any message yet: longer, as the processes of a cell start one after another.
const NEVER_HEARD: Micros = Micros(5_000_000);

/// Time of the last message of each robot that can be in an exchange region, and which robots were reported.
pub(crate) struct SilenceWatch {
    /// Per robot of the cell; `None` for a robot without exchange regions.
    robots: Vec<Option<Heard>>,
    looked: Micros,
}

struct Heard {
    name: String,
    /// Time of the last message; before the first, the start of this watch.
    at: Micros,
    has_spoken: bool,
    is_named: bool,
}

impl SilenceWatch {
    /// Starts the watch. `names` has `None` for robots without exchange regions: their guards send nothing to an arbiter.
    pub(crate) fn new(names: impl Iterator<Item = Option<String>>, now: Micros) -> Self {
        let heard = |name: String| Heard { name, at: now, has_spoken: false, is_named: false };
        Self { robots: names.map(|name| name.map(heard)).collect(), looked: now }
    }

    /// Records a message of a robot; returns a report if the robot was reported as silent.
    pub(crate) fn heard(&mut self, robot: RobotSlot, now: Micros) -> Option<String> {
        let robot = self.robots.get_mut(robot.0)?.as_mut()?;
        let silence = now - std::mem::replace(&mut robot.at, now);
        let again = if std::mem::replace(&mut robot.has_spoken, true) { "again, " } else { "" };
        let was_named = std::mem::take(&mut robot.is_named);
        was_named.then(|| format!("robot {}: heard {again}after {:.1} s", robot.name, seconds(silence)))
    }

    /// Records that a silent robot was cleared: regions are granted without it, so its silence is not reported.
    pub(crate) fn cleared(&mut self, robot: RobotSlot) {
        if let Some(Some(robot)) = self.robots.get_mut(robot.0) {
            robot.is_named = true;
        }
    }

    /// Returns the present reports. To be called several times a second.
    pub(crate) fn look(&mut self, now: Micros) -> Vec<String> {
        let gap = now - std::mem::replace(&mut self.looked, now);
        let robots = self.robots.iter_mut().flatten();
        if gap >= HELD_UP {
            // Messages sent during the gap still wait to be read: that is not silence of the robots.
            robots.filter(|robot| !robot.is_named).for_each(|robot| robot.at = now);
            let line = || format!("the arbiter did not run for {:.1} s, and granted nothing meanwhile", seconds(gap));
            return (gap >= SILENT).then(line).into_iter().collect();
        }
        let is_silent = |robot: &&mut Heard| {
            let longest = if robot.has_spoken { SILENT } else { NEVER_HEARD };
            !robot.is_named && now - robot.at >= longest
        };
        robots.filter(is_silent).map(|robot| robot.name_silent(now)).collect()
    }
}

impl Heard {
    fn name_silent(&mut self, now: Micros) -> String {
        self.is_named = true;
        let since = if self.has_spoken { "" } else { ", since this arbiter has started" };
        format!(
            "robot {}: not heard for {:.1} s{since}: no region that it may be in is granted to another one",
            self.name,
            seconds(now - self.at)
        )
    }
}

fn seconds(micros: Micros) -> f64 {
    micros.0 as f64 * 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: u64 = 100_000;

    /// Looks every 0.1 s, with messages of the robots in `speaks`; returns the lines with their ticks of 0.1 s.
    fn told(seconds: u64, speaks: impl Fn(usize, u64) -> bool, runs: impl Fn(u64) -> bool) -> Vec<(u64, String)> {
        let names = [Some("left"), Some("right"), None].map(|name| name.map(str::to_owned));
        let (mut watch, mut lines) = (SilenceWatch::new(names.into_iter(), Micros(0)), Vec::new());
        for tick in (1..=seconds * 10).filter(|tick| runs(*tick)) {
            let now = Micros(tick * TICK);
            let mut say = |line: String| lines.push((tick, line));
            watch.look(now).into_iter().for_each(&mut say);
            let heard = (0..2).filter(|robot| speaks(*robot, tick));
            heard.filter_map(|robot| watch.heard(RobotSlot(robot), now)).for_each(&mut say);
        }
        lines
    }

    #[test]
    fn silence_is_said_once_and_its_end_too() {
        let lines = told(20, |robot, tick| robot == 0 || !(50..90).contains(&tick), |_| true);
        let [silent, again] = &lines[..] else { panic!("{lines:?}") };
        let text = "robot right: not heard for 1.0 s: no region that it may be in is granted to another one";
        assert_eq!((silent.0, silent.1.as_str()), (59, text));
        assert_eq!((again.0, again.1.as_str()), (90, "robot right: heard again, after 4.1 s"));
    }

    #[test]
    fn who_was_never_heard_has_more_time_and_nobody_is_silent_because_the_arbiter_stood() {
        let lines = told(20, |robot, _| robot == 0, |_| true);
        assert!(
            matches!(&lines[..], [(50, line)] if line.contains("5.0 s, since this arbiter has started")),
            "{lines:?}"
        );
        let lines = told(20, |robot, tick| robot == 0 || tick >= 150, |_| true);
        assert!(matches!(&lines[..], [_, (150, line)] if line == "robot right: heard after 15.0 s"), "{lines:?}");
        assert!(told(20, |_, _| true, |tick| tick % 10 < 3).is_empty(), "held up for 0.8 s again and again");
        let lines = told(20, |_, _| true, |tick| !(50..112).contains(&tick));
        assert_eq!(lines, [(112, "the arbiter did not run for 6.3 s, and granted nothing meanwhile".to_owned())]);
    }

    #[test]
    fn who_was_cleared_is_not_in_the_way() {
        let mut watch = SilenceWatch::new([Some("left".to_owned())].into_iter(), Micros(0));
        watch.cleared(RobotSlot(0));
        assert!((1..100).all(|tick| watch.look(Micros(tick * TICK)).is_empty()));
        assert_eq!(watch.heard(RobotSlot(0), Micros(100 * TICK)).as_deref(), Some("robot left: heard after 10.0 s"));
    }
}
