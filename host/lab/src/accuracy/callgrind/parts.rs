//! The texts of callgrind and objdump.

use std::collections::HashMap;

/// Instructions of a part, and the floating-point operations among those of the program.
///
/// A line of cost is `0xADDRESS LINE COUNT`. The one behind `calls=` repeats what the called function has cost. `ob=(NUMBER) FILE` says
/// whose the addresses are and `cob=` whose the called function is, both without `FILE` from the second time on.
pub(super) fn sum(text: &str, program: &str, operations: Option<&HashMap<u64, u64>>) -> (u64, u64) {
    let (mut instructions, mut flops) = (0, 0);
    let (mut repeats, mut own, mut number) = (false, false, None);
    for line in text.lines() {
        if let Some((called, object)) = line.split_once("ob=").filter(|(called, _)| matches!(*called, "" | "c")) {
            let (of, name) = object.split_once(' ').unwrap_or((object, ""));
            if name == program {
                number = Some(of);
            }
            if called.is_empty() {
                own = number == Some(of);
            }
        } else if line.starts_with("calls=") {
            repeats = true;
        } else if let Some((address, count)) = cost(line) {
            if !repeats {
                let lanes = operations.filter(|_| own).and_then(|of| of.get(&address)).copied();
                instructions += count;
                flops += count * lanes.unwrap_or(0);
            }
            repeats = false;
        }
    }
    (instructions, flops)
}

fn cost(line: &str) -> Option<(u64, u64)> {
    let mut words = line.strip_prefix("0x")?.split(' ');
    let address = u64::from_str_radix(words.next()?, 16).ok()?;
    let _line = words.next()?;
    Some((address, words.next()?.parse().ok()?))
}

/// Address and lanes of every arithmetic instruction of floats: `  12345:\tmulsd %xmm1,%xmm0`.
pub(super) fn operations(disassembly: &str) -> impl Iterator<Item = (u64, u64)> + '_ {
    disassembly.lines().filter_map(|line| {
        let (address, rest) = line.split_once(':')?;
        let lanes = lanes(rest.trim_start().split([' ', '\t']).next()?)?;
        Some((u64::from_str_radix(address.trim(), 16).ok()?, lanes))
    })
}

/// Floats that an instruction computes; `None` for those that compute none.
fn lanes(mnemonic: &str) -> Option<u64> {
    let plain = mnemonic.strip_prefix('v').unwrap_or(mnemonic);
    let operation = plain.get(..plain.len().checked_sub(2)?)?;
    if !["add", "sub", "mul", "div", "sqrt"].contains(&operation) {
        return None;
    }
    match &plain[operation.len()..] {
        "sd" | "ss" => Some(1),
        "pd" => Some(2),
        "ps" => Some(4),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISASSEMBLY: &str = "\n0000000000001000 <_ZN4soft15measured_region17habcE>:\n    1000:\tpush   %rbp\n    \
                               1004:\tmulsd  %xmm1,%xmm0\n    1008:\taddpd  %xmm1,%xmm0\n    100c:\tsqrtss %xmm0,%xmm0\n    \
                               1010:\tmovsd  (%rax),%xmm0\n    1014:\taddq   $0x8,%rsp\n";

    #[test]
    fn arithmetic_is_told_from_the_rest() {
        let found: Vec<_> = operations(DISASSEMBLY).collect();
        assert_eq!(found, [(0x1004, 1), (0x1008, 2), (0x100c, 1)]);
    }

    #[test]
    fn callees_are_counted_once_and_foreign_code_is_no_operation() {
        let text = "positions: instr line\nevents: Ir\nob=(2) /lib/theirs\nfn=(3)\ncob=(1) /bin/ours\ncalls=1 0x1000 0\n0x1004 0 50\n\
                    ob=(1)\nfn=(1)\n0x1000 0 7\n0x1004 0 3\ncalls=1 0x2000 0\n0x1008 0 99\n\
                    fn=(2)\n0x2000 0 5\nob=(2)\nfn=(3)\n0x1004 0 2\nob=(1)\nfn=(1)\n0x1004 0 1\ntotals: 18\n";
        let operations = HashMap::from([(0x1004, 1), (0x2000, 2)]);
        assert_eq!(sum(text, "/bin/ours", Some(&operations)), (18, 14));
        assert_eq!(sum(text, "/bin/ours", None), (18, 0));
    }
}
