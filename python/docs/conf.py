"""The documentation: ``python -m sphinx -W -b html python/docs OUT``, without a network.

The pages of the repository's ``docs/`` are copied beside these for the time of a build; what they
link to outside of it (code, data, other Markdown files) becomes text.
"""

import re
import shutil
from importlib.metadata import version as version_of
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]

project = "colltrans"
author = "the authors of colltrans"
release = version = version_of("colltrans")
extensions = ["sphinx.ext.autodoc", "numpydoc", "myst_parser"]
exclude_patterns = ["_build"]
html_theme = "alabaster"
html_theme_options = {"description": "How far can a body move before it touches another?"}
html_show_sourcelink = False
# Signatures say the types in full; the text does.
autodoc_typehints = "none"
autodoc_member_order = "groupwise"
numpydoc_show_class_members = False
myst_heading_anchors = 3
# A page shows the form of a line of JSON, which is none itself.
suppress_warnings = ["misc.highlighting_failure"]


def copy_pages() -> None:
    target = HERE / "pages"
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir()
    shutil.copytree(ROOT / "docs" / "figures", target / "figures")
    for file in (ROOT / "docs").iterdir():
        if file.suffix == ".svg":
            shutil.copy(file, target)
        elif file.suffix == ".md":
            (target / file.name).write_text(without_links_out(file.read_text()))


def without_links_out(text: str) -> str:
    """Links to what is not a page or a picture beside it, and not of the web, as their text."""

    def kept(link: re.Match[str]) -> str:
        words, target = link.groups()
        beside = re.fullmatch(r"[\w.-]*\.(md|svg)?(#[\w-]+)?", target)
        return link[0] if beside or target.startswith(("http", "#")) else words

    return re.sub(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)", kept, text)


copy_pages()
