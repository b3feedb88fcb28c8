//! Requests that a server refuses, and its work afterwards.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::common::{Page, answer, cell, get, limits, open, settings, status, token};
use elbowroom_testkit::certificate::write_certificate;
use elbowroom_testkit::random::split_mix;
use elbowroom_view::http::{Endpoint, TlsClient, TlsIdentity};
use elbowroom_view::{ClientLimits, Server, ServerSettings};
use serde_json::json;
use tungstenite::Message;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;

fn server() -> Server {
    Server::jog(&cell(), settings()).unwrap()
}

/// Checks that a page gets its frames.
fn assert_alive(server: &Server) {
    assert_eq!(status(&get(server.address(), "/", "")), 200);
    assert!(Page::of(server).frame().unwrap()["robots"].as_array().unwrap().len() == 2);
}

#[test]
fn a_wrong_token_sees_nothing() {
    let server = server();
    for wrong in [json!({ "token": "" }), json!({ "token": "0".repeat(64) }), json!({ "token": &token(&server)[..63] })]
    {
        let mut page = Page::nameless(&server);
        page.send(&wrong);
        assert_eq!(page.next().unwrap_err(), "4401 the token is another one");
    }
    let mut silent = Page::nameless(&server);
    assert_eq!(silent.next().unwrap_err(), "1013 no token has come");
    // A command before the token is refused.
    let mut hasty = Page::nameless(&server);
    hasty.send(&json!({ "type": "home" }));
    assert!(hasty.next().unwrap_err().starts_with("4400"));
    let address = server.address();
    for headers in ["", "Authorization: Bearer \r\n", "Authorization: Bearer abc\r\n", "Authorization: Basic abc\r\n"] {
        assert_eq!(status(&get(address, "/geometry", headers)), 401, "{headers}");
        assert_eq!(status(&get(address, "/history", headers)), 401, "{headers}");
    }
    let right = format!("Authorization: Bearer {}\r\n", token(&server));
    assert_eq!(status(&get(address, "/geometry", &right)), 200);
    // Files that need no token say nothing about the cell.
    for path in ["/", "/view.js", "/view.css"] {
        assert!(!get(address, path, "").contains("two arms"));
    }
    assert_alive(&server);
}

#[test]
fn pages_of_others_and_other_hosts_are_refused() {
    let server = server();
    let address = server.address();
    let host = address.to_string();
    for origin in ["http://evil.example", "null", "https://127.0.0.1", &format!("https://{host}"), "http://localhost:1"]
    {
        assert!(open(address, &host, Some(origin)).is_err_and(|e| e.contains("403")), "{origin}");
    }
    assert!(open(address, &host, None).is_err_and(|e| e.contains("403")));
    for other in ["evil.example", "evil.example:80", "127.0.0.1", "127.0.0.1:1", "0.0.0.0:80"] {
        assert!(open(address, other, Some(&format!("http://{other}"))).is_err_and(|e| e.contains("421")), "{other}");
        let request = format!("GET / HTTP/1.1\r\nHost: {other}\r\n\r\n");
        assert_eq!(status(&answer(address, request.as_bytes())), 421, "{other}");
    }
    assert_eq!(status(&answer(address, b"GET / HTTP/1.0\r\n\r\n")), 421);
    let local = format!("localhost:{}", address.port());
    assert!(open(address, &local, Some(&format!("http://{local}"))).is_ok());
    assert_alive(&server);
}

#[test]
fn only_the_files_of_the_page_are_served() {
    let server = server();
    let address = server.address();
    for path in [
        "/../../../../etc/passwd",
        "/..%2f..%2f..%2fetc%2fpasswd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/....//....//etc/passwd",
        "/view.js/../../etc/passwd",
        "//etc/passwd",
        "/etc/passwd",
        "/three.js%00.html",
        "/.git/config",
        "/C:/Windows/win.ini",
        "/..\\..\\etc\\passwd",
        "http://evil.example/",
        "/view.js.map",
    ] {
        let answer = get(address, path, "");
        // An absolute address is one of the root; any other is not found, or not an address at all.
        assert!(matches!(status(&answer), 400 | 404 | 421 | 0) || path.starts_with("http"), "{path}: {answer}");
        assert!(!answer.contains("root:"), "{path}");
    }
    for path in ["/", "/view.css", "/three.js", "/view.js"] {
        let answer = get(address, path, "");
        assert_eq!(status(&answer), 200);
        for header in [
            "content-security-policy: default-src 'none'",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
        ] {
            assert!(answer.contains(header), "{path} lacks {header}");
        }
    }
    assert_alive(&server);
}

