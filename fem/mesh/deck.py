"""A deck of Nastran, Abaqus or CalculiX as the description of its mesh, in SI.

Carried over are materials, properties of solids, shells, beams and rods, masses at nodes, rigid links, springs and where it is
held.
Whatever else weighs, holds or joins is listed as lost, and never passed over.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fem.mesh import files
from fem.mesh.constraints import Term
from fem.mesh.deck_content import ALL, TRANSLATIONS, Deck, DeckSpring, Elastic, read_cards
from fem.mesh.deck_keywords import read_keywords
from fem.mesh.deck_text import NotThere, naming
from fem.mesh.description import SEAM
from fem.mesh.files import numbers_of
from fem.user_model.units import KNOWN, UnitSystem, unit_system
from geometry import toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.inertia import ROUNDING, six_from_tensor
from geometry.toml_file import STANDARD_GRAVITY

ELASTIC, DENSE, SOUND = (1e6, 1.3e12), (5.0, 22_600.0), (30.0, 14_000.0)
"""Young's modulus [Pa], density [kg/m³] and speed of sound [m/s] between which materials lie, from soft rubber and foam to
diamond and osmium: units in which a deck's materials are outside are not its own. Held by test_deck.py."""

NONE = ((0.0, 1000.0, 18e9, np.inf), (3000.0, np.inf, 0.0, 12e9), (5000.0, 10_000.0, 0.0, 30e9))
"""Densities [kg/m³] and moduli [Pa] from and to between which there is no material: what swims and is stiffer than the best wood,
metal or ceramic softer than lead, and metal but lead and gold softer than tin. Held there, too."""

OF_METALS = ("mm-kgf-s", 2600.0, 9000.0, 60e9)
"""A system in which the wood of others is a metal, the densities [kg/m³] from aluminium to copper that it is taken for, and the
least modulus [Pa] of those, cast. Held there, too."""

CORE = 0.02
"""[1] Modulus of layers, as a share of the stiffest material's, below which they are a core. By definition."""

LIGHT = 1e-3
"""[kg/m³] Density of what a deck gives no mass, a thousandth of that of air, as a material of a description has some."""

HEAVY = 300.0
"""[kg/m³] that the heaviest material of a structure exceeds, as light wood does: nothing is of foam alone. Held there, too."""


def described(path: Path, units: str | None = None) -> tuple[str, tuple[str, ...]]:
    """The deck in `path` as the TOML text of a description that lies beside it, and what of it is not carried over.

    `units` names its system, ``mm-t-N-s``; else it is the one of `KNOWN` in which its materials are some.

    Raises
    ------
    BadInput : it cannot be read, it has no elements, or its units are not known or cannot be told from its materials.
    """
    deck = read(path)
    return _text(path, deck, _system(deck, str(path), units)), tuple(deck.lost)


def read(path: Path) -> Deck:
    """The deck in `path`.

    Raises
    ------
    BadInput : it cannot be read, it has no elements, or something is at, joins or holds a node that is not there (which line).
    """
    mesh = files.read(path, lambda card: True)
    try:
        deck = read_keywords(path, mesh) if mesh.coordinates is None else read_cards(path, mesh, mesh.coordinates)
        deck.settle()
    except NotThere as error:
        more = (*files.LOOSE, "SPC", "SPC1", "BOUNDARY", "SURFACE", "TRANSFORM")
        line, card = naming(path, error.what, lambda card: files.carries(card) or card in more)
        problem = f"{card} names {'node' if isinstance(error.what, int) else 'the set'} {error.what}, which is not there"
        field = f"line {line.number}" if line.number else ""
        remedy = "Correct it, or take it out: solvers stop there, or pass it over"
        raise BadInput(str(line.file), field, problem, remedy) from None
    except BadInput:
        raise
    except (ValueError, IndexError, KeyError, ArithmeticError) as error:
        problem = f"a record of it cannot be read: {type(error).__name__}, {error}"
        raise BadInput(str(path), "", problem, "Check the deck; it may be cut short or damaged") from None
    return deck


