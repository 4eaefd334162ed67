//! Which symbols are arithmetic in double precision, done in software.

/// Conversions to double in the run-time interface of the Arm architecture; those from double begin as its arithmetic does.
const TO_DOUBLE: [&str; 6] =
    ["__aeabi_f2d", "__aeabi_h2d", "__aeabi_i2d", "__aeabi_ui2d", "__aeabi_l2d", "__aeabi_ul2d"];

/// Whether a symbol is such a routine, by its Arm name (`__aeabi_dmul`) or that of compiler libraries (`__muldf3`), mangled or not.
pub(crate) fn is_double(symbol: &str) -> bool {
    let arm = symbol.starts_with("__aeabi_d") || symbol.starts_with("__aeabi_cd") || TO_DOUBLE.contains(&symbol);
    arm || symbol.rsplit_once("__").is_some_and(|(_, name)| is_library_name(name))
}

/// Names such as `muldf3`, `ledf2`, `extendsfdf2`, `fixunsdfsi`, `floatsidf`: `df` is the type.
fn is_library_name(name: &str) -> bool {
    let operation = name.strip_suffix("df3").or_else(|| name.strip_suffix("df2"));
    let narrowed = name.strip_prefix("truncdf");
    let to_integer = name.strip_prefix("fix").map(|rest| rest.strip_prefix("uns").unwrap_or(rest));
    let from_integer = name.strip_prefix("float").and_then(|rest| rest.strip_suffix("df"));
    operation.or(narrowed).or(from_integer).is_some() || to_integer.is_some_and(|rest| rest.starts_with("df"))
}

#[cfg(test)]
mod tests {
    use super::is_double;

    #[test]
    fn double_is_told_from_single_integer_and_memory() {
        for symbol in [
            "__aeabi_dadd",
            "__aeabi_ddiv",
            "__aeabi_d2f",
            "__aeabi_f2d",
            "__aeabi_ui2d",
            "__aeabi_cdcmple",
            "__muldf3",
            "__unorddf2",
            "__powidf2",
            "__truncdfsf2",
            "__extendsfdf2",
            "__fixdfsi",
            "__fixunsdfdi",
            "__floatunsidf",
            "_RNvNtNtCskVuKRTy0ldb_17compiler_builtins5float3add8___adddf3",
        ] {
            assert!(is_double(symbol), "{symbol}");
        }
        for symbol in [
            "",
            "main",
            "__aeabi_fadd",
            "__aeabi_f2iz",
            "__aeabi_idiv",
            "__aeabi_uldivmod",
            "__aeabi_memcpy4",
            "__mulsf3",
            "__fixsfsi",
            "__floatsisf",
            "__udivmoddi4",
            "__divdi3",
            "_RNvNtNtCsa_4libm4math5fdim4fdim",
        ] {
            assert!(!is_double(symbol), "{symbol}");
        }
    }
}