#[test]
fn bodies_long_heads_and_large_messages_are_refused() {
    let server = server();
    let address = server.address();
    let with_body = |method: &str, body: &str| {
        let length = body.len();
        let head = format!("{method} / HTTP/1.1\r\nHost: {address}\r\nContent-Length: {length}\r\n\r\n");
        status(&answer(address, (head + body).as_bytes()))
    };
    let large = "x".repeat(4 << 20);
    assert_eq!(with_body("POST", "abc"), 405);
    assert_eq!(with_body("GET", "abc"), 413);
    assert!(matches!(with_body("POST", &large), 405 | 0));
    assert!(matches!(with_body("GET", &large), 413 | 0));
    let claims = format!("GET / HTTP/1.1\r\nHost: {address}\r\nContent-Length: 99999999999999\r\n\r\n");
    assert_eq!(status(&answer(address, claims.as_bytes())), 413);
    let chunked = "Transfer-Encoding: chunked\r\n";
    assert_eq!(status(&get(address, "/", chunked)), 413);
    assert!(matches!(status(&get(address, "/", &format!("X: {large}\r\n"))), 400 | 431 | 0));
    assert!(matches!(status(&get(address, &format!("/{large}"), "")), 400 | 414 | 431 | 0));
    assert!(matches!(status(&get(address, "/", &"X: y\r\n".repeat(500))), 400 | 431 | 0));
    let mut page = Page::of(&server);
    let _ = page.send_raw(Message::text(large));
    while page.next().is_ok() {}
    assert_alive(&server);
}

#[test]
fn garbage_ends_only_the_page_that_sends_it() {
    let server = server();
    let mut other = Page::of(&server);
    other.frame().unwrap();
    let mut random = 17;
    let mut byte = || split_mix(&mut random) as u8;
    let mut texts: Vec<String> = vec![
        "{".into(),
        "[]".into(),
        "null".into(),
        "{\"type\":\"jog\"}".into(),
        "{\"type\":\"jog\",\"robot\":-1,\"q\":[]}".into(),
        "{\"type\":\"jog\",\"robot\":0,\"q\":[\"a\"]}".into(),
        "{\"type\":\"shutdown\"}".into(),
        "[".repeat(10_000),
        format!("{{\"type\":\"tcp\",\"robot\":0,\"position_m\":[1e999,0,0]}}"),
    ];
    texts.extend((0..150).map(|_| (0..byte()).map(|_| char::from(byte())).collect()));
    for (i, text) in texts.iter().enumerate() {
        let mut page = if i % 2 == 0 { Page::of(&server) } else { Page::nameless(&server) };
        let message = if i % 3 == 0 { Message::binary(text.clone().into_bytes()) } else { Message::text(text.clone()) };
        let _ = page.send_raw(message);
        let end =
            std::iter::from_fn(|| page.next().err().map_or(Some(None), |e| Some(Some(e)))).flatten().next().unwrap();
        assert!(end.starts_with("4400"), "{text:?}: {end}");
    }
    // Bytes that are not a WebSocket, and requests that are invalid.
    for _ in 0..200 {
        let bytes: Vec<u8> = (0..byte()).map(|_| byte()).collect();
        let mut stream = TcpStream::connect(server.address()).unwrap();
        let _ = stream.write_all(&bytes);
    }
    other.send(&json!({ "type": "jog", "robot": 1, "q": [0.1, 0.2] }));
    other.frame_where(|frame| frame["robots"][1]["q"] == json!([0.1, 0.2]));
    assert_alive(&server);
}

