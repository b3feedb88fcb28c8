//! Permissions in a sealed cell, and detection of unsealed changes: attempts of an integrator, a programmer, and an
//! operator with an editor.

use std::io::Write;
use std::path::Path;
use std::process::Stdio;

use crate::common::{Answer, answer, command, keys, solid_swing};
use tempfile::TempDir;

/// Returns a cell with the owner's comments and blank lines, a permanent region `post` and a temporary one, `cart`.
fn text() -> String {
    solid_swing().replace(
        "[program.arm]",
        "# The cart comes on Mondays.\n[region.cart]\nshape  = 'sphere'   # a ball of a cart\ncentre = [0, 2000, 0]\n\
         radius = 100        # mm\nlife = \"temporary\"\nwarning = 50\n\n[monitor]\nstale_ms = 20   # ours\n\n[program.arm]",
    )
}

const NEW: &str =
    "[region.NAME]\nshape = \"sphere\"\ncentre = [0, -2000, 0]\nradius = 100\nwarning = 50\nlife = \"LIFE\"\n";

/// Runs the command with only the keys and the trust that the test provides.
fn run_in(dir: &Path, args: &[&str]) -> Answer {
    answer(quiet(dir, args).output().unwrap())
}

fn quiet(dir: &Path, args: &[&str]) -> std::process::Command {
    let mut command = command(dir, args);
    command.env_remove("ELBOWROOM_KEY").env_remove("ELBOWROOM_TRUSTED_KEYS");
    command
}

fn read(dir: &Path, file: &str) -> String {
    std::fs::read_to_string(dir.join(file)).unwrap()
}

fn write(dir: &Path, file: &str, text: &str) {
    std::fs::write(dir.join(file), text).unwrap();
}

fn keygen(dir: &Path, class: &str, name: &str) {
    let file = format!("{name}.key");
    let public = run_in(dir, &["region", "keygen", "--as", class, "--name", name, "--out", &file]).expect(0).stdout;
    let mut trusted = std::fs::read_to_string(dir.join("trusted-keys.toml")).unwrap_or_default();
    trusted += &public;
    write(dir, "trusted-keys.toml", &trusted);
}

/// Makes a folder with a cell, the keys `programmer.key` and `integrator.key`, and no seal yet.
fn with_keys() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), "cell.toml", &text());
    for class in ["programmer", "integrator"] {
        keygen(dir.path(), class, class);
    }
    for life in ["permanent", "temporary"] {
        write(dir.path(), &format!("{life}.toml"), &NEW.replace("NAME", life).replace("LIFE", life));
    }
    dir
}

fn sealed() -> TempDir {
    let dir = with_keys();
    act(dir.path(), "integrator", &["seal", "cell.toml"]).expect(0);
    dir
}

/// Runs `elbowroom region …` as a class, with the class's own key.
fn act(dir: &Path, class: &str, args: &[&str]) -> Answer {
    let key = format!("{class}.key");
    let mut all = vec!["region"];
    all.extend(args);
    all.extend(["--as", class]);
    if class != "operator" {
        all.extend(["--key", &key]);
    }
    run_in(dir, &all)
}

/// Checks that everything that reads the cell refuses it, with these words.
#[track_caller]
fn refused(dir: &Path, words: &[&str]) {
    let verbs: &[&[&str]] = &[
        &["run", "cell.toml"],
        &["run", "cell.toml", "--no-monitor", "--json"],
        &["query", "cell.toml", "--ask", "collision"],
        &["plan", "cell.toml", "--to", "0.1,0.1"],
        &["map", "cell.toml"],
    ];
    for verb in verbs {
        let answer = run_in(dir, verb).expect(2);
        assert_eq!(answer.stdout, "", "{verb:?}");
        for word in words {
            assert!(answer.stderr.contains(word), "{verb:?}: no \"{word}\" in\n{}", answer.stderr);
        }
    }
}

