//! Programs in C and C++: compiled by all compilers that are found, linked with the shared or the static library, run.
//!
//! `COLLTRANS_C_FLAGS` adds flags of the compiler, `COLLTRANS_C_RUNNER` runs the programs by another one; `.ci/run c`
//! sets them for sanitizers and valgrind.

use std::collections::BTreeSet;
use std::env;
use std::ffi::OsStr;
use std::fmt::Display;
use std::fs;
use std::io::Write as _;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, OnceLock};

use crate::header::crate_folder;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Language {
    C,
    Cpp,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Link {
    Shared,
    Static,
}

/// System libraries that the static library needs.
const SYSTEM: &[&str] =
    if cfg!(target_os = "macos") { &["-lm"] } else { &["-lpthread", "-ldl", "-lm"] };

/// Returns the compilers that are found, and reports the others.
pub(crate) fn compilers(language: Language) -> Vec<&'static str> {
    let names = if language == Language::C { ["gcc", "clang"] } else { ["g++", "clang++"] };
    let is_found = |name: &&str| {
        let found = Command::new(name).arg("--version").output().is_ok();
        if !found {
            report(format_args!("no {name}: its programs are not tested"));
        }
        found
    };
    let found: Vec<_> = names.into_iter().filter(is_found).collect();
    assert!(!found.is_empty(), "none of {names:?} is installed");
    found
}

/// Prints a line once, past the capture of test output.
pub(crate) fn report(line: impl Display) {
    static LINES: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let line = line.to_string();
    if LINES.lock().expect("no panic").insert(line.clone()) {
        let _ = writeln!(std::io::stderr(), "{line}");
    }
}

/// Returns the folder with both libraries that cargo has built for this test.
pub(crate) fn libraries() -> PathBuf {
    let program = env::current_exe().expect("the path of the test");
    let folders = program.ancestors().skip(1).take(2);
    let has_libraries = |folder: &&Path| folder.join("libcolltrans_c.a").exists();
    folders
        .into_iter()
        .find(has_libraries)
        .expect("libcolltrans_c.a in the folder of the test")
        .to_owned()
}

/// Returns a folder with the shared library by the name by which programs load it.
fn shared_folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = temporary("shared");
        let (built, loaded) = if cfg!(target_os = "macos") {
            ("libcolltrans_c.dylib", format!("libcolltrans_c.{}.dylib", colltrans_c::COLLTRANS_ABI))
        } else {
            ("libcolltrans_c.so", format!("libcolltrans_c.so.{}", colltrans_c::COLLTRANS_ABI))
        };
        for name in [built, &loaded] {
            symlink(libraries().join(built), folder.join(name)).expect("a link");
        }
        folder
    })
}

