"""Docstrings of the extension into its stub, so that editors show them: one text, told twice.

``python python/tools/docstrings.py`` writes them, as the installed extension has them;
``--check`` says whether the stub has the same.
"""

import argparse
import ast
import inspect
import subprocess
import sys
from pathlib import Path
from textwrap import indent
from typing import Any

from colltrans import _colltrans

STUB = Path(__file__).parents[1] / "src" / "colltrans" / "_colltrans.pyi"
Edit = tuple[tuple[int, int], tuple[int, int], str]


def edits_of(module: ast.Module) -> list[Edit]:
    """What is to be put in the place of what, from the first to the last."""
    edits, told = [], set()
    for node in module.body:
        thing = getattr(_colltrans, getattr(node, "name", ""), None)
        if thing is None or isinstance(node, (ast.Assign, ast.AnnAssign)):
            continue
        if isinstance(node, ast.FunctionDef) and node.name not in told:
            edits += edit_of(node, thing)
            told.add(node.name)
        if isinstance(node, ast.ClassDef):
            edits += edit_of(node, thing) + members_of(node, thing)
    return edits


def members_of(node: ast.ClassDef, thing: Any) -> list[Edit]:
    """Of an overloaded method the first has the text."""
    edits, told = [], set()
    for member in node.body:
        if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
            if member.name not in told:
                edits += edit_of(member, inspect.getattr_static(thing, member.name))
            told.add(member.name)
    return edits


def edit_of(node: ast.ClassDef | ast.FunctionDef, thing: Any) -> list[Edit]:
    text = getattr(thing, "__func__", thing).__doc__
    if not text:
        return []
    margin = " " * (node.col_offset + 4)
    lines = inspect.cleandoc(text)
    closing = "\n" if "\n" in lines else ""
    raw = "r" if "\\" in lines else ""
    written = indent(f'{raw}"""{lines}{closing}"""', margin).lstrip()
    first = node.body[0]
    if isinstance(first, ast.Expr):  # The text that was there, or dots, maybe behind the colon.
        place = (first.lineno, first.col_offset)
        begins = "\n" + margin if first.col_offset > len(margin) else ""
        return [(place, (first.end_lineno or 0, first.end_col_offset or 0), begins + written)]
    decorators = getattr(first, "decorator_list", [])
    place = (min(part.lineno for part in (first, *decorators)), len(margin))
    return [(place, place, f"{written}\n\n{margin}")]


def told(source: str) -> str:
    """The stub with the docstrings that it should have."""
    lines = source.splitlines(keepends=True)
    for (line, column), (last, until), text in reversed(edits_of(ast.parse(source))):
        before = lines[line - 1].encode()[:column].decode()
        after = lines[last - 1].encode()[until:].decode()
        if text.startswith("\n"):
            before = before.rstrip()
        lines[line - 1 : last] = [before + text + after]
    command = ["ruff", "format", "--stdin-filename", str(STUB), "-"]
    formatted = subprocess.run(
        command, input="".join(lines), capture_output=True, text=True, check=True
    )
    return formatted.stdout


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing")
    checks = parser.parse_args().check
    source = STUB.read_text()
    written = told(source)
    if written == source:
        return 0
    if checks:
        print(f"{STUB} has other docstrings: run python python/tools/docstrings.py")
        return 1
    STUB.write_text(written)
    return 0


if __name__ == "__main__":
    sys.exit(main())
