"""Tests that all packages have one version and a change entry, and the recipe for conda."""

import json
import re
import tomllib
from typing import Any

import pytest
from conftest import ROOT

import colltrans


def toml(path: str) -> Any:
    return tomllib.loads((ROOT / path).read_text())


def test_all_that_is_released_has_one_version() -> None:
    version = toml("Cargo.toml")["workspace"]["package"]["version"]
    citation = (ROOT / "CITATION.cff").read_text()
    released = re.findall(r"^## (\S+) — (\S+)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    found = {
        "the extension": colltrans.__version__,
        "its crate": toml("crates/colltrans-python/Cargo.toml")["package"]["version"],
        "the page's crate": toml("crates/colltrans-wasm/Cargo.toml")["package"]["version"],
        "the Python package": toml("python/pyproject.toml")["project"]["version"],
        "the page": json.loads((ROOT / "web/package.json").read_text())["version"],
        "the citation": re.findall(r"^version: (\S+)$", citation, re.MULTILINE)[0],
        "the changelog": released[0][0],
        "the recipe": re.findall(r'version: "([^"]+)"', recipe())[0],
    }
    assert found == dict.fromkeys(found, version)
    assert f'date-released: "{released[0][1]}"' in citation


def test_crates_ask_for_each_other_by_that_version() -> None:
    version = toml("Cargo.toml")["workspace"]["package"]["version"]
    asked = [*ROOT.glob("Cargo.toml"), *ROOT.glob("crates/*/Cargo.toml")]
    pattern = re.compile(r'^colltrans\S* = \{ path = .*version = "([^"]+)"', re.MULTILINE)
    versions = [found for file in asked for found in pattern.findall(file.read_text())]
    assert len(versions) > 3 and set(versions) == {version}


def recipe() -> str:
    return (ROOT / "python/conda/recipe.yaml").read_text()


def test_the_recipe_for_conda_is_rendered_and_says_what_the_package_needs() -> None:
    rattler_build = pytest.importorskip("rattler_build")
    known = rattler_build.Stage0Recipe.from_file(ROOT / "python/conda/recipe.yaml")
    (rendered,) = known.render(rattler_build.VariantConfig())
    assert (rendered.recipe.package.name, rendered.recipe.package.version) == (
        "colltrans",
        colltrans.__version__,
    )
    project, build = (toml("python/pyproject.toml")[name] for name in ("project", "build-system"))
    for need in [*project["dependencies"], *build["requires"]]:
        assert f"- {need.replace('>=', ' >=', 1)}" in recipe(), need
    assert f"- python {project['requires-python']}" in recipe()
    assert f"license: {project['license']}" in recipe()
    assert project["description"] in recipe()
