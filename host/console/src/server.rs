//! The web server: it serves the page, opens one socket for each page, and sends every page the current view.

use std::fmt::Write;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{io, thread};

use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Path, Request, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, ORIGIN, REFERRER_POLICY};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::serve::ListenerExt;
use serde::Serialize;
use tokio::net::TcpListener;
use tokio::runtime::Builder;
use tokio::sync::watch;
use tokio::time::{MissedTickBehavior, interval};

use crate::desk::{Client, Desk};
use crate::order::{self, Order};

/// Time between two pings of a page.
const PING: Duration = Duration::from_secs(1);
/// The server closes the socket of a page that does not answer for this long.
const SILENT: Duration = Duration::from_secs(3);
/// Longest message of a page, bytes.
const MESSAGE_MAX: usize = 4096;

/// Allows nothing but the files and the socket of the console.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; base-uri 'none'; \
                      form-action 'none'; frame-ancestors 'none'";

/// Parts of the page that come from the caller.
pub struct Site {
    /// Style sheet that console and report share.
    pub style: &'static str,
    /// The script that draws a limb in space.
    pub limb_script: &'static str,
    /// Description of the scene as JSON: each page receives it first.
    pub scene: String,
}

/// A console that is open.
pub struct Console {
    shared: Arc<Shared>,
    view: watch::Sender<Arc<str>>,
    url: String,
}

struct Shared {
    site: Site,
    hosts: [String; 2],
    token: String,
    desk: Mutex<Desk>,
    report: Mutex<Option<PathBuf>>,
    clients: AtomicU64,
    began: Instant,
    view: watch::Receiver<Arc<str>>,
}

impl Console {
    /// Opens the console on the loopback address; port 0 is any free one.
    ///
    /// # Errors
    /// A port that is not free, or a system without random numbers or threads.
    pub fn open(port: u16, site: Site) -> io::Result<Self> {
        let listener = std::net::TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let SocketAddr::V4(address) = listener.local_addr()? else { return Err(io::ErrorKind::Unsupported.into()) };
        let token = token()?;
        let url = format!("http://{address}/{token}/");
        let (view, receiver) = watch::channel(Arc::from("null"));
        let shared = Arc::new(Shared {
            site,
            hosts: [address.to_string(), format!("localhost:{}", address.port())],
            token,
            desk: Mutex::default(),
            report: Mutex::default(),
            clients: AtomicU64::new(0),
            began: Instant::now(),
            view: receiver,
        });
        let runtime = Builder::new_current_thread().enable_io().enable_time().build()?;
        let router = router(Arc::clone(&shared));
        thread::Builder::new().name("console".into()).spawn(move || {
            runtime.block_on(async {
                // Without Nagle's algorithm: short messages are sent at once.
                let listener = TcpListener::from_std(listener)?.tap_io(|stream| {
                    let _ = stream.set_nodelay(true);
                });
                axum::serve(listener, router).await
            })
        })?;
        Ok(Self { shared, view, url })
    }

    /// Address of the page, with its token.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// The orders since the last call, each with the time that it has waited here.
    pub fn orders(&self) -> Vec<(Order, Duration)> {
        let now = self.shared.now();
        self.shared.desk().orders(now)
    }

    /// Shows all pages a view.
    ///
    /// # Panics
    /// Never: numbers and text become JSON.
    pub fn show(&self, view: &impl Serialize) {
        let text = serde_json::to_string(view).expect("numbers and text become JSON");
        self.view.send_replace(text.into());
    }

    /// The report that the pages link to; `None` while there is none.
    pub fn set_report(&self, report: Option<PathBuf>) {
        *self.shared.report.lock().unwrap_or_else(PoisonError::into_inner) = report;
    }
}

impl Shared {
    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a header names the console's own address, behind a prefix.
    fn is_own(&self, header: Option<&HeaderValue>, prefix: &str) -> bool {
        let host = header.and_then(|value| value.to_str().ok()).and_then(|text| text.strip_prefix(prefix));
        host.is_some_and(|host| self.hosts.iter().any(|own| own == host))
    }

