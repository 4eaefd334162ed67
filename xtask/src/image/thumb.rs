//! Cycles of a Cortex-M4 for one instruction: an estimate by the tables of its reference manual (DDI 0439, "Instruction set summary" and
//! "FPU instruction set"), memory without waits.
//!
//! 1 each, but 2 for what is loaded, 1 and one a register for several at once, 12 for a division of integers, 14 for one of floats and a
//! root, 3 for a product with a sum; 1 more for a float that the next instruction needs, 2 more where the program does not go on with the
//! next instruction.

/// Cost of a taken branch: the pipeline is filled again.
const REFILL: u64 = 2;

/// One instruction, as far as its cost goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Instruction {
    /// Bytes: 2 or 4.
    pub(super) length: u32,
    /// Cycles where everything it needs is there and the next instruction follows.
    cycles: u64,
    /// Register for a float whose value it computes.
    result: Option<u8>,
    /// Registers for floats that it needs.
    needs: [Option<u8>; 3],
}

impl Instruction {
    /// The instruction that begins with these two half-words; the second may belong to the next.
    pub(super) fn of(first: u16, second: u16) -> Self {
        let none = [None; 3];
        if first >> 11 < 0b11101 {
            return Self { length: 2, cycles: narrow(first), result: None, needs: none };
        }
        let is_float = first & 0xec00 == 0xec00 && second & 0x0e00 == 0x0a00;
        if is_float {
            return Self { length: 4, ..float(first, second) };
        }
        Self { length: 4, cycles: wide(first, second), result: None, needs: none }
    }

    /// Cycles, with what came before and whether the next one follows.
    pub(super) fn cost(&self, before: Option<&Self>, straight: bool) -> u64 {
        let result = before.and_then(|before| before.result);
        let waits = result.is_some() && self.needs.contains(&result);
        self.cycles + u64::from(waits) + if straight { 0 } else { REFILL }
    }
}

/// Instructions of one half-word.
fn narrow(code: u16) -> u64 {
    let list = |registers: u16| 1 + u64::from(registers.count_ones());
    match code >> 11 {
        // LDR of a constant.
        0b01001 => 2,
        // STR, STRH, STRB, then LDRSB and those that load, of a register and a register.
        0b01010 | 0b01011 => 1 + u64::from(code >> 9 & 7 >= 3),
        // Words, bytes, half-words, words of the stack: the lowest bit of the five loads.
        0b01100..=0b10011 => 1 + u64::from(code >> 11 & 1),
        // PUSH and POP.
        0b10110 | 0b10111 if code & 0x0600 == 0x0400 => list(code & 0x01ff),
        // STM and LDM.
        0b11000 | 0b11001 => list(code & 0x00ff),
        _ => 1,
    }
}

/// Instructions of two half-words on integers.
fn wide(first: u16, second: u16) -> u64 {
    match first >> 4 & 0x7f {
        _ if first >> 11 == 0b11110 => 1,
        // STM, LDM; STRD, LDRD; tables of branches and exclusive access.
        group if first >> 11 == 0b11101 && group & 0b110_0100 == 0 => 1 + u64::from(second.count_ones()),
        group if first >> 11 == 0b11101 && group & 0b110_0100 == 0b000_0100 => {
            let is_double = first & 0x0120 != 0;
            if is_double { 3 } else { 2 }
        }
        // Loads of a byte, a half-word, a word.
        group if first >> 11 == 0b11111 && group & 0b110_0001 == 1 => 2,
        // SDIV, UDIV.
        0b011_1001 | 0b011_1011 if first >> 11 == 0b11111 => 12,
        _ => 1,
    }
}

