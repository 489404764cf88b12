#!/usr/bin/env python3
"""Prepares and checks a release: one version everywhere, its section of the changelog, the address of the repository.

    .ci/release.py version 0.3.0 [--date 2027-01-31]    writes the version into all files, and dates the changelog
    .ci/release.py repository https://HOST/OWNER/NAME   writes the address of the repository into all packages
    .ci/release.py check [--tag v0.3.0]                 checks that all files agree; with a tag, that it can be released
    .ci/release.py notes 0.3.0                          prints the section of the changelog
    .ci/release.py notices MANIFEST [--target T]        prints the licences of the crates that a program contains
    .ci/release.py packages FOLDER                      checks licences and texts in the packages of a folder

`--root` names another copy of the repository.
"""

import argparse
import datetime
import json
import posixpath
import re
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

LICENCES = ("LICENSE-APACHE", "LICENSE-MIT")
CHANGELOG = "CHANGELOG.md"
LICENCE_FILE = re.compile(r"(?i)(un)?licen[sc]e|copying|copyright|notice")
RELATIVE_LINK = re.compile(r"\]\((?!https?:|#)([^)\s]+)\)")
NUMBER = re.compile(r"\d+\.\d+\.\d+(?:-[0-9A-Za-z.]+)?")

# Where a version stands: files, and a pattern whose first group is the text before it.
OWN = r'(?m)(^version = )"([^"]+)"'
DEPENDENCY = r'(?m)(^colltrans\S* = \{[^}\n]*\bversion = )"([^"]+)"'
LOCKED = r'(?m)(^name = "colltrans(?!-fuzz")(?:-[a-z-]+)?"\nversion = )"([^"]+)"(?!\nsource)'
PLACES = [
    ("Cargo.toml", OWN),
    ("crates/colltrans-python/Cargo.toml", OWN),
    ("crates/colltrans-wasm/Cargo.toml", OWN),
    ("python/pyproject.toml", OWN),
    ("Cargo.toml", DEPENDENCY),
    ("crates/*/Cargo.toml", DEPENDENCY),
    ("Cargo.lock", LOCKED),
    ("crates/colltrans-python/Cargo.lock", LOCKED),
    ("crates/colltrans-wasm/Cargo.lock", LOCKED),
    ("fuzz/Cargo.lock", LOCKED),
    ("python/conda/recipe.yaml", r'(?m)(^  version: )"([^"]+)"'),
    ("web/package.json", r'(?m)(^  "version": )"([^"]+)"'),
    ("web/package-lock.json", r'("name": "colltrans-page",\s+"version": )"([^"]+)"'),
    ("CITATION.cff", r"(?m)(^version: )(\S+)$"),
    ("web/package/package.json", r'(?m)(^  "version": )"([^"]+)"'),
    ("web/package-lock.json", r'("package": \{\s+"name": "colltrans",\s+"version": )"([^"]+)"'),
    (".github/ISSUE_TEMPLATE/*.yml", r"(placeholder: colltrans )([^,\s]+)"),
]
# Folders of packages that are not crates.
OTHER_PACKAGES = ("python", "web/package")
# Files that need not have a version.
OPTIONAL = ("crates/*/Cargo.toml", ".github/ISSUE_TEMPLATE/*.yml")


class Failure(Exception):
    """A reason why the repository cannot be released."""


def versions(root: Path) -> dict[str, set[str]]:
    """Returns the versions that each file has."""
    found: dict[str, set[str]] = {}
    for files, pattern in PLACES:
        for path in sorted(root.glob(files)):
            here = {match[2] for match in re.finditer(pattern, path.read_text(encoding="utf-8"))}
            if not here and files not in OPTIONAL:
                raise Failure(f"{path.relative_to(root)}: no version in it")
            if here:
                found.setdefault(path.relative_to(root).as_posix(), set()).update(here)
    return found


def section(root: Path, version: str) -> tuple[str, str]:
    """Returns the date and the text of a version in the changelog."""
    text = (root / CHANGELOG).read_text(encoding="utf-8")
    found = re.search(rf"(?ms)^## {re.escape(version)} — (\S+)\n(.*?)(?=^## |\Z)", text)
    if not found or not found[2].strip():
        raise Failure(f"{CHANGELOG}: no section '## {version} — DATE' with a text")
    return found[1], found[2].strip()


