//! The generator of `include/colltrans.h`, and the test that the committed header is what it writes.
//!
//! It reads the public items of this crate as rustfmt formats them: constants, structs and enums with `repr(C)`, other
//! structs (handles), and `extern "C"` functions. Anything else is an error. It takes the place of `cbindgen`, whose
//! licence (MPL 2.0) and dependencies with other features the workspace excludes.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// The modules in the order of their declarations.
const MODULES: [&str; 11] = [
    "lib", "error", "body", "answer", "cast", "pair", "tracker", "motion", "scene", "many", "proof",
];

const HEAD: &str = "\
/* C interface of colltrans: shape casts, distances and motions with proven bounds.
 *
 * Generated from crates/colltrans-c/src. Guide: docs/guide/c-and-cpp.md. C++: colltrans.hpp.
 *
 * - Functions return COLLTRANS_OK or another status. If it is another one, colltrans_error_message() has the text, which
 *   names the argument, and no output is written, unless stated otherwise. With COLLTRANS_INTERNAL_ERROR an output may
 *   be incomplete, and Rust has printed the place of the defect to stderr.
 * - Poses, points, normals and directions are in the world frame, vertices in the frame of their body. Lengths have the
 *   unit of the bodies. A vector is three numbers, a table of vectors three numbers for each row.
 * - Numbers are 0, or have magnitudes from 2^-200 to 2^200. NaN is an error.
 * - Handles are created by a function with an output `T **` and freed by the function of their type. They share what
 *   they need: a body may be freed while a tracker or a scene still uses it.
 * - Any number of threads may pass one handle as a pointer to const. A call that takes a pointer that is not const
 *   needs the handle for itself.
 * - The same input gives the same bits on every run, thread and platform. The input of a table is all of its rows.
 */
#ifndef COLLTRANS_H
#define COLLTRANS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern \"C\" {
#endif
";

const FOOT: &str = "
/* Options of a compiler for shorter enums, such as -fshort-enums, change the interface. */
#if defined(__cplusplus)
static_assert(sizeof(colltrans_status) == 4 && sizeof(colltrans_outcome) == 4, \"enums have 4 bytes\");
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
_Static_assert(sizeof(colltrans_status) == 4 && sizeof(colltrans_outcome) == 4, \"enums have 4 bytes\");
#endif

#ifdef __cplusplus
}
#endif

#endif
";

/// A declaration with its documentation.
pub(crate) struct Item {
    documentation: Vec<String>,
    pub(crate) kind: Kind,
}

/// A declaration, with the names of Rust.
pub(crate) enum Kind {
    Constant { name: String, value: String },
    Handle { name: String },
    Enum { name: String, variants: Vec<(Vec<String>, String, String)> },
    Struct { name: String, fields: Vec<(Vec<String>, String, String)> },
    Function { name: String, arguments: Vec<(String, String)>, answer: String },
}

pub(crate) fn crate_folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Reads all public items.
pub(crate) fn items() -> Vec<Item> {
    let source = crate_folder().join("src");
    let of = |module: &&str| items_of(&source.join(format!("{module}.rs")));
    MODULES.iter().flat_map(of).collect()
}

fn items_of(file: &Path) -> Vec<Item> {
    let text = fs::read_to_string(file).expect("the module exists");
    let (mut items, mut documentation, mut is_c) = (Vec::new(), Vec::new(), false);
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(text) = line.strip_prefix("///") {
            documentation.push(text.trim().to_owned());
            continue;
        }
        if line.starts_with("#[") {
            is_c |= line == "#[repr(C)]";
            continue;
        }
        let kind = if let Some(name) = block_name(line, "pub struct ") {
            if is_c {
                Some(Kind::Struct { name, fields: members(&mut lines, ": ") })
            } else {
                Some(Kind::Handle { name })
            }
        } else if let Some(name) = block_name(line, "pub enum ") {
            assert!(is_c, "{line}: no repr(C)");
            Some(Kind::Enum { name, variants: members(&mut lines, " = ") })
        } else if let Some(constant) = line.strip_prefix("pub const ") {
            let (name, value) = constant.split_once(": ").expect("a type");
            let value = value.split_once(" = ").expect("a value").1.trim_end_matches(';');
            Some(Kind::Constant { name: name.into(), value: value.into() })
        } else if line.starts_with("pub unsafe extern ") || line.starts_with("pub extern ") {
            let mut signature = line.to_owned();
            while !signature.ends_with('{') {
                signature += lines.next().expect("a body").trim();
            }
            Some(function(&signature))
        } else {
            assert!(!line.starts_with("pub fn"), "{line}: not a declaration of C");
            None
        };
        if let Some(kind) = kind {
            items.push(Item { documentation: std::mem::take(&mut documentation), kind });
        }
        documentation.clear();
        is_c = false;
    }
    items
}

