"""Configuration of Sphinx; ``build.py`` gathers the sources and calls it."""

from importlib.metadata import version as version_of

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

project = "colltrans"
author = "the authors of colltrans"
project_copyright = "the authors of colltrans; MIT or Apache 2.0"
release = version = version_of("colltrans")
extensions = ["sphinx.ext.autodoc", "numpydoc", "myst_nb"]
html_theme = "furo"
html_title = f"colltrans {version}"
html_static_path = ["static"]
html_favicon = "static/icon.svg"
html_css_files = ["site.css"]
html_show_sourcelink = False
# Pages load nothing from other sites.
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b57d0", "color-brand-content": "#0b57d0"},
    "dark_css_variables": {"color-brand-primary": "#a9c9ff", "color-brand-content": "#a9c9ff"},
}
pygments_dark_style = "github-dark"
# Signatures omit types, because the text has them.
autodoc_typehints = "none"
autodoc_member_order = "groupwise"
numpydoc_show_class_members = False
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
# Formulas are MathML, made at build time: browsers need neither scripts nor fonts for it.
html_math_renderer = "mathml"
# build.py has executed the notebooks and stored their outputs.
nb_execution_mode = "off"
# Some blocks of JSON show the form of a line and are not valid JSON.
suppress_warnings = ["misc.highlighting_failure"]


def inline_formula(writer: HTML5Translator, node: nodes.Element) -> None:
    """Writes a formula of ``$...$``."""
    writer.body.append(convert(node.astext()))
    raise nodes.SkipNode


def block_formula(writer: HTML5Translator, node: nodes.Element) -> None:
    """Writes a formula of ``$$...$$``, which scrolls by itself where it is wide."""
    formula = convert(node.astext(), display="block")
    writer.body.append(f'<div class="formula">{formula}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    app.add_html_math_renderer("mathml", (inline_formula, None), (block_formula, None))