def repository(root: Path) -> str | None:
    """Returns the address of the repository; None if it has not been written yet."""
    found = re.search(r'(?m)^repository = "([^"]+)"$', (root / "Cargo.toml").read_text(encoding="utf-8"))
    return found[1] if found else None


def check(root: Path, tag: str | None) -> str:
    """Checks that all files have one version, whose section of the changelog has the date of the citation."""
    (version,) = versions(root)["CITATION.cff"]
    wrong = [f"{file}: {', '.join(sorted(found))}" for file, found in versions(root).items() if found != {version}]
    if wrong:
        raise Failure(f"CITATION.cff has version {version}, but\n  " + "\n  ".join(wrong))
    date, _ = section(root, version)
    if f'date-released: "{date}"' not in (root / "CITATION.cff").read_text(encoding="utf-8"):
        raise Failure(f"CITATION.cff: date-released is not {date}, the date in {CHANGELOG}")
    for licence in LICENCES:
        others = [root / folder / licence for folder in OTHER_PACKAGES]
        for copy in [*others, *(p.parent / licence for p in published(root))]:
            if copy.is_symlink() or not copy.is_file() or copy.read_bytes() != (root / licence).read_bytes():
                raise Failure(f"{copy.relative_to(root)} is not a copy of {licence}")
    if tag is not None:
        if tag != f"v{version}":
            raise Failure(f"the tag is {tag}, but the version is {version}: use the tag v{version}")
        changelog = (root / CHANGELOG).read_text(encoding="utf-8")
        pending = re.search(r"(?ms)^## Unreleased\n(.*?)(?=^## )", changelog)
        if pending and pending[1].strip():
            raise Failure(f"{CHANGELOG}: changes are under Unreleased: run .ci/release.py version VERSION")
        if repository(root) is None:
            raise Failure("the packages have no repository: run .ci/release.py repository URL")
    return version


def published(root: Path) -> list[Path]:
    """Returns the manifests of the crates that are published."""
    manifests = sorted(root.glob("crates/*/Cargo.toml"))
    return [path for path in manifests if "publish = false" not in path.read_text(encoding="utf-8")]


def edit(path: Path, change: Callable[[str], str]) -> None:
    """Changes a text, with its line ends."""
    old = path.read_bytes().decode("utf-8")
    new = change(old)
    if new != old:
        path.write_bytes(new.encode("utf-8"))


def set_version(root: Path, version: str, date: str) -> None:
    """Writes a version into all files, and turns what is unreleased into its section of the changelog."""
    if not NUMBER.fullmatch(version):
        raise Failure(f"{version} is not a version such as 0.3.0")
    if re.search(rf"(?m)^## {re.escape(version)} ", (root / CHANGELOG).read_text(encoding="utf-8")):
        raise Failure(f"{CHANGELOG} has a section {version} already")

    def replace(match: re.Match[str]) -> str:
        quote = '"' if match[0].endswith('"') else ""
        return f"{match[1]}{quote}{version}{quote}"

    for files, pattern in PLACES:
        for path in sorted(root.glob(files)):
            edit(path, lambda text, pattern=pattern: re.sub(pattern, replace, text))  # type: ignore[misc]
    heading = f"## Unreleased\n\n## {version} — {date}"
    edit(root / CHANGELOG, lambda text: text.replace("## Unreleased", heading, 1))
    edit(root / "CITATION.cff", lambda text: re.sub(r'(date-released: )"[^"]+"', rf'\1"{date}"', text))
    check(root, None)


