//! `elbowroom control teach`: a region taught at a running robot, compared with the real obstacle before it is used.

use std::io::{BufRead as _, IsTerminal as _, Write as _};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use elbowroom::cell::Units;
use elbowroom::spatial::Vec3;
use elbowroom::spatial::units::{AngleUnit, LengthUnit};
use serde_json::{Value, json};

use super::args::TeachAtRobotArgs;
use super::client::Client;
use crate::output::{Failure, note};
use crate::taught_fence::FEWEST_CORNERS;
use crate::taught_part::part;
use crate::taught_region::{TaughtRegion, TaughtSolid, points_of};
use crate::taught_shape::TaughtShape;

/// Time between two questions where the robot is.
const PERIOD: Duration = Duration::from_millis(200);

/// Where a robot is, m, and whether it moves.
struct Place {
    at: Vec3,
    moves: bool,
}

/// A person at a robot, and the service that knows where the robot is.
pub(super) struct Teacher<'a> {
    args: &'a TeachAtRobotArgs,
    client: &'a Client,
    units: Units,
    /// What is typed, line by line.
    typed: Receiver<String>,
    is_terminal: bool,
}

impl<'a> Teacher<'a> {
    /// Listens to standard input.
    pub(super) fn new(args: &'a TeachAtRobotArgs, client: &'a Client) -> Result<Self, Failure> {
        let now = client.regions()?;
        let units = units(&now)?;
        let names = now["regions"].as_array().into_iter().flatten().filter_map(|r| r["name"].as_str());
        if names.into_iter().any(|name| name == args.region) {
            let what = format!("there is a region `{}` already", args.region);
            return Err(Failure::Wrong(format!("{what}\n  write: another name")));
        }
        let (send, typed) = channel();
        std::thread::spawn(move || {
            let lines = std::io::stdin().lock().lines().map_while(Result::ok);
            for line in lines {
                if send.send(line).is_err() {
                    break;
                }
            }
        });
        Ok(Self { args, client, units, typed, is_terminal: std::io::stderr().is_terminal() })
    }

    /// The table of the region, once the person has taught and accepted it.
    pub(super) fn teach(&self) -> Result<String, Failure> {
        let shape = &self.args.shape;
        let (name, is_temporary) = (self.args.region.as_str(), !self.args.permanent);
        let taught = TaughtRegion { name, shape, units: self.units, is_temporary };
        taught.check_arguments()?;
        if shape.shape == TaughtShape::Fence && self.args.add {
            let what = "a fence is not added to a running cell";
            let help = "--shape fence without --add, and the table into the cell file";
            return Err(Failure::Wrong(format!("{what}\n  write: {help}")));
        }
        self.place()?;
        loop {
            let points = self.points(&taught)?;
            let made = taught.solid(&points).and_then(|solid| Ok((taught.built(&solid, &points)?, solid)));
            let (built, solid): (Vec<String>, TaughtSolid) = match made {
                Ok(made) => made,
                Err(why) => {
                    note(format_args!("{why}: teach the points again"));
                    continue;
                }
            };
            built.iter().for_each(note);
            let text = taught.toml(&solid);
            taught.check(&text, Path::new("the taught points"))?;
            if self.is_accepted(&text)? {
                return Ok(text);
            }
        }
    }

    /// The places to which the person moves the robot.
    fn points(&self, taught: &TaughtRegion<'_>) -> Result<Vec<Vec3>, Failure> {
        let shape = self.args.shape.shape;
        let wanted = points_of(shape);
        let is_fence = shape == TaughtShape::Fence;
        let mut points = Vec::new();
        while is_fence || points.len() < wanted.len() {
            let count = points.len() + 1;
            let may_close = is_fence && count > FEWEST_CORNERS;
            let number = if is_fence { format!("corner {count}") } else { format!("{count} of {}", wanted.len()) };
            let point = wanted[if is_fence { 0 } else { count - 1 }];
            match self.point(taught, &points, [&number, point], may_close)? {
                Some(at) => points.push(at),
                None => break,
            }
        }
        Ok(points)
    }

    /// The place of one more point; `None` if the person closes the fence.
    fn point(
        &self,
        taught: &TaughtRegion<'_>,
        before: &[Vec3],
        [number, point]: [&str; 2],
        may_close: bool,
    ) -> Result<Option<Vec3>, Failure> {
        let (robot, part) = (&self.args.robot, part(taught, before));
        let what = if self.args.shape.flange { "flange" } else { "TCP" };
        let (known, closes) = if may_close { (&["", "c"][..], "c closes the fence, ") } else { (&[""][..], "") };
        note(format_args!("{number}: move the {what} of {robot} to {point}, then press Enter ({closes}q ends)"));
        let from_part = || part.as_ref().and_then(|part| self.distance(&part.toml, part.what).ok());
        let typed = self.wait(known, || {
            let text = self.place().map(|p| format!("{what} at {}", self.shown(p.at)))?;
            Ok(from_part().map_or_else(|| text.clone(), |distance| format!("{text}; {distance}")))
        })?;
        if typed == "c" {
            return Ok(None);
        }
        let Place { at, moves } = self.place()?;
        note(format_args!("{number}: {point} at {}", self.shown(at)));
        from_part().into_iter().for_each(note);
        if moves {
            note(format_args!("{robot} is moving: the point is where it was a moment ago"));
        }
        Ok(Some(at))
    }

