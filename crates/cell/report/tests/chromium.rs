//! A page in headless Chromium.
#![allow(clippy::print_stdout, reason = "a skipped test says so")]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

const TIMEOUT: Duration = Duration::from_secs(100);

/// Before all other scripts: records errors.
const WATCH: &str = "<script>
window.problems = [];
addEventListener('error', (event) => problems.push(event.message));
addEventListener('unhandledrejection', (event) => problems.push(String(event.reason)));
const log = console.error;
console.error = (...words) => { problems.push(words.join(' ')); log(...words); };
</script>";

/// The browser; without one, prints a line.
pub fn chromium() -> Option<PathBuf> {
    let named = std::env::var_os("ELBOWROOM_CHROMIUM").map(PathBuf::from);
    if named.is_none() {
        println!("skipped: no browser; name a Chromium in ELBOWROOM_CHROMIUM (cargo xtask test --only tests)");
    }
    named
}

/// A separate folder for each test.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("browser-{name}"));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Opens a page, and returns what its last script wrote into `<pre id="seen">` as JSON in base64; no error may reach the
/// console. Headless Chromium has windows of 500 px and more, so that a narrower page is a frame.
pub fn seen(chromium: &Path, folder: &Path, page: &str, width: u32) -> Value {
    let page = page.replacen("<head>", &format!("<head>{WATCH}"), 1);
    let file = folder.join("page.html");
    std::fs::write(&file, if width < 500 { framed(&page, width) } else { page }).unwrap();
    let out = folder.join("dom.html");
    let size = format!("--window-size={width},900");
    let profile = format!("--user-data-dir={}", folder.join("profile").display());
    let mut browser = Command::new(chromium)
        .args([
            "--headless",
            "--no-sandbox",
            "--enable-unsafe-swiftshader",
            "--virtual-time-budget=20000",
            "--dump-dom",
        ])
        .args([&size, &profile])
        .arg(format!("file://{}", file.display()))
        .stdout(std::fs::File::create(&out).unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap_or_else(|e| panic!("{}: {e}", chromium.display()));
    let begin = Instant::now();
    while browser.try_wait().unwrap().is_none() {
        if begin.elapsed() > TIMEOUT {
            let _ = browser.kill();
            panic!("{} did not end in {} s", chromium.display(), TIMEOUT.as_secs());
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let dom = std::fs::read_to_string(&out).unwrap();
    let from = dom.find("<pre id=\"seen\">").expect("the page was played to the end") + "<pre id=\"seen\">".len();
    let text = &dom[from..from + dom[from..].find('<').unwrap()];
    let seen: Value = serde_json::from_slice(&STANDARD.decode(text).unwrap()).unwrap();
    assert_eq!(seen["problems"], json!([]), "errors on the page");
    seen
}

/// A page in a frame of this width, as on a phone.
fn framed(page: &str, width: u32) -> String {
    let page = STANDARD.encode(page);
    format!(
        "<!DOCTYPE html><body><iframe style=\"width:{width}px;height:844px;border:0\"></iframe><script>\
         document.querySelector('iframe').srcdoc = \
         new TextDecoder().decode(Uint8Array.from(atob('{page}'), (c) => c.charCodeAt(0)));</script></body>"
    )
}
