//! `SPEC.md` says what the code does: its tables and its schema text are printed from the interface.
//!
//! `UPDATE_SPEC=1 cargo test -p softlimb-protocol --test spec` rewrites the printed parts.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use softlimb_protocol::*;

fn spec_path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("SPEC.md")
}

/// Replaces what stands between the markers of a printed part.
fn with_part(spec: &str, part: &str, text: &str) -> String {
    let (begin, end) = (format!("<!-- printed: {part} -->\n"), format!("<!-- end: {part} -->"));
    let (head, rest) = spec.split_once(&begin).unwrap_or_else(|| panic!("no {begin}"));
    let (_, tail) = rest.split_once(&end).unwrap_or_else(|| panic!("no {end}"));
    format!("{head}{begin}{text}{end}{tail}")
}

fn codes(sets: &[CodeLayout], column: &str) -> String {
    let mut out = String::new();
    for set in sets {
        writeln!(out, "\n#### {}\n\n{}\n", set.name, set.meaning.trim()).unwrap();
        writeln!(out, "| {column} | Name | Meaning |\n| ---: | --- | --- |").unwrap();
        for (name, code, meaning) in set.members {
            writeln!(out, "| {code} | {name} | {} |", meaning.trim()).unwrap();
        }
    }
    out + "\n"
}

fn fields(fields: &[FieldLayout]) -> String {
    let mut out = String::from(
        "| Offset | Bytes | Number | Field | Type | Meaning |\n| ---: | ---: | ---: | --- | --- | --- |\n",
    );
    let mut offset = 0;
    for (number, field) in fields.iter().enumerate() {
        let bytes = match field.element_len {
            0 if is_batch(field) => format!("{} + records", field.fixed_len),
            0 => field.fixed_len.to_string(),
            element_len => format!("{} + {element_len} n", field.fixed_len),
        };
        let (name, wire_type, meaning) = (field.name, field.wire_type, field.meaning.trim());
        writeln!(out, "| {offset} | {bytes} | {number} | `{name}` | `{wire_type}` | {meaning} |").unwrap();
        offset += field.fixed_len;
    }
    out
}

fn is_batch(field: &FieldLayout) -> bool {
    field.wire_type.starts_with("Batch<")
}

fn records() -> String {
    RECORDS.iter().map(|(name, layout)| format!("\n#### {name}\n\n{}\n", fields(layout))).collect()
}

fn payload_len(fields: &[FieldLayout]) -> String {
    let fixed: usize = fields.iter().map(|field| field.fixed_len).sum();
    match fields.iter().map(|field| field.element_len).sum::<usize>() {
        0 if fields.iter().any(is_batch) => format!("{fixed} bytes and the records"),
        0 => format!("{fixed} bytes"),
        element => format!("{fixed} + {element} n bytes, n = 1..={MAX_CHANNELS}"),
    }
}

fn messages(layouts: &[MessageLayout]) -> String {
    let mut out = String::new();
    for layout in layouts {
        let MessageLayout { message_type, name, delivery, meaning, .. } = layout;
        writeln!(out, "\n#### {message_type:#04x} {name}\n\n{}\n", meaning.trim()).unwrap();
        writeln!(out, "{delivery:?}; payload {}.\n", payload_len(layout.fields)).unwrap();
        writeln!(out, "{}", fields(layout.fields).trim_end()).unwrap();
    }
    out + "\n"
}

fn limits() -> String {
    format!(
        "| Limit | Value |\n| --- | ---: |\n| Protocol version | {PROTOCOL_VERSION} |\n| Channels, and elements of a list | \
         {MAX_CHANNELS} |\n| Payload, bytes | {MAX_PAYLOAD_LEN} |\n| Body (before COBS), bytes | {MAX_BODY_LEN} |\n\
         | Frame on the wire with both delimiters, bytes | {MAX_FRAME_LEN} |\n"
    )
}

fn example() -> String {
    let message = HostMessage::from(Heartbeat { session: 7, host_time_us: 1_000_000 });
    let wire = crate::common::encode(&message, 0x0102);
    let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ");
    let mut body = vec![0; wire.len()];
    let len = cobs::decode(&wire[1..], &mut body).unwrap().frame_size();
    format!("```text\nbody   {}\nframe  {}\n```\n", hex(&body[..len]), hex(&wire))
}

fn schema() -> String {
    format!(
        "```schema\n{SCHEMA_TEXT}```\n\nSchema hash: `{SCHEMA_HASH:#010x}` ({} bytes of text).\n",
        SCHEMA_TEXT.len()
    )
}

#[test]
fn printed_parts_are_those_of_the_interface() {
    let spec = fs::read_to_string(spec_path()).unwrap();
    let parts = [
        ("limits", limits()),
        ("example", example()),
        ("codes", codes(CODES, "Code")),
        ("flags", codes(FLAGS, "Bit")),
        ("records", records()),
        ("host", messages(HostMessage::LAYOUT)),
        ("device", messages(DeviceMessage::LAYOUT)),
        ("schema", schema()),
    ];
    let printed = parts.iter().fold(spec.clone(), |spec, (part, text)| with_part(&spec, part, text));
    if std::env::var_os("UPDATE_SPEC").is_some() {
        fs::write(spec_path(), printed).unwrap();
        return;
    }
    let difference = spec.lines().zip(printed.lines()).find(|(old, new)| old != new);
    assert_eq!(difference, None, "SPEC.md differs from the interface; see the head of this test");
    assert_eq!(spec.len(), printed.len(), "SPEC.md differs from the interface; see the head of this test");
}

#[test]
fn schema_text_has_one_line_per_definition() {
    let definitions =
        CODES.len() + FLAGS.len() + RECORDS.len() + HostMessage::LAYOUT.len() + DeviceMessage::LAYOUT.len();
    assert_eq!(SCHEMA_TEXT.lines().count(), 2 + definitions);
    assert!(SCHEMA_TEXT.is_ascii() && SCHEMA_TEXT.ends_with('\n') && !SCHEMA_TEXT.contains("  "));
}

#[test]
fn type_bytes_name_one_message_and_tell_the_direction() {
    let types = |layouts: &[MessageLayout]| layouts.iter().map(|layout| layout.message_type).collect::<Vec<_>>();
    assert_eq!(types(HostMessage::LAYOUT), (0x01..=0x10).collect::<Vec<_>>());
    assert_eq!(types(DeviceMessage::LAYOUT), (0x81..=0x8a).collect::<Vec<_>>());
}
