//! Who is let in. In: the head of a request. Out: nothing, or a refusal. Every request goes through here,
//! upgrades included, before anything looks at what it asks for.
//!
//! `Host` has to be the address by which the request came in: a page of another site whose name was bound to
//! this address anew says its own name. `Origin` has to be the panel itself, where a browser sends one.

use std::{net::SocketAddr, sync::Arc};

use axum::{
    Extension,
    extract::{Request, State},
    http::{HeaderMap, HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse as _, Response},
};

use super::{api::MOST_ASKED, house::House};

/// The address by which a request came in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Here(pub(crate) SocketAddr);

/// By this name clients of a WebSocket ask for the panel; another one is `token.` with the secret.
pub(crate) const PROTOCOL: &str = "pitchlock.panel.1";

/// The names that a request may call this address by.
fn names(here: SocketAddr) -> Vec<String> {
    let mut names = vec![here.to_string()];
    if here.ip().is_loopback() {
        names.push(format!("localhost:{}", here.port()));
    }
    if here.port() == 80 {
        names.extend(names.clone().iter().filter_map(|name| name.strip_suffix(":80")).map(str::to_owned));
    }
    names
}

/// A header that stands there at most once, as text.
fn only(headers: &HeaderMap, name: header::HeaderName) -> Result<Option<&str>, ()> {
    let mut all = headers.get_all(name).iter();
    let first = all.next().map(|value| value.to_str().map_err(drop)).transpose()?;
    if all.next().is_some() { Err(()) } else { Ok(first) }
}

/// Why a request is refused.
fn refusal(request: &Request, here: SocketAddr, house: &House) -> Option<(StatusCode, String)> {
    let headers = request.headers();
    let names = names(here);
    match only(headers, header::HOST) {
        Ok(Some(host)) if names.iter().any(|name| name == host) => {}
        _ => return Some((StatusCode::FORBIDDEN, format!("Host has to be {}", names.join(" or ")))),
    }
    match only(headers, header::ORIGIN) {
        Ok(None) => {}
        Ok(Some(origin)) if names.iter().any(|name| origin == format!("http://{name}")) => {}
        _ => return Some((StatusCode::FORBIDDEN, "Origin is another page than the panel".into())),
    }
    let site = headers.get("sec-fetch-site").map(HeaderValue::as_bytes);
    if site.is_some_and(|site| ![&b"same-origin"[..], b"none"].contains(&site)) {
        return Some((StatusCode::FORBIDDEN, "another page has asked for this".into()));
    }
    let length = headers.get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok());
    if length.is_some_and(|length| length.parse().map_or(true, |length: usize| length > MOST_ASKED)) {
        let why = format!("a body has {MOST_ASKED} bytes at most");
        return Some((StatusCode::PAYLOAD_TOO_LARGE, why));
    }
    let path = request.uri().path();
    if !path.starts_with("/api/") {
        return None;
    }
    if path == "/api/do" && request.method() != Method::POST {
        return Some((StatusCode::METHOD_NOT_ALLOWED, "only POST does something".into()));
    }
    let said = only(headers, header::AUTHORIZATION).ok().flatten();
    let bearer = said.and_then(|said| said.strip_prefix("Bearer "));
    let protocols = only(headers, header::SEC_WEBSOCKET_PROTOCOL).ok().flatten().unwrap_or_default();
    let by_protocol = protocols.split(',').find_map(|one| one.trim().strip_prefix("token."));
    match bearer.or(by_protocol) {
        Some(token) if house.knows(token) => None,
        _ => {
            let why = "the token is wrong or missing: it stands in the address that was printed";
            Some((StatusCode::UNAUTHORIZED, why.into()))
        }
    }
}

/// What every answer says to a browser.
const HEADERS: [(&str, &str); 7] = [
    (
        "content-security-policy",
        "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("x-frame-options", "DENY"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cache-control", "no-store"),
];

/// Lets a request through, or refuses it.
pub(crate) async fn guard(
    State(house): State<Arc<House>>,
    Extension(Here(here)): Extension<Here>,
    request: Request,
    next: Next,
) -> Response {
    let mut response = match refusal(&request, here, &house) {
        Some((status, why)) => (status, format!("{why}\n")).into_response(),
        None => next.run(request).await,
    };
    if response.status() == StatusCode::METHOD_NOT_ALLOWED {
        response.headers_mut().entry(header::ALLOW).or_insert(HeaderValue::from_static("POST"));
    }
    // Said here and not by the server, which would say it of an upgrade as well: some clients refuse that.
    if response.status() != StatusCode::SWITCHING_PROTOCOLS {
        response.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
    }
    for (name, value) in HEADERS {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}
