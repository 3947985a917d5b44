//! Requests that somebody means ill with. Each is refused, and the panel goes on; docs/panel.md has a row for
//! each test.

use std::{
    io::{Read as _, Write as _},
    net::TcpStream,
    time::Duration,
};

use serde_json::{Value, json};
use testing::Seed;

use super::client::Panel;
use crate::shop::{Place, example};

/// A panel of a program that nobody has started.
fn idle(place: &Place) -> Panel {
    Panel::start(place, &["panel", &example("m20x2").display().to_string()])
}

#[test]
fn a_request_that_calls_the_panel_by_another_name_is_refused() {
    let place = Place::new();
    let panel = idle(&place);
    let token = format!("Authorization: Bearer {}\r\n", panel.token);
    let port = panel.address.rsplit(':').next().expect("a port").to_owned();
    let wrong = [
        String::new(),
        "Host: panel.example\r\n".into(),
        format!("Host: panel.example:{port}\r\n"),
        "Host: 127.0.0.1\r\n".into(),
        "Host: 127.0.0.1:1\r\n".into(),
        format!("Host: {}.\r\n", panel.address),
        format!("Host: {0}\r\nHost: panel.example\r\n", panel.address),
    ];
    for host in &wrong {
        for line in ["GET / HTTP/1.1", "GET /api/state HTTP/1.1", "POST /api/do HTTP/1.1"] {
            let (status, text) = panel.raw(format!("{line}\r\n{host}{token}\r\n").as_bytes());
            assert!([400, 403].contains(&status), "{host:?} {line}: {status} {text}");
        }
        let (_, (status, text)) = panel.upgrade(&format!("{host}{token}"));
        assert!([400, 403].contains(&status), "{host:?}: {text}");
    }
    let named = format!("GET /api/state HTTP/1.1\r\nHost: localhost:{port}\r\n{token}\r\n");
    assert_eq!(panel.raw(named.as_bytes()).0, 200);
    panel.is_well();
}

#[test]
fn a_page_of_another_site_is_refused() {
    let place = Place::new();
    let panel = idle(&place);
    let host = format!("Host: {}\r\nAuthorization: Bearer {}\r\n", panel.address, panel.token);
    let sites = [
        "Origin: http://panel.example\r\n".to_owned(),
        "Origin: null\r\n".into(),
        format!("Origin: https://{}\r\n", panel.address),
        format!("Origin: http://{}.panel.example\r\n", panel.address),
        format!("Origin: http://{}\r\nOrigin: http://panel.example\r\n", panel.address),
        "Sec-Fetch-Site: cross-site\r\n".into(),
        "Sec-Fetch-Site: same-site\r\n".into(),
    ];
    for site in &sites {
        for line in ["GET /", "GET /api/state", "POST /api/do"] {
            assert_eq!(panel.request(line, site, "").0, 403, "{site} {line}");
        }
        let (_, (status, text)) = panel.upgrade(&format!("{host}{site}"));
        assert_eq!(status, 403, "{site}: {text}");
    }
    panel.is_well();
}

#[test]
fn without_the_token_nothing_is_seen_and_nothing_pressed() {
    let place = Place::new();
    let panel = idle(&place);
    assert!(panel.token.len() >= 32 && panel.token.bytes().all(|byte| byte.is_ascii_hexdigit()));
    let other = idle(&Place::new());
    assert_ne!(panel.token, other.token);
    let short = &panel.token[1..];
    for said in [
        "",
        "Bearer ",
        "Bearer x",
        &panel.token,
        &format!("Bearer {short}"),
        &format!("Bearer {}", other.token),
    ] {
        let header = format!("Authorization: {said}\r\nContent-Type: application/json\r\n");
        assert_eq!(panel.bare("GET /api/state", &header, "").0, 401, "{said}");
        let press = "{\"id\":1,\"do\":\"take-seat\",\"as\":\"me\"}";
        assert_eq!(panel.bare("POST /api/do", &header, press).0, 401, "{said}");
        let secret = said.strip_prefix("Bearer ").unwrap_or_default();
        let protocol = format!("Sec-WebSocket-Protocol: pitchlock.panel.1, token.{secret}");
        let (_, (status, text)) = panel.upgrade(&format!("Host: {}\r\n{protocol}\r\n", panel.address));
        assert!([400, 401].contains(&status), "{said}: {text}");
    }
    let (status, page) = panel.bare("GET /", "", "");
    assert!(status == 200 && !page.contains(&panel.token), "the page itself holds no secret");
    let told = std::fs::read_to_string(format!("/proc/{}/cmdline", panel.server().expect("it runs")));
    assert!(!told.expect("it runs").contains(&panel.token), "other users see command lines");
    panel.is_well();
}

