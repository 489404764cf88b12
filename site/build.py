"""Builds the whole site without a network: ``python site/build.py OUT``.

The parts are pages of text by Sphinx (the Markdown of the repository, the reference of Python, the
help of the command line, the JSON schema, the measurements), notebooks and the gallery, whose cells
and programs are executed, the documentation of Rust, the interactive page, and a report of the
laboratory. At the end every link is followed (``links.py``).

Needs Rust, Python with ``pip install './python[docs]'``, and for the page Node, after ``npm ci`` in
``web/``. ``--without page`` omits the page; the site then states this.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from html import escape
from pathlib import Path, PurePosixPath
from typing import Any

import links
import measurements
import nbformat
import outputs
import schema

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
#: The published libraries, each after those that it uses.
CRATES = (
    "colltrans-kernel",
    "colltrans-convex",
    "colltrans-solid",
    "colltrans-motion",
    "colltrans-removal",
    "colltrans-scene",
    "colltrans-proof",
    "colltrans",
    "colltrans-mesh",
    "colltrans-picture",
    "colltrans-assembly",
    "colltrans-assembly-io",
)
#: Texts, or folders of texts, and their places on the site.
TEXTS = {
    "docs": "docs",
    "python/docs": "python",
    "site/index.md": "index.md",
    "site/notebooks": "notebooks",
    "ARCHITECTURE.md": "architecture.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "MIGRATION.md": "migration.md",
}
KINDS = (".md", ".svg", ".ipynb", ".json")
#: Pages that are generated, by what stands for them in the repository.
GENERATED = {
    "docs/measurements": "docs/measurements.md",
    "docs/measurements/README.md": "docs/measurements.md",
    "docs/answers.schema.json": "docs/reference/json.md",
}
#: Stands in ``docs/laboratory.md`` for the table of claims.
CLAIMS = "<!-- claims -->\n"


def run(*words: str | Path, **choices: Any) -> str:
    """Returns the standard output of a program. A failure ends the build with this output."""
    command = [str(word) for word in words]
    choices = {"cwd": ROOT, "stdout": subprocess.PIPE, "text": True} | choices
    done = subprocess.run(command, check=False, **choices)
    if done.returncode != 0:
        raise SystemExit(f"{done.stdout or ''}\n{' '.join(command)}: exit code {done.returncode}")
    return done.stdout or ""


def gather(source: Path) -> None:
    """Copies all texts to their places, with links between places on the site."""
    copied = dict(_files())
    places = copied | GENERATED
    for file, place in copied.items():
        target = source / place
        target.parent.mkdir(parents=True, exist_ok=True)
        # Texts of the folder site already link to places.
        if file.endswith(".md") and not file.startswith("site/"):
            text = (ROOT / file).read_text()
            text = text.replace(CLAIMS, measurements.claims()) if CLAIMS in text else text
            target.write_text(relinked(text, PurePosixPath(file), places))
        else:
            shutil.copy(ROOT / file, target)
    (source / "docs/measurements.md").write_text(measurements.page())


def _files() -> list[tuple[str, str]]:
    found = []
    for text, place in TEXTS.items():
        if (ROOT / text).is_file():
            found.append((text, place))
            continue
        for file in sorted((ROOT / text).rglob("*")):
            if file.suffix in KINDS and "measurements" not in file.parent.parts:
                inside = file.relative_to(ROOT / text).as_posix()
                found += [(file.relative_to(ROOT).as_posix(), f"{place}/{inside}")]
    return found


def relinked(text: str, file: PurePosixPath, places: dict[str, str]) -> str:
    """Replaces links to files by links to their places, or by their text if there is no place."""

    def kept(link: re.Match[str]) -> str:
        bang, words, target, anchor = link.groups()
        if re.match(r"(https?:|#|page/|rust/|laboratory/)", target + (anchor or "")):
            return link[0]
        led = os.path.normpath(file.parent / target)
        if led not in places:
            return words
        here = PurePosixPath(places[str(file)]).parent
        return f"{bang}[{words}]({os.path.relpath(places[led], here)}{anchor or ''})"

    return re.sub(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)#\s]*)(#[^)\s]*)?\)", kept, text)


def command_line(source: Path, program: Path) -> None:
    """Writes the page with the help of every command."""
    wide = os.environ | {"COLUMNS": "88"}
    text = [
        "# The command line",
        "",
        "The help of every command. `colltrans setup` installs it as man pages.",
        "",
    ]
    # There is one man page for each command, and one for all.
    run(program, "setup", "--prefix", source.parent / "setup")
    pages = (source.parent / "setup" / "share" / "man" / "man1").glob("*.1")
    commands = sorted(page.stem.removeprefix("colltrans").removeprefix("-") for page in pages)
    for command in commands:
        help_text = run(program, *command.split(), "--help", env=wide).rstrip()
        text += [f"## colltrans {command}".rstrip(), "", "````text", help_text, "````", ""]
    (source / "docs/reference/command-line.md").write_text("\n".join(text))


def json_fields(source: Path) -> None:
    """Writes the page with tables of every object that the programs write as JSON."""
    read = json.loads((ROOT / "docs/answers.schema.json").read_text())
    text = schema.Page(read, skipped="page_").text("JSON: all fields")
    (source / "docs/reference/json.md").write_text(text)


def gallery(source: Path, program: Path) -> None:
    """Runs every program of the gallery, and writes the page with the pictures and the programs."""
    programs = sorted(
        file for file in (HERE / "gallery").iterdir() if file.suffix in (".sh", ".py")
    )
    folder = source / "gallery"
    folder.mkdir()
    tools = os.environ | {
        "PATH": f"{program.parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    shown, sections = [], []
    for file in programs:
        picture = folder / f"{file.stem}.svg"
        language = "sh" if file.suffix == ".sh" else "python"
        start = ["bash", "-eu"] if file.suffix == ".sh" else [sys.executable]
        run(*start, file, picture, env=tools)
        if "<svg" not in picture.read_text():
            raise SystemExit(f"{file}: wrote no picture")
        title, *words = described(file.read_text())
        shown.append(
            f'<a href="#{anchor(title)}"><img src="{{}}" alt="">{escape(title)}</a>'.format(
                f"_images/{picture.name}"
            )
        )
        text = without_head(file.read_text())
        sections += [f"## {title}", "", " ".join(words), ""]
        sections += [f"![{title}](gallery/{picture.name})", ""]
        sections += [f"`site/gallery/{file.name} OUT.svg`", ""]
        sections += [f"```{language}", text.strip(), "```", ""]
    head = [
        "# Gallery",
        "",
        f"{len(programs)} pictures, each with the program that drew it when this site was built.",
        "",
    ]
    cards = ["```{raw} html", '<div class="pictures">', *shown, "</div>", "```", ""]
    (source / "gallery.md").write_text("\n".join(head + cards + sections))


def notebooks(source: Path) -> None:
    """Runs every notebook. A cell that fails, or has another output than stored, ends the build."""
    wrong = []
    for file in sorted((source / "notebooks").glob("*.ipynb")):
        book = outputs.executed(file)
        wrong += outputs.differences(file.stem, book)
        nbformat.write(book, file)
    if wrong:
        raise SystemExit("\n".join([*wrong, "python site/outputs.py --keep writes new outputs"]))


def described(program: str) -> list[str]:
    """Returns the lines of the first comment: a title, then the description."""
    lines = program.splitlines()
    lines = lines[1:] if lines[0].startswith("#!") else lines
    head = []
    for line in lines:
        if not line.startswith("#"):
            break
        head.append(line.lstrip("# ").rstrip())
    return head


def without_head(program: str) -> str:
    return re.sub(r"\A(#.*\n)+", "", program)


def anchor(title: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def sphinx(source: Path, out: Path) -> None:
    words = [
        "-q",
        "-W",
        "--keep-going",
        "-E",
        "-b",
        "html",
        "-c",
        HERE,
        "-d",
        source.parent / "doctrees",
    ]
    run(
        sys.executable,
        "-m",
        "sphinx",
        *words,
        source,
        out,
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
    )


def rust(out: Path) -> None:
    # A folder of its own, because other crates may have been documented in the usual one.
    folder = TARGET / "site"
    flags = {"RUSTDOCFLAGS": "-D warnings", "CARGO_TARGET_DIR": str(folder)}
    # In order of dependency: rustdoc links to the pages of a crate only if they exist.
    for crate in CRATES:
        run("cargo", "doc", "--no-deps", "--lib", "--quiet", "-p", crate, env=os.environ | flags)
    shutil.copytree(folder / "doc", out / "rust")
    names = [crate.replace("-", "_") for crate in CRATES]
    listed = "".join(f'<li><a href="{name}/index.html">{name}</a></li>' for name in names)
    (out / "rust" / "index.html").write_text(page_of("Rust", f"<ul>{listed}</ul>"))


def page(out: Path, built: Path | None) -> None:
    if built is None:
        for script in ["package/build.mjs", "build.mjs"]:
            run("node", script, "--install", cwd=ROOT / "web", stdout=None)
        built = ROOT / "web" / "dist"
    shutil.copytree(built, out / "page")


def laboratory(out: Path, results: Path | None) -> None:
    if results is None:
        results = out / "laboratory"
        run(
            "cargo",
            "run",
            "--release",
            "--quiet",
            "-p",
            "colltrans-lab",
            "--",
            "all",
            "--quick",
            "-o",
            results,
        )
        return
    shutil.copytree(results, out / "laboratory")


def not_built(out: Path, part: str) -> None:
    """Writes a page in place of an omitted part."""
    names = {"page": "page/index.html", "laboratory": "laboratory/report.html"}
    wanted = {"rust": [f"rust/{crate.replace('-', '_')}/index.html" for crate in CRATES]}
    for name in wanted.get(part, [names.get(part, "")]):
        file = out / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(
            page_of("Not built", f"This site was built without its part <b>{part}</b>.")
        )


def page_of(title: str, body: str) -> str:
    return (
        '<!doctype html><html lang="en"><meta name="viewport" content="width=device-width">'
        '<meta name="color-scheme" content="light dark">'
        f"<title>{title}</title><h1>{title}</h1>{body}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=Path, help="a folder, which is made anew")
    parser.add_argument(
        "--without", action="append", default=[], choices=["rust", "page", "laboratory"]
    )
    parser.add_argument(
        "--page",
        type=Path,
        metavar="DIST",
        help="the page as it was built, in place of building it",
    )
    parser.add_argument(
        "--laboratory", type=Path, metavar="DIR", help="results of a run, in place of a quick one"
    )
    arguments = parser.parse_args()
    out = arguments.out.resolve()
    if out.exists() and not (out / "objects.inv").exists() and any(out.iterdir()):
        raise SystemExit(f"{out}: is no site; give it another place")
    shutil.rmtree(out, ignore_errors=True)
    work = TARGET / "site-source"
    shutil.rmtree(work, ignore_errors=True)
    source = work / "source"
    source.mkdir(parents=True)
    program = TARGET / "release" / "colltrans"
    # The style of pictures, for notebooks and programs of the gallery.
    os.environ["MATPLOTLIBRC"] = str(HERE / "matplotlibrc")

    def part(name: str, make: Callable[[], object]) -> None:
        began = time.monotonic()
        if name in arguments.without:
            not_built(out, name)
            print(f"{name:12} NOT BUILT", flush=True)
            return
        make()
        print(f"{name:12} {time.monotonic() - began:6.1f} s", flush=True)

    part(
        "program",
        lambda: run("cargo", "build", "--release", "--quiet", "--bin", "colltrans"),
    )
    part("texts", lambda: gather(source))
    part("help", lambda: command_line(source, program))
    part("json", lambda: json_fields(source))
    part("gallery", lambda: gallery(source, program))
    part("notebooks", lambda: notebooks(source))
    part("sphinx", lambda: sphinx(source, out))
    part("rust", lambda: rust(out))
    part("page", lambda: page(out, arguments.page))
    part("laboratory", lambda: laboratory(out, arguments.laboratory))
    wrong = links.wrong(out)
    print(f"links        {len(wrong)} that lead nowhere", flush=True)
    raise SystemExit("\n".join(wrong) if wrong else 0)


if __name__ == "__main__":
    main()