#[test]
fn a_thousand_hanging_connections_keep_nobody_out() {
    // Two waves are more than the server keeps; larger waves would wait for a second until the system accepts them.
    const WAVE: usize = 100;
    // 10,000 connections with `ELBOWROOM_LONG=1`.
    let waves = elbowroom_testkit::extent::amount(10, 100);
    let server = server();
    let address = server.address();
    let begin = Instant::now();
    let mut slowest = Duration::ZERO;
    let mut hanging: Vec<TcpStream> = Vec::new();
    for _ in 0..waves {
        hanging.drain(..hanging.len().saturating_sub(WAVE));
        for k in 0..WAVE {
            let Ok(mut stream) = TcpStream::connect(address) else { continue };
            let sent = match k % 3 {
                // Nothing, half a head, and the whole head of a WebSocket without its token.
                0 => String::new(),
                1 => format!("GET / HTTP/1.1\r\nHost: {address}\r\nX-Slow: "),
                _ => format!(
                    "GET /socket HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: Upgrade\r\n\
                     Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
                ),
            };
            let _ = stream.write_all(sent.as_bytes());
            hanging.push(stream);
        }
        let asked = Instant::now();
        assert_alive(&server);
        slowest = slowest.max(asked.elapsed());
    }
    eprintln!("{} connections in {:?}, the slowest answer took {slowest:?}", waves * WAVE, begin.elapsed());
    assert!(slowest < Duration::from_secs(10), "{slowest:?}");
    // The server closes connections that still hang within its limits.
    for mut stream in hanging {
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let closed = std::io::copy(&mut stream, &mut std::io::sink());
        assert!(closed.is_ok() || closed.is_err_and(|e| e.kind() == std::io::ErrorKind::ConnectionReset));
    }
    assert_alive(&server);
}

/// The order of acceptance counts, not the order in which the server processes connections.
#[test]
fn a_websocket_is_as_old_as_its_connection() {
    let long = Duration::from_secs(10);
    let two =
        ServerSettings { limits: ClientLimits { connections: 2, head: long, request: long, ..limits() }, ..settings() };
    let server = Server::jog(&cell(), two).unwrap();
    let address = server.address();
    let connect = || {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(long / 2)).unwrap();
        stream
    };
    let (mut page, mut younger) = (connect(), connect());
    let upgrade = format!(
        "GET /socket HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: Upgrade\r\n\
         Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    );
    page.write_all(upgrade.as_bytes()).unwrap();
    let mut upgraded = [0; 12];
    page.read_exact(&mut upgraded).unwrap();
    assert_eq!(&upgraded, b"HTTP/1.1 101");
    let mut youngest = connect();
    std::io::copy(&mut page, &mut std::io::sink()).expect("the oldest connection makes room");
    for stream in [&mut younger, &mut youngest] {
        write!(stream, "GET /view.css HTTP/1.1\r\nHost: {address}\r\n\r\n").unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        assert_eq!(status(&String::from_utf8_lossy(&answer)), 200);
    }
}

#[test]
fn more_browsers_than_allowed_are_refused_with_a_reason() {
    let few = ServerSettings { limits: ClientLimits { browsers: 2, ..limits() }, ..settings() };
    let server = Server::jog(&cell(), few).unwrap();
    let (mut one, two) = (Page::of(&server), Page::of(&server));
    let mut three = Page::nameless(&server);
    three.send(&json!({ "token": token(&server) }));
    assert!(three.next().unwrap_err().starts_with("4429 too many browsers"));
    drop(two);
    one.frame().unwrap();
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(10) {
        let mut again = Page::nameless(&server);
        again.send(&json!({ "token": token(&server) }));
        if again.next().is_ok() {
            return;
        }
    }
    panic!("the place of a browser that is gone stays taken");
}

#[test]
fn a_stopped_server_is_gone() {
    let server = server();
    let address = server.address();
    let mut page = Page::of(&server);
    server.stop();
    while page.next().is_ok() {}
    assert!(TcpStream::connect_timeout(&address, Duration::from_millis(500)).is_err());
}

