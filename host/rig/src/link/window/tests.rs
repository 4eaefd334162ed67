//! The window against a small device behind a lossy line.

use std::collections::VecDeque;

use softlimb_protocol::{List, Message, Setpoint as Knot};

use super::*;

/// A device with 8 places that passes a knot every 3 rounds, behind a line that loses a share of what it carries.
struct Device {
    applied: Vec<Knot>,
    free: u16,
    random: u64,
    loss: u64,
}

/// Words of the device, in their order.
enum Word {
    Ack(Ack),
    Progress(u32, u16),
}

impl Device {
    fn loses(&mut self) -> bool {
        // Numerical Recipes' linear congruential generator; the high bits are good enough here.
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.random >> 33) % 100 < self.loss
    }

    fn receive(&mut self, seq: u16, message: HostMessage) -> Option<Ack> {
        if self.loses() {
            return None;
        }
        let expected = self.applied.len() as u32;
        let (index, knots) = match &message {
            HostMessage::Setpoint(knot) => (knot.index, vec![knot.clone()]),
            HostMessage::Knots(message) => (message.index, self.walked(message)),
            other => panic!("{other:?}"),
        };
        let (result, detail) = if index != expected {
            (ResultCode::UnexpectedIndex, expected)
        } else if usize::from(self.free) < knots.len() {
            (ResultCode::QueueFull, 0)
        } else {
            self.free -= knots.len() as u16;
            self.applied.extend(knots);
            (ResultCode::Ok, 0)
        };
        assert_ne!(result, ResultCode::QueueFull, "the host knows how many places there are");
        let ack = Ack {
            ref_type: message.message_type(),
            ref_seq: seq,
            result: result.into(),
            detail,
            free_knots: self.free,
            mcu_time_us: 0,
        };
        (!self.loses()).then_some(ack)
    }
}

impl Device {
    /// The knots that the steps lead to from the last one.
    fn walked(&self, message: &Knots) -> Vec<Knot> {
        let Some(mut last) = self.applied.last().cloned() else { return Vec::new() };
        let walk = message.knots.iter().map(|step| {
            let values: Vec<_> = last.values.iter().zip(&step.steps[..]).map(|(v, s)| v + i32::from(*s)).collect();
            let (index, time_us) = (last.index + 1, last.time_us + u64::from(step.step_us));
            last = Knot { index, time_us, outputs: step.outputs, values: List::from_slice(&values).unwrap(), ..last };
            last.clone()
        });
        walk.collect()
    }
}

fn index(message: HostMessage) -> u32 {
    match message {
        HostMessage::Setpoint(Knot { index, .. }) | HostMessage::Knots(Knots { index, .. }) => index,
        other => panic!("{other:?}"),
    }
}

/// Rounds of 1 ms until all `count` knots are accepted; answers take 4 rounds.
fn rounds(count: i32, batch: u8, loss: u64, seed: u64) -> (u64, Device, Window) {
    let knots: Vec<_> = (0..count).map(|i| (i as u64 * 1_000, vec![i, -i])).collect();
    let mut window = Window::new(20_000, batch);
    window.load(Trajectory::from_pairs(&knots));
    window.open(0, 500, 8);
    let mut device = Device { applied: Vec::new(), free: 8, random: seed, loss };
    let (mut answers, mut seq) = (VecDeque::new(), 65_500_u16);
    for round in 0..100_000_u64 {
        if window.is_complete() {
            return (round, device, window);
        }
        let now_us = round * 1_000;
        while let Some(message) = window.send(now_us, 7, seq) {
            answers.push_back((round + 4, device.receive(seq, message).map(Word::Ack)));
            seq = seq.wrapping_add(1);
        }
        if round % 3 == 0 {
            device.free = (device.free + 1).min(8);
            let told = Word::Progress(device.applied.len() as u32, device.free);
            answers.push_back((round + 4, (!device.loses()).then_some(told)));
        }
        while answers.front().is_some_and(|(due, _)| *due <= round) {
            match answers.pop_front().unwrap().1 {
                Some(Word::Ack(ack)) => window.on_ack(now_us, &ack).unwrap(),
                Some(Word::Progress(next_index, free)) => window.on_progress(now_us, 0, next_index, free),
                None => {}
            }
        }
    }
    panic!("only {} of {count} knots after 100 s", device.applied.len());
}

fn assert_in_order(device: &Device, count: i32) {
    let expected: Vec<_> = (0..count).map(|i| (i as u32, 500 + i as u64 * 1_000, vec![i, -i])).collect();
    let applied: Vec<_> = device.applied.iter().map(|k| (k.index, k.time_us, k.values.to_vec())).collect();
    assert_eq!(applied, expected);
}

#[test]
fn good_line_repeats_nothing_and_is_limited_by_the_device() {
    for batch in [1, 2, 4] {
        let (rounds, device, window) = rounds(300, batch, 0, 1);
        assert_in_order(&device, 300);
        assert_eq!(window.repeated(), 0);
        assert!(rounds <= 3 * 300, "{rounds}");
    }
}

