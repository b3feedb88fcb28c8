//! Client in C: the same bytes and the same decisions as the client in Rust, and its example against a node.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::common::{rail, start_node};
use elbowroom_interlock::Micros;
use elbowroom_live::messages::{AttachedVolume, JointState, OverrideAnswer};
use elbowroom_live::network::{Network, UdpNetwork};
use elbowroom_live::{Clock, ControllerClient, ControllerState, Keys, Refused};
use elbowroom_monitor::VolumeId;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::compiler;
use elbowroom_testkit::random::{split_mix, unit};

/// Boot number of `messages.c`.
const BOOT: u64 = 7;
const CONFIGURATION: u64 = 99;

/// Compiles a program; `None` if there is no compiler.
fn compile(source: &Path, name: &str) -> Option<PathBuf> {
    let mut compiler = compiler::c()?;
    let program = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    compiler.arg("-I").arg(clients());
    compiler::compile(compiler, source, &program, &["-lm".into()]);
    Some(program)
}

fn clients() -> PathBuf {
    elbowroom_testkit::folder::workspace().join("clients/c")
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").expect("a string takes all");
        text
    })
}

/// The client in C behind `messages.c`, killed when it is dropped.
struct InC {
    process: Child,
    output: BufReader<ChildStdout>,
}

impl InC {
    fn start(program: &Path) -> Self {
        let mut command = Command::new(program);
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
        let output = BufReader::new(process.stdout.take().expect("its output"));
        Self { process, output }
    }

    fn ask(&mut self, line: &str) -> String {
        writeln!(self.process.stdin.as_mut().expect("its input"), "{line}").expect("it reads");
        self.process.stdin.as_mut().expect("its input").flush().expect("it reads");
        self.line()
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.output.read_line(&mut line).expect("it prints");
        assert!(line.ends_with('\n'), "it ended after {line:?}");
        line.trim_end().to_owned()
    }
}

impl Drop for InC {
    fn drop(&mut self) {
        // A process that has ended cannot be killed.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn messages() -> Option<InC> {
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/c_client/messages.c");
    // Tests run at the same time, so each has its own program.
    let name = format!("messages_{:?}", std::thread::current().id()).replace(['(', ')'], "_");
    compile(&source, &name).map(|program| InC::start(&program))
}

/// The values that `messages.c` makes from a time and from numbers of joints and volumes.
struct Values {
    q: Vec<f64>,
    qd: Vec<f64>,
    intent: Vec<f64>,
    attached: Vec<AttachedVolume>,
}

impl Values {
    fn new(now: u64, joints: usize, attached: usize) -> Self {
        let x = |i: usize| (now % 1000) as f64 + i as f64;
        let quaternions = [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.5, 0.5]];
        let volume = |i: usize| AttachedVolume {
            volume: VolumeId(i * 1000),
            in_link: Pose {
                rotation: Rotation::from_quaternion_xyzw(quaternions[i % 3]).expect("a rotation"),
                translation: Vec3::new(x(i) / 7.0, -0.25, i as f64),
            },
        };
        Self {
            q: (0..joints).map(|i| x(i) / 8.0).collect(),
            qd: (0..joints).map(|i| -x(i) / 3.0).collect(),
            intent: (0..joints).map(|i| x(i) * 1e-300).collect(),
            attached: (0..attached).map(volume).collect(),
        }
    }
}