#[test]
fn a_get_changes_nothing() {
    let place = Place::new();
    let panel = idle(&place);
    let body = "{\"id\":1,\"do\":\"take-seat\",\"as\":\"me\"}";
    let json = "Content-Type: application/json\r\n";
    for method in ["GET", "HEAD", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE"] {
        assert_eq!(panel.request(&format!("{method} /api/do"), json, body).0, 405, "{method}");
        assert_eq!(panel.request(&format!("{method} /api/do?do=take-seat&as=me&id=1"), json, "").0, 405);
    }
    for (line, status) in [("POST /api/state", 405), ("POST /", 405), ("DELETE /panel.js", 405)] {
        assert_eq!(panel.request(line, json, body).0, status, "{line}");
    }
    panel.is_well();
}

#[test]
fn a_form_of_a_page_does_nothing() {
    let place = Place::new();
    let panel = idle(&place);
    let body = "{\"id\":1,\"do\":\"take-seat\",\"as\":\"me\"}";
    for kind in ["", "Content-Type: text/plain\r\n", "Content-Type: application/x-www-form-urlencoded\r\n"] {
        assert_eq!(panel.request("POST /api/do", kind, body).0, 415, "{kind}");
    }
    panel.is_well();
}

#[test]
fn a_body_of_a_gigabyte_is_not_read() {
    let place = Place::new();
    let panel = idle(&place);
    let head = format!(
        "POST /api/do HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\nContent-Type: application/json\r\n",
        panel.address, panel.token
    );
    let (status, text) = panel.raw(format!("{head}Content-Length: 1000000000\r\n\r\n").as_bytes());
    assert_eq!(status, 413, "{text}");
    let chunk = format!("2000\r\n{}\r\n", "x".repeat(0x2000));
    let chunks = format!("{head}Transfer-Encoding: chunked\r\n\r\n{}", chunk.repeat(500));
    let (status, _) = panel.raw(chunks.as_bytes());
    assert!([0, 413].contains(&status), "{status}: refused, or cut off while it still sends");
    let both = format!("{head}Content-Length: 5\r\nContent-Length: 6\r\n\r\n{{}}");
    assert_eq!(panel.raw(both.as_bytes()).0, 400);
    panel.is_well();
}

#[test]
fn a_head_without_an_end_and_one_that_is_too_long_are_cut_off() {
    let place = Place::new();
    let panel = idle(&place);
    let mut slow = panel.connect();
    let mut stands = panel.connect();
    let mut unfinished = panel.connect();
    unfinished.write_all(b"GET / HTTP/1.1\r\nHost: ").expect("it is taken");
    // Meanwhile others are served.
    for byte in b"GET /api/state HTTP/1.1\r\n" {
        let _ = slow.write_all(&[*byte]);
        panel.is_well();
    }
    for stream in [&mut slow, &mut stands, &mut unfinished] {
        // It ends by itself: nothing more is sent.
        let mut rest = Vec::new();
        let _ = stream.read_to_end(&mut rest);
        let rest = String::from_utf8_lossy(&rest).into_owned();
        assert!(rest.is_empty() || rest.starts_with("HTTP/1.1 4"), "{rest}");
    }
    for head in
        [format!("GET /{}", "a".repeat(70_000)), format!("GET / HTTP/1.1\r\nX: {}", "a".repeat(70_000))]
    {
        let (status, _) = panel.raw(format!("{head} HTTP/1.1\r\n\r\n").as_bytes());
        assert!([0, 400, 414, 431].contains(&status), "{status}");
    }
    panel.is_well();
}

