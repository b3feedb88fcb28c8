//! `elbowroom control` with a service on the loopback network.

use std::path::Path;

use crate::common::{Answer, answer, command};

fn control(folder: &Path, arguments: &[&str]) -> Answer {
    let mut command = command(folder, &["control"]);
    answer(command.args(arguments).env_remove("ELBOWROOM_SECRET").output().unwrap())
}

/// Makes a file of tokens with one of each role, and a file `ROLE.secret` for each.
fn make_tokens(folder: &Path) {
    for role in ["operator", "programmer", "integrator"] {
        let made = control(folder, &["token", "--role", role, "--name", role, "--file", "tokens.toml"]);
        assert!(made.status == 0, "{}", made.stderr);
        let secret = made.stdout;
        assert_eq!(secret.trim().len(), 64);
        std::fs::write(folder.join(format!("{role}.secret")), &secret).unwrap();
        let kept = std::fs::read_to_string(folder.join("tokens.toml")).unwrap();
        assert!(!kept.contains(secret.trim()) && !made.stderr.contains(secret.trim()));
    }
}

#[test]
fn tokens_are_made_without_a_service_and_wrong_calls_say_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    make_tokens(folder);
    std::fs::write(folder.join("empty.secret"), "").unwrap();
    let cases: [(&[&str], &str); 6] = [
        (
            &["token", "--role", "operator", "--name", "operator", "--file", "tokens.toml"],
            "has a token \"operator\" already",
        ),
        (&["token", "--role", "operator", "--name", " ", "--file", "tokens.toml"], "a token needs a name"),
        (&["regions"], "--secret FILE, or ELBOWROOM_SECRET=FILE"),
        (&["regions", "--secret", "missing.secret"], "missing.secret: cannot be read"),
        (&["regions", "--secret", "empty.secret"], "is no secret"),
        (&["regions", "--secret", "operator.secret", "--at", "127.0.0.1:1"], "the service does not answer"),
    ];
    for (arguments, message) in cases {
        let answer = control(folder, arguments);
        assert!(answer.status == 2 && answer.stderr.contains(message), "{arguments:?}: {}", answer.stderr);
    }
}

#[cfg(feature = "live")]
mod with_a_service {
    use super::*;
    use crate::common::live_process::LiveProcess;
    use elbowroom_testkit::certificate::write_certificate;
    use std::process::Stdio;
    use std::time::{Duration, Instant};

    const CELL: &str = r#"
version = 1
name = "rail"
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
start = [1000]
[region.cart]
shape = "sphere"
centre = [0, 0, 1000]
radius = 100
life = "temporary"
warning = 100
[region.end]
shape = "sphere"
centre = [0, 0, 2500]
radius = 200
warning = 100
"#;