#[test]
fn joint_states_have_the_same_bytes() {
    let Some(mut c) = messages() else { return };
    let mut rust = ControllerClient::new(BOOT, CONFIGURATION);
    let cases =
        [(1, true, true, 0), (6, true, true, 2), (6, true, false, 1), (7, false, false, 0), (7, false, true, 3)];
    let cases = cases.into_iter().chain([(0, false, false, 0), (32, true, true, 16)]);
    for (n, (joints, has_velocity, has_intent, attached)) in cases.cycle().take(70).enumerate() {
        let (now, stamp) = (n as u64 * 1_234_567, u64::MAX - n as u64);
        let values = Values::new(now, joints, attached);
        let state = ControllerState {
            q: &values.q,
            qd: if has_velocity { &values.qd } else { &[] },
            intent: if has_intent { &values.intent } else { &[] },
            programmed_override: 0.75,
            attached: &values.attached,
            stamp: Some(Micros(stamp)),
        };
        let (velocity, intent) = (u8::from(has_velocity), u8::from(has_intent));
        let in_c = c.ask(&format!("S {now} {stamp} {joints} {velocity} {intent} {attached}"));
        let bytes = rust.joint_state(Micros(now), &state);
        if joints > 0 {
            assert_eq!(in_c, hex(bytes), "{joints} joints, {attached} volumes");
        }
        JointState::default().decode(bytes).expect("what is sent can be read");
    }
    // More joints than fit: nothing is sent, and no number is used.
    assert_eq!(c.ask("S 1 1 33 0 0 0"), "");
    assert_eq!(c.ask("S 1 1 6 0 0 17"), "");
    let values = Values::new(5, 1, 0);
    let state = ControllerState { q: &values.q, programmed_override: 0.75, ..ControllerState::default() };
    assert_eq!(c.ask("S 5 5 1 0 0 0"), hex(rust.joint_state(Micros(5), &state)));
}

/// Returns the number of a refusal in `elbowroom_client.h`.
fn code(taken: Result<(), Refused>) -> u8 {
    match taken {
        Ok(()) => 0,
        Err(Refused::Message(_)) => 1,
        Err(Refused::OtherStart) => 2,
        Err(Refused::OtherConfiguration) => 3,
        Err(Refused::Late) => 4,
        Err(Refused::Override) => 5,
    }
}

/// Makes an answer of a node, or of a stranger.
fn answer(sent: u64, random: &mut u64) -> Vec<u8> {
    let mut below = |n: u64| split_mix(random) % n;
    let mut answer = OverrideAnswer {
        checksum: CONFIGURATION,
        boot: BOOT,
        echo: sent.saturating_sub(below(4)),
        sequence: sent + below(3),
        outputs: u64::MAX - 1,
        reason: 1,
        region: 3,
        speed_override: 0.0,
    };
    let kind = below(12);
    answer.speed_override = unit(split_mix(random));
    match kind {
        0 => answer.boot += 1,
        1 => answer.checksum += 1,
        2 => answer.echo = sent + 1,
        3 => answer.speed_override = [f64::NAN, 1.000_001, -0.001, f64::INFINITY][sent as usize % 4],
        4 => answer.echo = 0,
        _ => {}
    }
    let mut bytes = Vec::new();
    answer.encode(&mut bytes);
    match kind {
        5 => bytes[split_mix(random) as usize % 60] ^= 1 << (sent % 8),
        6 => bytes.truncate(1 + sent as usize % 59),
        7 => bytes.push(0),
        _ => {}
    }
    bytes
}

#[test]
fn answers_are_taken_alike() {
    let Some(mut c) = messages() else { return };
    let mut rust = ControllerClient::new(BOOT, CONFIGURATION);
    let (mut random, mut now, mut seen) = (11, 1_000, [0; 6]);
    let (mut stopped, mut sent) = (0, 0);
    for _ in 0..4_000 {
        // Pauses after which no answer is valid any more.
        now += if split_mix(&mut random).is_multiple_of(40) { 25_000 } else { 2_000 };
        let values = Values::new(now, 2, 0);
        let state = ControllerState { q: &values.q, programmed_override: 0.75, ..ControllerState::default() };
        sent += 1;
        assert_eq!(c.ask(&format!("S {now} {now} 2 0 0 0")), hex(rust.joint_state(Micros(now), &state)));
        let bytes = answer(sent, &mut random);
        // At times before the limit, at it, and after it.
        let at = now + [0, 1_000, 20_000, 20_001, 14_000][split_mix(&mut random) as usize % 5];
        let taken = code(rust.receive(&bytes));
        let expected = rust.speed_override(Micros(at));
        let in_c = c.ask(&format!("A {at} {}", hex(&bytes)));
        let (code_in_c, override_in_c) = in_c.split_once(' ').expect("two values");
        assert_eq!(code_in_c.parse::<u8>(), Ok(taken));
        assert_eq!(override_in_c.parse::<f64>(), Ok(expected));
        seen[usize::from(taken)] += 1;
        stopped += usize::from(expected == 0.0);
    }
    assert!(seen.iter().all(|count| *count > 50) && (500..3_500).contains(&stopped), "{seen:?}, {stopped}");
}

