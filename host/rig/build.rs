//! Packs the script that draws the report's plots: the crate `plotly` carries it, and no copy of it is kept here.

use std::io::Write;
use std::path::Path;
use std::{env, fs};

use flate2::Compression;
use flate2::write::GzEncoder;

/// Sizes between which the script is the whole of plotly.js and nothing else, bytes.
const BYTES: std::ops::Range<usize> = 3_000_000..5_000_000;

fn main() -> std::io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    let sources = plotly::Plot::offline_js_sources();
    // The first script is plotly.js; a typesetter of formulas follows, which no plot here needs.
    let (_, rest) = sources.split_once("<script type=\"text/javascript\">").expect("plotly brings a script");
    let (script, _) = rest.split_once("</script>").expect("the script ends");
    let opening: String = script.chars().take(200).collect();
    assert!(opening.contains("plotly.js v"), "the first script of the crate plotly is another: {opening}");
    assert!(BYTES.contains(&script.len()), "plotly.js has {} bytes, not {BYTES:?}", script.len());
    let folder = env::var_os("OUT_DIR").expect("Cargo names the folder");
    let mut packed = GzEncoder::new(fs::File::create(Path::new(&folder).join("plotly.js.gz"))?, Compression::best());
    packed.write_all(script.as_bytes())?;
    packed.finish()?;
    Ok(())
}