#[test]
fn very_many_sockets_leave_the_panel_as_it_is() {
    let place = Place::new();
    let panel = idle(&place);
    let address = panel.address.parse().expect("an address");
    // Those that the system has no room for do not come in at all.
    let brief = Duration::from_millis(5);
    let many = testing::count("PITCHLOCK_SOCKETS", 600);
    let sockets: Vec<_> =
        (0..many).filter_map(|_| TcpStream::connect_timeout(&address, brief).ok()).collect();
    assert!(sockets.len() > 64, "{} came in", sockets.len());
    let files =
        std::fs::read_dir(format!("/proc/{}/fd", panel.server().expect("it runs"))).expect("its files");
    assert!(files.count() < 120, "no more than have a place are opened");
    drop(sockets);
    panel.is_well();
    let watching: Vec<_> = (0..32).map(|_| panel.socket()).collect();
    let (_, (status, _)) =
        panel.upgrade(&format!("Host: {}\r\nAuthorization: Bearer {}\r\n", panel.address, panel.token));
    assert_eq!(status, 503, "so many watch already");
    drop(watching);
    panel.is_well();
}

#[test]
fn frames_that_break_the_rules_close_their_socket() {
    let place = Place::new();
    let panel = idle(&place);
    let mut good = panel.socket();
    let cases: [(&str, u8, usize); 7] = [
        ("a text that is too long", 0x81, 70_000),
        ("bytes", 0x82, 10),
        ("a kind that is none", 0x83, 10),
        ("a reserved bit", 0xC1, 10),
        ("a part of nothing", 0x80, 10),
        ("a ping that is too long", 0x89, 200),
        ("a text that is not UTF-8", 0x81, 3),
    ];
    for (what, first, length) in cases {
        let mut socket = panel.socket();
        socket.frame(first, &vec![0xFF; length]);
        assert!(socket.is_closed(), "{what}");
    }
    let mut socket = panel.socket();
    socket.0.write_all(b"\x81\x05hello").expect("it is taken");
    assert!(socket.is_closed(), "a client has to mask");
    let mut socket = panel.socket();
    socket.0.write_all(b"\x81\xFF\x7F\xFF\xFF\xFF\xFF\xFF\xFF\xFF\0\0\0\0").expect("it is taken");
    assert!(socket.is_closed(), "an exabyte to come");
    good.say(&json!({ "id": 5, "do": "hold", "as": "me" }));
    assert_eq!(good.answer(&json!(5)).expect("it lives")["refused"], "no-seat");
    panel.is_well();
}

#[test]
fn no_path_leads_out_of_the_pages() {
    let place = Place::new();
    let panel = idle(&place);
    for path in [
        "/../Cargo.toml",
        "/../../../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/..%2f..%2fetc/passwd",
        "/panel.js/../../../etc/passwd",
        "//etc/passwd",
        "/api/../../etc/passwd",
        "/index.html",
        "/summary.json",
        "/panel.js%00",
        "/etc/passwd",
    ] {
        let (status, text) = panel.request(&format!("GET {path}"), "", "");
        assert_eq!((status, text.contains("root:")), (404, false), "{path}");
    }
    panel.is_well();
}

#[test]
fn what_is_no_http_is_cut_off() {
    let place = Place::new();
    let panel = idle(&place);
    let mut seed = Seed::new(20);
    for _ in 0..100 {
        let length = 1 + seed.below(400);
        let mut bytes: Vec<u8> = (0..length).map(|_| seed.next() as u8).collect();
        bytes.extend(b"\r\n\r\n");
        let (status, text) = panel.raw(&bytes);
        assert!([0, 400, 403].contains(&status), "{status}: {text}");
    }
    panel.is_well();
}

