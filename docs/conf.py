"""How `make docs` builds the documentation."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))

import docs_pages  # noqa: E402
import nao_kin as nk  # noqa: E402

docs_pages.write()

project = "nao_kin"
author = copyright = "The nao_kin developers"  # noqa: A001 (Sphinx names it so)
version = release = nk.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"]
exclude_patterns = ["_build", "bench"]
html_theme = "furo"
html_title = f"nao_kin {version}"
default_role = "code"  # docstrings put names between single backticks
nitpicky = True

myst_heading_anchors = 3
suppress_warnings = ["myst.header"]  # a changelog goes from the title straight to its versions

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_type_aliases = {name: name for name in ("ArrayLike", "Floats")}
napoleon_use_ivar = True
napoleon_attr_annotations = False
napoleon_use_rtype = False

# What is not ours to document, or is a name for an array.
nitpick_ignore_regex = [("py:.*", pattern) for pattern in (r"(?!nao_kin\.).*",)]


def _escaped(_app: Sphinx, _what: str, _name: str, _object: Any, _options: Any, lines: list[str]) -> None:
    """Bars are lengths and trailing underscores are names here, not references as in reStructuredText."""
    for k, line in enumerate(lines):
        parts = re.split(r"(``?[^`]*``?)", line)
        parts[::2] = [re.sub(r"\|", r"\\|", part) for part in parts[::2]]
        lines[k] = "".join(parts)


def setup(app: Sphinx) -> None:
    """Sphinx's own hook."""
    app.connect("autodoc-process-docstring", _escaped)
