"""Sphinx's settings for the site that `tools.site` builds: nothing is fetched, and search and equations work from disk."""

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

project = "massline"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "index"
myst_heading_anchors = 6
suppress_warnings = ["ref.python"]  # a word in back-quotes that many classes have for an attribute leads to one of them

# Of docstrings: numpydoc's sections, back-quotes as code, attributes with their class and in no index of their own
default_role = "py:obj"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True

html_theme = "furo"
html_title = "massline"
html_copy_source = False
html_show_copyright = False
html_theme_options = {"top_of_page_buttons": []}
html_math_renderer = "mathml"


def escaped(app: Sphinx, what: str, name: str, of: object, options: object, lines: list[str]) -> None:
    """An absolute value is no substitution; what is indented in the docstring of a module stands as it is."""
    text, formula = [], False
    for before, line in zip(["", *lines], lines, strict=False):
        indented = what == "module" and line.startswith("    ")
        if indented and not formula:
            text += ["::", ""]
        elif formula and line and not indented:
            text += [] if not before else [""]
        formula = indented or (formula and not line)
        text.append(line if indented else line.replace("|", r"\|").replace("_ ", r"\_ "))
    lines[:] = text


def mathml(display: str) -> object:
    """What turns an equation into MathML, which browsers set by themselves."""

    def visit(self: HTML5Translator, node: nodes.Element) -> None:
        markup = convert(node.astext(), display=display)
        self.body.append(f'<div class="math">{markup}</div>' if display == "block" else markup)
        raise nodes.SkipNode

    return visit


def setup(app: Sphinx) -> None:
    """Register both."""
    app.connect("autodoc-process-docstring", escaped)
    app.add_html_math_renderer("mathml", (mathml("inline"), None), (mathml("block"), None))