def set_repository(root: Path, url: str) -> None:
    """Writes the address of the repository into all packages, and makes the links of the Python README absolute."""
    if not re.fullmatch(r"https://[^/\s]+/[^/\s]+/[^/\s]+", url):
        raise Failure(f"{url} is not an address such as https://HOST/OWNER/NAME")
    old = repository(root)
    if old is not None:
        named = ["Cargo.toml", "python/pyproject.toml", "python/README.md", "python/conda/recipe.yaml", "CITATION.cff"]
        named += ["web/package/package.json", "web/src/index.html"]
        for name in named:
            edit(root / name, lambda text: text.replace(old, url))
        return
    after = 'authors = ["The colltrans developers"]\n'
    own = "authors.workspace = true\n"
    edit(root / "Cargo.toml", lambda text: text.replace(after, f'{after}repository = "{url}"\n', 1))
    for path in published(root):
        edit(path, lambda text: text.replace(own, f"{own}repository.workspace = true\n", 1))
    links = f'Repository = "{url}"\nChangelog = "{url}/blob/main/CHANGELOG.md"\nIssues = "{url}/issues"\n'
    edit(root / "python/pyproject.toml", lambda text: text.replace("[project.urls]\n", f"[project.urls]\n{links}", 1))

    def absolute(match: re.Match[str]) -> str:
        return f"]({url}/blob/main/{posixpath.normpath(posixpath.join('python', match[1]))})"

    edit(root / "python/README.md", lambda text: RELATIVE_LINK.sub(absolute, text))
    edit(root / "python/conda/recipe.yaml", lambda text: text.replace("about:\n", f"about:\n  repository: {url}\n", 1))
    field = f'  "repository": {{ "type": "git", "url": "git+{url}.git", "directory": "web/package" }},\n'
    after = '  "author": "The colltrans developers",\n'
    edit(root / "web/package/package.json", lambda text: text.replace(after, f"{after}{field}", 1))
    link = f'<a href="{url}">Source</a>'
    edit(root / "web/src/index.html", lambda text: text.replace("<!-- source -->", link, 1))
    edit(root / "CITATION.cff", lambda text: text.replace("license:\n", f'repository-code: "{url}"\nlicense:\n', 1))


def contained(manifest: Path, target: str | None) -> list[dict[str, Any]]:
    """Returns the crates of other projects that are compiled into the program or library of a manifest."""
    command = ["cargo", "metadata", "--locked", "--format-version=1", f"--manifest-path={manifest}"]
    if target:
        command.append(f"--filter-platform={target}")
    answer = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    packages = {package["id"]: package for package in answer["packages"]}
    nodes = {node["id"]: node for node in answer["resolve"]["nodes"]}
    roots = [key for key, one in packages.items() if Path(one["manifest_path"]) == manifest.resolve()]
    seen: set[str] = set()
    while roots:
        one = roots.pop()
        # What tests, build scripts and the compiler run is not a part of the program.
        macros = any("proc-macro" in part["kind"] for part in packages[one]["targets"])
        if one not in seen and not macros:
            seen.add(one)
            for needed in nodes[one]["deps"]:
                if any(kind["kind"] is None for kind in needed["dep_kinds"]):
                    roots.append(needed["pkg"])
    return sorted((packages[key] for key in seen if packages[key]["source"]), key=lambda one: one["name"])


def notices(manifest: Path, target: str | None) -> str:
    """Returns the licence texts of the crates that a program contains, each text once."""
    users: dict[str, list[str]] = {}
    for package in contained(manifest, target):
        folder = Path(package["manifest_path"]).parent
        name = f"{package['name']} {package['version']} ({package['license']})"
        found = sorted(p for p in folder.iterdir() if LICENCE_FILE.match(p.name))
        texts = [p.read_text(encoding="utf-8", errors="replace").strip() for p in found if p.is_file()]
        for text in texts or [f"The package has no licence text. It is licensed under {package['license']}."]:
            users.setdefault(text, []).append(name)
    head = "This program contains the following crates, besides those of colltrans and Rust's standard library."
    rule = "\n\n" + "=" * 80 + "\n"
    blocks = sorted(("\n".join(names), text) for text, names in users.items())
    return head + "".join(f"{rule}{names}\n\n{text}" for names, text in blocks) + "\n"


def members(path: Path) -> dict[str, bytes]:
    """Returns the files of a package without their first folder, if all are in one."""
    if path.suffix in (".whl", ".zip"):
        with zipfile.ZipFile(path) as archive:
            return {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}
    with tarfile.open(path) as archive:
        files = [member for member in archive.getmembers() if member.isfile()]
        read = {member.name: archive.extractfile(member) for member in files}
        return {name.split("/", 1)[1]: file.read() for name, file in read.items() if file}