#[test]
fn every_class_and_every_edit() {
    const EDITS: &[(&[&str], &str)] = &[
        (&["add", "cell.toml", "permanent.toml"], "integrator"),
        (&["add", "cell.toml", "temporary.toml"], "programmer"),
        (&["change", "cell.toml", "post", "radius=60"], "integrator"),
        (&["change", "cell.toml", "cart", "radius=120"], "programmer"),
        (&["change", "cell.toml", "post", "life=temporary"], "integrator"),
        (&["change", "cell.toml", "cart", "life=permanent"], "integrator"),
        (&["change", "cell.toml", "cart", "--unset", "life"], "integrator"),
        (&["remove", "cell.toml", "post"], "integrator"),
        (&["remove", "cell.toml", "cart"], "programmer"),
        (&["laws", "cell.toml", "stopping_distance=true"], "integrator"),
        (&["laws", "cell.toml", "--unset", "stale_ms"], "integrator"),
    ];
    let rank = |class: &str| ["operator", "programmer", "integrator"].iter().position(|c| *c == class);
    for (edit, least) in EDITS {
        for class in ["operator", "programmer", "integrator"] {
            let dir = sealed();
            let before = (read(dir.path(), "cell.toml"), read(dir.path(), "cell.seal.jsonl"));
            let answer = act(dir.path(), class, edit);
            if rank(class) >= rank(least) {
                let answer = answer.expect(0);
                assert!(answer.stdout.contains(class), "{edit:?} {class}: {}", answer.stdout);
                assert_ne!(read(dir.path(), "cell.toml"), before.0, "{edit:?} {class}");
                assert!(read(dir.path(), "cell.seal.jsonl").starts_with(&before.1), "only appended");
                run_in(dir.path(), &["run", "cell.toml"]).expect(0);
            } else {
                let answer = answer.expect(2);
                let named = if class == "operator" { "operator" } else { "--as integrator" };
                assert!(answer.stderr.contains(named), "{edit:?} {class}: {}", answer.stderr);
                let after = (read(dir.path(), "cell.toml"), read(dir.path(), "cell.seal.jsonl"));
                assert_eq!(after, before, "{edit:?} {class}");
            }
        }
    }
}

#[test]
fn what_is_not_edited_stays_as_it_was_written() {
    let dir = sealed();
    act(dir.path(), "programmer", &["change", "cell.toml", "cart", "radius=120", "slow_to=30", "kind=monitored"])
        .expect(0);
    act(dir.path(), "integrator", &["laws", "cell.toml", "stale_ms=10"]).expect(0);
    act(dir.path(), "programmer", &["add", "cell.toml", "temporary.toml"]).expect(0);
    let expected = text()
        .replace("radius = 100        # mm", "radius = 120        # mm")
        .replace("warning = 50\n", "warning = 50\nslow_to = 30\nkind = \"monitored\"\n")
        .replace("stale_ms = 20   # ours", "stale_ms = 10   # ours");
    let added = NEW.replace("NAME", "temporary").replace("LIFE", "temporary");
    assert_eq!(read(dir.path(), "cell.toml"), format!("{}\n\n{added}", expected.trim_end()));
    act(dir.path(), "programmer", &["remove", "cell.toml", "temporary"]).expect(0);
    assert_eq!(read(dir.path(), "cell.toml").trim_end(), expected.trim_end());
}

/// Edits by an operator with an editor, and the resulting messages.
#[test]
fn a_cell_that_was_edited_without_a_key_is_refused_with_what_differs() {
    let edits: &[(&str, &str, &[&str])] = &[
        (
            "radius = 50",
            "radius = 40",
            &["cell.toml:11:", "`region.post`", "radius is 40, sealed was 50", "--as integrator"],
        ),
        ("base = [495, 495, -500]", "base = [495, 495, 500]", &["`region.post`", "base is [495, 495, 500]"]),
        ("guards = [\"tcp\"]\n", "", &["`region.post`", "guards", "was removed"]),
        ("stale_ms = 20", "stale_ms = 90", &["`monitor`", "stale_ms is 90, sealed was 20", "--as integrator"]),
        ("stale_ms = 20", "direction_aware = true", &["`monitor`", "direction_aware = true was added"]),
        ("length = \"mm\"", "length = \"m\"", &["`units`", "length is \"m\", sealed was \"mm\""]),
        ("a = 300", "a = 310", &["`robot.arm`", "dh is"]),
        (
            "radius = 100        # mm",
            "radius = 90",
            &["`region.cart`", "radius is 90, sealed was 100", "--as programmer"],
        ),
        (
            "life = \"temporary\"",
            "life = \"permanent\"",
            &["`region.cart`", "life is \"permanent\"", "--as integrator"],
        ),
        (
            "[region.cart]",
            "[region.wagon]",
            &["`region.cart` was removed", "`region.wagon` was added", "--as programmer"],
        ),
        ("version = 1\n", "version = 1\ntick_ms = 8\n", &["`cell`", "tick_ms = 8 was added"]),
    ];
    for (from, to, words) in edits {
        let dir = sealed();
        let edited = text().replace(from, to);
        assert_ne!(edited, text(), "{from}");
        write(dir.path(), "cell.toml", &edited);
        refused(dir.path(), words);
        let message = run_in(dir.path(), &["run", "cell.toml"]).expect(2).stderr;
        let hex = |word: &str| word.len() >= 64 && word.chars().all(|c| c.is_ascii_hexdigit());
        assert!(!message.split(|c: char| !c.is_ascii_alphanumeric()).any(hex), "nothing to paste:\n{message}");
        // No class can edit on top of it; only a seal helps.
        act(dir.path(), "integrator", &["change", "cell.toml", "post", "radius=60"]).expect(2);
        assert!(run_in(dir.path(), &["region", "log", "cell.toml"]).expect(1).stdout.lines().count() > 1);
        act(dir.path(), "integrator", &["seal", "cell.toml"]).expect(0);
        run_in(dir.path(), &["region", "log", "cell.toml"]).expect(0);
    }
}