/// Returns the name of a struct or an enum that begins in this line.
fn block_name(line: &str, keyword: &str) -> Option<String> {
    let rest = line.strip_prefix(keyword)?;
    Some(rest.chars().take_while(char::is_ascii_alphanumeric).collect())
}

/// Reads the fields or variants of a block: documentation, name, and type or value.
fn members<'a>(
    lines: &mut impl Iterator<Item = &'a str>,
    separator: &str,
) -> Vec<(Vec<String>, String, String)> {
    let (mut members, mut documentation) = (Vec::new(), Vec::new());
    for line in lines.map(str::trim).take_while(|line| *line != "}") {
        if let Some(text) = line.strip_prefix("///") {
            documentation.push(text.trim().to_owned());
            continue;
        }
        let member = line.trim_start_matches("pub ").trim_end_matches(',');
        let (name, rest) = member.split_once(separator).expect("a field or a variant");
        members.push((std::mem::take(&mut documentation), name.into(), rest.into()));
    }
    members
}

fn function(signature: &str) -> Kind {
    let (name, rest) = signature.split_once("fn ").expect("fn").1.split_once('(').expect("(");
    let (arguments, answer) = rest.rsplit_once(')').expect(")");
    let argument = |text: &str| {
        let (name, kind) = text.split_once(':').expect("a type");
        (name.trim().to_owned(), kind.trim().to_owned())
    };
    let arguments = arguments.split(',').filter(|text| !text.trim().is_empty()).map(argument);
    let answer = answer.trim_end_matches('{').trim().trim_start_matches("->").trim().to_owned();
    Kind::Function { name: name.into(), arguments: arguments.collect(), answer }
}

/// Returns a name with underscores between its words, for example `cast_answer`.
fn snake(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.push(letter.to_ascii_lowercase());
    }
    snake
}

pub(crate) fn c_name(name: &str) -> String {
    format!("colltrans_{}", snake(name))
}

/// Returns a type of C. Pointers end with `*`.
fn c_type(name: &str) -> String {
    if let Some(of) = name.strip_prefix("*mut ") {
        let of = c_type(of);
        return if of.ends_with('*') { of + "*" } else { of + " *" };
    }
    if let Some(of) = name.strip_prefix("*const ") {
        let of = c_type(of);
        return if of.ends_with('*') { of + "const *" } else { format!("const {of} *") };
    }
    match name.rsplit("::").next().unwrap_or(name) {
        "" => "void".into(),
        "f64" => "double".into(),
        "u32" => "uint32_t".into(),
        "u64" => "uint64_t".into(),
        "usize" => "size_t".into(),
        "c_char" => "char".into(),
        own => {
            assert!(own.starts_with(|first: char| first.is_ascii_uppercase()), "type {own}");
            c_name(own)
        }
    }
}

/// Returns the declaration of a variable.
fn variable(name: &str, of: &str) -> String {
    if let Some((of, count)) = of.strip_prefix('[').and_then(|of| of.split_once("; ")) {
        return format!("{} {name}[{}]", c_type(of), count.trim_end_matches(']'));
    }
    let of = c_type(of);
    let space = if of.ends_with('*') { "" } else { " " };
    format!("{of}{space}{name}")
}

/// Writes documentation as a comment.
fn comment(lines: &[String], indent: &str, to: &mut String) {
    let lines = lines.iter().map(|line| line.replace("[`", "`").replace("`]", "`"));
    let lines: Vec<String> = lines.collect();
    match &lines[..] {
        [] => panic!("an item without documentation: {to}"),
        [line] => writeln!(to, "{indent}/** {line} */").unwrap(),
        lines => {
            writeln!(to, "{indent}/**").unwrap();
            for line in lines {
                let line = format!("{indent} * {line}");
                writeln!(to, "{}", line.trim_end()).unwrap();
            }
            writeln!(to, "{indent} */").unwrap();
        }
    }
}

