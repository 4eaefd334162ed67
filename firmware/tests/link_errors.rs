//! Errors of the link's port: on request, and unasked where a count has changed.

use softlimb_protocol::*;

use crate::common::{Bench, SESSION};

fn errors(queue_full: u32) -> LinkErrors {
    LinkErrors { overrun: 3, framing: 0, noise: 70_000, parity: u32::MAX, queue_full }
}

fn sent(bench: &Bench) -> Vec<LinkErrors> {
    let errors = bench.messages.iter().filter_map(|message| match message {
        DeviceMessage::LinkErrors(errors) => Some(errors.clone()),
        _ => None,
    });
    errors.collect()
}

#[test]
fn request_is_answered_before_its_ack_without_a_configuration() {
    let mut bench = Bench::new();
    bench.hello();
    for (count, asked) in [LinkErrors::NONE, errors(1)].into_iter().enumerate() {
        bench.controller.set_link_errors(asked.clone());
        let ack = bench.request(&ReadLinkErrors { session: SESSION }.into());
        assert_eq!(ack.result, ResultCode::Ok);
        assert_eq!(sent(&bench).len(), count + 1);
        let place = bench.messages.iter().rposition(|message| *message == asked.clone().into());
        assert!(place.unwrap() < bench.messages.len() - 1, "the Ack comes last: {:?}", bench.messages);
    }
    let ack = bench.request(&ReadLinkErrors { session: SESSION + 1 }.into());
    assert_eq!((ack.result.known(), sent(&bench).len()), (Some(ResultCode::WrongSession), 2));
}

#[test]
fn changes_are_sent_unasked_ten_times_a_second_at_most() {
    let mut bench = Bench::new();
    bench.ticks(300);
    assert_eq!(sent(&bench), [], "nothing has changed");
    for count in 0..1_000 {
        bench.controller.set_link_errors(errors(count));
        bench.tick();
    }
    assert_eq!(sent(&bench), (0..10).map(|number| errors(100 * number)).collect::<Vec<_>>());
    bench.ticks(1_000);
    assert_eq!(sent(&bench).last(), Some(&errors(999)), "the last change is sent once its time has come");
    assert_eq!(sent(&bench).len(), 11);
}
