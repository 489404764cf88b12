"""Tests that the documentation is complete, and the scripts of the site (``.ci/run site``)."""

import importlib
import json
import re
import subprocess
import sys
from pathlib import Path, PurePosixPath
from types import ModuleType

import pytest
from conftest import ROOT

SITE = ROOT / "site"
#: The modules that group the names that are not at the top.
GROUPS = ["answers", "assembly", "columns", "errors", "motions", "removal", "robots", "scenes"]


def test_every_public_name_is_in_the_reference() -> None:
    page = (ROOT / "python/docs/api.md").read_text()
    told = re.findall(r"(?<!module):: colltrans\.([\w.]+)\n", page)
    assert sorted(name.split(".")[-1] for name in told) == sorted({*public_names(), *BULK})
    for name in told:
        module, _, last = f"colltrans.{name}".rpartition(".")
        assert last in importlib.import_module(module).__all__


#: The names of the group of files of queries.
BULK = [
    "Answer",
    "Bodies",
    "ChangedError",
    "Job",
    "NoRangesError",
    "Options",
    "ReadError",
    "Report",
    "answer_shard",
    "answer_table",
    "check_shard",
]


def public_names() -> dict[str, object]:
    """Returns all public names of the package and of its groups."""
    modules = ["", *(f".{group}" for group in GROUPS)]
    found = (importlib.import_module(f"colltrans{name}") for name in modules)
    return {name: getattr(module, name) for module in found for name in module.__all__}


@pytest.fixture
def measurements(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(SITE))
    return importlib.import_module("measurements")


def test_the_page_of_measurements_has_every_run(measurements: ModuleType) -> None:
    page = measurements.page()
    runs = measurements.newest_runs()
    for kind, file in runs.items():
        if file.suffix == ".txt":
            assert f"## {kind.replace('-', ' ').capitalize()}\n\n`{file.name}`\n" in page
        elif file.suffix == ".csv":
            assert measurements.csv_table(file) in page
        elif not kind.startswith("laboratory"):
            assert json.loads(file.read_text())["versions"] in page, kind
    for line in page.splitlines():
        assert not line.startswith("| ") or not re.search(r"\bnan\b", line, re.IGNORECASE), line
    # A command is printed without the folders of the original machine.
    assert "--bin table -- --quick --json 2026-11-27-table.json" in page


def test_the_table_of_claims_has_every_claim(measurements: ModuleType) -> None:
    run, again = measurements.laboratory()
    text = measurements.claims()
    for claim in run["claims"]:
        assert f" (`{claim['id']}`) | {claim['paper']}; {claim['place']} | " in text, claim
        assert not claim["why"] or f"\n- `{claim['id']}`, {claim['reason']}: " in text, claim
    other = measurements.by_name(again)
    differ = sum(claim["verdict"] != other[claim["id"]]["verdict"] for claim in run["claims"])
    assert text.count("(again: ") == differ
    page = (ROOT / "docs/laboratory.md").read_text()
    assert measurements.counts(run) in page
    assert "\n<!-- claims -->\n" in page
    assert [measurements.rounded(x) for x in (0.333, 12.34, 4321.0)] == ["0.33", "12.3", "4,321"]


def test_every_page_is_in_the_table_of_contents() -> None:
    index = (SITE / "index.md").read_text()
    docs = (page.relative_to(ROOT) for page in (ROOT / "docs").rglob("*.md"))
    pages = {page.with_suffix("").as_posix() for page in docs if page.parts[1] != "measurements"}
    pages |= {f"python/tutorials/{page.stem}" for page in ROOT.glob("python/docs/tutorials/*.md")}
    pages |= {f"notebooks/{page.stem}" for page in (SITE / "notebooks").glob("*.ipynb")}
    assert [page for page in sorted(pages) if f"\n{page}\n" not in index] == []


