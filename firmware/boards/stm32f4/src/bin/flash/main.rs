//! The image that is flashed: the controller of the limb on an STM32F4. On a computer with an operating system the same program prints
//! the table of its pins.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod fault;

#[cfg(not(target_os = "none"))]
fn main() {
    print!("{}", softlimb_image_stm32f4::pins::Table);
}

/// Priorities: the link's bytes (3) before the schedule of the coils (2) before the controller (1) before watching over it (0).
#[cfg(target_os = "none")]
#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use core::sync::atomic::Ordering;

    use heapless::spsc::{Consumer, Producer, Queue};
    use softlimb_firmware::log::{prepare, wants_room};
    use softlimb_firmware::{BootInfo, LOOK_US};
    use softlimb_image_stm32f4::hardware::backstop::Backstop;
    use softlimb_image_stm32f4::hardware::coils::{COILS, tick_begins};
    use softlimb_image_stm32f4::hardware::log_flash::LogFlash;
    use softlimb_image_stm32f4::hardware::receiver::Receiver;
    use softlimb_image_stm32f4::hardware::watchdog::Watchdog;
    use softlimb_image_stm32f4::hardware::{clocks, converter, crash, image, option_bytes, ports, stack};
    use softlimb_image_stm32f4::health::{Counters, Health};
    use softlimb_image_stm32f4::pins::Controller;
    use softlimb_image_stm32f4::record::{DAMAGED, ResetFlags, boot_info};
    use softlimb_image_stm32f4::schedule::{OFF, SLOT_US, SLOTS, VENTING};
    use softlimb_image_stm32f4::watchdog::Window;
    use softlimb_protocol::BootCause;
    use stm32f4xx_hal::pac::{self, USART2};
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::serial::{Serial, Tx, config::Config};

    use crate::board::{COUNTS, FlashedBoard, INCOMING, LINK_ERRORS, OUTGOING};

    /// Speed of the link, bits a second.
    const BAUD: u32 = 921_600;
    /// Slots from one look at the link to the next.
    const SLOTS_PER_LOOK: usize = (LOOK_US / SLOT_US as u64) as usize;
    const _: () = assert!(2 * SLOTS_PER_LOOK == SLOTS);
    /// Slots of the schedule a second.
    const SLOTS_PER_S: u32 = 10_000;
    /// Wakes of the lowest task between two looks at the stack.
    const WAKES_PER_LOOK: u32 = 1_000;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        watchdog: Watchdog,
        backstop: Backstop,
        transmitter: Tx<USART2>,
        receiver: Receiver,
        received: Producer<'static, u8>,
        to_send: Consumer<'static, u8>,
        board: FlashedBoard,
        boot: Option<BootInfo>,
        source: clocks::Source,
    }

    #[init(local = [incoming: Queue<u8, INCOMING> = Queue::new(), outgoing: Queue<u8, OUTGOING> = Queue::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let device = context.device;
        let flags = ResetFlags(device.RCC.csr().read().bits());
        device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
        let boot = boot_info(crash::take(), flags);
        if boot.cause == BootCause::PowerOn {
            option_bytes::set_brown_out_level(&device.FLASH);
        }
        let mut log = LogFlash::new(device.FLASH);
        // Erasing takes seconds, and no coil has current yet. After a crash the vents must not wait. A damaged image erases nothing.
        if !boot.is_after_crash() && wants_room(&log) && image::is_sealed() {
            prepare(&mut log);
        }
        // Before the clocks, so that nothing on the way can last.
        let watchdog = Watchdog::start(device.IWDG, Window::STARTING);
        let first = if boot.is_after_crash() { VENTING } else { OFF };
        // The reset has let go of the vents: where they were open they shall not wait for the clocks.
        ports::set_up(&first);
        stack::paint();
        let (mut rcc, source) = clocks::start(device.RCC, &device.DBGMCU);
        let is_sealed = image::is_sealed();
        let (boot, first) = if is_sealed { (boot, first) } else { (DAMAGED, VENTING) };
        let port = device.GPIOA.split(&mut rcc);
        let pins = (port.pa2, port.pa3);
        let serial = Serial::new(device.USART2, pins, Config::default().baudrate(BAUD.bps()), &mut rcc);
        // Again: taking the link's pins has reset their port.
        ports::set_up(&first);
        COILS.put(&[first; SLOTS]);
        converter::start(&device.ADC1, &device.ADC_COMMON, &device.DMA2, &mut rcc);
        let Ok(serial) = serial else { crash::stop(softlimb_image_stm32f4::record::Crash::Panic { line: line!() }) };
        let (transmitter, receiver) = serial.split();
        let receiver = Receiver::start(receiver);
        let backstop = Backstop::start(device.TIM1, &device.DMA2, &mut rcc);
        let mut timer = context.core.SYST;
        timer.set_clock_source(cortex_m::peripheral::syst::SystClkSource::Core);
        timer.set_reload(clocks::PROCESSOR_HZ / SLOTS_PER_S - 1);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        let (received, incoming) = context.local.incoming.split();
        let (outgoing, to_send) = context.local.outgoing.split();
        let board = FlashedBoard::new((incoming, outgoing), is_sealed.then_some(log), source.is_exact() && is_sealed);
        (
            Shared {},
            Local { watchdog, backstop, transmitter, receiver, received, to_send, board, boot: Some(boot), source },
        )
    }

    /// Every 100 us: the coils, and every fifth time the controller.
    #[task(binds = SysTick, priority = 2, local = [backstop, slot: usize = SLOTS - 1])]
    fn slot(context: slot::Context) {
        let slot::LocalResources { backstop, slot, .. } = context.local;
        *slot = if *slot + 1 < SLOTS { *slot + 1 } else { 0 };
        if *slot == 0 {
            COILS.begin_tick();
            COUNTS.ticks.fetch_add(1, Ordering::Relaxed);
            tick_begins();
        }
        if *slot % SLOTS_PER_LOOK == 0 {
            rtic::pend(pac::Interrupt::EXTI0);
        }
        ports::apply(&COILS.words(*slot));
        backstop.set_back();
        COUNTS.slots.fetch_add(1, Ordering::Relaxed);
    }

    /// Every half millisecond: one turn of the controller where a tick has begun, else a look at the link.
    #[task(binds = EXTI0, priority = 1, local = [
        board, boot,
        controller: Controller = Controller::new(BootInfo { cause: BootCause::PowerOn, detail: 0 }),
    ])]
    fn turn(context: turn::Context) {
        let controller = context.local.controller;
        if let Some(boot) = context.local.boot.take() {
            controller.set_boot(boot);
        }
        let board = context.local.board;
        if board.has_tick() {
            softlimb_firmware::turn(controller, board);
            COUNTS.turns.fetch_add(1, Ordering::Relaxed);
        } else {
            let now_us = board.now_us() + LOOK_US;
            softlimb_firmware::exchange(controller, board, now_us);
        }
        rtic::pend(pac::Interrupt::USART2);
    }

    /// At every byte received, while there are bytes to send, and once a turn.
    #[task(binds = USART2, priority = 3, local = [transmitter, receiver, received, to_send])]
    fn link(context: link::Context) {
        let link::LocalResources { transmitter, receiver, received, to_send, .. } = context.local;
        // The frame of a damaged or dropped byte fails its checksum.
        if let Some(byte) = receiver.read(&LINK_ERRORS)
            && received.enqueue(byte).is_err()
        {
            LINK_ERRORS.take_without_place();
        }
        // As many as there is room for: one or two in the chip, all in an emulator that has no interrupt for it.
        while let Some(&byte) = to_send.peek()
            && transmitter.write(byte).is_ok()
        {
            to_send.dequeue();
        }
        if to_send.ready() {
            transmitter.listen()
        } else {
            transmitter.unlisten()
        }
        COUNTS.link.fetch_add(1, Ordering::Relaxed);
    }

    #[idle(local = [watchdog, source, health: Health = Health::new(), wakes: u32 = 0])]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources { watchdog, source, health, wakes, .. } = context.local;
        watchdog.change(Window::RUNNING);
        loop {
            let count = |counter: &core::sync::atomic::AtomicU32| counter.load(Ordering::Relaxed);
            let now = Counters { slots: count(&COUNTS.slots), turns: count(&COUNTS.turns), link: count(&COUNTS.link) };
            if health.is_time_to_feed(now) {
                watchdog.feed();
            }
            if *wakes % WAKES_PER_LOOK == 0 {
                COUNTS.stack_used.store(stack::used(), Ordering::Relaxed);
            }
            *wakes = wakes.wrapping_add(1);
            // Waking an emulator takes longer than the sleep.
            if *source != clocks::Source::Emulator {
                cortex_m::asm::wfi();
            }
        }
    }
}