def check_package(root: Path, path: Path) -> None:
    """Checks that a package has the licences, its own text, and the names that its registry needs."""
    files = members(path)
    texts = {licence: (root / licence).read_bytes() for licence in LICENCES}

    def need(kind: bool, what: str) -> None:
        if not kind:
            raise Failure(f"{path.name}: {what}")

    if path.suffix == ".whl":
        (metadata,) = (name for name in files if name.endswith(".dist-info/METADATA"))
        for licence, text in texts.items():
            need(files.get(f"{Path(metadata).parent}/licenses/{licence}") == text, f"no {licence}")
        others = files.get(f"{Path(metadata).parent}/licenses/LICENSE-THIRD-PARTY", b"")
        need(b"\npyo3 " in others, "no LICENSE-THIRD-PARTY: build it by .ci/wheel")
        fields = files[metadata].decode("utf-8")
    else:
        for licence, text in texts.items():
            need(files.get(licence) == text, f"no {licence}")
        fields = files.get("PKG-INFO", b"").decode("utf-8")
    if path.suffix == ".whl" or "PKG-INFO" in files:
        for field in ("Author", "Keywords", "Classifier", "Project-URL", "License-Expression", "License-File"):
            need(f"\n{field}: " in fields, f"no field {field}")
        readme = (root / "python/README.md").read_text(encoding="utf-8")
        need(fields.rstrip().endswith(readme.rstrip()), "the description is not python/README.md")
        need(repository(root) is None or not RELATIVE_LINK.search(fields), "the description has relative links")
    if path.suffix == ".tgz":
        about = json.loads(files["package.json"])
        for field in ("author", "description", "license", "keywords", "exports", "engines"):
            need(bool(about.get(field)), f"no {field} in package.json")
        others = files.get("dist/LICENSE-THIRD-PARTY", b"")
        need(b"\nglam " in others, "no LICENSE-THIRD-PARTY: build it by web/package/build.mjs")
        readme = files.get("README.md", b"").decode("utf-8")
        need(readme.startswith("# colltrans\n"), "README.md is not its own")
        need(not RELATIVE_LINK.search(readme), "README.md has relative links")
    if path.suffix == ".crate":
        manifest = files["Cargo.toml"].decode("utf-8")
        for field in ("authors", "description", "license", "readme", "keywords", "categories"):
            need(f"\n{field} = " in manifest, f"no {field} in Cargo.toml")
        name = re.search(r'(?m)^name = "([^"]+)"', manifest)
        own = files.get("README.md", b"").decode("utf-8")
        need(name is not None and own.startswith(f"# {name[1]}\n"), "README.md is not its own")


def check_packages(root: Path, folder: Path) -> Iterable[str]:
    """Checks all packages of a folder, and yields their names."""
    found = sorted(p for p in folder.iterdir() if p.name.endswith((".crate", ".whl", ".tar.gz", ".tgz")))
    if not found:
        raise Failure(f"{folder}: no package in it")
    for path in found:
        check_package(root, path)
        yield path.name


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("version")
    one.add_argument("version")
    one.add_argument("--date", default=datetime.date.today().isoformat())
    commands.add_parser("repository").add_argument("url")
    commands.add_parser("check").add_argument("--tag")
    commands.add_parser("notes").add_argument("version")
    one = commands.add_parser("notices")
    one.add_argument("manifest", type=Path)
    one.add_argument("--target")
    commands.add_parser("packages").add_argument("folder", type=Path)
    given = parser.parse_args()
    sys.stdout.reconfigure(encoding="utf-8")  # type: ignore[union-attr]
    try:
        match given.command:
            case "version":
                set_version(given.root, given.version, given.date)
            case "repository":
                set_repository(given.root, given.url)
            case "check":
                print(f"all files have version {check(given.root, given.tag)}")
            case "notes":
                print(section(given.root, given.version)[1])
            case "notices":
                print(notices(given.manifest, given.target), end="")
            case "packages":
                for name in check_packages(given.root, given.folder):
                    print(f"complete: {name}")
    except Failure as failure:
        print(f".ci/release.py: {failure}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