#[test]
fn programs_objects_and_words_are_the_users_own() {
    let dir = sealed();
    let free = text()
        .replace("speed = 50 }", "speed = 40 }")
        .replace("[program.arm]", "[object.box]\nshape = \"sphere\"\nat = [0, 5000, 0]\nradius = 10\n\n[program.arm]")
        .replace("# The cart comes on Mondays.", "name = \"my cell\" # no\n")
        .replace("name = \"my cell\" # no\n", "");
    write(dir.path(), "cell.toml", &free);
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
    // The same values in another notation.
    write(
        dir.path(),
        "cell.toml",
        &text().replace("radius = 50\n", "radius = 5.0e1 # mm\n").replace("'sphere'", "\"sphere\""),
    );
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
}

#[test]
fn a_programmer_seals_temporary_regions_and_nothing_else() {
    let dir = sealed();
    write(dir.path(), "cell.toml", &text().replace("radius = 100        # mm", "radius = 90"));
    act(dir.path(), "programmer", &["seal", "cell.toml"]).expect(0);
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
    write(dir.path(), "cell.toml", &text().replace("radius = 50", "radius = 40"));
    let answer = act(dir.path(), "programmer", &["seal", "cell.toml"]).expect(2);
    assert!(answer.stderr.contains("`region.post`") && answer.stderr.contains("--as integrator"), "{}", answer.stderr);
    // The integrator makes the first seal.
    let dir = with_keys();
    let answer = act(dir.path(), "programmer", &["seal", "cell.toml"]).expect(2);
    assert!(answer.stderr.contains("integrator"), "{}", answer.stderr);
    assert!(!dir.path().join("cell.seal.jsonl").exists());
}

#[test]
fn a_fence_is_sealed_as_the_region_that_it_is() {
    let fence = |life: &str| {
        format!(
            "[fence.pen]\ncorners = [[-9000, -9000], [9000, -9000], [9000, 9000], [-9000, 9000]]\nheight = 2000\n\
             life = \"{life}\"\nwarning = 50\n"
        )
    };
    for (life, class) in [("temporary", "programmer"), ("permanent", "integrator")] {
        let dir = sealed();
        write(dir.path(), "pen.toml", &fence(life));
        if life == "permanent" {
            let refusal = act(dir.path(), "programmer", &["add", "cell.toml", "pen.toml"]).expect(2).stderr;
            assert!(refusal.contains("`pen`") && refusal.contains("--as integrator"), "{refusal}");
        }
        act(dir.path(), class, &["add", "cell.toml", "pen.toml"]).expect(0);
        let twice = act(dir.path(), class, &["add", "cell.toml", "pen.toml"]).expect(2).stderr;
        assert!(twice.contains("a region `pen` already"), "{twice}");
        act(dir.path(), class, &["change", "cell.toml", "pen", "height=2500"]).expect(0);
        assert!(read(dir.path(), "cell.toml").contains("height = 2500"));
        // Changed with an editor: the message names it, and the same class may seal it.
        let lower = read(dir.path(), "cell.toml").replace("height = 2500", "height = 1500");
        write(dir.path(), "cell.toml", &lower);
        refused(dir.path(), &["region.pen", "height"]);
        act(dir.path(), class, &["seal", "cell.toml"]).expect(0);
        run_in(dir.path(), &["run", "cell.toml"]).expect(0);
        act(dir.path(), class, &["remove", "cell.toml", "pen"]).expect(0);
        assert!(!read(dir.path(), "cell.toml").contains("fence"));
        run_in(dir.path(), &["run", "cell.toml"]).expect(0);
    }
}