    fn report(&self) -> Option<PathBuf> {
        self.report.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// 128 random bits in hexadecimal.
fn token() -> io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

fn router(shared: Arc<Shared>) -> Router {
    Router::new()
        .route("/{token}/", get(|| file("text/html; charset=utf-8", include_str!("page.html"))))
        .route("/{token}/console.css", get(|| file(CSS, include_str!("console.css"))))
        .route("/{token}/console.js", get(|| file(SCRIPT, include_str!("console.js"))))
        .route("/{token}/report.css", get(async |State(shared): Shares| file(CSS, shared.site.style).await))
        .route("/{token}/limb.js", get(async |State(shared): Shares| file(SCRIPT, shared.site.limb_script).await))
        .route("/{token}/report", get(report))
        .route("/{token}/socket", get(socket))
        .fallback(async || not_found())
        .layer(from_fn_with_state(Arc::clone(&shared), guard))
        .with_state(shared)
}

type Shares = State<Arc<Shared>>;

const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

async fn file(kind: &'static str, text: &'static str) -> Response {
    ([(CONTENT_TYPE, kind)], text).into_response()
}

fn not_found() -> Response {
    // A browser replaces an empty answer by its own error page.
    (StatusCode::NOT_FOUND, "There is no such page. The address that `softlimb console` printed has a token.\n")
        .into_response()
}

/// Refuses requests without the token, and those under another host name.
async fn guard(State(shared): Shares, request: Request, next: Next) -> Response {
    if !shared.is_own(request.headers().get(HOST), "") {
        return (StatusCode::FORBIDDEN, "The console answers on its own address alone.\n").into_response();
    }
    let is_known = request.uri().path().split('/').nth(1) == Some(&shared.token);
    let mut response = if is_known { next.run(request).await } else { not_found() };
    let headers = response.headers_mut();
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    // The report contains its scripts, so its route sets another policy.
    headers.entry(CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(POLICY));
    response
}

async fn report(State(shared): Shares) -> Response {
    const OWN: &str = "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:; \
                       font-src data:; connect-src data:; worker-src blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    let text = shared.report().and_then(|path| std::fs::read_to_string(path).ok());
    let Some(text) = text else { return (StatusCode::NOT_FOUND, "There is no report yet.\n").into_response() };
    ([(CONTENT_TYPE, "text/html; charset=utf-8"), (CONTENT_SECURITY_POLICY, OWN)], text).into_response()
}

async fn socket(
    State(shared): Shares,
    Path(_): Path<String>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    // A page of another site may know the address, but browsers state its origin.
    if !shared.is_own(headers.get(ORIGIN), "http://") {
        return (StatusCode::FORBIDDEN, "The socket is for the console's own page.\n").into_response();
    }
    upgrade.max_message_size(MESSAGE_MAX).on_upgrade(move |socket| page(socket, shared))
}

/// Serves one page until its socket closes.
async fn page(mut socket: WebSocket, shared: Arc<Shared>) {
    let client = shared.clients.fetch_add(1, Ordering::Relaxed);
    shared.desk().join(client);
    // An error closes the socket, too.
    let _ = talk(&mut socket, client, &shared).await;
    let now = shared.now();
    shared.desk().leave(client, now);
}

async fn talk(socket: &mut WebSocket, client: Client, shared: &Shared) -> Result<(), axum::Error> {
    let text = |text: String| Message::Text(text.into());
    socket.send(text(format!("{{\"scene\":{}}}", shared.site.scene))).await?;
    let (mut view, mut heard) = (shared.view.clone(), shared.now());
    view.mark_changed();
    let mut ping = interval(PING);
    ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            message = socket.recv() => {
                let Some(message) = message.transpose()? else { return Ok(()) };
                heard = shared.now();
                if let Message::Text(words) = message {
                    let read = serde_json::from_str::<order::Message>(&words).map_err(|error| error.to_string());
                    let number = read.as_ref().map_or(0, |message| message.number);
                    let answer = match read.and_then(|message| shared.desk().take(client, message, heard)) {
                        Ok(()) => format!("{{\"taken\":{number}}}"),
                        Err(reason) => format!("{{\"refused\":{}}}", serde_json::Value::from(reason)),
                    };
                    socket.send(text(answer)).await?;
                }
            }
            changed = view.changed() => {
                if changed.is_err() {
                    return Ok(());
                }
                let commander = shared.desk().commander();
                let (commands, is_free) = (commander == Some(client), commander.is_none());
                let view = view.borrow_and_update().clone();
                let view = format!("{{\"commands\":{commands},\"free\":{is_free},\"view\":{view}}}");
                socket.send(text(view)).await?;
            }
            _ = ping.tick() => {
                if shared.now().saturating_sub(heard) > SILENT {
                    return Ok(());
                }
                socket.send(Message::Ping(Default::default())).await?;
            }
        }
    }
}
