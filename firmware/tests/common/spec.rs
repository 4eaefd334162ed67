//! The tables of `protocol/SPEC.md`.

/// A table of the specification without its header, found by its header; cells without spaces and backticks around them.
pub(crate) fn table<const COLUMNS: usize>(header: [&str; COLUMNS]) -> Vec<[String; COLUMNS]> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../protocol/SPEC.md");
    let text = std::fs::read_to_string(path).expect("the specification is beside the firmware");
    let heads: Vec<usize> =
        text.lines().enumerate().filter(|(_, line)| cells(line) == header).map(|(number, _)| number).collect();
    assert_eq!(heads.len(), 1, "tables with the header {header:?}");
    // The line below the header aligns the columns.
    let rows = text.lines().skip(heads[0] + 2).take_while(|line| line.starts_with('|'));
    rows.map(|line| {
        let row = cells(line).into_iter().map(String::from).collect::<Vec<_>>();
        row.try_into().unwrap_or_else(|row| panic!("{COLUMNS} cells in {row:?}"))
    })
    .collect()
}

fn cells(line: &str) -> Vec<&str> {
    let inner = line.trim().trim_start_matches('|').trim_end_matches('|');
    inner.split('|').map(|cell| cell.trim().trim_matches('`')).collect()
}
