"""Tests ``.ci/run``: it fails if a part cannot run, and cargo compiles nothing twice."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the script needs bash")
TOOLS = ["basename", "bash", "dirname", "env", "grep", "mktemp", "rm", "sed"]


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """A machine with Rust and without any other tool; all commands succeed."""
    for tool in TOOLS:
        (tmp_path / tool).symlink_to(str(shutil.which(tool)))
    for tool in ["cargo", "rustc", "cmp"]:
        install(tmp_path, tool, "exit 0")
    # The pictures that the commands of the gallery would draw.
    install(tmp_path, "colltrans", "exit 0")
    return tmp_path


def install(machine: Path, tool: str, script: str) -> None:
    (machine / tool).unlink(missing_ok=True)
    (machine / tool).write_text(f"#!/usr/bin/env bash\n{script}\n")
    (machine / tool).chmod(0o755)


def check(machine: Path, *arguments: str, **variables: str) -> tuple[int, str]:
    ran = subprocess.run(
        [shutil.which("bash") or "bash", str(ROOT / ".ci/run"), *arguments],
        env={"PATH": str(machine), "HOME": str(machine), **variables},
        capture_output=True,
        text=True,
        check=False,
    )
    return ran.returncode, ran.stdout + ran.stderr


def summary(output: str) -> dict[str, str]:
    """Returns the result of each part, which the summary lists with its seconds."""
    _, _, last = output.partition("== summary\n")
    rows = re.findall(r"^(\w+) +(passed|failed|not run|skipped) +\d+ s$", last, re.MULTILINE)
    return dict(rows)


def test_a_part_that_passes_is_listed_with_its_seconds(machine: Path) -> None:
    status, output = check(machine, "checked", "fuzz")
    assert (status, summary(output)) == (0, {"checked": "passed", "fuzz": "passed"})
    assert "== all passed in" in output


@pytest.mark.parametrize(
    ("part", "command"),
    [
        ("python", "apt-get install python3 python3-venv python3-pip"),
        ("web", "apt-get install nodejs npm"),
        ("site", "apt-get install python3 python3-venv python3-pip"),
        ("instructions", "apt-get install valgrind"),
        ("c", "apt-get install valgrind cmake pkg-config libeigen3-dev"),
    ],
)
def test_a_missing_tool_fails_the_run_and_its_install_command_is_printed(
    machine: Path, part: str, command: str
) -> None:
    status, output = check(machine, part, "fuzz")
    assert (status, summary(output)) == (1, {part: "not run", "fuzz": "passed"})
    assert f"\n    {command}\n" in output
    assert "passed in" not in output


def test_a_skipped_part_does_not_fail_the_run(machine: Path) -> None:
    status, output = check(machine, "--skip", "web", "web", "fuzz")
    assert (status, summary(output)) == (0, {"web": "skipped", "fuzz": "passed"})


def test_the_parts_after_a_failed_one_still_run(machine: Path) -> None:
    install(machine, "cargo", 'case "$*" in *"--profile checked"*) exit 3 ;; esac')
    status, output = check(machine, "checked", "fuzz")
    assert (status, summary(output)) == (1, {"checked": "failed", "fuzz": "passed"})


def test_the_first_failed_command_ends_its_part(machine: Path) -> None:
    failing = 'case "$*" in "fmt --version") ;; fmt*) exit 1 ;; esac'
    install(machine, "cargo", f'echo "cargo $*"; {failing}')
    status, output = check(machine, "style")
    assert (status, summary(output)) == (1, {"style": "failed"})
    assert "cargo clippy --release" not in output


def test_a_run_without_arguments_takes_every_part_unless_it_checks_a_submission(
    machine: Path,
) -> None:
    script = (ROOT / ".ci/run").read_text()
    every = set(re.findall(r"^part_(\w+)\(\)", script, re.MULTILINE))
    assert set(summary(check(machine)[1])) == every
    submission = set(summary(check(machine, CI="true")[1]))
    assert {"style", "readme", "tests", "checked", "python"} <= submission < every


@pytest.mark.parametrize("arguments", [["chekced"], ["--skip", "sites"], ["--skip"]])
def test_an_unknown_part_is_refused_with_the_names_of_all_parts(
    machine: Path, arguments: list[str]
) -> None:
    status, output = check(machine, *arguments)
    assert status == 2 and "style readme tests checked" in output


def compile_units(*arguments: str) -> list[Any]:
    """Returns the compile units of a cargo command, each with what its output depends on."""
    command = ["cargo", *arguments, "--release", "--unit-graph", "-Zunstable-options"]
    ran = subprocess.run(
        command,
        cwd=ROOT,
        # The graph is an unstable output of cargo.
        env={**os.environ, "RUSTC_BOOTSTRAP": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    units = json.loads(ran.stdout)["units"]

    def key(number: int) -> Any:
        unit = units[number]
        if "key" not in unit:
            parts = [unit[part] for part in ("pkg_id", "mode", "platform", "profile", "features")]
            needs = sorted(key(need["index"]) for need in unit["dependencies"])
            described = [*parts, unit["target"]["name"], unit["target"]["kind"], needs]
            digest = hashlib.sha256(json.dumps(described, sort_keys=True).encode()).hexdigest()
            unit["key"] = f"{unit['mode']} {unit['target']['name']} {digest}"
        return unit["key"]

    return [key(number) for number in range(len(units))]


def test_cargo_run_compiles_nothing_after_cargo_test() -> None:
    # `cargo run` builds the same units as this, but prints no graph of them without an error.
    tests, program = compile_units("test"), compile_units("build", "--bin", "colltrans")
    assert [unit for unit in program if unit not in tests] == []


def test_tests_of_research_compile_nothing_of_the_product_again() -> None:
    without = ["--exclude", "colltrans-lab", "--exclude", "colltrans-bench"]
    product, both = compile_units("test"), compile_units("test", "--workspace", *without)
    assert [unit for unit in product if unit not in both] == []


def test_the_native_page_is_compiled_once_for_its_own_tests_and_these() -> None:
    page = ["--manifest-path=crates/colltrans-wasm/Cargo.toml", "--features=assembly,min-gap"]
    tests, native = compile_units("test", *page), compile_units("build", "--example=native", *page)
    assert [unit for unit in native if unit not in tests] == []


def test_cargo_test_compiles_each_library_of_the_product_once() -> None:
    # Unit tests and examples compile the library once more: CI asks for them.
    crates = {path.parent.name for path in ROOT.glob("crates/*/Cargo.toml")}
    units = [unit.split() for unit in compile_units("test")]
    programs = {name.replace("_", "-") for mode, name, _ in units if mode in ("test", "doctest")}
    assert len(programs) > 5 and programs & crates == set()


def test_workflows_name_every_action_by_its_commit() -> None:
    uses = [
        line.split("uses:")[1].strip()
        for file in ROOT.glob(".github/workflows/*.yml")
        for line in file.read_text().splitlines()
        if "uses:" in line
    ]
    pinned = re.compile(r"[\w-]+/[\w-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+")
    assert len(uses) > 5 and [use for use in uses if not pinned.fullmatch(use)] == []


def test_the_workflow_of_a_change_runs_every_part() -> None:
    script, workflow = (
        (ROOT / file).read_text() for file in (".ci/run", ".github/workflows/ci.yml")
    )
    every = set(re.findall(r"^part_(\w+)\(\)", script, re.MULTILINE))
    listed = re.findall(r"^        part: \[(.*)\]$", workflow, re.MULTILINE)[0].split(", ")
    assert {*listed, *re.findall(r"part: (\w+) }", workflow)} == every


def test_the_pinned_compiler_is_the_oldest_that_is_supported() -> None:
    pinned = tomllib.loads((ROOT / "rust-toolchain.toml").read_text())["toolchain"]
    oldest = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]
    assert pinned["channel"] == f"{oldest['rust-version']}.0"