def _system(deck: Deck, source: str, named: str | None) -> UnitSystem:
    if not deck.masses and not any(one.density for one in deck.materials.values()):
        what = "no material states a density" if deck.materials else "it has no material that is known here"
        itself = f'describe it: [fe_model] with kind = "mesh", file = "{Path(source).name}" and materials of its groups'
        raise BadInput(source, "", what, f"Masses are asked for: write a deck with densities, or {itself}")
    names = (*KNOWN, OF_METALS[0]) if named is None else (named,)
    known = [unit_system(name, source, *(["--units"] if named else [])) for name in names]
    fitting = [one for one in known if _believed(deck, one)]
    g = {one.name: STANDARD_GRAVITY * one.time**2 / one.length for one in known}
    weights = [one.name for one in known if not fitting and _believed(deck, one, 1 / g[one.name])]
    if len(weights) == 1:
        own, remedy = g[weights[0]], "Divide them by {0:.6g}, or write PARAM,WTMASS,{1:.6g} in bulk data"
        problem = f"its densities are weights, not masses, in {weights[0]}"
        raise BadInput(source, "", problem, remedy.format(own, deck.weight / own))
    if named is not None or len(fitting) == 1:
        return (fitting or known)[0]
    which = " and ".join(one.name for one in fitting) or f"none of {', '.join(one.name for one in known)}"
    weighed = f"; in {' and '.join(weights)} its densities would be weights" if weights else ""
    problem = f"its units cannot be told: {which} make known materials of what it states{weighed}"
    raise BadInput(source, "", problem, "Name them, as in --units mm-t-N-s")


def _believed(deck: Deck, system: UnitSystem, share: float = 1.0) -> bool:
    """Whether the materials of the deck are some when it is in `system`, and this `share` of its densities are masses."""
    heaviest, stiffest = 0.0, max((one.modulus for one in deck.materials.values() if not one.equivalent), default=0.0)
    for one in deck.materials.values():
        if one.equivalent or (one.shear and one.modulus < CORE * stiffest):
            continue
        E = one.modulus * system.mass / (system.length * system.time**2)
        rho = share * one.density * deck.weight * system.mass / system.length**3
        known = ELASTIC[0] <= E <= ELASTIC[1] and DENSE[0] <= (rho or DENSE[0]) <= DENSE[1]
        known = known and (not rho or SOUND[0] <= np.sqrt(E / rho) <= SOUND[1])
        metal = not rho or system.name != OF_METALS[0] or (OF_METALS[1] < rho < OF_METALS[2] and OF_METALS[3] < E)
        if not (known and metal) or any(rho > light and rho < dense and soft < E < stiff for light, dense, soft, stiff in NONE):
            return False
        heaviest = max(heaviest, rho)
    return heaviest >= HEAVY


# Where it is held.


def _supports(deck: Deck) -> dict[str, list[int | str]]:
    """What is held, by the directions, such as "13", in which it is; under "" what is held in all in which it could move."""
    carriers, found = set(deck.carriers), dict[str, set[int]]()
    turning = deck.turning | carriers
    for node in (deck.numbers(1, 2, 3) | carriers | deck.loose) & set(deck.held):
        able = ALL if node in turning | deck.loose else TRANSLATIONS
        if held := deck.held[node] & able:
            whole = held == able and node not in deck.loose
            found.setdefault("" if whole else "".join(sorted(held)), set()).add(node)
    return {directions: _named(deck, nodes) for directions, nodes in found.items()}


