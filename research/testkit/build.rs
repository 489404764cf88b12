//! Records the compiler and the build settings. Reports contain them, because times depend on them.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let compiler = env::var_os("RUSTC")
        .and_then(|rustc| Command::new(rustc).arg("--version").output().ok())
        .and_then(|output| String::from_utf8(output.stdout).ok())
        .map_or_else(|| "unknown compiler".into(), |version| version.trim().to_owned());
    let level = env::var("OPT_LEVEL").unwrap_or_default();
    let target = env::var("TARGET").unwrap_or_default();
    // Cargo separates flags by 0x1f.
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\u{1f}', " ");
    println!("cargo:rustc-env=COLLTRANS_TESTKIT_COMPILER={compiler}");
    println!(
        "cargo:rustc-env=COLLTRANS_TESTKIT_BUILD={}",
        format!("{target}, opt-level {level} {flags}").trim_end()
    );
}
