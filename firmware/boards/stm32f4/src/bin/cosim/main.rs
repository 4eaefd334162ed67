//! The controller of the limb on an emulated processor, in lock-step with whoever started the emulator: time, samples and the link's
//! bytes come over its standard input, coil times and bytes go back over its standard output, once a tick.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod fault;

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    eprintln!("this program runs in an emulator: `cargo xtask firmware` builds it for one");
    std::process::ExitCode::FAILURE
}

#[cfg(target_os = "none")]
mod image {
    use softlimb_firmware::{BootInfo, exchange, turn};
    use softlimb_image_stm32f4::hardware::host::{Gone, Streams};
    use softlimb_image_stm32f4::pins::Controller;
    use softlimb_protocol::BootCause;

    use crate::board::LockStep;
    use crate::fault::leave;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        static mut CONTROLLER: Controller = Controller::new(BootInfo { cause: BootCause::PowerOn, detail: 0 });
        static mut BOARD: LockStep = LockStep::new();
        let outcome = match (cortex_m::Peripherals::take(), Streams::open()) {
            (Some(core), Ok(streams)) => {
                let mut timer = core.SYST;
                BOARD.begin(&mut timer);
                run(CONTROLLER, BOARD, &streams, &mut timer)
            }
            _ => Err(Gone),
        };
        leave(outcome.is_ok())
    }

    /// Ticks until the other side has enough.
    fn run(
        controller: &mut Controller,
        board: &mut LockStep,
        streams: &Streams,
        timer: &mut cortex_m::peripheral::SYST,
    ) -> Result<(), Gone> {
        while board.ask(streams)? {
            if board.is_after_crash() {
                controller.set_boot(BootInfo { cause: BootCause::HardFault, detail: 0 });
            }
            timer.clear_current();
            timer.enable_counter();
            match board.link_alone_us() {
                Some(now_us) => exchange(controller, board, now_us),
                None => drop(turn(controller, board)),
            }
            board.note_cost(timer);
            board.answer(streams)?;
        }
        Ok(())
    }
}