#[test]
fn keys_and_datagrams_are_those_of_docs() {
    let Some(mut c) = messages() else { return };
    for (cell, robot) in [("rail", "left"), ("a/b*c", "d$e?f#g")] {
        assert_eq!(c.ask(&format!("K {cell} {robot}")), Keys::new(cell).joint_states(robot));
    }
    assert_eq!(c.ask(&format!("K {} r", "x".repeat(255))), "-");
    let framed = |kind: u8, version: u8| [b"EU", &[version, kind, 3][..], b"a/b", &[1, 255]].concat();
    assert_eq!(c.ask(&format!("D a/b {}", hex(&framed(2, 1)))), "01ff");
    for other in [framed(1, 1), framed(2, 2), framed(2, 1)[..7].to_vec(), b"EU".to_vec()] {
        assert_eq!(c.ask(&format!("D a/b {}", hex(&other))), "-");
    }
    assert_eq!(c.ask(&format!("D a/c {}", hex(&framed(2, 1)))), "-");
}

/// Parses the override and the position from a line of the example's output.
fn printed(line: &str) -> Option<(f64, f64)> {
    let (_, rest) = line.split_once("override ")?;
    let (speed_override, rest) = rest.split_once(',')?;
    let (_, position) = rest.split_once("joint at ")?;
    Some((speed_override.parse().ok()?, position.parse().ok()?))
}

#[test]
fn the_example_obeys_its_node_and_stops_without_one() {
    let Some(program) = compile(&clients().join("example.c"), "example") else { return };
    let network = Arc::new(UdpNetwork::bind("127.0.0.1:0", &[]).expect("a socket"));
    let address = network.local_address().expect("its address");
    // Messages of the example; a client in Rust must write the same bytes.
    let heard: Arc<Mutex<Vec<Vec<u8>>>> = Arc::default();
    let taken = heard.clone();
    let handler = Box::new(move |bytes: &[u8]| taken.lock().unwrap().push(bytes.to_vec()));
    let subscription = network.subscribe(&Keys::new("rail").joint_states("rail"), handler).expect("a key");
    let node = start_node(&rail(100, ""), Clock::start(), network.clone());
    let mut command = Command::new(program);
    command.args(["127.0.0.1", &address.port().to_string(), "rail", "rail", "20", "0.2", "1.2"]);
    let mut process = command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().expect("the example starts");
    let output = BufReader::new(process.stdout.take().expect("its output"));
    let mut example = InC { process, output };

    let began = Instant::now();
    let mut until = |what: &str, is_seen: &mut dyn FnMut(f64, f64) -> bool| {
        loop {
            assert!(began.elapsed() < Duration::from_secs(15), "{what}");
            if printed(&example.line()).is_some_and(|(speed_override, q)| is_seen(speed_override, q)) {
                return;
            }
        }
    };
    until("the robot never moved", &mut |speed_override, q| speed_override == 1.0 && q > 0.3);
    drop((node, subscription, network));
    until("it went on without a node", &mut |speed_override, _| speed_override == 0.0);
    let mut places = Vec::new();
    until("it went on printing", &mut |speed_override, q| {
        assert_eq!(speed_override, 0.0);
        places.push(q);
        places.len() == 5
    });
    assert!(places.iter().all(|q| *q == places[0]), "it moved without a node: {places:?}");
    same_bytes_in_rust(&heard.lock().unwrap());
}

/// Writes the messages of the example in Rust and compares them.
fn same_bytes_in_rust(messages: &[Vec<u8>]) {
    assert!(messages.len() > 50, "only {} messages arrived", messages.len());
    let (mut state, mut again) = (JointState::default(), Vec::new());
    for message in messages {
        state.decode(message).expect("a message");
        state.encode(&mut again);
        assert_eq!(again, *message);
    }
}
