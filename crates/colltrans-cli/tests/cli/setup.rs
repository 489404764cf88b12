//! `colltrans setup`: completions and man pages.

use std::fs;
use std::path::Path;

use crate::support::{answered, folder, refused};

#[test]
fn setup_prints_and_writes_all_files() {
    let folder = folder();
    let said = answered(folder.path(), &["setup", "--prefix", "all"]);
    for file in said.lines() {
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(text.contains("colltrans"), "{file}");
    }
    for place in [
        "share/bash-completion/completions/colltrans",
        "share/zsh/site-functions/_colltrans",
        "share/fish/vendor_completions.d/colltrans.fish",
    ] {
        let text = fs::read_to_string(folder.path().join("all").join(place)).unwrap();
        assert!(["clearance", "fixed-pose", "assembly"].iter().all(|word| text.contains(word)));
    }
}

#[test]
fn each_command_has_a_man_page() {
    let folder = folder();
    answered(folder.path(), &["setup", "--prefix", "."]);
    let page = |name: &str| {
        let place = folder.path().join("share/man/man1").join(format!("{name}.1"));
        fs::read_to_string(place).unwrap().replace('\\', "")
    };
    let program = page("colltrans");
    let parts: Vec<_> = program.lines().filter_map(|l| l.strip_suffix("(1)")).collect();
    assert!(parts.len() >= 13, "{parts:?}");
    for part in parts {
        let text = page(part);
        assert!(text.contains("SYNOPSIS") && text.contains("OPTIONS"), "{part}");
    }
    assert!(page("colltrans-cast").contains("--direction"));
}

#[test]
fn print_writes_no_file() {
    let folder = folder();
    let printed = answered(folder.path(), &["setup", "--print", "powershell"]);
    assert!(printed.contains("Register-ArgumentCompleter"));
    assert!(!Path::new(&folder.path().join(".local")).exists());
    refused(folder.path(), &["setup", "--print", "tcsh"], 2, &["tcsh", "bash"]);
}

#[test]
fn unwritable_prefix_returns_exit_code_5() {
    let folder = folder();
    refused(folder.path(), &["setup", "--prefix", "cube.off"], 5, &["cube.off/share"]);
}