    /// The distance of the robot from a region or a part of one, in words.
    fn distance(&self, table: &str, what: &str) -> Result<String, Failure> {
        let robot = &self.args.robot;
        let request = json!({ "robot": robot, "region": self.args.region, "toml": table });
        let answer = self.client.distance(&request)?;
        Ok(match answer["distance_m"].as_f64() {
            Some(metres) => format!("{robot} is {} from {what}", self.units.show_length(metres)),
            None => format!("{robot} is not heard"),
        })
    }

    /// Shows the distance of the robot from the region, so that it can be compared with the obstacle; returns whether the
    /// person takes the region.
    fn is_accepted(&self, text: &str) -> Result<bool, Failure> {
        let robot = &self.args.robot;
        let distance = || self.distance(text, "the region");
        note("compare it with the obstacle: move the robot there and see its distance from the region");
        note("Enter takes the region, r teaches it again, q ends");
        if self.args.add && !self.args.off {
            note(format_args!("before Enter, move {robot} out of the region and its reach of braking: it will be on"));
        }
        note(distance()?);
        let typed = self.wait(&["", "r"], distance)?;
        note(distance()?);
        Ok(typed != "r")
    }

    /// Waits for one of the known answers; meanwhile a terminal shows what is so now.
    fn wait(&self, known: &[&str], now: impl Fn() -> Result<String, Failure>) -> Result<String, Failure> {
        loop {
            match self.typed.recv_timeout(PERIOD) {
                Ok(line) => match line.trim() {
                    "q" => return Err(Failure::Wrong("nothing was taught: ended by q".into())),
                    other if known.contains(&other) => return Ok(other.to_owned()),
                    other => {
                        let more = [&["Enter"], &known[1..]].concat().join(", ");
                        note(format_args!("`{other}` is not an answer here: {more} or q"));
                    }
                },
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(Failure::Wrong("nothing was taught: the standard input has ended".into()));
                }
                Err(RecvTimeoutError::Timeout) if self.is_terminal => {
                    // A moment without an answer ends nothing: the points stay.
                    let text = now().unwrap_or_else(|_| "no answer".into());
                    // A failed write is ignored, as for all messages.
                    let _ = write!(std::io::stderr().lock(), "\r\x1b[K{text}\r");
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    /// Where the TCP or the flange of the robot is, in the world.
    fn place(&self) -> Result<Place, Failure> {
        let document = self.client.regions()?;
        let robots = document["robots"].as_array().map_or(&[][..], Vec::as_slice);
        let name = &self.args.robot;
        let robot = robots.iter().find(|r| r["name"] == name.as_str()).ok_or_else(|| {
            let names: Vec<&str> = robots.iter().filter_map(|r| r["name"].as_str()).collect();
            Failure::Wrong(format!("there is no robot `{name}`\n  write: --robot with one of {}", names.join(", ")))
        })?;
        let frame = &robot[if self.args.shape.flange { "flange" } else { "tcp" }];
        let coordinate = |i: usize| frame["position_m"][i].as_f64();
        let [Some(x), Some(y), Some(z)] = [0, 1, 2].map(coordinate) else {
            let help = "connect its controller, or `elbowroom live CELL --simulate` for a try";
            return Err(Failure::Wrong(format!("{name}: its controller is not heard\n  write: {help}")));
        };
        Ok(Place { at: Vec3::new(x, y, z), moves: robot["moves"] == true })
    }

    fn shown(&self, p: Vec3) -> String {
        let per_unit = self.units.length.to_metres(1.0);
        let [x, y, z] = p.to_array().map(|v| ((v / per_unit) * 1e4).round() / 1e4);
        format!("[{x}, {y}, {z}] {}", self.units.length.symbol())
    }
}

/// The units of the cell file, as the service names them.
fn units(document: &Value) -> Result<Units, Failure> {
    let named = document["units"]["length"].as_str().zip(document["units"]["angle"].as_str());
    let found = named.and_then(|(length, angle)| {
        Some(Units { length: LengthUnit::parse(length)?, angle: AngleUnit::parse(angle)? })
    });
    found.ok_or_else(|| Failure::Wrong("the service does not name its units: it is of another version".into()))
}
