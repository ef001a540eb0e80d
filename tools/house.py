"""Figures of the house: how large it is, what imports what, how much of it is said twice or called once.

    python -m tools.house [FOLDER]

prints them as a table; ``tests/architecture/test_house.py`` holds each to its bar. The source is read, nothing is run.
"""

from __future__ import annotations

import ast
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("geometry", "fem", "identification", "validation")
LONG = 800
"""Lines from which a module is more than one subject."""

FACE = "massline"
"""The package that hands the names of the rooms on to users; no figure counts it."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True, eq=False, kw_only=True)
class Module:
    """A file with its `name` as it is imported; a `package` where it is an ``__init__.py``."""

    name: str
    package: bool
    text: str

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text)

    @cached_property
    def statements(self) -> tuple[ast.Import | ast.ImportFrom | ast.ClassDef, ...]:
        """Its imports and classes, wherever they stand: of one walk, which takes long."""
        found, waiting = [], list[ast.AST](self.tree.body)
        while waiting:
            node = waiting.pop()
            if isinstance(node, ast.Import | ast.ImportFrom | ast.ClassDef):
                found.append(node)
            if not isinstance(node, ast.expr):  # in which none stands
                waiting += _children(node)
        return tuple(found)

    @cached_property
    def imported(self) -> tuple[ast.Import | ast.ImportFrom, ...]:
        return tuple(node for node in self.statements if not isinstance(node, ast.ClassDef))

    @cached_property
    def classes(self) -> tuple[str, ...]:
        """Names of its classes."""
        return tuple(node.name for node in self.statements if isinstance(node, ast.ClassDef))

    @cached_property
    def functions(self) -> frozenset[str]:
        """Names of those at its top level."""
        return frozenset(node.name for node in self.tree.body if isinstance(node, ast.FunctionDef))

    @cached_property
    def header(self) -> int:
        """Lines down to the last import at the head; blank lines and docstring are among them."""
        last = 0
        for node in self.tree.body:
            text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            typing = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
            if not (text or typing or isinstance(node, ast.Import | ast.ImportFrom)):
                break
            last = node.end_lineno or 0
        return last

    def base(self, node: ast.ImportFrom) -> str:
        """What stands behind ``from``, written out."""
        above = self.name.split(".")[: len(self.name.split(".")) - node.level + self.package] if node.level else []
        return ".".join([*above, *([node.module] if node.module else [])])


def modules(root: Path = ROOT, rooms: Iterable[str] = ROOMS) -> dict[str, Module]:
    """The modules of `rooms` by name."""
    return {one.name: one for room in rooms for one in _of_room(root, room)}


@cache
def _of_room(root: Path, room: str) -> tuple[Module, ...]:
    """Read once a process: to parse the whole house takes seconds, and several figures want it."""
    found = []
    for path in sorted((root / room).rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        package = parts[-1] == "__init__"
        name = ".".join(parts[:-1] if package else parts)
        found.append(Module(name=name, package=package, text=path.read_text(encoding="utf-8")))
    return tuple(found)


def imports(house: dict[str, Module]) -> dict[str, set[str]]:
    """By module what it imports of the house, wherever the import stands; of ``from package import module`` the module."""
    found: dict[str, set[str]] = {}
    for one in house.values():
        names = {name.name for node in one.imported if isinstance(node, ast.Import) for name in node.names}
        for base, name in (
            (one.base(node), name.name) for node in one.imported if isinstance(node, ast.ImportFrom) for name in node.names
        ):
            names.add(f"{base}.{name}" if f"{base}.{name}" in house else base)
        found[one.name] = (names & house.keys()) - {one.name}
    return found


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Modules that import each other, directly or on the way; each circle sorted."""
    import networkx

    every = networkx.strongly_connected_components(networkx.DiGraph({name: sorted(to) for name, to in graph.items()}))
    return sorted(sorted(circle) for circle in every if len(circle) > 1)