/// With a certificate a page is served to other computers, and nobody in between can read it.
#[test]
fn with_a_certificate_everything_is_encrypted() {
    let folder = tempfile::tempdir().unwrap();
    let (certificate, key) = write_certificate(folder.path(), "cell", &["127.0.0.1", "cell.local"]);
    let (other, other_key) = write_certificate(folder.path(), "other", &["127.0.0.1"]);
    let refused = TlsIdentity::read(&certificate, &other_key).unwrap_err().to_string();
    assert!(refused.contains("other.key.pem") && refused.contains("the private key of the certificate"), "{refused}");
    for (certificate, key) in [(&certificate, &certificate), (&key, &key), (&folder.path().join("none.pem"), &key)] {
        let refused = TlsIdentity::read(certificate, key).unwrap_err().to_string();
        assert!(refused.contains(".pem: ") && refused.contains("write: "), "{refused}");
    }
    let pem = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        file
    };
    let garbage = pem("garbage.pem", "-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n");
    let refused = TlsIdentity::read(&garbage, &key).unwrap_err().to_string();
    assert!(refused.contains("garbage.pem: "), "the certificate is named: {refused}");
    let open = pem("open.pem", &std::fs::read_to_string(&key).unwrap());
    let refused = TlsIdentity::read(&certificate, &open).unwrap_err().to_string();
    assert!(cfg!(not(unix)) || refused.contains("others may read"), "{refused}");
    let locked = std::fs::read_to_string(&key).unwrap().replace("PRIVATE KEY", "ENCRYPTED PRIVATE KEY");
    std::fs::write(&other_key, locked).unwrap();
    let refused = TlsIdentity::read(&other, &other_key).unwrap_err().to_string();
    assert!(refused.contains("encrypted with a password"), "{refused}");
    let identity = TlsIdentity::read(&certificate, &key).unwrap();
    assert!(Endpoint::new("0.0.0.0:0", Some(identity.clone())).is_ok(), "other computers are served");
    let endpoint = Endpoint::new("127.0.0.1:0", Some(identity)).unwrap();
    let server = Server::jog(&cell(), ServerSettings { limits: limits(), ..ServerSettings::new(endpoint) }).unwrap();
    let address = server.address();
    assert!(server.url().starts_with("https://"), "{}", server.url());

    let connect = |trusted: &Path, name: &str| {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        TlsClient::trusting(trusted).unwrap().connect(name, stream)
    };
    let ask = |trusted: &Path, name: &str| -> std::io::Result<String> {
        let (mut stream, mut answer) = (connect(trusted, name)?, Vec::new());
        stream.write_all(format!("GET / HTTP/1.1\r\nHost: {name}\r\n\r\n").as_bytes())?;
        stream.read_to_end(&mut answer)?;
        Ok(String::from_utf8_lossy(&answer).into_owned())
    };
    for name in ["127.0.0.1", "cell.local"] {
        assert_eq!(status(&ask(&certificate, name).unwrap()), 200, "{name}");
    }
    // A client refuses a server with another certificate or another name.
    assert!(ask(&other, "127.0.0.1").is_err() && ask(&certificate, "evil.example").is_err());
    // Nothing is sent unencrypted; the frames of the cell are encrypted as well.
    assert!(!get(address, "/", "").contains("200 OK"));
    let request = |origin: &str| {
        let mut request = format!("wss://cell.local:{}/socket", address.port()).into_client_request().unwrap();
        request.headers_mut().insert("origin", HeaderValue::from_str(origin).unwrap());
        request
    };
    let own = format!("https://cell.local:{}", address.port());
    let open = |origin: &str| {
        let stream = connect(&certificate, "cell.local").unwrap();
        tungstenite::client(request(origin), stream).map(|(socket, _)| socket).map_err(|e| e.to_string())
    };
    let mut socket = open(&own).unwrap();
    socket.send(Message::text(json!({ "token": token(&server) }).to_string())).unwrap();
    let frame = (0..5).find_map(|_| socket.read().ok()?.into_text().ok().filter(|text| text.contains("\"robots\"")));
    assert!(frame.is_some_and(|frame| frame.contains("left")), "frames come");
    assert!(open(&own.replace("https", "http")).is_err() && open("https://evil.example").is_err());
    // Handshakes that hang are closed within the time limit of a head, and other connections work.
    let hanging: Vec<TcpStream> = (0..8).map(|_| TcpStream::connect(address).unwrap()).collect();
    let begun = Instant::now();
    for mut stream in hanging {
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let _ = stream.write_all(&[22, 3, 1, 2, 0, 1]);
        let mut byte = [0];
        assert!(!matches!(stream.read(&mut byte), Ok(1)), "nothing is answered");
    }
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    assert_eq!(status(&ask(&certificate, "cell.local").unwrap()), 200);
}
