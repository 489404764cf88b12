"""Tests that the stub has types only, and in a wheel also the docstrings of the extension."""

import ast
import importlib
import inspect
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from conftest import ROOT

from colltrans import _colltrans

STUB = ROOT / "python/src/colltrans/_colltrans.pyi"


@pytest.fixture
def tool(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "python" / "tools"))
    return importlib.import_module("docstrings")


def documented_names(node: Any, prefix: str = "") -> dict[str, str | None]:
    """Returns the docstring of each definition; that of the first if there are overloads."""
    found: dict[str, str | None] = {}
    for child in node.body:
        if isinstance(child, ast.ClassDef | ast.FunctionDef):
            found.setdefault(prefix + child.name, ast.get_docstring(child))
        if isinstance(child, ast.ClassDef):
            found |= documented_names(child, f"{child.name}.")
    return found


def test_every_docstring_of_the_extension_is_in_the_stub_of_a_wheel(tool: ModuleType) -> None:
    written = documented_names(ast.parse(tool.documented(STUB.read_text(), _colltrans)))
    for name, docstring in written.items():
        thing: Any = _colltrans
        for part in name.split("."):
            thing = inspect.getattr_static(thing, part, None)
        text = getattr(getattr(thing, "__func__", thing), "__doc__", None)
        if text and not name.split(".")[-1].startswith("_"):
            assert docstring == inspect.cleandoc(text), name
    assert sum(map(bool, written.values())) > 300
    # A class of the stub alone, which is the base of classes of the extension.
    assert written["_Answer.to_dict"] == inspect.cleandoc(_colltrans.Contact.to_dict.__doc__ or "")


def test_the_stub_of_the_repository_has_no_docstrings() -> None:
    written = documented_names(ast.parse(STUB.read_text()))
    told = [name for name, text in written.items() if text]
    # Types of the stub alone, which have no docstring in the extension.
    assert told == ["HasMatrix", "HasFaces", "HasTriangles"]
    assert not any(hasattr(_colltrans, name) for name in told)


def test_a_wheel_is_rewritten_with_docstrings_in_its_stub(tool: ModuleType, tmp_path: Path) -> None:
    pytest.importorskip("wheel")
    content = tmp_path / "colltrans-0.0.0"
    (content / "colltrans").mkdir(parents=True)
    shutil.copy(_colltrans.__file__ or "", content / "colltrans")
    shutil.copy(STUB, content / "colltrans")
    information = content / "colltrans-0.0.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: colltrans\nVersion: 0.0.0\n"
    )
    (information / "WHEEL").write_text(
        "Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: py3-none-any\n"
    )
    command = [sys.executable, "-m", "wheel"]
    subprocess.run([*command, "pack", content, "--dest", tmp_path], check=True)
    (wheel,) = tmp_path.glob("*.whl")
    tool.write_docstrings(wheel)
    # Checks the sizes and hashes that the wheel lists for its files.
    subprocess.run([*command, "unpack", wheel, "--dest", tmp_path / "again"], check=True)
    stub = tmp_path / "again" / content.name / "colltrans" / STUB.name
    assert stub.read_text() == tool.documented(STUB.read_text(), _colltrans)

    # A wheel for another platform, whose extension cannot be loaded here.
    (content / "colltrans" / Path(_colltrans.__file__ or "").name).write_bytes(
        b"of another platform"
    )
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    subprocess.run([*command, "pack", content, "--dest", foreign], check=True)
    (other,) = foreign.glob("*.whl")
    tool.write_docstrings(other, wheel)
    subprocess.run([*command, "unpack", other, "--dest", foreign / "again"], check=True)
    assert (
        foreign / "again" / content.name / "colltrans" / STUB.name
    ).read_text() == stub.read_text()