#[test]
fn every_answer_forbids_what_a_page_does_not_need_and_none_lets_other_sites_read() {
    let place = Place::new();
    let panel = idle(&place);
    for (line, headers) in [
        ("GET /", ""),
        ("GET /nowhere", ""),
        ("GET /api/state", ""),
        ("OPTIONS /api/do", "Access-Control-Request-Method: POST\r\n"),
        ("POST /api/do", "Origin: http://panel.example\r\n"),
    ] {
        let mut stream = panel.connect();
        let host = &panel.address;
        stream
            .write_all(format!("{line} HTTP/1.1\r\nHost: {host}\r\n{headers}\r\n").as_bytes())
            .expect("taken");
        let mut text = String::new();
        let _ = stream.read_to_string(&mut text);
        let head = text.to_lowercase();
        let head = head.split("\r\n\r\n").next().expect("a head");
        for needed in ["content-security-policy: default-src 'self';", "nosniff", "no-referrer", "no-store"] {
            assert!(head.contains(needed), "{line}: {needed}: {head}");
        }
        assert!(
            head.contains("frame-ancestors 'none'") && !head.contains("access-control-"),
            "{line}: {head}"
        );
    }
    for (path, _, content) in panel::PAGES {
        let away = ["http://", "https://", "//cdn", "@import", "style=\"", "onclick=\"", "eval("];
        let own = content.replace("ws://${location.host}", "").replace("http://www.w3.org", "");
        assert!(!away.iter().any(|link| own.contains(link)), "{path} needs nothing from elsewhere");
    }
    let bytes: usize = panel::PAGES.iter().map(|(.., content)| content.len()).sum();
    assert!(bytes <= 250_000, "{bytes} bytes");
}

#[test]
fn words_and_values_that_mean_nothing_are_refused_by_name() {
    let place = Place::new();
    let panel = idle(&place);
    let mut socket = panel.socket();
    for (document, code) in [
        (json!({ "id": 1, "do": "format", "as": "me" }), "unknown"),
        (json!({ "id": 1, "do": "home", "as": "me" }), "bad-value"),
        (json!({ "id": 1, "do": "jog", "as": "me", "value": 5 }), "bad-value"),
        (
            json!({ "id": 1, "do": "jog", "as": "me", "value": { "axis": "X", "mm_min": 1, "way": "up" } }),
            "bad-value",
        ),
        (json!({ "id": 1, "do": "mdi", "as": "me", "value": "G".repeat(600) }), "bad-value"),
        (json!({ "id": 1, "do": "mdi", "as": "me", "value": " " }), "bad-value"),
        (
            json!({ "id": 1, "do": "touch-off", "as": "me", "value": { "axis": "X", "value": 1e9 } }),
            "bad-value",
        ),
        (json!({ "id": 1, "do": "spindle", "as": "me", "value": "fast" }), "bad-value"),
        (json!({ "id": 1, "do": "feed-override", "as": "me", "value": "60" }), "bad-value"),
        (json!({ "id": 1, "do": "feed-override", "as": "me", "value": 1e300 }), "bad-value"),
        (json!({ "id": 1, "do": "hold", "as": "me", "value": true }), "bad-value"),
        (json!({ "id": 1, "do": ["hold"], "as": "me" }), "bad-request"),
        (json!({ "id": 1, "do": "hold", "as": "<script>" }), "bad-request"),
        (json!({ "id": 1, "do": "hold", "as": "me" }), "no-seat"),
        (json!([1, 2, 3]), "bad-request"),
    ] {
        let answer = panel.ask(&document);
        assert_eq!((answer["refused"].as_str(), answer["why"].is_string()), (Some(code), true), "{answer}");
        socket.say(&document);
        let again = socket.answer(&answer["id"]).expect("it lives");
        assert_eq!(again, answer, "the same by both ways");
    }
    let (status, _) = panel.request("POST /api/do", "Content-Type: application/json\r\n", &"[".repeat(1000));
    assert_eq!(status, 400, "as deep as it can be");
    panel.is_well();
}

#[test]
fn whoever_asks_without_end_and_reads_nothing_hinders_nobody() {
    let place = Place::new();
    let panel = idle(&place);
    let mut flood = panel.socket();
    flood.0.set_nonblocking(true).expect("it need not wait");
    let document = json!({ "id": 1, "do": "hold", "as": "me" }).to_string();
    for _ in 0..20_000 {
        flood.frame(0x81, document.as_bytes());
    }
    panel.is_well();
    let mut other = panel.socket();
    other.say(&json!({ "id": "other", "do": "stop", "as": "me" }));
    assert_eq!(other.answer(&Value::from("other")).expect("it lives")["refused"], "no-seat");
    panel.is_well();
}