    /// Makes a folder with the cell file, tokens, and their secrets.
    fn cell_and_tokens() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        make_tokens(folder.path());
        std::fs::write(folder.path().join("cell.toml"), CELL).unwrap();
        folder
    }

    /// Starts the whole cell, and returns its control address once it serves.
    fn start(folder: &Path, arguments: &[&str]) -> (LiveProcess, String) {
        start_at(folder, "127.0.0.1:0", arguments)
    }

    fn start_at(folder: &Path, address: &str, arguments: &[&str]) -> (LiveProcess, String) {
        use std::io::{BufRead as _, BufReader};
        let mut command = command(folder, &["live", "cell.toml", "--listen", "127.0.0.1:0", "--for", "100"]);
        command.args(["--control", address, "--tokens", "tokens.toml"]).args(arguments);
        let mut process = LiveProcess(command.stderr(Stdio::piped()).spawn().expect("elbowroom starts"));
        let mut lines = BufReader::new(process.0.stderr.take().unwrap()).lines().map_while(Result::ok);
        let address = lines.find_map(|line| line.strip_prefix("control: ").map(str::to_owned));
        // Later output must not fill the pipe.
        std::thread::spawn(move || lines.for_each(drop));
        (process, address.expect("a control address"))
    }

    /// The list of regions.
    fn regions(folder: &Path, at: &str) -> String {
        control(folder, &["regions", "--at", at, "--secret", "operator.secret"]).stdout
    }

    /// Starts the whole cell with simulated controllers, and waits until they are heard.
    fn start_simulated(folder: &Path) -> (LiveProcess, String) {
        let (process, at) = start(folder, &["--simulate"]);
        let began = Instant::now();
        while regions(folder, &at).contains("not heard") {
            assert!(began.elapsed() < Duration::from_secs(20), "the simulated controller is not heard");
        }
        (process, at)
    }

    #[test]
    fn a_running_cell_is_listed_switched_and_logged() {
        let folder = cell_and_tokens();
        let folder = folder.path();
        let (_process, at) = start(folder, &[]);
        let run = |arguments: &[&str], role: &str| {
            let secret = format!("{role}.secret");
            control(folder, &[arguments, &["--at", &at, "--secret", &secret]].concat())
        };
        // It was never switched off.
        assert!(run(&["regions"], "operator").stdout.contains("temporary  on"));
        assert_eq!(run(&["switch", "cart", "off"], "programmer").status, 0);
        let listed = run(&["regions"], "operator").stdout;
        assert!(listed.contains("cart") && listed.contains("temporary  off"), "{listed}");
        assert!(listed.contains("rail: its controller is not heard"), "{listed}");
        let refused = run(&["switch", "cart", "on"], "operator");
        assert_eq!(refused.status, 2);
        assert!(refused.stderr.contains("takes the programmer class"), "{}", refused.stderr);
        let switched = run(&["switch", "cart", "on", "--note", "cart arrives"], "programmer");
        assert!(switched.status == 0, "{}", switched.stderr);
        assert!(switched.stdout.contains("programmer (programmer): switch region.cart - cart arrives"));
        assert!(switched.stderr.contains("rail: is not heard, so it may be inside"));
        assert!(run(&["regions"], "operator").stdout.contains("temporary  on"));
        let refused = run(&["clear", "rail", "--outside", "cart", "--repeat", "rail"], "integrator");
        assert!(refused.stderr.contains("does not name the exchange regions of `rail`"), "{}", refused.stderr);
        let log = control(folder, &["log", "cell.toml"]).stdout;
        assert!(log.contains("region.cart: active false -> true") && log.lines().count() == 6, "{log}");
        let moved = run(&["move", "cart", "centre=[0, 0, 1900]", "--note", "other dock"], "programmer");
        assert!(moved.status == 0, "{}", moved.stderr);
        assert!(moved.stdout.contains("region.cart: centre [0, 0, 1000] -> [0, 0, 1900]"));
        std::fs::write(folder.join("table.toml"), "[region.table]\nshape = \"sphere\"\ncentre = [0, 900, 0]\nradius = 100\nwarning = 100\nlife = \"temporary\"\n").unwrap();
        let added = run(&["add", "table", "table.toml"], "programmer");
        assert!(added.status == 0 && added.stdout.contains("add region.table"), "{}", added.stderr);
        assert!(run(&["regions"], "operator").stdout.contains("table                forbidden  temporary  on"));
        let refused = run(&["add", "table", "table.toml"], "programmer");
        assert!(refused.stderr.contains("there is a region `table` already"), "{}", refused.stderr);
        let refused = run(&["move", "end", "centre=[0, 0, 2600]"], "integrator");
        assert!(refused.stderr.contains("is permanent and in the cell file"), "{}", refused.stderr);
        assert!(run(&["move", "cart", "nowhere"], "programmer").stderr.contains("is not KEY=VALUE"));
        assert!(run(&["remove", "table"], "programmer").status == 0);
        assert!(!run(&["regions"], "operator").stdout.contains("table "));
        let file = folder.join("cell.control.jsonl");
        let written = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, written.replace("cart arrives", "cart departs") + &written).unwrap();
        let broken = control(folder, &["log", "cell.toml"]);
        assert!(broken.status == 2 && broken.stderr.contains("does not follow the entry before it"));
    }

    /// A client on another computer connects with encryption, or not at all.
    #[test]
    fn a_service_with_a_certificate_is_controlled_from_any_address() {
        let folder = cell_and_tokens();
        let folder = folder.path();
        let listen =
            ["live", "cell.toml", "--listen", "127.0.0.1:0", "--tokens", "tokens.toml", "--control", "0.0.0.0:0"];
        let open = answer(command(folder, &listen).output().unwrap());
        assert!(open.status == 2 && open.stderr.contains("--certificate FILE.pem"), "{}", open.stderr);
        write_certificate(folder, "cell", &["localhost"]);
        write_certificate(folder, "other", &["localhost"]);
        let certificate = ["--certificate", "cell.pem", "--certificate-key", "cell.key.pem"];
        let (_process, at) = start_at(folder, "0.0.0.0:0", &certificate);
        let port = at.rsplit_once(':').unwrap().1;
        let at = format!("localhost:{port}");
        let ask =
            |more: &[&str]| control(folder, &[&["regions", "--at", &at, "--secret", "operator.secret"], more].concat());
        let listed = ask(&["--certificate", "cell.pem"]);
        assert!(listed.status == 0 && listed.stdout.contains("cart"), "{}", listed.stderr);
        for (more, message) in [
            (&[][..], "--certificate FILE.pem as the service has it"),
            (&["--certificate", "other.pem"][..], "the service is not trusted: "),
            (&["--certificate", "missing.pem"][..], "missing.pem: "),
            (&["--certificate", "tokens.toml"][..], "tokens.toml: "),
        ] {
            let refused = ask(more);
            assert!(refused.status == 2 && refused.stderr.contains(message), "{more:?}: {}", refused.stderr);
        }
        // A secret never leaves this computer unencrypted, whether anybody listens or not: this address is unused.
        let far = control(folder, &["regions", "--at", "192.0.2.1:7448", "--secret", "operator.secret"]);
        assert!(far.status == 2 && far.stderr.contains("would travel in the clear"), "{}", far.stderr);
        let other = cell_and_tokens();
        let (_plain, at) = start(other.path(), &[]);
        let certificate_of_another = folder.join("cell.pem");
        let words = ["regions", "--at", &at, "--secret", "operator.secret", "--certificate"];
        let plain = control(other.path(), &[&words[..], &[certificate_of_another.to_str().unwrap()]].concat());
        assert!(plain.status == 2 && plain.stderr.contains("no encrypted service answers"), "{}", plain.stderr);
        let unused = [&["live", "cell.toml", "--listen", "127.0.0.1:0"][..], &certificate].concat();
        let unused = answer(command(folder, &unused).output().unwrap());
        assert!(unused.status == 2 && unused.stderr.contains("neither a page nor a control"), "{}", unused.stderr);
    }

    #[test]
    fn a_region_is_not_switched_on_around_a_simulated_robot() {
        let folder = cell_and_tokens();
        let folder = folder.path();
        let (_process, at) = start_simulated(folder);
        let secret = ["--at", &at, "--secret", "programmer.secret"];
        let off = control(folder, &[&["switch", "cart", "off"][..], &secret].concat());
        assert!(off.status == 0, "{}", off.stderr);
        let refused = control(folder, &[&["switch", "cart", "on"][..], &secret].concat());
        assert_eq!(refused.status, 2);
        let message = refused.stderr;
        assert!(message.contains("robot `rail` is inside region `cart`: its distance is 0 mm"), "{message}");
    }

    /// A dialogue with `control teach`.
    struct Lesson {
        process: LiveProcess,
        said: Box<dyn Iterator<Item = String>>,
    }

    impl Lesson {
        fn start(folder: &Path, at: &str, arguments: &[&str]) -> Self {
            use std::io::{BufRead as _, BufReader};
            let mut command = command(folder, &["control", "teach", "lamp", "--robot", "rail", "--at", at]);
            command.args(["--secret", "programmer.secret"]).args(arguments);
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
            let mut process = LiveProcess(command.spawn().expect("elbowroom starts"));
            let lines = BufReader::new(process.0.stderr.take().unwrap()).lines().map_while(Result::ok);
            Self { process, said: Box::new(lines) }
        }

        /// The next line with these words.
        fn hear(&mut self, words: &str) -> String {
            self.said.find(|line| line.contains(words)).unwrap_or_else(|| panic!("nobody says: {words}"))
        }

        fn type_line(&mut self, line: &str) {
            use std::io::Write as _;
            writeln!(self.process.0.stdin.as_mut().unwrap(), "{line}").unwrap();
        }

        /// The number after these words in the next line that has them.
        fn number(&mut self, words: &str) -> f64 {
            let line = self.hear(words);
            let rest = line.split_once(words).unwrap().1.trim_start_matches(['[', ' ']);
            // Of a place on the rail its height.
            let last = rest.split_once(']').map_or(rest, |(place, _)| place.rsplit(", ").next().unwrap());
            last.split(' ').next().unwrap().parse().unwrap_or_else(|_| panic!("no number: {line}"))
        }

        fn end(mut self) -> (i32, String) {
            use std::io::Read as _;
            let mut text = String::new();
            self.process.0.stdout.take().unwrap().read_to_string(&mut text).unwrap();
            (self.process.0.wait().unwrap().code().unwrap(), text)
        }
    }

    #[test]
    fn a_region_is_taught_at_a_moving_robot_compared_and_added() {
        let folder = cell_and_tokens();
        let folder = folder.path();
        // 20 mm/s, away from the cart.
        let program = "[program.rail]\nsteps = [{ move = \"joint\", to = [2000], speed = 2 }]\n";
        let text = CELL.replace("[region.cart]", &format!("{program}[region.cart]"));
        let text = text.replace("centre = [0, 0, 1000]", "centre = [0, 900, 1000]");
        std::fs::write(folder.join("cell.toml"), text).unwrap();
        let (_process, at) = start_simulated(folder);
        let mut lesson = Lesson::start(folder, &at, &["--shape", "sphere", "--warning", "20", "--add", "--off"]);
        lesson.hear("1 of 2: move the TCP of rail to the centre");
        lesson.type_line("");
        let centre = lesson.number("the centre at ");
        lesson.hear("2 of 2: move the TCP of rail to a point on the surface");
        std::thread::sleep(Duration::from_millis(600));
        lesson.type_line("");
        let surface = lesson.number("a point on the surface at ");
        let told = lesson.hear("rail is ");
        assert!(told.contains(" mm from the point"), "{told}");
        assert!(surface > centre + 2.0, "{centre} {surface}");
        lesson.hear("Enter takes the region, r teaches it again");
        let near = lesson.number("rail is ");
        std::thread::sleep(Duration::from_millis(3500));
        lesson.type_line("");
        let far = lesson.number("rail is ");
        // The robot's own ball has 50 mm: inside at first, beyond the surface later.
        assert!(near == 0.0 && far > 5.0, "{near} {far}");
        let (status, toml) = lesson.end();
        assert_eq!(status, 0);
        let keys = toml.split_once("[region.lamp]\n").unwrap().1;
        let lines: Vec<&str> = keys.lines().take_while(|line| line.contains(" = ")).collect();
        let table = lines.join("\n") + "\n";
        assert!(toml.contains("add region.lamp") && table.contains("shape = \"sphere\"\n"), "{toml}");
        let radius: f64 = table.split_once("radius = ").unwrap().1.lines().next().unwrap().parse().unwrap();
        assert!((radius - (surface - centre)).abs() < 1e-3 && table.contains("life = \"temporary\"\n"), "{table}");
        let listed = regions(folder, &at);
        assert!(listed.contains("lamp                 forbidden  temporary  off"), "{listed}");
        // What is printed is what a cell file takes.
        let text = std::fs::read_to_string(folder.join("cell.toml")).unwrap() + &format!("[region.lamp]\n{table}");
        std::fs::write(folder.join("taught.toml"), text).unwrap();
        assert_eq!(answer(command(folder, &["query", "taught.toml", "--ask", "distance"]).output().unwrap()).status, 0);
    }

    /// Three slides, whose tool centre point goes around a rectangle on the floor again and again.
    const GANTRY: &str = r#"