def test_the_gallery_has_thirteen_programs_and_the_site_three_notebooks() -> None:
    programs = sorted((SITE / "gallery").iterdir())
    assert len(programs) == 13
    for program in programs:
        title, words = program.read_text().splitlines()[:2]
        assert title.startswith("# ") and words.startswith("# "), program
        assert ('"$1"' if program.suffix == ".sh" else "sys.argv[1]") in program.read_text()
    notebooks = sorted((SITE / "notebooks").glob("*.ipynb"))
    assert len(notebooks) == 3
    for notebook in notebooks:
        cells = json.loads(notebook.read_text())["cells"]
        # The build makes their outputs, which are not committed.
        assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)


def links(folder: Path) -> list[str]:
    command = [sys.executable, str(SITE / "links.py"), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True)
    told = done.stdout.splitlines()
    assert done.returncode == (told != ["every link leads somewhere"]), done.stderr
    return [] if done.returncode == 0 else told


def test_broken_links_are_found(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "b.html").write_text('<h2 id="there">There</h2><a href="../a.html">a</a>')
    good = '<a href="sub/b.html#there">b</a> <a href="#x">x</a><p id=x> <a href="https://a.b">c</a>'
    # Rustdoc writes anchors in this form.
    good += '<p id="impl-Into%3CU%3E"></p><a href="#impl-Into%3CU%3E">i</a>'
    (tmp_path / "a.html").write_text(good)
    assert links(tmp_path) == []
    bad = {
        '<a href="sub/c.html">': "sub/c.html: leads nowhere",
        '<img src="no.svg">': "no.svg: leads nowhere",
        '<a href="sub/b.html#here">': "sub/b.html#here: there is no place #here",
        '<a href="../../etc/passwd">': "../../etc/passwd: leads out of the site",
        '<script src="https://cdn.example/x.js">': "https://cdn.example/x.js: is fetched",
        '<link rel="stylesheet" href="//cdn.example/x.css">': "//cdn.example/x.css: is fetched",
    }
    for text, told in bad.items():
        (tmp_path / "a.html").write_text(good + text)
        (found,) = links(tmp_path)
        assert found.startswith(f"a.html: {told}"), found


@pytest.fixture
def build(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    pytest.importorskip("nbclient")
    monkeypatch.syspath_prepend(str(SITE))
    return importlib.import_module("build")


def test_links_between_files_become_links_between_pages(build: ModuleType) -> None:
    places = {
        "docs/a.md": "docs/a.md",
        "python/docs/t/b.md": "python/t/b.md",
        "docs/p.svg": "docs/p.svg",
    }
    text = (
        "[b](../python/docs/t/b.md#x) ![p](p.svg) [code](../crates/x.rs) [w](https://w.org) [h](#h)"
    )
    told = build.relinked(text, PurePosixPath("docs/a.md"), places)
    assert told == "[b](../python/t/b.md#x) ![p](p.svg) code [w](https://w.org) [h](#h)"


def test_the_tables_of_the_schema_have_its_definitions_and_fields(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(str(SITE))
    schema = importlib.import_module("schema")
    read = json.loads((ROOT / "docs/answers.schema.json").read_text())
    text = schema.Page(read, skipped="page_").text("JSON")
    for name, definition in read["$defs"].items():
        assert (f"\n## {name}\n" in text) == (not name.startswith("page_")), name
        for field in definition.get("properties", {}):
            assert name.startswith("page_") or f"| `{field}` |" in text, (name, field)
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    assert all(len(re.findall(r"(?<!\\)\|", row)) == 4 for row in rows)
    assert "| `translation` | number, optional | First contact" in text
    assert "With outcome `separated`: `margin`." in text


def test_notebooks_print_the_committed_outputs(build: ModuleType) -> None:
    outputs = importlib.import_module("outputs")
    notebooks = sorted((SITE / "notebooks").glob("*.ipynb"))
    assert len(notebooks) == 3
    wrong = [
        line
        for file in notebooks
        for line in outputs.differences(file.stem, outputs.executed(file))
    ]
    assert not wrong, "\n".join(wrong)
