//! The README and the guides show the output of their commands, and programs of the examples.

use colltrans_testkit::TemporaryFolder;
use std::path::{Path, PathBuf};

use crate::support::{colltrans, stderr, stdout};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A fenced block with its language, its text, and the line before it.
struct Block {
    language: String,
    text: String,
    before: String,
}

fn blocks() -> Vec<Block> {
    blocks_of(&std::fs::read_to_string(root().join("README.md")).unwrap())
}

fn blocks_of(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    let mut last = String::new();
    for line in page.lines() {
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

/// Returns the arguments of each command of a page that begins with `program` and is followed by its output, and this
/// output.
fn shown_commands(blocks: &[Block], program: &str) -> Vec<(String, String)> {
    let shown = |pair: &[Block]| {
        let [command, output] = pair else { unreachable!("windows of two") };
        let is_shown = command.text.lines().count() == 1
            && ["text", "json"].contains(&output.language.as_str());
        let arguments = command.text.strip_prefix(program).filter(|_| is_shown)?;
        Some((arguments.to_owned(), output.text.clone()))
    };
    blocks.windows(2).filter_map(shown).collect()
}

/// Runs a command of a page, its pictures written to a folder of their own. Returns what it prints.
fn printed(arguments: &str) -> String {
    let folder = TemporaryFolder::new();
    let placed = |word: &str| {
        let is_picture = Path::new(word).extension().is_some_and(|kind| kind == "svg");
        let place = if is_picture { folder.path().join(word) } else { word.into() };
        place.to_str().unwrap().to_owned()
    };
    let output =
        colltrans(&root()).args(arguments.split_whitespace().map(placed)).output().unwrap();
    assert!(output.status.success(), "{arguments}: {}", stderr(&output));
    stdout(&output)
}

#[test]
fn readme_shows_the_printed_output() {
    let shown = shown_commands(&blocks(), "cargo run --release -- ");
    for (arguments, output) in &shown {
        assert_eq!(printed(arguments), *output, "{arguments}");
    }
    assert!(shown.len() >= 2, "the README shows {} answers", shown.len());
}

/// All commands of guides that are followed by their output.
#[test]
fn guides_show_the_printed_output() {
    let mut pages: Vec<PathBuf> = std::fs::read_dir(root().join("docs/guide"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect();
    pages.sort();
    let mut counts = Vec::new();
    for page in &pages {
        let blocks = blocks_of(&std::fs::read_to_string(page).unwrap());
        let name = page.file_stem().unwrap().to_str().unwrap().to_owned();
        let shown = shown_commands(&blocks, "colltrans ");
        for (arguments, output) in &shown {
            assert_eq!(printed(arguments), *output, "{name}: colltrans {arguments}");
        }
        counts.push((name, shown.len()));
    }
    assert!(counts.contains(&("distance".into(), 3)), "{counts:?}");
    assert!(counts.iter().map(|(_, count)| count).sum::<usize>() >= 7, "{counts:?}");
}

#[test]
fn readme_programs_match_example_files() {
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
fn readme_has_at_most_200_lines() {
    let lines = std::fs::read_to_string(root().join("README.md")).unwrap().lines().count();
    assert!(lines <= 200, "{lines} lines");
}