/// Returns regions that follow an object, a file of poses and an encoder with a file; and an object that no region follows.
fn carried(life: &str) -> String {
    let region = |name: &str, follow: &str| {
        format!(
            "[region.{name}]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 50\nwarning = 50\nlife = \"{life}\"\n\
             follow = {{ {follow} }}\n\n"
        )
    };
    let regions = [
        region("on_cart", "object = \"cart\""),
        region("on_poses", "poses = \"poses.csv\""),
        region("on_belt", "encoder = \"belt\""),
    ];
    let object = |name: &str, at: &str| format!("[object.{name}]\nshape = \"sphere\"\nat = {at}\nradius = 10\n\n");
    let objects = object("cart", "[0, 4000, 0]") + &object("free", "[0, 6000, 0]");
    let encoder = "[encoder.belt]\nfile = \"belt.csv\"\n\n";
    text().replace("[program.arm]", &format!("{objects}{encoder}{}[program.arm]", regions.concat()))
}

const POSES: &str = "t_s,x_m,y_m,z_m\n0,0,-4,0\n5,0,-4,0\n";
const BELT: &str = "t_s,travel_m\n0,5\n5,5\n";

fn sealed_and_carried(life: &str) -> TempDir {
    let dir = with_keys();
    write(dir.path(), "cell.toml", &carried(life));
    write(dir.path(), "poses.csv", POSES);
    write(dir.path(), "belt.csv", BELT);
    act(dir.path(), "integrator", &["seal", "cell.toml"]).expect(0);
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
    dir
}

/// Moving the carrier of a region moves the region.
#[test]
fn what_carries_a_region_is_sealed_with_it() {
    let cart = carried("LIFE").replace("at = [0, 4000, 0]", "at = [0, 40000, 0]");
    let cases: &[(&str, &str, &[&str])] = &[
        ("cell.toml", &cart, &["`region.on_cart`", "object.cart.at is [0, 40000, 0], sealed was [0, 4000, 0]"]),
        ("poses.csv", "t_s,x_m,y_m,z_m\n0,0,-9,0\n5,0,-9,0\n", &["`region.on_poses`", "poses from \"poses.csv\""]),
        ("belt.csv", "t_s,travel_m\n0,9\n5,9\n", &["`region.on_belt`", "encoder belt from \"belt.csv\""]),
    ];
    for (life, class) in [("permanent", "integrator"), ("temporary", "programmer")] {
        for (file, edited, words) in cases {
            let dir = sealed_and_carried(life);
            write(dir.path(), file, &edited.replace("LIFE", life));
            refused(
                dir.path(),
                &[&["cell.toml:", "is not as it was sealed", &format!("--as {class}")], *words].concat(),
            );
            let log = run_in(dir.path(), &["region", "log", "cell.toml"]).expect(1);
            let message = log.stdout + &log.stderr;
            assert!(words.iter().all(|w| message.contains(w)), "{message}");
            let answer = act(dir.path(), "programmer", &["seal", "cell.toml"]);
            if class == "integrator" {
                let message = answer.expect(2).stderr;
                assert!(message.contains(words[0]) && message.contains("that needs the integrator class"), "{message}");
                act(dir.path(), "integrator", &["seal", "cell.toml"]).expect(0);
            } else {
                answer.expect(0);
            }
            run_in(dir.path(), &["run", "cell.toml"]).expect(0);
            run_in(dir.path(), &["region", "log", "cell.toml"]).expect(0);
        }
    }
}

#[test]
fn an_object_that_no_region_follows_is_the_users_own() {
    let dir = sealed_and_carried("permanent");
    write(dir.path(), "cell.toml", &carried("permanent").replace("at = [0, 6000, 0]", "at = [0, 7000, 0]"));
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
    run_in(dir.path(), &["region", "log", "cell.toml"]).expect(0);
    // The object is sealed once a region follows it: adding the region seals the object.
    let add = NEW.replace("NAME", "on_free").replace("LIFE", "temporary") + "follow = { object = \"free\" }\n";
    write(dir.path(), "on_free.toml", &add);
    act(dir.path(), "programmer", &["add", "cell.toml", "on_free.toml"]).expect(0);
    let cell = read(dir.path(), "cell.toml");
    write(dir.path(), "cell.toml", &cell.replace("at = [0, 7000, 0]", "at = [0, 6000, 0]"));
    refused(dir.path(), &["`region.on_free`", "object.free.at", "--as programmer"]);
    // It is no longer sealed once the region is removed.
    write(dir.path(), "cell.toml", &cell);
    act(dir.path(), "programmer", &["remove", "cell.toml", "on_free"]).expect(0);
    let cell = read(dir.path(), "cell.toml");
    write(dir.path(), "cell.toml", &cell.replace("at = [0, 7000, 0]", "at = [0, 6000, 0]"));
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
}