class Callers:
    """How often each top-level function of the house is referred to; names are followed through imports and re-exports."""

    def __init__(self, house: dict[str, Module]) -> None:
        self.house = house
        self.bound = {name: dict(self._bindings(one)) for name, one in house.items()}
        self.count: Counter[tuple[str, str]] = Counter()
        for one in house.values():
            self._visit(one.tree, one.name, frozenset())

    def single(self) -> list[tuple[str, str]]:
        """Functions, as (module, name), that one place refers to."""
        return sorted(function for function, number in self.count.items() if number == 1)

    def _bindings(self, one: Module) -> Iterator[tuple[str, tuple[str, str]]]:
        """By name in the module: the module that is meant and the name in it, empty where it is the module itself."""
        for node in one.imported:
            if isinstance(node, ast.Import):
                for each in node.names:
                    first = each.name.split(".")[0]
                    yield each.asname or first, (each.name if each.asname else first, "")
            else:
                base = one.base(node)
                for each in node.names:
                    whole = f"{base}.{each.name}"
                    is_module = whole in self.house and each.name not in getattr(self.house.get(base), "functions", ())
                    yield each.asname or each.name, ((whole, "") if is_module else (base, each.name))

    def _function(self, module: str, name: str, depth: int = 9) -> tuple[str, str] | None:
        if module not in self.house or not depth:
            return None
        if name in self.house[module].functions:
            return module, name
        base, what = self.bound[module].get(name, ("", ""))
        return self._function(base, what, depth - 1) if what else None

    def _dotted(self, module: str, path: list[str]) -> tuple[str, str] | None:
        """The function that ``a.b.c`` names, where all but its end are modules."""
        target, what = self.bound[module].get(path[0], ("", ""))
        for part in path[1:-1]:
            if what or not target:
                return None
            inner = f"{target}.{part}"
            target, what = (inner, "") if inner in self.house else self.bound.get(target, {}).get(part, ("", ""))
        return None if what else self._function(target, path[-1])

    def _visit(self, node: ast.AST, module: str, hidden: frozenset[str]) -> None:
        if isinstance(node, Function | ast.Lambda):
            hidden |= _locals(node)
        elif isinstance(node, ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp):
            hidden |= {one.id for part in node.generators for one in ast.walk(part.target) if isinstance(one, ast.Name)}
        found = None
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id not in hidden:
            found = self._function(module, node.id)
        elif isinstance(node, ast.Attribute):
            path, inner = [node.attr], node.value
            while isinstance(inner, ast.Attribute):
                path, inner = [inner.attr, *path], inner.value
            if isinstance(inner, ast.Name) and inner.id not in hidden:
                found = self._dotted(module, [inner.id, *path])
        if found:
            self.count[found] += 1
        for child in _children(node):
            self._visit(child, module, hidden)


def _children(node: ast.AST) -> list[ast.AST]:
    """Nodes right within `node`. Most of all nodes are names, constants and contexts, and nothing that could refer is in them."""
    found: list[ast.AST] = []
    for name in () if isinstance(node, ast.Name | ast.Constant) else node._fields:
        value = getattr(node, name, None)
        if isinstance(value, list):
            found += [one for one in value if isinstance(one, ast.AST)]
        elif isinstance(value, ast.AST) and not isinstance(value, ast.expr_context | ast.operator | ast.cmpop):
            found.append(value)
    return found


def _locals(function: Function | ast.Lambda) -> set[str]:
    """Names that a function binds, which hide those of its module."""
    names = {one.arg for one in ast.walk(function.args) if isinstance(one, ast.arg)}
    waiting: list[ast.AST] = list(function.body) if isinstance(function.body, list) else []
    while waiting:
        node = waiting.pop()
        if isinstance(node, Function | ast.ClassDef):
            names.add(node.name)
        elif not isinstance(node, ast.Lambda):
            names |= {node.id} if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load) else set()
            waiting += _children(node)
    return names


def twice(house: dict[str, Module], package: str) -> list[str]:
    """Names that more than one class of `package` has."""
    inside = [one for name, one in house.items() if f"{name}.".startswith(f"{package}.")]
    names = Counter(name for one in inside for name in one.classes)
    return sorted(name for name, number in names.items() if number > 1)


def figures(root: Path = ROOT) -> dict[str, float]:
    """The table, by what is counted."""
    house = modules(root)
    lines = sum(len(one.text.splitlines()) for one in house.values())
    functions = sum(len(one.functions) for one in house.values())
    inside = [one for name, one in house.items() if name.startswith("validation.") and name.count(".") == 1]
    return {
        "product files": len(house),
        "product lines": lines,
        "modules over 800 lines": sum(len(one.text.splitlines()) > LONG for one in house.values()),
        "import circles": len(circles(imports(house))),
        "packages of validation": sum(one.package for one in inside),
        "loose modules of validation": sum(not one.package for one in inside),
        "class names twice in validation": len(twice(house, "validation")),
        "share of lines that are file headers [%]": 100 * sum(one.header for one in house.values()) / lines,
        "top-level functions": functions,
        "share of them with a single caller [%]": 100 * len(Callers(house).single()) / functions,
    }


if __name__ == "__main__":
    for what, figure in figures(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT).items():
        sys.stdout.write(f"{what:42}{round(figure, 1):>10,g}\n")
