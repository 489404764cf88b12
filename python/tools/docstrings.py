"""Writes the docstrings of the extension into the stub of each wheel: editors read only the stub.

``python python/tools/docstrings.py dist/*.whl`` changes the wheels in place. It loads their
extension, so it runs on a platform that they are for. ``--like WHEEL`` takes the stub of a finished
wheel instead, for wheels of other platforms. It needs the package ``wheel``.
"""

import argparse
import ast
import inspect
import subprocess
import sys
from importlib.machinery import ExtensionFileLoader, ModuleSpec
from importlib.util import module_from_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import indent
from types import ModuleType
from typing import Any
from zipfile import ZipFile


def documented(stub: str, extension: ModuleType) -> str:
    """Returns a stub with the docstrings of the extension; of overloads only the first has one."""
    module = ast.parse(stub)
    found = _docstrings(module, extension)
    # A class of the stub alone documents what the classes derived from it have in common.
    classes = [node for node in module.body if isinstance(node, ast.ClassDef)]
    owners: dict[str, Any] = {}
    for node in reversed(classes):
        owner = owners.setdefault(node.name, getattr(extension, node.name, None))
        owners |= {ast.unparse(base): owner for base in node.bases}
        if not hasattr(extension, node.name):
            found += _docstrings(node, owner)
    lines = stub.splitlines()
    for node, text in sorted(found, key=lambda each: -each[0].lineno):
        _insert(lines, node, text)
    return "\n".join(lines) + "\n"


def _docstrings(node: Any, owner: Any) -> list[tuple[Any, str]]:
    """Returns the definitions inside a module or class, and their docstrings."""
    found: dict[str, tuple[Any, str]] = {}
    inner = []
    for child in node.body:
        thing = inspect.getattr_static(owner, getattr(child, "name", ""), None)
        if thing is None or child.name.startswith("_") or child.name in found:
            continue
        if text := getattr(thing, "__func__", thing).__doc__:
            found[child.name] = (child, inspect.cleandoc(text))
        if isinstance(child, ast.ClassDef):
            inner += _docstrings(child, thing)
    return [*found.values(), *inner]


def _insert(lines: list[str], node: Any, text: str) -> None:
    """Puts a docstring before the body of a definition, or in the place of its dots."""
    raw, end = "r" if "\\" in text else "", "\n" if "\n" in text else ""
    docstring = indent(f'{raw}"""{text}{end}"""', " " * (node.col_offset + 4))
    first = node.body[0]
    line = min([first.lineno, *(each.lineno for each in getattr(first, "decorator_list", []))]) - 1
    if isinstance(first, ast.Expr):
        before = lines[line][: first.col_offset].rstrip()
        lines[line : line + 1] = [before, docstring] if before else [docstring]
    else:
        lines.insert(line, docstring)


def write_docstrings(wheel: Path, like: Path | None = None) -> None:
    """Rewrites a wheel with docstrings in its stub, or with the stub of a finished wheel."""
    # Windows cannot remove an extension that is loaded.
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        _run_wheel("unpack", wheel, "--dest", folder)
        (content,) = Path(folder).iterdir()
        package = content / "colltrans"
        stub = package / "_colltrans.pyi"
        if like is not None:
            with ZipFile(like) as finished:
                stub.write_bytes(finished.read("colltrans/_colltrans.pyi"))
        else:
            (library,) = (*package.glob("_colltrans*.so"), *package.glob("_colltrans*.pyd"))
            stub.write_text(documented(stub.read_text("utf-8"), _load(library)), "utf-8")
        _run_wheel("pack", content, "--dest", wheel.parent)


def _load(library: Path) -> ModuleType:
    """Loads an extension without the package around it, whose dependencies may be missing."""
    loader = ExtensionFileLoader("_colltrans", str(library))
    module = module_from_spec(ModuleSpec("_colltrans", loader, origin=str(library)))
    loader.exec_module(module)
    return module


def _run_wheel(*words: str | Path) -> None:
    subprocess.run([sys.executable, "-m", "wheel", *words], check=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheels", type=Path, nargs="+")
    parser.add_argument("--like", type=Path)
    given = parser.parse_args()
    for each in given.wheels:
        write_docstrings(each, given.like)
