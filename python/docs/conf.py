"""The pages of the Python package: built by tools/python, warnings are errors."""

import leadscrew

project = "Leadscrew in Python"
copyright = "the Leadscrew authors, MIT or Apache-2.0"
version = release = leadscrew.__version__
extensions = ["sphinx.ext.autodoc", "myst_parser"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_type_aliases = {"pa.Table": "pyarrow.Table"}
# pages of the repository lead to others of it, which are not part of these
suppress_warnings = ["myst.xref_missing"]
html_theme = "alabaster"
html_theme_options = {"description": "Programs checked, timed, run and judged; studies over many", "page_width": "72rem"}
html_sidebars = {"**": ["about.html", "navigation.html", "searchbox.html"]}
exclude_patterns = ["_build"]
