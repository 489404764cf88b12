"""How Sphinx makes the pages; ``build.py`` gathers what they are made of and calls it."""

from importlib.metadata import version as version_of

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
# Nothing is fetched from elsewhere when a page is read.
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b57d0", "color-brand-content": "#0b57d0"},
    "dark_css_variables": {"color-brand-primary": "#a9c9ff", "color-brand-content": "#a9c9ff"},
}
pygments_dark_style = "github-dark"
# Signatures say the types in full; the text does.
autodoc_typehints = "none"
autodoc_member_order = "groupwise"
numpydoc_show_class_members = False
myst_heading_anchors = 3
# They have been run, and hold what came of it.
nb_execution_mode = "off"
# A page shows the form of a line of JSON, which is none itself.
suppress_warnings = ["misc.highlighting_failure"]