#[test]
fn knots_are_applied_once_in_order_whatever_is_lost() {
    for seed in 0..50 {
        for (batch, loss) in [(1, 5), (1, 30), (1, 60), (3, 30), (8, 60)] {
            let (_, device, window) = rounds(200, batch, loss, seed);
            assert_in_order(&device, 200);
            assert!(window.repeated() > 0);
        }
    }
}

/// An answer to the frame with a number.
fn answer(seq: u16, result: ResultCode, detail: u32) -> Ack {
    Ack { ref_type: Knot::MESSAGE_TYPE, ref_seq: seq, result: result.into(), detail, free_knots: 8, mcu_time_us: 0 }
}

#[test]
fn device_that_forgot_setpoints_is_an_error() {
    let mut window = Window::new(20_000, 1);
    window.load(Trajectory::from_pairs(&[(0, vec![0]), (1_000, vec![0]), (2_000, vec![0])]));
    window.open(0, 0, 8);
    let sent: Vec<_> = (0..3).map(|seq| index(window.send(0, 7, seq).unwrap())).collect();
    assert_eq!(sent, [0, 1, 2]);
    window.on_ack(0, &answer(1, ResultCode::Ok, 0)).unwrap();
    assert_eq!(window.accepted(), 2);
    let later = Ack { mcu_time_us: 1, ..answer(2, ResultCode::UnexpectedIndex, 0) };
    let error = window.on_ack(0, &later).unwrap_err();
    assert!(matches!(error, LinkError::SetpointsDropped));
}

#[test]
fn answer_that_was_overtaken_has_its_knot_sent_again() {
    let mut window = Window::new(20_000, 1);
    let knots: Vec<_> = (0..5).map(|index| (1_000 * index, vec![0])).collect();
    window.load(Trajectory::from_pairs(&knots));
    window.open(0, 0, 8);
    (0..4).for_each(|seq| assert!(window.send(0, 7, seq).is_some()));
    window.on_ack(0, &answer(0, ResultCode::Ok, 0)).unwrap();
    // The third knot arrived before the second, which is told the other way round.
    window.on_ack(0, &answer(1, ResultCode::Ok, 0)).unwrap();
    window.on_ack(0, &answer(2, ResultCode::UnexpectedIndex, 1)).unwrap();
    assert_eq!(window.accepted(), 2);
    assert_eq!(window.send(0, 7, 9).map(index), Some(2));
}

#[test]
fn frames_shorten_after_a_loss_and_grow_again_when_they_arrive() {
    let knots: Vec<_> = (0..400).map(|index| (1_000 * index, vec![0])).collect();
    let mut window = Window::new(20_000, 8);
    window.load(Trajectory::from_pairs(&knots));
    window.open(0, 0, 400);
    let count = |message| match message {
        HostMessage::Knots(knots) => knots.knots.len(),
        HostMessage::Setpoint(_) => 1,
        other => panic!("{other:?}"),
    };
    // The first knot is alone, and the next frame is lost.
    let sent = [0, 1].map(|seq| count(window.send(0, 7, seq).unwrap()));
    window.on_ack(0, &answer(0, ResultCode::Ok, 0)).unwrap();
    let mut lengths = sent.to_vec();
    for seq in 2..30 {
        let now_us = 20_000 + 1_000 * u64::from(seq);
        lengths.push(count(window.send(now_us, 7, seq).unwrap()));
        window.on_ack(now_us, &Ack { free_knots: 400, ..answer(seq, ResultCode::Ok, 0) }).unwrap();
    }
    // The whole knot before the loss is the first of no row.
    assert_eq!(lengths, [vec![1, 8], vec![4; 8], vec![8; 20]].concat());
}

#[test]
fn answer_that_names_the_first_knot_and_was_overtaken_is_no_drop() {
    let knots: Vec<_> = (0..5).map(|index| (1_000 * index, vec![0])).collect();
    for by_telemetry in [false, true] {
        let mut window = Window::new(20_000, 1);
        window.load(Trajectory::from_pairs(&knots));
        window.open(0, 0, 8);
        (0..2).for_each(|seq| assert!(window.send(0, 7, seq).is_some()));
        // The second knot arrived first, and is refused by the first one's index; then that of the first one, whose answer overtakes.
        match by_telemetry {
            true => window.on_progress(0, 5_000, 1, 7),
            false => window.on_ack(0, &Ack { mcu_time_us: 5_000, ..answer(0, ResultCode::Ok, 0) }).unwrap(),
        }
        window.on_ack(0, &Ack { mcu_time_us: 4_500, ..answer(1, ResultCode::UnexpectedIndex, 0) }).unwrap();
        assert_eq!(window.accepted(), 1);
        assert_eq!(window.send(0, 7, 9).map(index), Some(1), "sent again");
    }
}
