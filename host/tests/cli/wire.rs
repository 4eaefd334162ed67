//! Time from an order of a page to its setpoint on the wire, in the server of `console`.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, channel};
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

use crate::cli::desk::Desk;
use crate::cli::program::Program;
use crate::samples::samples;

/// Longest time until the device has started.
const STARTED: Duration = Duration::from_secs(60);

/// A page of the console, as bytes on its socket (RFC 6455).
struct Page {
    socket: TcpStream,
    heard: Receiver<String>,
    number: u32,
}

impl Page {
    fn open(url: &str) -> Self {
        let (address, token) = url.trim_start_matches("http://").split_once('/').unwrap();
        let mut socket = TcpStream::connect(address).unwrap();
        socket.set_nodelay(true).unwrap();
        // The server does not compare the key with others.
        write!(
            socket,
            "GET /{token}socket HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
        )
        .unwrap();
        let mut reader = BufReader::new(socket.try_clone().unwrap());
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        assert!(line.starts_with("HTTP/1.1 101"), "{line}");
        while line != "\r\n" {
            line.clear();
            reader.read_line(&mut line).unwrap();
        }
        let (told, heard) = channel();
        spawn(move || while frame(&mut reader).is_some_and(|text| told.send(text).is_ok()) {});
        Self { socket, heard, number: 0 }
    }

    /// Sends an order. It fits into the shortest frame, and is masked by zero.
    fn send(&mut self, order: &str) {
        self.number += 1;
        let text = format!("{{\"number\":{},{order}}}", self.number);
        assert!(text.len() < 126, "{text}");
        let head = [0x81, 0x80 | text.len() as u8, 0, 0, 0, 0];
        self.socket.write_all(&[&head, text.as_bytes()].concat()).unwrap();
    }

    /// Waits for a message that has these words.
    fn wait(&mut self, words: &str) {
        let began = Instant::now();
        while began.elapsed() < STARTED {
            if self.heard.recv_timeout(Duration::from_secs(1)).is_ok_and(|text| text.contains(words)) {
                return;
            }
            // The server leaves pages that are silent.
            self.send("\"take\":true");
        }
        panic!("no message has {words}");
    }
}

/// The next frame of a server; `None` at the end.
fn frame(reader: &mut impl Read) -> Option<String> {
    let mut head = [0; 2];
    reader.read_exact(&mut head).ok()?;
    let length = match head[1] {
        126 => {
            let mut length = [0; 2];
            reader.read_exact(&mut length).ok()?;
            u64::from(u16::from_be_bytes(length))
        }
        127 => {
            let mut length = [0; 8];
            reader.read_exact(&mut length).ok()?;
            u64::from_be_bytes(length)
        }
        length => u64::from(length),
    };
    let mut bytes = vec![0; length as usize];
    reader.read_exact(&mut bytes).ok()?;
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

/// The console prints the percentiles. Measure on an idle machine: build the command with `cargo build --release -p softlimb`, and let
/// `SOFTLIMB_SAMPLES=full SOFTLIMB_COMMAND=$PWD/target/release/softlimb cargo test -p softlimb --test main orders_reach_the_wire -- --nocapture`
/// send it 1000 orders.
#[test]
fn orders_reach_the_wire() {
    let desk = Desk::new();
    let program = std::env::var("SOFTLIMB_COMMAND").unwrap_or_else(|_| env!("CARGO_BIN_EXE_softlimb").to_owned());
    let mut console = Program::start_of(&program, &desk, "console --out console");
    let mut page = Page::open(&console.first_line());
    page.send("\"order\":\"arm\"");
    page.wait("\"device\":\"running\"");
    let count = samples(1000);
    for index in 0..count {
        // By turns a held move of a drive, its end, and steps of the tip there and back.
        let [act, drive, with] = match index % 4 {
            0 => ["jog", "0", "true"],
            1 => ["stop", "", ""],
            2 => ["step", "null", "true"],
            _ => ["step", "null", "false"],
        };
        let way = format!(",\"drive\":{drive},\"axis\":0,\"with\":{with},\"speed\":1,\"step\":0");
        page.send(&format!("\"order\":\"{act}\"{}", if drive.is_empty() { "" } else { &way }));
        // Times that drift through the periods of knots and views.
        sleep(Duration::from_micros(60_000 + 7_919 * u64::from(index % 13)));
    }
    page.send("\"order\":\"end\"");
    page.wait("\"session\":\"idle\"");
    let (code, text) = console.interrupted();
    let line = text.lines().find(|line| line.starts_with("order to setpoint on the wire:"));
    println!("{}", line.unwrap_or("no figures"));
    // Two orders may share a setpoint.
    let orders = line.and_then(|line| line.split(", ").last()?.strip_suffix(" orders")?.parse::<u32>().ok());
    assert!(code == Some(0) && orders.is_some_and(|orders| orders > count / 2), "{text}");
}
