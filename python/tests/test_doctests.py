"""Runs the examples of all docstrings and of the pages about Python."""

import doctest
import importlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT
from test_docs import GROUPS, public_names

import colltrans

TUTORIALS = ROOT / "python" / "docs" / "tutorials"
GUIDES = [
    ROOT / "docs" / "guide" / f"{name}.md"
    for name in (
        "python",
        "python-arrays",
        "distance",
        "rounded",
        "point-clouds",
        "motions",
        "robots",
    )
]
PAGES = [*GUIDES, *sorted(TUTORIALS.glob("*.md"))]

#: The packages that pages use besides numpy.
NEEDED = {"cad": ["plotly"], "data": ["pyarrow"], "python": ["plotly"]}


def docstrings() -> Iterator[tuple[str, str]]:
    yield "colltrans", colltrans.__doc__ or ""
    for group in GROUPS:
        yield group, importlib.import_module(f"colltrans.{group}").__doc__ or ""
    for name, thing in public_names().items():
        yield name, thing.__doc__ or ""
        # In a fixed order: the extension adds members of a class in any.
        for member, value in sorted(vars(thing).items()) if isinstance(thing, type) else ():
            if not member.startswith("_") and getattr(value, "__doc__", None):
                yield f"{name}.{member}", value.__doc__


@pytest.mark.parametrize(("name", "text"), list(docstrings()))
def test_examples_in_docstrings_give_their_outputs(
    name: str, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if name in ("picture", "show"):
        pytest.importorskip("plotly")
    monkeypatch.chdir(ROOT)
    run(name, text)
    assert text, f"{name} has no docstring"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_examples_on_pages_give_their_outputs(page: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs each page from start to end without a screen; most pages are tutorials."""
    for package in NEEDED.get(page.stem, ()):
        pytest.importorskip(package)
    monkeypatch.chdir(ROOT)
    monkeypatch.delenv("ROWS", raising=False)
    run(page.name, page.read_text())


def run(name: str, text: str) -> None:
    test = doctest.DocTestParser().get_doctest(text, {}, name, name, 0)
    said: list[str] = []
    doctest.DocTestRunner(verbose=False).run(test, out=said.append)
    assert not said, "".join(said)


def test_every_public_callable_has_an_example() -> None:
    for name, thing in public_names().items():
        if not isinstance(thing, type) and name != "read":
            assert ">>>" in (thing.__doc__ or ""), name
