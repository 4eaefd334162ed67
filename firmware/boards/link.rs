//! Hands the linker the memory map in the folder of an image; nothing on a computer with an operating system.

use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=memory.x");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let folder = env::var("OUT_DIR").expect("Cargo names the folder");
    fs::copy("memory.x", Path::new(&folder).join("memory.x")).expect("memory.x is copied");
    println!("cargo::rustc-link-search={folder}");
    println!("cargo::rustc-link-arg-bins=--nmagic");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}
