"""Configuration of the documentation site: `sphinx-build -W python/docs OUT`, with the package installed."""

import elbowroom

project = "elbowroom"
version = release = elbowroom.__version__
copyright = "the authors of elbowroom, MIT OR Apache-2.0"  # noqa: A001

extensions = ["sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon"]
templates_path = ["_templates"]
# A page per class, from its docstrings.
autosummary_generate = True
autosummary_imported_members = True
# Sections in the style of NumPy; attributes are said once, in the docstring of the class.
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_attr_annotations = False
# `code` in docstrings is code.
default_role = "code"
autodoc_typehints = "none"
html_theme = "alabaster"
html_theme_options = {"description": "Collision awareness for industrial robot cells", "page_width": "1100px"}
html_sidebars = {"**": ["about.html", "navigation.html", "searchfield.html"]}
html_show_sourcelink = False
# Names of attributes such as `robot` occur in several classes: they are not references.
suppress_warnings = ["ref.python"]