/// Returns an empty folder of this test program.
pub(crate) fn temporary(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("c-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Returns the command of a compiler with strict warnings, and no contraction of sums and products.
fn compile(compiler: &str, language: Language) -> Command {
    let mut command = Command::new(compiler);
    command.arg(if language == Language::C { "-std=c11" } else { "-std=c++17" });
    command.args(["-O1", "-g", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffp-contract=off"]);
    if language == Language::Cpp {
        command.args(["-Wconversion", "-Wsign-conversion", "-Wshadow"]);
    }
    command.args(env::var("COLLTRANS_C_FLAGS").unwrap_or_default().split_whitespace());
    command.arg("-I").arg(crate_folder().join("include"));
    command
}

/// Compiles and links a program of this crate, named by its path without the ending.
pub(crate) fn build(compiler: &str, language: Language, link: Link, source: &str) -> PathBuf {
    let ending = if language == Language::C { "c" } else { "cpp" };
    let file = crate_folder().join(format!("{source}.{ending}"));
    let name = Path::new(source).file_name().and_then(OsStr::to_str).expect("a name");
    let program = temporary(&format!("{compiler}-{name}-{ending}")).join(name);
    let mut command = compile(compiler, language);
    command.arg(file).arg("-o").arg(&program);
    succeed(link_with(&mut command, link));
    program
}

/// Adds the library to the command of a compiler.
fn link_with(command: &mut Command, link: Link) -> &mut Command {
    match link {
        Link::Shared => {
            let folder = shared_folder().display();
            command.arg(format!("-L{folder}")).arg("-lcolltrans_c");
            command.arg(format!("-Wl,-rpath,{folder}"));
        }
        Link::Static => {
            command.arg(libraries().join("libcolltrans_c.a"));
        }
    }
    command.args(SYSTEM)
}

/// Runs a command, which must succeed, and returns its output.
pub(crate) fn succeed(command: &mut Command) -> String {
    let done = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "{command:?}: {}\n{out}\n{err}", done.status);
    out.into_owned()
}

/// Runs a program, which must succeed, and returns its output.
pub(crate) fn run(program: &Path) -> String {
    let runner = env::var("COLLTRANS_C_RUNNER").unwrap_or_default();
    let mut words = runner.split_whitespace();
    let Some(first) = words.next() else { return succeed(&mut Command::new(program)) };
    succeed(Command::new(first).args(words).arg(program))
}

/// The examples and what they print.
const EXAMPLES: [(Language, &str, &str); 6] = [
    (Language::C, "first_contact", "\
contact after 3, at (0.5, 0, 0)
proven: the bodies first meet at a translation between 2.9999999999999636 and 3.000000000000111
"),
    (Language::Cpp, "cast", "\
falls 8.38, proven: 8.38 to 8.38
an edge of the parcel: yes
to a gap of 0.25: 8.13
error: the direction [0.0, 0.0, 0.0] is zero, not finite or has a component outside the exact range (0, or a magnitude from 2^-200 to 2^200)
"),
    (Language::Cpp, "distance", "\
distance 4.5, nearest point of the ball (0.3, 0.4, 0)
closer than 4.4: no
at the origin they overlap by 0.5
"),
    (Language::Cpp, "many_poses", "\
999 of 1000 are above the table; the last one falls 2.999
"),
    (Language::Cpp, "mesh_against_mesh", "\
down 3 to the foot
left: free
proof of some kilobytes, verified
"),
    (Language::Cpp, "tracked_loop", "\
the least distance is 2.158529
"),
];

#[test]
#[ignore = "long: compiles six programs"]
fn examples_print_what_the_guide_shows() {
    for (language, name, printed) in EXAMPLES {
        for compiler in compilers(language) {
            let link = if language == Language::C { Link::Static } else { Link::Shared };
            let found = run(&build(compiler, language, link, &format!("examples/{name}")));
            assert_eq!(found, printed, "{name} by {compiler}");
        }
    }
}

#[test]
#[ignore = "long: compiles C++"]
fn the_counted_tasks_have_their_answers() {
    for compiler in compilers(Language::Cpp) {
        let program = build(compiler, Language::Cpp, Link::Shared, "tests/statements/colltrans");
        assert_eq!(
            run(&program),
            "8.380000 4.500000 1.500000 3.500000 3.000000 3.000000\n",
            "{compiler}"
        );
    }
}

#[test]
fn the_guide_shows_an_example_as_it_is() {
    let guide = crate_folder().join("../../docs/guide/c-and-cpp.md");
    let guide = fs::read_to_string(guide).expect("the guide exists");
    for (language, name, printed) in EXAMPLES {
        let ending = if language == Language::C { "c" } else { "cpp" };
        let shown = format!("<!-- crates/colltrans-c/examples/{name}.{ending} -->\n");
        if let Some((_, rest)) = guide.split_once(&shown) {
            let source = crate_folder().join(format!("examples/{name}.{ending}"));
            let source = fs::read_to_string(source).expect("the example exists");
            assert!(rest.starts_with(&format!("```{ending}\n{source}```\n")), "{name}: other code");
            assert!(rest.contains(&format!("```text\n{printed}```\n")), "{name}: other output");
        }
    }
    let count = guide.matches("<!-- crates/colltrans-c/examples/").count();
    assert!(count >= 2, "the guide shows {count} examples");
}

#[test]
fn invalid_arguments_are_errors_that_name_the_argument() {
    for compiler in compilers(Language::C) {
        run(&build(compiler, Language::C, Link::Shared, "tests/c_interface/errors"));
    }
}

#[test]
#[ignore = "long: compiles C++"]
fn the_wrapper_accepts_matrices_of_eigen() {
    let found = Command::new("pkg-config").args(["--cflags", "eigen3"]).output();
    let Ok(found) = found.map_err(drop).and_then(|of| of.status.success().then_some(of).ok_or(()))
    else {
        return report("no Eigen that pkg-config finds: the wrapper is not tested with it");
    };
    let flags = String::from_utf8(found.stdout).expect("UTF-8").replace("-I", "-isystem");
    let source = crate_folder().join("tests/c_interface/eigen.cpp");
    for compiler in compilers(Language::Cpp) {
        let program = temporary(&format!("{compiler}-eigen")).join("eigen");
        let mut command = compile(compiler, Language::Cpp);
        command.args(flags.split_whitespace()).arg(&source).arg("-o").arg(&program);
        succeed(link_with(&mut command, Link::Shared));
        run(&program);
    }
}

#[test]
#[ignore = "long: compiles C++"]
fn files_with_and_without_exceptions_form_a_program() {
    let source = crate_folder().join("tests/c_interface/mixed.cpp");
    for compiler in compilers(Language::Cpp) {
        let folder = temporary(&format!("{compiler}-mixed"));
        // The linker keeps the first definition of an inline function that the compiler has not expanded.
        let objects = [(&["-c"][..], "aborting.o"), (&["-c", "-DTHROWING"], "throwing.o")];
        let objects = objects.map(|(flags, name)| {
            let object = folder.join(name);
            let mut command = compile(compiler, Language::Cpp);
            succeed(command.arg("-O0").args(flags).arg(&source).arg("-o").arg(&object));
            object
        });
        let mut command = compile(compiler, Language::Cpp);
        command.args(objects).arg("-o").arg(folder.join("mixed"));
        succeed(link_with(&mut command, Link::Shared));
        run(&folder.join("mixed"));
    }
}

#[test]
#[ignore = "long: compiles C++"]
fn the_wrapper_has_views_results_exceptions_and_threads() {
    for compiler in compilers(Language::Cpp) {
        run(&build(compiler, Language::Cpp, Link::Shared, "tests/c_interface/wrapper"));
    }
}
