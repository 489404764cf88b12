//! The README: its commands print what it shows, and its programs are the files it names.

use colltrans_testkit::TemporaryFolder;
use std::path::{Path, PathBuf};

use crate::support::{colltrans, stderr, stdout};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A fenced block: its language, its text, and the line before it.
struct Block {
    language: String,
    text: String,
    before: String,
}

fn blocks() -> Vec<Block> {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    let mut last = String::new();
    for line in readme.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(language)) => {
                let before = std::mem::take(&mut last);
                open = Some(Block { language: language.into(), text: String::new(), before });
            }
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(block), None) => block.text.extend([line, "\n"]),
            (None, None) => last = line.into(),
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

#[test]
fn commands_print_what_it_shows() {
    let blocks = blocks();
    let mut shown = 0;
    for pair in blocks.windows(2) {
        let [command, answer] = pair else { unreachable!("windows of two") };
        let Some(arguments) = command.text.strip_prefix("cargo run --release -- ") else {
            continue;
        };
        if !["text", "json"].contains(&answer.language.as_str()) {
            continue;
        }
        let pictures = TemporaryFolder::new();
        let picture = |word: &str| match word {
            "contact.svg" => pictures.path().join(word).to_str().unwrap().to_owned(),
            _ => word.to_owned(),
        };
        let output =
            colltrans(&root()).args(arguments.split_whitespace().map(picture)).output().unwrap();
        assert!(output.status.success(), "{arguments}: {}", stderr(&output));
        assert_eq!(stdout(&output), answer.text, "{arguments}");
        shown += 1;
    }
    assert!(shown >= 2, "the README shows {shown} answers");
}

#[test]
fn programs_are_files() {
    let mut found = 0;
    for block in blocks().iter().filter(|block| block.language == "rust") {
        let name = block.before.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->"));
        let name = name.unwrap_or_else(|| panic!("no file is named before {}", block.text));
        let file = std::fs::read_to_string(root().join(name)).unwrap();
        assert_eq!(file, block.text, "{name}");
        found += 1;
    }
    assert!(found >= 1, "the README shows {found} programs");
}

#[test]
fn it_is_short() {
    let lines = std::fs::read_to_string(root().join("README.md")).unwrap().lines().count();
    assert!(lines <= 200, "{lines} lines");
}