type Tamper = fn(&mut Vec<String>);

#[test]
fn a_seal_or_log_that_was_tampered_with_is_refused() {
    let lines = |dir: &Path| read(dir, "cell.seal.jsonl").lines().map(str::to_owned).collect::<Vec<_>>();
    let cases: &[(&str, Tamper, &[&str])] = &[
        ("a value", |l| l[1] = l[1].replace("\"120\"", "\"130\""), &["cell.seal.jsonl:2:", "signed"]),
        ("the class", |l| l[1] = l[1].replace("programmer", "integrator"), &["cell.seal.jsonl:2:", "signed"]),
        ("the time", |l| l[0] = l[0].replace("\"time\":\"2", "\"time\":\"1"), &["cell.seal.jsonl:1:", "signed"]),
        (
            "a signature",
            |l| {
                let at = l[2].len() - 3;
                l[2].replace_range(at - 4..at, "0000");
            },
            &["cell.seal.jsonl:3:"],
        ),
        (
            "an entry less",
            |l| {
                l.remove(1);
            },
            &["cell.seal.jsonl:2:", "does not follow"],
        ),
        (
            "the first entry less",
            |l| {
                l.remove(0);
            },
            &["cell.seal.jsonl:1:", "does not follow"],
        ),
        (
            "the last entry less",
            |l| {
                l.pop();
            },
            &["`monitor`", "stale_ms is 10, sealed was 20"],
        ),
        ("two in another order", |l| l.swap(1, 2), &["cell.seal.jsonl:2:", "does not follow"]),
        ("one twice", |l| l.push(l[2].clone()), &["cell.seal.jsonl:4:", "does not follow"]),
        (
            "half a line",
            |l| {
                let half = l[2].len() / 2;
                l[2].truncate(half);
            },
            &["cell.seal.jsonl:3:", "not an entry"],
        ),
        ("blanks", |l| l[2] = l[2].replacen("{\"", "{ \"", 1), &["cell.seal.jsonl:3:", "not an entry"]),
        ("another key of JSON", |l| l[2] = l[2].replacen('{', "{\"x\":1,", 1), &["cell.seal.jsonl:3:", "not an entry"]),
        ("all of it", Vec::clear, &["is empty"]),
    ];
    for (what, tamper, words) in cases {
        let dir = sealed();
        act(dir.path(), "programmer", &["change", "cell.toml", "cart", "radius=120"]).expect(0);
        act(dir.path(), "integrator", &["laws", "cell.toml", "stale_ms=10"]).expect(0);
        let mut all = lines(dir.path());
        let before = all.clone();
        tamper(&mut all);
        assert_ne!(all, before, "{what}");
        let text = all.iter().map(|l| format!("{l}\n")).collect::<Vec<_>>().concat();
        write(dir.path(), "cell.seal.jsonl", &text);
        refused(dir.path(), words);
    }
}

/// If the seal is removed, the cell still falls under keys but is not sealed.
#[test]
fn a_seal_that_is_missing_is_missed() {
    let dir = sealed();
    std::fs::remove_file(dir.path().join("cell.seal.jsonl")).unwrap();
    refused(dir.path(), &["is not sealed", "trusted-keys.toml", "region seal"]);
    let answer = act(dir.path(), "integrator", &["change", "cell.toml", "post", "radius=60"]).expect(2);
    assert!(answer.stderr.contains("not sealed"), "{}", answer.stderr);
    // The keys without the seal.
    let dir = sealed();
    std::fs::remove_file(dir.path().join("trusted-keys.toml")).unwrap();
    refused(dir.path(), &["is sealed by", "trusted keys"]);
    // A cell without a seal and without trusted keys.
    std::fs::remove_file(dir.path().join("cell.seal.jsonl")).unwrap();
    let json = run_in(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    assert!(!keys(&json).contains(&"seal"));
}

#[test]
fn the_wrong_key_and_no_key() {
    let dir = sealed();
    let change = ["region", "change", "cell.toml", "post", "radius=60"];
    let with = |more: &[&str]| run_in(dir.path(), &[&change[..], more].concat()).expect(2).stderr;
    assert!(with(&["--as", "integrator"]).contains("--key FILE"));
    assert!(with(&["--as", "integrator", "--key", "none.key"]).contains("none.key"));
    let message = with(&["--as", "integrator", "--key", "programmer.key"]);
    assert!(message.contains("may act as programmer, not as integrator"), "{message}");
    // The key is of the right class, but not in the list of trusted keys, which is sealed too.
    run_in(dir.path(), &["region", "keygen", "--as", "integrator", "--name", "M", "--out", "m.key"]).expect(0);
    let message = with(&["--as", "integrator", "--key", "m.key"]);
    assert!(message.contains("does not count here"), "{message}");
    let before = read(dir.path(), "trusted-keys.toml");
    keygen(dir.path(), "integrator", "mallory");
    refused(dir.path(), &["`trusted-keys.toml`", "mallory", "was added"]);
    write(dir.path(), "cell.toml", &text().replace("radius = 50", "radius = 40"));
    let seal = ["region", "seal", "cell.toml", "--as", "integrator", "--key", "mallory.key"];
    let message = run_in(dir.path(), &seal).expect(2).stderr;
    assert!(message.contains("was not sealed with the cell"), "{message}");
    write(dir.path(), "trusted-keys.toml", &before);
    write(dir.path(), "cell.toml", &text());
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
    // A file that is not a key.
    write(dir.path(), "bad.key", "class = \"integrator\"\nname = \"X\"\nprivate = \"12\"\n");
    private(&dir.path().join("bad.key"));
    let message = with(&["--as", "integrator", "--key", "bad.key"]);
    assert!(message.contains("bad.key:3:") && message.contains("is no key"), "{message}");
}

#[cfg(unix)]
fn private(file: &Path) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(file, std::fs::Permissions::from_mode(0o600)).unwrap();
}