def _clamps(deck: Deck, held: Sequence[int | str]) -> dict[str, list[int | str]]:
    """Nodes of each foot that is `held` altogether, by the name of a link that holds it, so that it may give.

    A foot are nodes that elements join. None where one is a pin, which does not turn, or where they are more than a seam has.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    loose = numbers_of(deck.mesh, [one for one in held if one not in deck.links])
    nodes = np.flatnonzero(np.isin(deck.mesh.node_tags, loose))
    pairs, count = [np.zeros((0, 2), dtype=np.intp)], len(deck.mesh.node_tags)
    for cells in deck.mesh.cells.values() if len(nodes) else ():
        element, which = np.nonzero(np.isin(cells.nodes, nodes))
        pairs.append(np.column_stack([cells.nodes[element, which], count + element]))
        count += len(cells.nodes)
    every = np.vstack(pairs)
    foot = connected_components(coo_array((np.ones(len(every)), every.T), shape=(count, count)), directed=False)[1]
    feet = [deck.mesh.node_tags[nodes[foot[nodes] == k]].tolist() for k in np.unique(foot[nodes])]
    turning = deck.turning
    pins = [own for own in feet if len(own) == 1 and own[0] not in turning]
    if pins or not 0 < len(feet) <= SEAM:
        return {}
    return {f"clamp-{k}" if len(feet) > 1 else "clamp": _named(deck, set(own)) for k, own in enumerate(feet, start=1)}


def _named(deck: Deck, nodes: set[int]) -> list[int | str]:
    """`nodes` by the links that they carry and the groups that they are, else by their numbers."""
    names: list[int | str] = [name for node, name in deck.carriers.items() if node in nodes]
    left = nodes - set(deck.carriers)
    for name in sorted(deck.mesh.node_groups, key=lambda name: -len(deck.mesh.node_groups[name])):
        own = set(deck.mesh.node_tags[deck.mesh.node_groups[name]].tolist())
        if own and own <= nodes and own & left:
            names.append(name)
            left -= own
    return [*names, *sorted(left)]


# The text: SI with units, names and numbers of the deck.


def _listed(values: Iterable[str]) -> str:
    return f"[{', '.join(values)}]"


def _material(of: Elastic, added: float, density: float, pressure: float) -> str:
    """A material as TOML, with a density beside its own."""
    moduli = f'"{of.modulus * pressure:.9g} Pa"'
    if of.shear:
        shear = _listed(f'"{G * pressure:.9g} Pa"' for G in of.shear)
        moduli = f'[{moduli}, "{of.across * pressure:.9g} Pa"], shear_modulus = {shear}'
    said = f'density = "{(of.density + added) * density or LIGHT:.9g} kg/m^3", youngs_modulus = {moduli}'
    return f"{{ {said}, poisson_ratio = {of.poisson_ratio:.9g} }}"


def _one_spring_each(springs: Mapping[str, DeckSpring]) -> list[tuple[list[str], DeckSpring]]:
    """Springs that a deck draws direction by direction, since its cards have one each: those between the same ends, along the
    same axes and of the same loss, are one, with their names."""
    several, taken = dict[tuple[object, ...], list[str]](), Counter[tuple[object, ...]]()
    for name, one in springs.items():
        axes, alone = np.eye(3) if one.axes is None else one.axes, name if one.about is not None else ""
        like = (one.ends, one.loss_factor, alone, *np.ravel(axes).tolist())
        acts = [(*like, k) for k in np.flatnonzero(one.stiffness).tolist()]
        several.setdefault((*like, max((taken[each] for each in acts), default=0)), []).append(name)
        taken.update(acts)
    six = {names[0]: sum((springs[name].stiffness for name in names), np.zeros(6)) for names in several.values()}
    return [(names, replace(springs[names[0]], stiffness=six[names[0]])) for names in several.values()]


def _text(path: Path, deck: Deck, system: UnitSystem) -> str:
    holds = _supports(deck)
    held = holds.pop("", [])
    clamps = _clamps(deck, held)
    interface = [*clamps, *(one for one in held if not clamps or one in deck.links)]
    grounded = bool(holds) or any(len(one.ends) == 1 for one in deck.springs.values())
    pressure, density = system.mass / (system.length * system.time**2), deck.weight * system.mass / system.length**3
    mass, stiffness = deck.weight * system.mass, system.mass / system.time**2
    scale, unit = {"area": 2, "Iy": 4, "Iz": 4, "J": 4, "Iyz": 4}, {1: "m", 2: "m^2", 4: "m^4"}
    tables: list[tuple[str, dict[str, str]]] = []

    def metres(lengths: Iterable[float], digits: int = 9) -> str:
        return _listed(f'"{value * system.length:.{digits}g} m"' for value in lengths)

    for name, one in deck.properties.items():
        if name not in deck.mesh.groups:
            continue
        table: dict[str, str] = {}
        missing = [of for of in dict.fromkeys((one.material, *(of for of, *_ in one.layers))) if of not in deck.materials]
        missing += [one.material] if not missing and deck.materials[one.material].shear and not one.layers else []
        if missing:
            deck.lose(f"part {name}", f"no material {', '.join(missing)} that is known here; state it by hand")
        else:
            of, more = deck.materials[one.material], one.added / one.across if one.added and one.across else 0.0
            said = "  # with a mass beside its own" if more else ""
            if one.layers:
                rows = [
                    f"{{ material = {_material(deck.materials[ply], more, density, pressure)}, "
                    f'thickness = "{thickness * system.length:.9g} m", angle = {angle:.9g} }}'
                    for ply, thickness, angle in one.layers
                ]
                table["layers"] = "\n    ".join(["[" + said, *(f"{row}," for row in rows)]) + "\n]"
                table |= {"x_axis": _listed(f"{value:.9g}" for value in one.x_axis)} if one.x_axis else {}
                table |= {"offset": f'"{one.offset * system.length:.9g} m"'} if one.offset else {}
            else:
                table["material"] = _material(of, more, density, pressure) + said
            if lost := (one.loss_factor or of.loss_factor) + deck.loss_factor:
                table["loss_factor"] = f"{lost:.9g}"
        if one.thickness and not one.layers:
            table["thickness"] = f'"{one.thickness * system.length:.9g} m"'
        if one.section:
            keys = [
                f'{key} = "{value * system.length ** scale.get(key, 1):.9g} {unit[scale.get(key, 1)]}"'
                for key, value in one.section.items()
            ]
            several = {"z_axis": one.z_axis, "shear": one.shear}
            keys += [f"{key} = {_listed(f'{value:.9g}' for value in of)}" for key, of in several.items() if of]
            keys += [f"neutral_axis = {metres(one.neutral_axis)}"] if one.neutral_axis else []
            table["section"] = f"{{ {', '.join(keys)} }}"
        tables.append((f"parts.{toml_file.string(deck.mesh.called.get(name, name))}", table))
    carriers = {**{one.follower: name for name, one in deck.means.items()}, **deck.carriers}
    in_use, points = deck.numbers(1, 2, 3), deck.points

    def at(node: int) -> str:
        return toml_file.string(carriers[node]) if node in carriers else str(node)

    def term(of: Term) -> str:
        factor, node, way = of
        return f'[{factor * (system.length if way > 2 else 1.0):.12g}, {at(node)}, "{MOTIONS[way]}"]'

    def named(several: Iterable[int | str]) -> str:
        return _listed(str(one) if isinstance(one, int) else toml_file.string(one) for one in several)

    joined: list[tuple[str, int, str, Sequence[int | str]]] = []
    for name, (node, riders) in deck.links.items():
        every = [*([node] if node in in_use and node not in numbers_of(deck.mesh, riders) else []), *riders]
        joined.append((name, node, "nodes", every))
    for name, foot in clamps.items():
        middle = np.mean([points[node] for node in numbers_of(deck.mesh, foot)], axis=0)
        tables.append((f"links.{toml_file.string(name)}", {"at": metres(middle.tolist(), 12), "nodes": named(foot)}))
    joined += [(name, one.follower, "mean_of", list(one.shares)) for name, one in deck.means.items()]
    for name, node, key, nodes in joined:
        ways = {"directions": named(MOTIONS[int(one) - 1] for one in sorted(deck.riding[name]))} if name in deck.riding else {}
        if key == "mean_of":
            shares = list(deck.means[name].shares.values())
            ways |= {"weights": _listed(f"{one / max(shares):.9g}" for one in shares)} if len(set(shares)) > 1 else {}
            ways |= {"rotations": "true"} if deck.means[name].rotations else {}
        tables.append((f"links.{toml_file.string(name)}", {"at": metres(points[node].tolist(), 12), key: named(nodes), **ways}))
    for name, sums in deck.equations.items():
        table = {"sums": "\n    ".join(["[", *(f"{_listed(map(term, one))}," for one in sums)]) + "\n]"}
        tables.append((f"equations.{toml_file.string(name)}", table))
    for letters, held in holds.items():
        along = [MOTIONS[int(letter) - 1] for letter in letters]
        tables.append((f"holds.{toml_file.string('-'.join(along))}", {"nodes": named(held), "directions": named(along)}))
    for name, (node, body) in deck.masses.items():
        table = {"at": at(node), "mass": f'"{body.mass * mass:.9g} kg"'}
        if np.any(body.cog):
            table["cog"] = metres(body.cog.tolist())
        moments = np.where(np.abs(body.tensor_cog) > ROUNDING * np.abs(body.tensor).max(), body.tensor_cog, 0.0)
        if moments.any():
            turns = six_from_tensor(moments * mass * system.length**2).tolist()
            table["moments"] = _listed(f'"{one:.9g} kg m^2"' for one in turns)
        tables.append((f"masses.{toml_file.string(name)}", table))
    for names, spring in _one_spring_each(deck.springs):
        factors = [stiffness] * 3 + [stiffness * system.length**2] * 3
        words, ends = ("N/m",) * 3 + ("N m/rad",) * 3, spring.ends
        six = _listed(f'"{k * f:.9g} {word}"' for k, f, word in zip(spring.stiffness.tolist(), factors, words, strict=True))
        table = {"at": at(ends[0])} if len(ends) == 1 else {"between": f"[{at(ends[0])}, {at(ends[1])}]"}
        if spring.axes is not None:
            table |= {f"{k}_axis": _listed(f"{one:.12g}" for one in row) for k, row in zip("xy", spring.axes, strict=False)}
        table |= {} if spring.about is None else {"about": metres(spring.about.tolist(), 12)}
        table |= {"loss_factor": f"{lost:.9g}"} if (lost := spring.loss_factor + deck.loss_factor) else {}
        name, said = names[0], f"  # {', '.join(names)} as one; write those apart that are not" if names[1:] else ""
        tables.append((f"springs.{toml_file.string(name)}", table | {"stiffness": six + said}))
    support = "ground" if interface or grounded else "free"
    stated = [card for card in deck.carried if not any(one.lstrip("*").startswith((f"{card} ", f"{card}:")) for one in deck.lost)]
    lines = [
        f"# The structure of {path.name}, read by `massline model`. Units of its coordinates: {system.name}; all else is in SI.",
        *(f"# NOT CARRIED OVER: {one}" for one in deck.lost),
        "format = 1",
        "",
        "[fe_model]",
        f"name = {toml_file.string(path.stem)}",
        'kind = "mesh"',
        f"units = {toml_file.string(system.name)}",
        f"file = {toml_file.string(path.name)}",
        f"support = {toml_file.string(support)}" + "  # `base` for a test on a shaker that carries it",
        *([f"interface = {named(interface)}"] if interface else []),
        *([f"left_out = {named(stated)}  # stated below"] if stated else []),
    ]
    for where, table in tables:
        lines += ["", f"[fe_model.{where}]", *(f"{key} = {value}" for key, value in table.items())]
    return "\n".join(lines) + "\n"