version = 1
name = "gantry"
units = { length = "mm", angle = "deg" }
[robot.rail]
base = { at = [0, 0, 0], rpy = [0, 90, 0] }
dh = [
  { kind = "prismatic", min = -3000, max = 3000, speed = 1000, alpha = -90, theta = 0 },
  { kind = "prismatic", min = -3000, max = 3000, speed = 1000, alpha = 90, theta = -90 },
  { kind = "prismatic", min = -3000, max = 3000, speed = 1000 },
]
links = [[], [], { sphere = { radius = 30 } }]
[program.rail]
steps = [
  { move = "joint", to = [1000, 0, 0], speed = 40 },
  { move = "joint", to = [1000, 800, 0], speed = 40 },
  { move = "joint", to = [0, 800, 0], speed = 40 },
  { move = "joint", to = [0, 0, 0], speed = 40 },
]
"#;

    /// Each corner is on another side of the rectangle. While the fence is taught, the robot is compared with the line on
    /// the first corner, the first wall, and the walls so far; then with the fence.
    #[test]
    fn a_fence_is_taught_corner_by_corner_and_compared_all_the_while() {
        let folder = cell_and_tokens();
        let folder = folder.path();
        std::fs::write(folder.join("cell.toml"), GANTRY).unwrap();
        let (_process, at) = start_simulated(folder);
        let arguments = ["--shape", "fence", "--height", "1500", "--warning", "200", "--permanent"];
        let mut lesson = Lesson::start(folder, &at, &arguments);
        let parts = ["", "the upright line on the corner", "the wall", "the walls so far"];
        for (i, part) in parts.iter().enumerate().take(3) {
            let asked = lesson.hear(&format!("corner {}: move the TCP of rail to the next corner", i + 1));
            assert!(!asked.contains("c closes the fence"), "{asked}");
            std::thread::sleep(Duration::from_millis(2600));
            lesson.type_line("");
            lesson.hear(&format!("corner {}: the next corner of the fence on the floor at [", i + 1));
            if !part.is_empty() {
                let told = lesson.hear("rail is ");
                assert!(told.contains(" mm from ") && told.ends_with(part), "{told}");
            }
        }
        assert!(lesson.hear("corner 4: move").contains("(c closes the fence, q ends)"));
        lesson.type_line("d");
        lesson.hear("`d` is not an answer here: Enter, c or q");
        lesson.type_line("c");
        let built = lesson.hear("built 3 walls, 1500 mm high");
        assert!(built.contains("z from 0 to 1500 mm"), "{built}");
        lesson.hear("Enter takes the region, r teaches it again");
        lesson.number("rail is ");
        lesson.type_line("");
        let (status, toml) = lesson.end();
        assert_eq!(status, 0);
        let keys = toml.split_once("[fence.lamp]\n").unwrap().1;
        assert!(keys.starts_with("corners = [[") && keys.contains("\nfloor = 0\nheight = 1500\n"), "{toml}");
        assert!(keys.contains("warning = 200") && !keys.contains("life") && !keys.contains("gates"), "{toml}");
        let text = std::fs::read_to_string(folder.join("cell.toml")).unwrap() + &toml;
        std::fs::write(folder.join("taught.toml"), text).unwrap();
        let asked = answer(command(folder, &["query", "taught.toml", "--ask", "distance"]).output().unwrap());
        assert_eq!(asked.status, 0, "{}", asked.stderr);
        assert!(!regions(folder, &at).contains("lamp"), "a fence is put into the cell file");
        let teach = |arguments: &[&str]| {
            let words = ["teach", "yard", "--robot", "rail", "--at", &at, "--secret", "operator.secret"];
            control(folder, &[&words[..], arguments].concat())
        };
        for (arguments, message) in [
            (&["--shape", "fence"][..], "--shape fence needs --height above 0"),
            (&["--shape", "fence", "--height=-3"], "--shape fence needs --height above 0"),
            (&["--shape", "fence", "--height", "3", "--inside"], "--shape fence has no --inside"),
            (&["--shape", "fence", "--height", "3", "--add"], "a fence is not added to a running cell"),
        ] {
            let refused = teach(arguments);
            assert!(refused.status == 2 && refused.stderr.contains(message), "{arguments:?}: {}", refused.stderr);
        }
    }

    #[test]
    fn points_that_make_no_region_are_taught_again_and_nothing_is_added_without_an_end() {
        let folder = cell_and_tokens();
        let folder = folder.path();
        let (_process, at) = start_simulated(folder);
        let mut lesson = Lesson::start(folder, &at, &["--shape", "sphere"]);
        for _ in 0..2 {
            lesson.hear("1 of 2");
            lesson.type_line("");
            lesson.hear("2 of 2: move");
            lesson.type_line("");
        }
        lesson.hear("teach the points again");
        lesson.type_line("q");
        lesson.hear("nothing was taught: ended by q");
        assert_eq!(lesson.end(), (2, String::new()));
        let teach = |arguments: &[&str]| {
            let words = [&["teach", "lamp", "--at", &at, "--secret", "operator.secret"][..], arguments].concat();
            control(folder, &words)
        };
        for (arguments, message) in [
            (&["--robot", "rial", "--shape", "box"][..], "there is no robot `rial`"),
            (&["--robot", "rail", "--shape", "box3"][..], "--shape box3 needs --height"),
            (&["--robot", "rail", "--shape", "box3", "--height", "nan"][..], "--shape box3 needs --height"),
            (&["--robot", "rail", "--shape", "box", "--warning=-5"][..], "warning"),
            (&["--robot", "rail", "--shape", "box", "--height", "3"][..], "--shape box needs no --height"),
            (&["--robot", "rail", "--shape", "box"][..], "the standard input has ended"),
            (&["--robot", "rail", "--shape", "box", "--off"][..], "--add"),
        ] {
            let refused = teach(arguments);
            assert!(refused.status == 2 && refused.stderr.contains(message), "{arguments:?}: {}", refused.stderr);
        }
        let known = control(
            folder,
            &["teach", "cart", "--at", &at, "--secret", "operator.secret", "--robot", "rail", "--shape", "box"],
        );
        assert!(known.status == 2 && known.stderr.contains("there is a region `cart` already"), "{}", known.stderr);
        assert!(!regions(folder, &at).contains("lamp"));
        // What was taught is printed although the service does not add it; and words that mean nothing accept nothing.
        let mut lesson = Lesson::start(folder, &at, &["--shape", "sphere4", "--add"]);
        lesson.hear("1 of 4");
        lesson.type_line("no");
        lesson.hear("`no` is not an answer here: Enter or q");
    }
}