/// Instructions on floats, and between their registers and others.
fn float(first: u16, second: u16) -> Instruction {
    let [d, n, m] = [
        (second >> 12 & 0xf) << 1 | first >> 6 & 1,
        (first & 0xf) << 1 | second >> 7 & 1,
        (second & 0xf) << 1 | second >> 5 & 1,
    ]
    .map(|register| u8::try_from(register).ok());
    let instruction = |cycles, result, needs| Instruction { length: 4, cycles, result, needs };
    let is_load = first & 0x10 != 0;
    if first & 0xff00 != 0xee00 {
        // VMOV of two, VLDR and VSTR of one, VLDM and VSTM of many.
        let is_move = first & 0xffe0 == 0xec40;
        let is_one = first & 0x0120 == 0x0100;
        let cycles = if is_move || is_one { 2 } else { 1 + u64::from(second & 0xff) };
        return instruction(cycles, None, if is_load { [None; 3] } else { [d, None, None] });
    }
    if second & 0x10 != 0 {
        // Between a register for floats and another; the flags.
        return instruction(1, None, if is_load { [n, None, None] } else { [None; 3] });
    }
    match first >> 4 & 0b1011 {
        // VMLA, VMLS, VNMLA, VNMLS and their fused kin.
        0b0000 | 0b0001 | 0b1001 | 0b1010 => instruction(3, d, [d, n, m]),
        // VMUL, VNMUL; VADD, VSUB.
        0b0010 | 0b0011 => instruction(1, d, [n, m, None]),
        // VDIV.
        0b1000 => instruction(14, d, [n, m, None]),
        _ => others(first, second, d, m),
    }
}

/// Instructions on one float.
fn others(first: u16, second: u16, d: Option<u8>, m: Option<u8>) -> Instruction {
    let (kind, how) = (first & 0xf, second >> 6 & 3);
    let (cycles, result, needs) = match (kind, how) {
        // VSQRT.
        (0b0001, 0b11) => (14, d, [m, None, None]),
        // VCMP of two, and with zero.
        (0b0100, 0b01 | 0b11) => (1, None, [d, m, None]),
        (0b0101, 0b01 | 0b11) => (1, None, [d, None, None]),
        // VMOV of a constant computes nothing.
        (_, 0b00 | 0b10) => (1, None, [None; 3]),
        // VMOV, VABS, VNEG, VCVT.
        _ => (1, d, [m, None, None]),
    };
    Instruction { length: 4, cycles, result, needs }
}

#[cfg(test)]
mod tests {
    use super::Instruction;