fn declare(item: &Item, to: &mut String) {
    to.push('\n');
    comment(&item.documentation, "", to);
    match &item.kind {
        Kind::Constant { name, value } => {
            let value = value.replace("u64::MAX", "UINT64_MAX").replace("u32::MAX", "UINT32_MAX");
            writeln!(to, "#define {name} {value}").unwrap();
        }
        Kind::Handle { name } => {
            let name = c_name(name);
            writeln!(to, "typedef struct {name} {name};").unwrap();
        }
        Kind::Enum { name, variants } => {
            let name = c_name(name);
            writeln!(to, "typedef enum {name} {{").unwrap();
            for (documentation, variant, number) in variants {
                comment(documentation, "    ", to);
                let variant = snake(variant).to_uppercase();
                writeln!(to, "    COLLTRANS_{variant} = {number},").unwrap();
            }
            writeln!(to, "}} {name};").unwrap();
        }
        Kind::Struct { name, fields } => {
            let name = c_name(name);
            writeln!(to, "typedef struct {name} {{").unwrap();
            for (documentation, field, of) in fields {
                comment(documentation, "    ", to);
                writeln!(to, "    {};", variable(field, of)).unwrap();
            }
            writeln!(to, "}} {name};").unwrap();
        }
        Kind::Function { name, arguments, answer } => {
            let arguments: Vec<String> =
                arguments.iter().map(|(name, of)| variable(name, of)).collect();
            let list = if arguments.is_empty() { "void".into() } else { arguments.join(", ") };
            let start = variable(name, answer);
            if start.len() + list.len() < 115 {
                writeln!(to, "{start}({list});").unwrap();
            } else {
                writeln!(to, "{start}(\n    {});", arguments.join(",\n    ")).unwrap();
            }
        }
    }
}

fn header() -> String {
    let mut to = HEAD.to_owned();
    for item in items() {
        declare(&item, &mut to);
    }
    to + FOOT
}

#[test]
fn the_committed_header_is_generated_from_the_sources() {
    let (file, generated) = (crate_folder().join("include/colltrans.h"), header());
    if std::env::var_os("COLLTRANS_WRITE_HEADER").is_some() {
        fs::write(&file, &generated).expect("the header is written");
    }
    let committed = fs::read_to_string(&file).unwrap_or_default();
    let message = "run COLLTRANS_WRITE_HEADER=1 cargo test --release --test c_interface header::, and commit the header";
    assert!(committed == generated, "include/colltrans.h differs from src: {message}");
}

/// Number of the binary interface, and the FNV-1a hash of its declarations without comments.
const INTERFACE: (u32, u64) = (1, 0xe82e_79c8_1ce1_52b7);

#[test]
fn changed_declarations_have_another_number() {
    let (mut hash, text) = (0xcbf2_9ce4_8422_2325_u64, header());
    for part in text.split("/*") {
        let code = part.split_once("*/").map_or(part, |(_, code)| code);
        for byte in code.bytes().filter(|byte| !byte.is_ascii_whitespace()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    let message = "raise COLLTRANS_ABI after a release, and write both numbers here";
    assert_eq!((colltrans_c::COLLTRANS_ABI, hash), INTERFACE, "{message}: {hash:#x}");
}

#[test]
fn every_function_has_the_prefix_and_is_exported_by_the_crate() {
    let exported = fs::read_to_string(crate_folder().join("src/lib.rs")).expect("lib.rs exists");
    let mut count = 0;
    for item in items() {
        if let Kind::Function { name, .. } = item.kind {
            assert!(name.starts_with("colltrans_"), "{name}");
            assert!(exported.contains(&name), "{name} is not exported");
            count += 1;
        }
    }
    assert!(count > 50, "{count} functions");
}

#[test]
fn the_wrapper_uses_every_function() {
    let wrapper = crate_folder().join("include/colltrans.hpp");
    let wrapper = fs::read_to_string(wrapper).expect("the wrapper exists");
    let mut unused = Vec::new();
    for item in items() {
        if let Kind::Function { name, .. } = item.kind
            && !wrapper.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == name)
        {
            unused.push(name);
        }
    }
    assert_eq!(unused, ["colltrans_version"]);
}

#[test]
fn the_name_of_the_shared_library_has_the_number_of_the_interface() {
    let build = fs::read_to_string(crate_folder().join("build.rs")).expect("build.rs exists");
    assert!(build.contains(&format!("let abi = {};", colltrans_c::COLLTRANS_ABI)));
}
