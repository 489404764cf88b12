"""Tests that all packages have one version and a change entry, and the recipe for conda."""

import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from conftest import ROOT

import colltrans


def toml(path: str) -> Any:
    return tomllib.loads((ROOT / path).read_text(encoding="utf-8"))


def load_release() -> ModuleType:
    spec = importlib.util.spec_from_file_location("release", ROOT / ".ci/release.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


release = load_release()


def test_all_that_is_released_has_one_version() -> None:
    assert release.check(ROOT, None) == colltrans.__version__


def test_every_crate_is_published_with_licences_and_a_readme_of_its_own() -> None:
    manifests = release.published(ROOT)
    assert len(manifests) > 10
    for manifest in manifests:
        package = tomllib.loads(manifest.read_text(encoding="utf-8"))["package"]
        assert package["readme"] == "README.md" and package["authors"] == {"workspace": True}
        # The registry accepts five words of 20 letters, and five categories.
        assert 0 < len(package["keywords"]) <= 5 and max(map(len, package["keywords"])) <= 20
        assert 0 < len(package["categories"]) <= 5
        assert "/LICENSE-*" in package["include"]
        readme = (manifest.parent / "README.md").read_text(encoding="utf-8")
        assert readme.startswith(f"# {package['name']}\n")
        links = re.findall(r"\]\(([^)]+)\)", readme)
        known = re.compile(
            r"https://(docs\.rs|crates\.io/crates)/colltrans(-[a-z-]+)?|LICENSE-[A-Z]+"
        )
        assert all(known.fullmatch(link) for link in links), links
        if "bin" not in tomllib.loads(manifest.read_text(encoding="utf-8")):
            docs = package["metadata"]["docs"]["rs"]
            assert docs["all-features"] is True and docs["targets"] == ["x86_64-unknown-linux-gnu"]


def copy_of_what_a_release_changes(folder: Path) -> Path:
    """Copies the files with a version, and those of each package that a release needs."""
    patterns = {pattern for pattern, _ in release.PLACES}
    patterns |= {"CHANGELOG.md", "LICENSE-*", "*/LICENSE-*", "*/*/LICENSE-*"}
    patterns |= {"python/README.md", "crates/*/Cargo.toml", "web/src/index.html"}
    for path in {path for pattern in patterns for path in ROOT.glob(pattern)}:
        to = folder / path.relative_to(ROOT)
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, to)
    return folder


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(ROOT / ".ci/release.py"), *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


def test_two_commands_and_a_tag_prepare_a_release(tmp_path: Path) -> None:
    root = copy_of_what_a_release_changes(tmp_path)
    unreleased = re.search(
        r"(?ms)^## Unreleased\n(.*?)^## ", (root / "CHANGELOG.md").read_text(encoding="utf-8")
    )
    assert unreleased
    new = "97.98.99"
    changed = run("--root", str(root), "version", new, "--date", "2099-01-31")
    assert changed.returncode == 0, changed.stderr
    assert all(found == {new} for found in release.versions(root).values())
    assert release.section(root, new) == ("2099-01-31", unreleased[1].strip())
    assert 'date-released: "2099-01-31"' in (root / "CITATION.cff").read_text(encoding="utf-8")

    # Without a repository the packages would have no links.
    refused = run("--root", str(root), "check", "--tag", f"v{new}")
    assert refused.returncode == 1 and "repository URL" in refused.stderr
    for url in ["https://example.org/first/name", "https://example.org/second/name"]:
        release.set_repository(root, url)
        assert release.repository(root) == url
        python = tomllib.loads((root / "python/pyproject.toml").read_text(encoding="utf-8"))
        assert python["project"]["urls"]["Repository"] == url
        manifests = [path.read_text(encoding="utf-8") for path in release.published(root)]
        assert all("\nrepository.workspace = true\n" in text for text in manifests)
        npm = json.loads((root / "web/package/package.json").read_text(encoding="utf-8"))
        assert npm["repository"]["url"] == f"git+{url}.git"
        page = (root / "web/src/index.html").read_text(encoding="utf-8")
        assert f'<a href="{url}">Source</a>' in page
        readme = (root / "python/README.md").read_text(encoding="utf-8")
        targets = re.findall(rf"\]\({url}/blob/main/([^)]+)\)", readme)
        assert len(targets) > 3 and all((ROOT / target).is_file() for target in targets)
        assert not release.RELATIVE_LINK.search(readme)
    assert run("--root", str(root), "check", "--tag", f"v{new}").returncode == 0
    refused = run("--root", str(root), "check", "--tag", "v1.0.0")
    assert refused.returncode == 1 and f"use the tag v{new}" in refused.stderr


@pytest.mark.parametrize(
    ("file", "old", "new", "reason"),
    [
        (
            "crates/colltrans-wasm/Cargo.lock",
            "",
            "9.9.9",
            "crates/colltrans-wasm/Cargo.lock: 9.9.9",
        ),
        ("web/package.json", "", "9.9.9", "web/package.json: 9.9.9"),
        ("web/package/package.json", "", "9.9.9", "web/package/package.json: 9.9.9"),
        ("CITATION.cff", "date-released: ", "date-released: x", "date-released is not"),
        ("CHANGELOG.md", "## ", "## x", "no section"),
        ("python/LICENSE-MIT", "MIT", "BSD", "python/LICENSE-MIT is not a copy"),
    ],
)
def test_a_file_that_disagrees_is_named(
    tmp_path: Path, file: str, old: str, new: str, reason: str
) -> None:
    root = copy_of_what_a_release_changes(tmp_path)
    text = (root / file).read_text(encoding="utf-8")
    changed = text.replace(old or colltrans.__version__, new)
    assert changed != text
    (root / file).write_text(changed, encoding="utf-8")
    with pytest.raises(release.Failure, match=re.escape(reason)):
        release.check(root, None)


def test_the_reader_of_step_files_names_what_the_extra_installs() -> None:
    (requirement,) = toml("python/pyproject.toml")["project"]["optional-dependencies"]["step"]
    source = (ROOT / "python/src/colltrans/step.py").read_text(encoding="utf-8")
    assert f"pip install '{requirement}'" in source


def test_a_version_is_not_released_twice(tmp_path: Path) -> None:
    root = copy_of_what_a_release_changes(tmp_path)
    with pytest.raises(release.Failure, match="already"):
        release.set_version(root, colltrans.__version__, "2099-01-31")
    with pytest.raises(release.Failure, match="not a version"):
        release.set_version(root, "1.0", "2099-01-31")


def test_the_workflow_checks_the_tag_first_and_publishes_after_an_approval() -> None:
    workflow = (ROOT / ".github/workflows/release.yml").read_text(encoding="utf-8")
    # Actions are pinned by their commits.
    used = re.findall(r"uses: (\S+)", workflow)
    assert used and all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", action) for action in used)
    _, *parts = re.split(r"(?m)^  ([a-z-]+):\n", workflow[workflow.index("\njobs:\n") :])
    jobs = dict(zip(parts[::2], parts[1::2], strict=True))
    assert '.ci/release.py check --tag "$TAG"' in jobs.pop("tag")
    assert all("\n    needs: " in f"\n{job}" for job in jobs.values())
    publishing = [job for job in jobs.values() if "id-token: write" in job]
    assert len(publishing) == 3
    for job in [*publishing, jobs["draft"]]:
        assert "\n    if: github.ref_type == 'tag'\n" in job
    for job in publishing:
        assert "\n    environment: release\n" in job and "\n    needs: draft\n" in job


def recipe() -> str:
    return (ROOT / "python/conda/recipe.yaml").read_text(encoding="utf-8")


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