#[cfg(not(unix))]
fn private(_: &Path) {}

#[cfg(unix)]
#[test]
fn a_private_key_is_its_owners_alone() {
    use std::os::unix::fs::PermissionsExt;
    let dir = sealed();
    let key = dir.path().join("integrator.key");
    assert_eq!(std::fs::metadata(&key).unwrap().permissions().mode() & 0o777, 0o600);
    std::fs::set_permissions(&key, std::fs::Permissions::from_mode(0o640)).unwrap();
    let message = act(dir.path(), "integrator", &["change", "cell.toml", "post", "radius=60"]).expect(2).stderr;
    assert!(message.contains("integrator.key") && message.contains("chmod 600"), "{message}");
    // No key is overwritten, and operators have none.
    let again = ["region", "keygen", "--as", "integrator", "--name", "X", "--out", "integrator.key"];
    let refused = run_in(dir.path(), &again).expect(2).stderr;
    assert!(refused.contains("integrator.key") && refused.contains("write: another name"), "{refused}");
    run_in(dir.path(), &["region", "keygen", "--as", "operator", "--name", "X", "--out", "o.key"]).expect(2);
    assert!(!dir.path().join("o.key").exists());
}

/// A retired key permits nothing; its seals count once another integrator has sealed the cell.
#[test]
fn a_retired_key() {
    let dir = sealed();
    keygen(dir.path(), "integrator", "second");
    act(dir.path(), "integrator", &["seal", "cell.toml", "--note", "a second integrator"]).expect(0);
    let trusted = read(dir.path(), "trusted-keys.toml");
    let first = trusted.find("name = \"integrator\"\n").unwrap();
    write(dir.path(), "trusted-keys.toml", &format!("{}retired = true\n{}", &trusted[..first], &trusted[first..]));
    refused(dir.path(), &["cell.seal.jsonl:1:", "retired", "region seal"]);
    let message = act(dir.path(), "integrator", &["seal", "cell.toml"]).expect(2).stderr;
    assert!(message.contains("retired"), "{message}");
    run_in(dir.path(), &["region", "seal", "cell.toml", "--as", "integrator", "--key", "second.key"]).expect(0);
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
    act(dir.path(), "programmer", &["change", "cell.toml", "cart", "radius=120"]).expect(0);
}

/// If keys elsewhere are named, a list beside the cell permits nothing.
#[test]
fn keys_named_by_the_environment_come_before_those_beside_the_cell() {
    let dir = with_keys();
    let elsewhere = tempfile::tempdir().unwrap();
    keygen(elsewhere.path(), "integrator", "plant");
    let trusted = elsewhere.path().join("trusted-keys.toml");
    let run = |args: &[&str]| answer(quiet(dir.path(), args).env("ELBOWROOM_TRUSTED_KEYS", &trusted).output().unwrap());
    let message =
        run(&["region", "seal", "cell.toml", "--as", "integrator", "--key", "integrator.key"]).expect(2).stderr;
    assert!(message.contains("does not count here"), "{message}");
    assert!(run(&["run", "cell.toml"]).expect(2).stderr.contains("is not sealed"));
    let key = elsewhere.path().join("plant.key");
    run(&["region", "seal", "cell.toml", "--as", "integrator", "--key", key.to_str().unwrap()]).expect(0);
    let json = run(&["run", "cell.toml", "--json"]).expect(0).json();
    assert_eq!((json["seal"]["name"].as_str(), json["seal"]["class"].as_str()), (Some("plant"), Some("integrator")));
    let nowhere =
        answer(quiet(dir.path(), &["run", "cell.toml"]).env("ELBOWROOM_TRUSTED_KEYS", "no.toml").output().unwrap());
    assert!(nowhere.expect(2).stderr.contains("no.toml"));
}

