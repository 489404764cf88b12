//! The installed package: `install.sh`, found by pkg-config and `cmake`.

use std::env;
use std::fs::{self, File};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::header::crate_folder;
use crate::programs::{Language, compilers, libraries, report, succeed, temporary};

fn install(prefix: &Path) {
    let script = crate_folder().join("install.sh");
    succeed(Command::new("sh").arg(script).arg(prefix).arg(libraries()));
}

/// Returns the path by which programs load the shared library.
fn loaded_library(prefix: &Path) -> PathBuf {
    let abi = colltrans_c::COLLTRANS_ABI;
    let names = [format!("libcolltrans_c.so.{abi}"), format!("libcolltrans_c.{abi}.dylib")];
    let paths = names.map(|name| prefix.join("lib").join(name));
    paths.into_iter().find(|path| path.exists()).expect("the shared library")
}

/// Writes a shell script that takes the place of cargo.
fn write_cargo(folder: &Path, script: &str) {
    fs::create_dir_all(folder).expect("a folder");
    let cargo = folder.join("cargo");
    fs::write(&cargo, format!("#!/bin/sh\n{script}\n")).expect("a script");
    fs::set_permissions(&cargo, fs::Permissions::from_mode(0o755)).expect("permissions");
}

#[test]
fn an_installation_takes_the_libraries_that_cargo_reports_and_keeps_those_in_use() {
    let folder = temporary("again");
    let (prefix, tools) = (folder.join("a prefix"), folder.join("tools"));
    install(&prefix);
    let in_use = File::open(loaded_library(&prefix)).expect("the library");
    // This cargo has a target of its own, as with CARGO_BUILD_TARGET.
    let artifact = libraries().join("libcolltrans_c.a");
    let line = format!(r#"{{"filenames":["/none/libcolltrans_c.so","{}"]}}"#, artifact.display());
    write_cargo(&tools, &format!("echo '{line}'\necho '{{\"success\":true}}'"));
    let path = format!("{}:{}", tools.display(), env::var("PATH").unwrap_or_default());
    let mut script = Command::new("sh");
    script.arg(crate_folder().join("install.sh")).arg(&prefix).env("PATH", path).env("CDPATH", "/");
    succeed(&mut script);
    let [old, new] = [in_use.metadata(), fs::metadata(loaded_library(&prefix))];
    let [old, new] = [old, new].map(|of| of.expect("metadata"));
    assert!(old.ino() != new.ino() && old.len() == new.len());
}

fn is_found(tool: &str) -> bool {
    let found = Command::new(tool).arg("--version").output().is_ok();
    if !found {
        report(format_args!("no {tool}: the package is not tested with it"));
    }
    found
}

#[test]
fn pkg_config_finds_the_installed_package() {
    let folder = temporary("installed");
    let prefix = folder.join("prefix");
    install(&prefix);
    if !is_found("pkg-config") {
        return;
    }
    let packages = prefix.join("lib/pkgconfig");
    let query = |options: &[&str]| {
        let mut command = Command::new("pkg-config");
        succeed(command.env("PKG_CONFIG_PATH", &packages).args(options).arg("colltrans"))
    };
    assert_eq!(query(&["--modversion"]).trim(), env!("CARGO_PKG_VERSION"));
    let flags = query(&["--cflags", "--libs"]);
    for compiler in compilers(Language::C) {
        let mut command = Command::new(compiler);
        command.arg(crate_folder().join("examples/first_contact.c"));
        command.args(flags.split_whitespace()).arg("-o").arg(folder.join("first_contact"));
        succeed(&mut command);
        let mut program = Command::new(folder.join("first_contact"));
        let path = prefix.join("lib");
        let found = succeed(program.env("LD_LIBRARY_PATH", &path).env("DYLD_LIBRARY_PATH", path));
        assert!(found.starts_with("contact after 3"), "{found}");
    }
}

#[test]
#[ignore = "long: compiles C++ by CMake"]
fn cmake_finds_the_installed_package() {
    let folder = temporary("cmake");
    let prefix = folder.join("prefix");
    install(&prefix);
    if !is_found("cmake") {
        return;
    }
    let project = "cmake_minimum_required(VERSION 3.16)\nproject(test LANGUAGES C CXX)\n\
                   find_package(colltrans 0.2 REQUIRED)\n\
                   foreach(kind colltrans static)\n\
                   add_executable(cast_${kind} cast.cpp)\n\
                   target_link_libraries(cast_${kind} PRIVATE colltrans::${kind})\n\
                   endforeach()\n";
    fs::write(folder.join("CMakeLists.txt"), project).expect("the project is written");
    fs::copy(crate_folder().join("examples/cast.cpp"), folder.join("cast.cpp")).expect("a copy");
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(&folder).arg("-B").arg(folder.join("build"));
    succeed(configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())));
    succeed(Command::new("cmake").arg("--build").arg(folder.join("build")));
    for kind in ["colltrans", "static"] {
        let found = succeed(&mut Command::new(folder.join("build").join(format!("cast_{kind}"))));
        assert!(found.starts_with("falls "), "{found}");
    }
}

/// `.ci/run c` builds this project with cargo.
#[test]
#[ignore = "long: compiles C++ by CMake"]
fn cmake_builds_a_project_that_fetches_the_sources() {
    if !is_found("cmake") {
        return;
    }
    let folder = temporary("fetched");
    let library = libraries().join("libcolltrans_c.a");
    let script = format!(
        "if [ \"$1\" = -vV ]; then echo 'host: this-machine'; exit; fi\n\
         while [ $# -gt 0 ]; do case $1 in --target) t=$2;; --target-dir) d=$2;; esac; shift; done\n\
         mkdir -p \"$d/$t/release\" && cp '{}' \"$d/$t/release/\"",
        library.display()
    );
    write_cargo(&folder, &script);
    for target in ["", "another-machine"] {
        let build = folder.join(format!("build-{target}"));
        let mut configure = Command::new("cmake");
        configure.arg("-S").arg(crate_folder().join("tests/fetch_content")).arg("-B").arg(&build);
        configure.arg(format!("-DCOLLTRANS_CARGO={}", folder.join("cargo").display()));
        succeed(configure.arg(format!("-DCOLLTRANS_CARGO_TARGET={target}")));
        succeed(Command::new("cmake").arg("--build").arg(&build));
        for kind in ["colltrans", "static"] {
            let found = succeed(&mut Command::new(build.join(format!("cast_{kind}"))));
            assert!(found.starts_with("falls "), "{found}");
        }
    }
}
