"""What a laboratory reads of a tested structure, right or with a fault, and the files that it hands over."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyuff
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import eigsh, splu

from benchmarks.foreign_tests.truth import Array, Fine, Places

Fault = tuple[str, str, float]
"""Kind, target - of a channel with what it is mistaken for or goes along or about - and size in SI."""
GAIN, ANGLE, NOISE, LEVEL, DAMPING = 0.005, 0.5, 0.005, 0.0005, 0.3
"""Scatter of pick-ups [1], [deg]; noise of a line as a share of it and of the level of its run; of the logarithm of a loss."""
STANDARD_GRAVITY = 9.80665
"""[m/s²] What a pick-up that is stated in m/s² is divided by where it reads in g."""
BESIDE = "beside"
"""Place of the tested structure at which a pick-up sits that is not at its own."""
MODULUS, DENSITY, SUPPORT = 0.015, 0.003, 0.05
"""Scatter of what parts are made of, and of springs."""


@dataclass(frozen=True)
class Bench:
    """A structure: its truth, what its owner writes, where it is read and struck (place and axis), and how far."""

    fine: Callable[[], Fine]
    described: Callable[[Path, Places], str]
    places: Places
    responses: tuple[str, ...]
    drives: tuple[str, ...]
    modes: int
    faults: Mapping[str, Fault]
    loss: float = 0.02


@dataclass(frozen=True)
class Tested:
    """Modes (m,) and (m, p) by place and axis, more than enough of them, static answers among them; losses (m,)."""

    frequency: Array
    shapes: dict[str, Array]
    losses: Array


def tested(bench: Bench, fault: Fault | None, seed: int) -> Tested:
    """The structure with materials a little off and with the `fault` in it."""
    draw, fine = np.random.default_rng([seed, 1]), bench.fine()
    kind, target, size = fault or ("", "", 0.0)
    K, M = csc_array(next(iter(fine.stiffness.values())).shape), csc_array(next(iter(fine.mass.values())).shape)
    for part in fine.stiffness:
        softer = 1 + size if (kind, target) == ("modulus", part) else 1.0
        K = K + float(np.exp(MODULUS * draw.standard_normal())) * softer * fine.stiffness[part]
        M = M + float(np.exp(DENSITY * draw.standard_normal())) * fine.mass[part]
    n, d = K.shape[0], fine.per_node
    more, tie = np.zeros(n), 1e3 * abs(K).max()
    at = {name: fine.patch(p) for name, p in bench.places.items()}
    if kind == "beside":
        place, along = target.split(":")[0], "xyz".index(target[-1])
        at[BESIDE] = fine.patch(tuple(np.array(bench.places[place]) + size * np.eye(3)[along]))
    for name, (node, k) in fine.springs.items():
        factor = np.exp(SUPPORT * draw.standard_normal()) * (size if (kind, target) == ("support", name) else 1.0)
        more[d * node : d * node + len(k)] += factor * k
    heavy = dict(fine.masses)
    if kind == "point-mass":
        node = fine.nearest(bench.places[target])
        heavy[node] = heavy.get(node, 0.0) + size
    weights = np.zeros(n)
    for node, kg in heavy.items():
        weights[d * node : d * node + 3] += kg
    for name, (a, b) in fine.ties.items():
        k = np.full(6, tie)
        if kind == "joint" and name.startswith(target.rpartition(":")[0] + ":"):
            k[3 + "xyz".index(target[-1])] = 1 / size
        i, j = 6 * a + np.arange(6), 6 * b + np.arange(6)
        K = K + coo_array(
            (np.concatenate([k, k, -k, -k]), (np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i]))), shape=K.shape
        )
    diagonal = coo_array((more, (np.arange(n), np.arange(n))), shape=K.shape)
    K, M = (K + diagonal).tocsc(), (M + coo_array((weights, (np.arange(n), np.arange(n))), shape=M.shape)).tocsc()
    free = np.setdiff1d(np.flatnonzero(abs(K).sum(axis=0) > 0), fine.held)
    K, M = K[free][:, free], M[free][:, free]
    count = 4 * bench.modes + 10
    shift = -float(K.diagonal().sum() / M.diagonal().sum()) * 1e-7
    _values, vectors = eigsh(K, count, M, sigma=shift, v0=np.ones(len(free)))
    loads = np.zeros((len(free), 3 * len(at)))
    for column, feet in enumerate(at.values()):
        for axis in range(3):
            loads[np.isin(free, d * feet + axis), 3 * column + axis] = 1 / len(feet)
    left = splu((K - shift * M).tocsc()).solve(loads)
    left -= vectors @ (vectors.T @ (M @ left))
    left -= vectors @ (vectors.T @ (M @ left))
    square, turned = np.linalg.eigh(left.T @ (M @ left))
    left = left @ turned[:, square > 1e-12 * square.max()] / np.sqrt(square[square > 1e-12 * square.max()])
    basis = np.hstack([vectors, left])
    square, turned = np.linalg.eigh(basis.T @ (K @ basis))
    basis = basis @ turned
    shapes = {f"{name}:{'xyz'[axis]}": loads[:, 3 * k + axis] @ basis for k, name in enumerate(at) for axis in range(3)}
    losses = bench.loss * np.exp(DAMPING * np.random.default_rng([seed, 2]).standard_normal(len(square)))
    return Tested(frequency=np.sqrt(np.maximum(square, 0)) / (2 * np.pi), shapes=shapes, losses=losses)


def noticed(bench: Bench, made: Tested, fault: Fault | None, seed: int) -> dict[str, Array]:
    """By response what its pick-up feels of every mode: glued a little crooked, calibrated as its certificate says; or turned
    altogether, glued along another axis, beside its place or at another one."""
    draw, found = np.random.default_rng([seed, 3]), {}
    kind, target, size = fault or ("", "", 0.0)
    channel, _, other = target.partition(" ")
    for point in bench.responses:
        place, axis = point.split(":")
        turned = np.radians(ANGLE) * draw.standard_normal(3)
        turned["xyz".index(axis)] = 1.0
        gain = np.exp(GAIN * draw.standard_normal())
        if point == channel and kind == "turned":
            about = np.eye(3)["xyz".index(other)]  # O. Rodrigues
            turned = (
                np.cos(size) * turned + np.sin(size) * np.cross(about, turned) + (1 - np.cos(size)) * about * (about @ turned)
            )
        if point == channel and kind == "direction":
            a, b = "xyz".index(axis), "xyz".index(other)
            turned[[a, b]] = turned[[b, a]]
        place = {"beside": BESIDE, "moved": other}.get(kind, place) if point == channel else place
        found[point] = gain * sum(t * made.shapes[f"{place}:{a}"] for t, a in zip(turned, "xyz", strict=True))
    return found


def elastic(made: Tested) -> Array:
    return np.flatnonzero(made.frequency > 1e-2 * np.sort(made.frequency)[6] if made.frequency[0] < 0.5 else made.frequency > 0)


def mixed(read: Array, bench: Bench, fault: Fault | None, f: Array) -> Array:
    """What is wrong with the channels, (n, c), at frequencies `f` (n,)."""
    kind, target, size = fault or ("", "", 0.0)
    read, at = np.array(read), list(bench.responses)
    if kind == "gain":
        read[..., at.index(target)] *= 1 + size
    if kind == "unit":
        read[..., at.index(target)] /= STANDARD_GRAVITY
    if kind == "delay":
        read[..., at.index(target)] *= np.exp(-2j * np.pi * f * size)
    if kind == "polarity":
        read[..., at.index(target)] *= -1
    if kind == "swap":
        a, b = (at.index(one) for one in target.split(" "))
        read[..., [a, b]] = read[..., [b, a]]
    return read


def functions(folder: Path, bench: Bench, fault: Fault | None, seed: int, csv: bool) -> str:
    """Accelerances of all drives, as UFF 58 or CSV, and the table of the test."""
    made = tested(bench, fault, seed)
    own = elastic(made)
    low, high = 0.5 * made.frequency[own[0]], (made.frequency[own[bench.modes - 1]] + made.frequency[own[bench.modes]]) / 2
    f = np.linspace(low, high, 600)
    f = np.round(f[1] - f[0], 4) * np.arange(int(low / (f[1] - f[0])), int(high / (f[1] - f[0])))
    felt, draw = noticed(bench, made, fault, seed), np.random.default_rng([seed, 4])
    receptance = 1 / ((2 * np.pi * made.frequency) ** 2 * (1 + 1j * made.losses) - (2 * np.pi * f[:, None]) ** 2)
    sign = -((2 * np.pi * f[:, None]) ** 2)
    sets, text = [], ["[[test]]", 'kind = "response-functions"', 'article = "own"']
    files, places = [], {name: k + 1 for k, name in enumerate(bench.places)}
    cell = np.exp(GAIN * draw.standard_normal())
    for drive in bench.drives:
        read = sign * np.array([receptance @ (made.shapes[drive] * felt[one]) for one in bench.responses]).T * cell
        sd = np.hypot(NOISE * np.abs(read), LEVEL * np.median(np.abs(read))) / np.sqrt(2)
        read = mixed(read, bench, fault, f) + sd * (draw.standard_normal(read.shape) + 1j * draw.standard_normal(read.shape))
        if csv:
            names = [f"{one} {part}" for one in bench.responses for part in ("real", "imag")]
            columns = np.column_stack([f, np.stack([read.real, read.imag], axis=2).reshape(len(f), -1)])
            file = f"{drive.replace(':', '-')}.csv"
            np.savetxt(folder / file, columns, delimiter=",", header=",".join(["frequency", *names]), comments="", fmt="%.9g")
            files.append(f'{{ path = "{file}", drive = "{drive}" }}')
        for k, one in enumerate(bench.responses):
            (place, axis), (at, along) = one.split(":"), drive.split(":")
            sets.append(
                pyuff.prepare_58(
                    binary=0,
                    id1="own",
                    func_type=4,
                    rsp_ent_name="NONE",
                    rsp_node=places[place],
                    rsp_dir="xyz".index(axis) + 1,
                    ref_ent_name="NONE",
                    ref_node=places[at],
                    ref_dir="xyz".index(along) + 1,
                    abscissa_spec_data_type=18,
                    ordinate_spec_data_type=12,
                    orddenom_spec_data_type=13,
                    data=read[:, k],
                    x=f,
                    abscissa_spacing=1,
                    abscissa_min=f[0],
                    abscissa_inc=f[1] - f[0],
                    num_pts=len(f),
                    ord_data_type=5,
                )
            )
    if csv:
        text += [f"files = [{', '.join(files)}]", f"responses = {json.dumps(list(bench.responses))}"]
    else:
        pyuff.UFF(str(folder / "test.uff")).write_sets([units(), *sets], "overwrite")
        text += ['file = "test.uff"', f"places = {{ {', '.join(f'{name} = {k}' for name, k in places.items())} }}"]
    return "\n".join(text) + "\n"


def units() -> Any:
    return pyuff.prepare_164(units_code=1, units_description="SI", temp_mode=1, length=1.0, force=1.0, temp=1.0, temp_offset=0.0)


def table(folder: Path, bench: Bench, fault: Fault | None, seed: int) -> str:
    """A table of modes as UFF 55: frequencies to 0.1 %, damping to a tenth, shapes to 2 %."""
    made = tested(bench, fault, seed)
    own, felt, draw = elastic(made)[: bench.modes], noticed(bench, made, fault, seed), np.random.default_rng([seed, 5])
    shapes = mixed(np.array([felt[one] for one in bench.responses]).T, bench, fault, made.frequency)[own]
    shapes = shapes / np.abs(shapes).max(axis=1, keepdims=True)
    shapes = shapes + 0.02 * draw.standard_normal(shapes.shape)
    sets, nodes = [units()], list(bench.places)
    for k, r in enumerate(own):
        along = np.zeros((len(nodes), 3))
        for c, one in enumerate(bench.responses):
            place, axis = one.split(":")
            along[nodes.index(place), "xyz".index(axis)] = shapes[k, c]
        sets.append(
            pyuff.prepare_55(
                model_type=1,
                id1="own",
                analysis_type=2,
                data_ch=2,
                spec_data_type=8,
                data_type=2,
                n_data_per_node=3,
                r1=along[:, 0],
                r2=along[:, 1],
                r3=along[:, 2],
                load_case=0,
                mode_n=k + 1,
                freq=float(made.frequency[r] * (1 + 0.001 * draw.standard_normal())),
                modal_m=1.0,
                modal_damp_vis=float(made.losses[r] / 2 * (1 + 0.1 * draw.standard_normal())),
                modal_damp_his=0.0,
                node_nums=np.arange(1, len(nodes) + 1),
            )
        )
    pyuff.UFF(str(folder / "test.uff")).write_sets(sets, "overwrite")
    named = ", ".join(f"{name} = {k + 1}" for k, name in enumerate(nodes))
    text = ["[[test]]", 'kind = "modal-table"', 'article = "own"', 'file = "test.uff"', f"places = {{ {named} }}"]
    text += [f"sensors = {json.dumps(list(bench.responses))}", "frequency_deviation = 0.001", "damping_deviation = 0.1"]
    return "\n".join([*text, "shapes_deviation = 0.02"]) + "\n"
