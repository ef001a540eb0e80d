"""The two ways a run can end badly, and what the user reads then.

`BadInput` is the user's file or argument (exit code 2); `CheckFailed` is data or a model that fails a check (exit code 1).
Each carries its evidence as attributes, so that a program can act on it and a person can read it in one sentence.
"""


class BadInput(ValueError):
    """Input that cannot be used: where it stands, which field, what is wrong with it, and what to do.

    Attributes
    ----------
    source : file, argument or object that holds the input
    field : the field, option or key within it; empty when the whole source is at fault
    problem : the condition that is broken and what was found
    remedy : what the user can do
    """

    def __init__(self, source: str, field: str, problem: str, remedy: str) -> None:
        self.source = source
        self.field = field
        self.problem = problem
        self.remedy = remedy
        place = f"{source}: `{field}`" if field else source
        text = f"{place}: {problem}. {remedy}".rstrip(". ")
        super().__init__(text if text.endswith("?") else f"{text}.")

    def __reduce__(self) -> tuple[object, ...]:
        """It travels between processes."""
        return BadInput, (self.source, self.field, self.problem, self.remedy)


def require_fetched(content: bytes, source: str) -> None:
    """Refuse what Git LFS leaves in a clone in place of a large file that it was not asked to fetch."""
    if content.startswith(b"version https://git-lfs"):
        problem = "it is a pointer of Git LFS: the file itself was not fetched"
        raise BadInput(source, "", problem, "Run `git lfs pull` in its repository")


class CheckFailed(RuntimeError):
    """A check of data or model that did not pass, said in words; `evidence` holds the figures by name."""

    def __init__(self, message: str, **evidence: object) -> None:
        self.evidence = evidence
        super().__init__(message)


EXTRAS = {
    "cad": ("cadquery", "OCP"),
    "fem": ("exudyn", "pyyeti", "skfem"),
    "gpl": ("gmsh",),
    "pictures": ("pyvista", "vtk", "vtkmodules"),
    "fleet": ("distributed",),
    "app": ("trame", "trame_client", "trame_vuetify", "wslink", "aiohttp"),
}
"""The extras of `pyproject.toml`, by the modules that come with each; everything else is in the core."""


def lacking(error: ModuleNotFoundError) -> str | None:
    """Which extra brings what `error` looked for, in words; None where it is no library of an extra."""
    library = (error.name or "").partition(".")[0]
    extra = next((name for name, modules in EXTRAS.items() if library in modules), None)
    if extra is None:
        return None
    return f"this needs {library}, which is not installed. It comes with the extra `{extra}`: pip install 'massline[{extra}]'"
