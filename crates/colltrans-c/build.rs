//! Sets the name by which programs load the shared library. It contains the number of the binary interface.

use std::env::var;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // `COLLTRANS_ABI` of src/lib.rs; a test compares both.
    let abi = 1;
    match var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("macos" | "ios") => println!(
            "cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libcolltrans_c.{abi}.dylib"
        ),
        Ok("linux" | "android" | "freebsd" | "netbsd" | "openbsd" | "dragonfly") => {
            println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libcolltrans_c.so.{abi}");
        }
        _ => {}
    }
}