/// A user who can name another file of keys in the environment can seal with a forged key; elsewhere that is detected.
#[test]
fn a_forged_entry_is_found_out_where_the_keys_are_beside_the_cell() {
    let dir = sealed();
    keygen(dir.path(), "integrator", "mallory");
    write(dir.path(), "cell.toml", &text().replace("radius = 50", "radius = 40"));
    let trusted = dir.path().join("trusted-keys.toml");
    let seal = ["region", "seal", "cell.toml", "--as", "integrator", "--key", "mallory.key"];
    answer(quiet(dir.path(), &seal).env("ELBOWROOM_TRUSTED_KEYS", &trusted).output().unwrap()).expect(0);
    refused(dir.path(), &["cell.seal.jsonl:2:", "mallory", "was not sealed with the cell"]);
}

/// The seal also covers the models that the cell file names.
#[test]
fn a_file_that_the_cell_names_is_sealed_too() {
    let dir = with_keys();
    let stl = |x: f64| {
        let f = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            let v = |p: [f64; 3]| format!("vertex {} {} {}\n", p[0], p[1], p[2]);
            format!("facet normal 0 0 0\nouter loop\n{}{}{}endloop\nendfacet\n", v(a), v(b), v(c))
        };
        let [o, a, b, c] = [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
        format!("solid t\n{}{}{}{}endsolid t\n", f(o, b, a), f(o, a, c), f(o, c, b), f(a, b, c))
    };
    write(dir.path(), "pallet.stl", &stl(0.1));
    let region =
        "[region.pallet]\nshape = \"mesh\"\nmesh = \"pallet.stl\"\nat = [0, 3000, 0]\nwarning = 10\n\n[monitor]";
    write(dir.path(), "cell.toml", &text().replace("[monitor]", region));
    act(dir.path(), "integrator", &["seal", "cell.toml"]).expect(0);
    run_in(dir.path(), &["run", "cell.toml"]).expect(0);
    write(dir.path(), "pallet.stl", &stl(0.05));
    refused(dir.path(), &["`region.pallet`", "a file that it names"]);
}