    /// The names are what `llvm-mc --disassemble -triple=thumbv7em -mattr=+vfp4d16sp` makes of the codes.
    #[test]
    fn every_kind_has_its_cycles() {
        for (name, first, second, length, cycles) in [
            ("adds r0, r1, r2", 0x1888, 0, 2, 1),
            ("ldr r0, [pc, #4]", 0x4801, 0, 2, 2),
            ("str r0, [r1, r2]", 0x5088, 0, 2, 1),
            ("ldrsb r0, [r1, r2]", 0x5688, 0, 2, 2),
            ("ldr r0, [r1, #4]", 0x6848, 0, 2, 2),
            ("str r0, [r1, #4]", 0x6048, 0, 2, 1),
            ("strb r0, [r1]", 0x7008, 0, 2, 1),
            ("ldrh r0, [r1]", 0x8808, 0, 2, 2),
            ("ldr r0, [sp, #8]", 0x9802, 0, 2, 2),
            ("add r0, sp, #8", 0xa802, 0, 2, 1),
            ("push {r4, r5, r7, lr}", 0xb5b0, 0, 2, 5),
            ("pop {r4, r5, r7, pc}", 0xbdb0, 0, 2, 5),
            ("cbz r0, #4", 0xb110, 0, 2, 1),
            ("ldm r0!, {r1, r2}", 0xc806, 0, 2, 3),
            ("bx lr", 0x4770, 0, 2, 1),
            ("bne #-8", 0xd1fc, 0, 2, 1),
            ("bl #0", 0xf000, 0xf800, 4, 1),
            ("movw r0, #1", 0xf240, 0x0001, 4, 1),
            ("ldr.w r0, [r1, #300]", 0xf8d1, 0x012c, 4, 2),
            ("str.w r0, [r1, #300]", 0xf8c1, 0x012c, 4, 1),
            ("ldrb.w r0, [r1, r2, lsl #2]", 0xf811, 0x0022, 4, 2),
            ("ldrsh.w r0, [r1, #2]", 0xf9b1, 0x0002, 4, 2),
            ("ldrd r0, r1, [r2]", 0xe9d2, 0x0100, 4, 3),
            ("strd r0, r1, [r2, #8]", 0xe9c2, 0x0102, 4, 3),
            ("push.w {r4-r8, lr}", 0xe92d, 0x41f0, 4, 7),
            ("tbb [pc, r0]", 0xe8df, 0xf000, 4, 2),
            ("ldrex r0, [r1]", 0xe851, 0x0f00, 4, 2),
            ("add.w r0, r1, r2", 0xeb01, 0x0002, 4, 1),
            ("umull r0, r1, r2, r3", 0xfba2, 0x0103, 4, 1),
            ("udiv r0, r1, r2", 0xfbb1, 0xf0f2, 4, 12),
            ("sdiv r0, r1, r2", 0xfb91, 0xf0f2, 4, 12),
            ("vadd.f32 s0, s1, s2", 0xee30, 0x0a81, 4, 1),
            ("vmul.f32 s0, s1, s2", 0xee20, 0x0a81, 4, 1),
            ("vmla.f32 s0, s1, s2", 0xee00, 0x0a81, 4, 3),
            ("vfma.f32 s0, s1, s2", 0xeea0, 0x0a81, 4, 3),
            ("vdiv.f32 s0, s1, s2", 0xee80, 0x0a81, 4, 14),
            ("vsqrt.f32 s0, s1", 0xeeb1, 0x0ae0, 4, 14),
            ("vmov.f32 s0, #1.0", 0xeeb7, 0x0a00, 4, 1),
            ("vcmp.f32 s0, s1", 0xeeb4, 0x0a60, 4, 1),
            ("vmrs apsr_nzcv, fpscr", 0xeef1, 0xfa10, 4, 1),
            ("vmov s0, r0", 0xee00, 0x0a10, 4, 1),
            ("vldr s0, [r0]", 0xed90, 0x0a00, 4, 2),
            ("vstr s0, [r0]", 0xed80, 0x0a00, 4, 2),
            ("vpush {s16-s19}", 0xed2d, 0x8a04, 4, 5),
            ("vldmia r0, {s0, s1}", 0xec90, 0x0a02, 4, 3),
        ] {
            let instruction = Instruction::of(first, second);
            assert_eq!((instruction.length, instruction.cost(None, true)), (length, cycles), "{name}");
            assert_eq!(instruction.cost(None, false), cycles + 2, "{name}");
        }
    }

    #[test]
    fn a_float_that_is_needed_at_once_takes_a_cycle_more() {
        let sum = Instruction::of(0xee30, 0x0a81); // vadd.f32 s0, s1, s2
        let load = Instruction::of(0xed90, 0x0a00); // vldr s0, [r0]
        for (name, first, second, waits) in [
            ("vmul.f32 s3, s0, s2", 0xee60, 0x1a01, true),
            ("vmul.f32 s3, s2, s0", 0xee61, 0x1a00, true),
            ("vmul.f32 s0, s3, s2", 0xee21, 0x0a81, false),
            ("vmla.f32 s0, s3, s2", 0xee01, 0x0a81, true),
            ("vstr s0, [r0]", 0xed80, 0x0a00, true),
            ("vstr s1, [r0]", 0xedc0, 0x0a00, false),
            ("vldr s0, [r0]", 0xed90, 0x0a00, false),
            ("vmov r0, s0", 0xee10, 0x0a10, true),
            ("vcmp.f32 s0, #0", 0xeeb5, 0x0a40, true),
        ] {
            let next = Instruction::of(first, second);
            assert_eq!(next.cost(Some(&sum), true) - next.cost(None, true), u64::from(waits), "{name}");
            assert_eq!(next.cost(Some(&load), true), next.cost(None, true), "{name}");
        }
    }
}
