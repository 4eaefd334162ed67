//! A TCP server of one device for several clients at a time. No call waits.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use softlimb_protocol::{DeviceMessage, HostMessage, MAX_FRAME_LEN, encode_frame};

use super::gate::{Addressee, ClientId, Frames, Gate, refusal};
use super::serve::{Leave, Served};

/// Clients at a time.
const PLACES: usize = 16;
/// Time without a byte taken after which a client counts as dead.
const PATIENCE: Duration = Duration::from_secs(5);
/// Bytes that wait for a client before whole frames are left out.
const UNSENT_MAX: usize = 1 << 16;

/// The clients of a listener.
pub(super) struct Clients {
    listener: TcpListener,
    clients: Vec<Client>,
    gate: Gate,
    from_device: Frames<DeviceMessage>,
    next_id: ClientId,
}

struct Client {
    id: ClientId,
    address: SocketAddr,
    stream: TcpStream,
    frames: Frames<HostMessage>,
    unsent: Vec<u8>,
    /// Time since which nothing waits, or at which it last took bytes.
    took: Instant,
    heard: Instant,
    gone: Option<Leave>,
}

impl Clients {
    pub(super) fn listen(address: impl ToSocketAddrs) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, clients: Vec::new(), gate: Gate::default(), from_device: Frames::new(), next_id: 0 })
    }

    pub(super) fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Accepts new clients. If all places are taken, the client that has been silent the longest is closed.
    pub(super) fn greet(&mut self, on_news: &mut dyn FnMut(Served)) -> io::Result<()> {
        loop {
            match self.listener.accept() {
                Ok((stream, address)) => {
                    stream.set_nonblocking(true)?;
                    stream.set_nodelay(true)?;
                    if self.clients.len() == PLACES {
                        self.make_room();
                        self.dismiss(on_news);
                    }
                    self.clients.push(Client::new(self.next_id, address, stream));
                    self.next_id += 1;
                    on_news(Served::Connected(address));
                }
                Err(error) if is_nothing(&error) => return Ok(()),
                Err(error) => return Err(error),
            }
        }
    }

    fn make_room(&mut self) {
        let commander = self.gate.commander();
        let others = self.clients.iter_mut().filter(|client| Some(client.id) != commander);
        if let Some(client) = others.min_by_key(|client| client.heard) {
            client.gone = Some(Leave::MadeRoom);
        }
    }

    /// Appends the frames that may go to the device, whose time is `mcu_time_us`, and answers the others.
    pub(super) fn receive(&mut self, mcu_time_us: u64, into: &mut Vec<u8>, on_news: &mut dyn FnMut(Served)) {
        let (now, mut bytes) = (Instant::now(), Vec::new());
        for client in &mut self.clients {
            bytes.clear();
            if !read_all(&mut client.stream, &mut bytes) {
                client.gone = Some(Leave::Closed);
            }
            if !bytes.is_empty() {
                client.heard = now;
            }
            for &byte in &bytes {
                let Some((frame, bytes)) = client.frames.push(byte) else { continue };
                match self.gate.admit(now, client.id, &frame) {
                    Ok(()) => into.extend(bytes),
                    Err(result) => client.answer(now, frame.seq, &refusal(&frame, result, mcu_time_us)),
                }
            }
            client.flush(now);
        }
        self.dismiss(on_news);
    }

    /// Forwards the device's messages to their receivers.
    pub(super) fn send(&mut self, bytes: &[u8], on_news: &mut dyn FnMut(Served)) {
        let now = Instant::now();
        for &byte in bytes {
            let Some((frame, bytes)) = self.from_device.push(byte) else { continue };
            let before = self.gate.commander();
            let addressee = self.gate.addressee(now, &frame.message);
            let after = self.gate.commander();
            for client in &mut self.clients {
                if after != before && after == Some(client.id) {
                    on_news(Served::Commands(client.address));
                }
                if addressee == Addressee::All || addressee == Addressee::One(client.id) {
                    client.queue(now, &bytes);
                }
            }
        }
    }

    /// Removes clients that have disconnected.
    fn dismiss(&mut self, on_news: &mut dyn FnMut(Served)) {
        self.clients.retain(|client| {
            let Some(why) = client.gone else { return true };
            self.gate.leave(client.id);
            on_news(Served::Left { client: client.address, why });
            false
        });
    }
}

impl Client {
    fn new(id: ClientId, address: SocketAddr, stream: TcpStream) -> Self {
        let now = Instant::now();
        Self { id, address, stream, frames: Frames::new(), unsent: Vec::new(), took: now, heard: now, gone: None }
    }

    fn answer(&mut self, now: Instant, seq: u16, message: &DeviceMessage) {
        let mut frame = [0; MAX_FRAME_LEN];
        // A whole-frame buffer is never too small.
        let len = encode_frame(message, seq, &mut frame).unwrap_or_default();
        self.queue(now, &frame[..len]);
    }

    /// Sends a frame, as soon as the client takes it. It is left out where too much waits already.
    fn queue(&mut self, now: Instant, frame: &[u8]) {
        if self.unsent.len() + frame.len() <= UNSENT_MAX {
            self.unsent.extend_from_slice(frame);
        }
        self.flush(now);
    }

    fn flush(&mut self, now: Instant) {
        if self.unsent.is_empty() {
            self.took = now;
            return;
        }
        match self.stream.write(&self.unsent) {
            Ok(count) if count > 0 => {
                self.unsent.drain(..count);
                self.took = now;
            }
            Err(error) if !is_nothing(&error) => self.gone = Some(Leave::Closed),
            _ if now.saturating_duration_since(self.took) >= PATIENCE => self.gone = Some(Leave::TookNothing(PATIENCE)),
            _ => {}
        }
    }
}

/// Appends what has arrived, at most 64 KiB at a time; whether the client is still there.
pub(super) fn read_all(stream: &mut impl Read, into: &mut Vec<u8>) -> bool {
    let mut bytes = [0; 4096];
    for _ in 0..16 {
        match stream.read(&mut bytes) {
            Ok(0) => return false,
            Ok(count) => into.extend(bytes.iter().take(count)),
            Err(error) => return is_nothing(&error),
        }
    }
    true
}

/// Whether the operation had nothing to do, and may be repeated.
pub(super) fn is_nothing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