/// From the first key to the log that an auditor reads.
#[test]
fn a_round_trip() {
    let dir = with_keys();
    write(dir.path(), "cell.toml", &format!("checksum = \"00\"\n{}", text()));
    run_in(dir.path(), &["run", "cell.toml"]).expect(2);
    // A checksum in the file is updated.
    act(dir.path(), "integrator", &["seal", "cell.toml", "--note", "after commissioning"]).expect(0);
    let first = run_in(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    assert!(
        read(dir.path(), "cell.toml").starts_with(&format!("checksum = \"{}\"\n", first["checksum"].as_str().unwrap()))
    );
    let mut child = quiet(dir.path(), &["region", "add", "cell.toml", "-", "--as", "programmer"])
        .env("ELBOWROOM_KEY", "programmer.key")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let new = NEW.replace("NAME", "\"a b\"").replace("LIFE", "temporary");
    child.stdin.take().unwrap().write_all(new.as_bytes()).unwrap();
    answer(child.wait_with_output().unwrap()).expect(0);
    act(dir.path(), "programmer", &["change", "cell.toml", "a b", "centre=[0, -2500, 0]"]).expect(0);
    act(dir.path(), "integrator", &["change", "cell.toml", "post", "radius=60", "--note", "wider"]).expect(0);
    act(dir.path(), "programmer", &["remove", "cell.toml", "a b"]).expect(0);
    let last = run_in(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    assert_ne!(last["checksum"], first["checksum"]);
    assert_eq!((last["seal"]["name"].as_str(), last["seal"]["entries"].as_u64()), (Some("programmer"), Some(5)));
    let shown = run_in(dir.path(), &["run", "cell.toml"]).expect(0).stdout;
    assert!(shown.contains("Sealed by programmer (programmer, key "), "{shown}");

    let log = run_in(dir.path(), &["region", "log", "cell.toml", "--json"]).expect(0).json();
    let entries = log["entries"].as_array().unwrap();
    let actions: Vec<_> = entries.iter().map(|e| e["action"].as_str().unwrap()).collect();
    let expected = ["seal", "add region.a b", "change region.a b", "change region.post", "remove region.a b"];
    assert_eq!(actions, expected);
    assert_eq!(entries[0]["note"].as_str(), Some("after commissioning"));
    let changes = entries[3]["changes"].as_array().unwrap();
    let radius = changes.iter().find(|c| c["field"] == "radius").unwrap();
    assert_eq!((radius["before"].as_str(), radius["after"].as_str()), (Some("50"), Some("60")));
    assert_eq!(entries[4]["checksum"], last["checksum"]);
    assert!(log["sealed"].as_bool().unwrap());
    let shown = run_in(dir.path(), &["region", "log", "cell.toml"]).expect(0).stdout;
    assert!(shown.contains("radius is 60, sealed was 50") && shown.contains("wider"), "{shown}");
}

#[test]
fn what_is_no_edit_changes_nothing_and_says_why() {
    let dir = sealed();
    let before = (read(dir.path(), "cell.toml"), read(dir.path(), "cell.seal.jsonl"));
    write(dir.path(), "post.toml", &NEW.replace("NAME", "post").replace("LIFE", "temporary"));
    write(
        dir.path(),
        "law.toml",
        &format!("{}[monitor]\nstale_ms = 1\n", NEW.replace("NAME", "x").replace("LIFE", "temporary")),
    );
    write(dir.path(), "dotted.toml", "region.x.shape = \"sphere\"\n");
    write(dir.path(), "sub.toml", "[region.post.extra]\nshape = \"sphere\"\n");
    write(dir.path(), "none.toml", "# nothing\n");
    write(dir.path(), "wrong.toml", "[region.x]\nshape = \"sfere\"\n");
    let cases: &[(&[&str], &str)] = &[
        (&["add", "cell.toml", "post.toml"], "a region `post` already"),
        (&["add", "cell.toml", "law.toml"], "`monitor` is neither a region nor a fence"),
        (&["add", "cell.toml", "dotted.toml"], "outside of [region.NAME]"),
        (&["add", "cell.toml", "sub.toml"], "a region `post` already"),
        (&["add", "cell.toml", "none.toml"], "holds no region"),
        (&["add", "cell.toml", "wrong.toml"], "sphere"),
        (&["add", "cell.toml", "nowhere.toml"], "cannot be read"),
        (&["change", "cell.toml", "pots", "radius=1"], "no region `pots`"),
        (&["change", "cell.toml", "post", "radios=1"], "radius"),
        (&["change", "cell.toml", "post", "radius=-1"], "above 0"),
        (&["change", "cell.toml", "post", "--unset", "slow_to"], "no key `slow_to`"),
        (&["remove", "cell.toml", "pots"], "no region `pots`"),
        (&["laws", "cell.toml", "stale_ms=0"], "above 0"),
        (&["change", "cell.toml", "post", "radius"], "KEY=VALUE"),
        (&["change", "cell.toml", "post"], "KEY=VALUE"),
        (&["seal", "nowhere.toml"], "nowhere.toml"),
    ];
    for (args, words) in cases {
        let message = act(dir.path(), "integrator", args).expect(2).stderr;
        assert!(message.contains(words), "{args:?}: {message}");
        assert_eq!((read(dir.path(), "cell.toml"), read(dir.path(), "cell.seal.jsonl")), before, "{args:?}");
        assert!(!dir.path().join("cell.toml.new").exists(), "{args:?}");
    }
}

#[test]
fn a_program_that_grips_needs_no_new_seal() {
    let dir = sealed();
    let before = read(dir.path(), "cell.toml");
    let part = "[object.part]\nshape = \"sphere\"\nat = [0, 0, 3000]\nradius = 20\n\n[program.arm]";
    let grips = before.replace("[program.arm]", part).replace("steps = [", "steps = [{ grip = \"part\" }, ");
    assert!(grips.contains("grip") && grips.contains("[object.part]"), "{grips}");
    write(dir.path(), "cell.toml", &grips);
    // Programs and objects are not sealed, and so neither are the parts that a program grips.
    let answer = run_in(dir.path(), &["query", "cell.toml", "--ask", "distance"]).expect(0);
    assert!(!answer.stderr.contains("seal"), "{}", answer.stderr);
}
