"""A virtual test of any structure: struck, shaken, on a base that moves, or its modes in a table, with effects that its model
does not know.

The structure is that of the model file with its effects added to the matrices themselves; nothing is reduced. With its modes
Phi, all of them or the lowest with answers to the forces beside them, and what these leave static at a shift,

    A(omega) = -omega² (Phi psi (lambda - omega²)⁻¹ psi⁻¹ Phi^T + R) ,      (Lambda + i S) psi = lambda psi ,

whatever its losses S (A. D. Nashif et al., Vibration Damping, 1985, chapter 2). Records are made of these by Fourier transforms
long enough for all to ring down, and then cut to what a recorder would have kept. No code is shared with what predicts tests.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fem.structure import Sparse, Structure, place_rows, position_of, rows_beside
from fem.user_model import reading
from geometry import toml_file
from geometry.articles import built_in
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, Pose, rotation_by
from geometry.sensors import AXES, Channel, ChannelTable, Place, Point, point
from geometry.toml_file import nearest
from identification import campaign_file, test_file
from identification.campaign import Campaign, Processing
from identification.files import files
from identification.files.files import Signals
from validation.effects.catalogue import Named, parse_all
from validation.effects.effect import Vocabulary, position
from validation.effects.stages import ALONG
from validation.model import model_file
from validation.virtual_test.layout import ACCELEROMETERS, FORCES, mavis
from validation.virtual_test.plan import (
    BASE,
    BASE_FORCES,
    CROSS,
    FUNCTIONS,
    HAMMER,
    KINDS,
    MODES,
    OF_DRIVES,
    SENSORS,
    SHAKER,
    STRUCTURAL,
    Plan,
    Scatter,
    StructurePlan,
)
from validation.virtual_test.plan import NOISE as ORDINARY
from validation.virtual_test.planted import planted
from validation.virtual_test.shaker import FMD, Sensors, middles_of_cells, nominal_fmd, on_table
from validation.virtual_test.simulate import DrivenRun, cross_motion, recorded

GAIN = 0.01
"""Standard deviation of the gains of sensors and of the force cell in these laboratories, as their tests state it."""

NOISE = {HAMMER: 2e-4, SHAKER: 2e-4, FUNCTIONS: 0.005, MODES: 0.001}
"""Ordinary noise: of records a share of each channel's largest value, of functions a share of each value and of the median of its
function, of tables a share of a frequency; of damping and shapes a hundred and ten times that. That of a shaker is `ORDINARY`."""

DEAF = 0.01
"""Share of what the loudest pick-up reads below which the noise of others is as its own there: they are of one kind and range."""

MOST_MODES = 80
"""[count] of modes of a structure too large for all of them."""

WHOLE = 1200
"""[count] of degrees of freedom up to which all modes are computed."""

MASSLESS = 1e-12
"""Share of the mass of the slowest mode below which one has none."""

SPARED = 1e-9
"""[share] of the largest mass that one below nothing may have by rounding alone. By definition."""

ANSWERS = 3
"""[count] of answers to each load beside such modes, each but the first to the inertia of the one before."""

PULLED = 1.5
"""Up to so far above the band the losses of modes are answered, too."""

PASSED = 1.2
"""[end of the band] up to which a shaker drives, and beyond which a recorder's filter falls to nothing at half its rate: a blow
that comes late by a part of a sample would ring to the end of its block."""

BLOWS, BLOCKS = 4, 30
RINGS_DOWN = 7.0
"""[1] Natural logarithm of what is left of the slowest mode at the end of a block."""

LONGEST = 60.0
"""[s] of a block where nothing is said."""

LOWEST, RIGID, AT_REST = 5, 1e-9, 1e-3
"""[count] of modes that a test is for where nothing is said; [share of omega² of the twelfth] below which one is rigid; [share of
the largest motion] below which a point does not move. By definition."""

HEAVIEST = 10.0
"""Times what a structure weighs, beyond which a mass upon it is doubted to be in kilograms. By definition."""

HEAVIEST_PICKUP = 1.0
"""[kg] of a pick-up, beyond which its mass is doubted likewise: those for earthquakes have two thirds of it."""

SWEPT = 400.0
"""[count] of cycles of its lowest frequency that a sweep of a base lasts."""

RINGS_OUT = 11.5
"""[1] Natural logarithm of what is left of the slowest mode at its end."""

LINES = 800
"""[count] of lines between which its spectra are asked for."""

TIED = 1e-10
"""Share of the largest stiffness beyond which a motion of the base strains something: it is tied to the ground."""

UNSEEN = 1e-6
"""Share of its largest motion below which a mode moves the sensors by rounding alone, and nobody tabulates it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TestedStructure:
    """A structure as it really is, on its modes.

    Attributes
    ----------
    highest : [Hz] to which it is tested
    structure : with all that is planted, on all degrees of freedom
    losses : loss factor by part
    ratio : damping ratio of every mode, beside these; 0 for none
    """

    highest: float
    structure: Structure
    losses: Mapping[str, float]
    ratio: float

    @cached_property
    def modes(self) -> tuple[Array, Array, float, Any]:
        """omega² (m,), shapes on all degrees of freedom (n, m), a shift s below all, and what solves K - s M for what is left.

        Raises
        ------
        BadInput : what was taken away weighs more than what is there.
        """
        from scipy.linalg import eigh
        from scipy.sparse.linalg import eigsh, splu

        free = self.structure.free
        K, M = (one.tocsc()[free][:, free] for one in (self.structure.stiffness, self.structure.mass))
        shift = -((2 * np.pi * 2 * self.highest) ** 2)
        above = (K - shift * M).tocsc()
        solver = splu(above)
        if len(free) <= WHOLE:  # what has no mass is a mode of infinite frequency, and static
            try:
                shares, vectors = eigh(M.toarray(), above.toarray())
            except np.linalg.LinAlgError:
                raise _too_light() from None
            if shares.min() < -SPARED * shares.max():
                raise _too_light()
            kept = shares > MASSLESS * shares.max()
            squares, vectors = 1 / shares[kept] + shift, vectors[:, kept] / np.sqrt(shares[kept])
        else:
            first = solver.solve(M @ np.random.default_rng(0).standard_normal(len(free)))  # else every run begins elsewhere
            squares, vectors = eigsh(K, k=min(MOST_MODES, len(free) - 2), M=M, sigma=shift, v0=first)
        order = np.argsort(squares)
        whole = np.zeros((self.structure.mass.shape[0], len(squares)))
        whole[free] = vectors[:, order]
        return squares[order], whole, shift, solver

    def answering(self, loads: Array) -> tuple[Array, Array, float, Any]:
        """As `modes`, of a structure too large for all of them with what answers to `loads` (n, q) beside them.

        Very many modes move a point where a force acts, and lose as the others do: neither one static answer of them all nor one
        without losses is right to the noise of a test. So answers at the shift, to their own inertia and to what losses pull are
        coordinates (A. Ruhe and D. Skoogh, Lecture Notes in Computer Science 1541, 1998).
        """
        squares, shapes, shift, solver = self.modes
        free = self.structure.free
        K, M = (one.tocsc()[free][:, free] for one in (self.structure.stiffness, self.structure.mass))
        own, found = shapes[free], [solver.solve(loads[free])]
        for _ in range(ANSWERS - 1):
            found.append(solver.solve(M @ found[-1]))
        lost = sum((eta * self.structure.part_stiffness[part] for part, eta in self.losses.items()), 0 * self.structure.stiffness)
        swinging = own[:, squares <= (2 * np.pi * PULLED * self.highest) ** 2]
        found.append(solver.solve(lost.tocsc()[free][:, free] @ np.hstack([swinging, found[0]])))
        X = np.hstack([one / np.maximum(np.linalg.norm(one, axis=0), np.finfo(np.float64).tiny) for one in found])
        X = X - own @ (own.T @ (M @ X))
        square, directions = np.linalg.eigh(X.T @ (K @ X) - shift * X.T @ (M @ X))
        kept = square > MASSLESS * square[-1]
        V = np.hstack([own / np.sqrt(squares - shift), X @ (directions[:, kept] / np.sqrt(square[kept]))])
        shares, turned = np.linalg.eigh(V.T @ (M @ V))
        moving = shares > MASSLESS * shares[-1]
        whole = np.zeros((len(shapes), int(moving.sum())))
        whole[free] = V @ (turned[:, moving] / np.sqrt(shares[moving]))
        return 1 / shares[moving] + shift, whole, shift, solver

    @cached_property
    def lossy(self) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """lambda (m,), and on the modes their psi (m, m), a column each, and what these are dual to, a row each."""
        return self.lossy_on(*self.modes[:2])

    def lossy_on(self, squares: Array, shapes: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """The same on modes of these squares (m,) and shapes (n, m): psi⁻¹ is not psi^T where modes have one frequency, as the
        rigid motions of what floats and the pairs of what is round."""
        shares = (eta * shapes.T @ (self.structure.part_stiffness[part] @ shapes) for part, eta in self.losses.items())
        S = sum(shares, np.zeros((len(squares), len(squares))))
        values, vectors = np.linalg.eig(np.diag(squares) + 1j * S)
        return values, vectors, np.linalg.inv(vectors)

    def accelerance(self, frequency: Array, rows: Sequence[Sparse], forces: Sequence[Sparse]) -> ComplexArray:
        """(n, c, r) [m/s² per N] along `rows` for forces along `forces`, (n,) each."""
        whole = len(self.structure.free) <= WHOLE
        squares, shapes, shift, solver = self.modes if whole else self.answering(np.array([*rows, *forces]).T)
        values, turned, dual = self.lossy if whole else self.lossy_on(squares, shapes)
        left, right = (np.array([row @ shapes for row in of]) @ by for of, by in ((rows, turned), (forces, dual.T)))
        omega = 2 * np.pi * np.maximum(frequency, 1e-6)[:, None]
        omega2 = omega[:, 0] ** 2
        viscous = 2j * self.ratio * np.sqrt(np.maximum(values.real, 0.0)) * omega
        A = np.einsum("cm,nm,rm->ncr", left, 1 / (values - omega**2 + viscous), right)
        free = self.structure.free
        static = np.array([row[free] for row in rows]) @ solver.solve(np.array([one[free] for one in forces]).T)
        far = (np.array([row @ shapes for row in rows]) / (squares - shift)) @ np.array([one @ shapes for one in forces]).T
        A = A + (static - far)
        return np.asarray(-omega2[:, None, None] * A)

    def on_base(self, frequency: Array, rows: Sequence[Sparse]) -> tuple[ComplexArray, ComplexArray]:
        """(n, c, 6) accelerations along `rows`, and (n, 6, 6) what the base carries, for a unit of each of its accelerations.

        What rides along as the base does, R, is loaded by D R, D = M - K / omega²; K R is of ties to the ground. With the
        accelerances A to these loads the rest is -A D R, and the base has to bring R^T D R - (D R)^T A D R.
        """
        of, square = self.structure, (2 * np.pi * np.maximum(frequency, 1e-6)) ** 2
        R, inertia, tied = of.rigid, of.mass @ of.rigid, of.stiffness @ of.rigid
        loads, share = inertia, np.broadcast_to(np.eye(6), (len(square), 6, 6))
        if np.abs(tied).max() > TIED * np.abs(of.stiffness.data).max() * np.abs(R).max():
            loads, share = np.hstack([inertia, tied]), np.concatenate([share, -np.eye(6) / square[:, None, None]], axis=1)
        read = np.array(rows).reshape(-1, len(R))
        bent = -self.accelerance(frequency, [*read, *loads.T], list(loads.T)) @ share
        carried = R.T @ loads @ share + share.swapaxes(1, 2) @ bent[:, len(read) :]
        return read @ R + bent[:, : len(read)], carried

    def table(self, rows: Sequence[Sparse], low: float, high: float) -> tuple[Array, Array, Array]:
        """Frequencies (m,) [Hz] from `low` to `high`, ascending, damping ratios (m,), and shapes (m, c) along `rows`,
        of the modes that move one of them."""
        values, turned, _ = self.lossy
        hertz, eta = np.sqrt(np.maximum(values.real, 0)) / (2 * np.pi), values.imag / np.maximum(values.real, 1e-30)
        inside = [int(k) for k in np.argsort(hertz) if low <= hertz[k] <= high]
        complex_shapes = (np.array(rows) @ self.modes[1]) @ turned[:, inside]
        shapes = (complex_shapes * np.exp(-0.5j * np.angle(np.sum(complex_shapes**2, axis=0)))).real.T  # in phase
        seen = np.abs(shapes).max(axis=1) > UNSEEN * np.abs(self.modes[1] @ turned[:, inside]).max(axis=0)
        inside, shapes = [k for k, is_seen in zip(inside, seen, strict=True) if is_seen], shapes[seen]
        # A shape has no sign; that of its largest entry is +, so that noise upon it is the same in every run
        largest = np.take_along_axis(shapes, np.abs(shapes).argmax(axis=1, keepdims=True), axis=1)
        return hertz[inside], self.ratio + eta[inside] / 2, np.where(largest < 0, -shapes, shapes)


def _too_light() -> BadInput:
    problem = "with all that is planted, and what the model has added, a place or a part weighs less than nothing"
    return BadInput("--effect", "", problem, "Take away no more than there is; `massline model` lists both")


def tested(plan: StructurePlan) -> TestedStructure:
    """The structure of `plan` as it really is.

    Raises
    ------
    BadInput : it has no matrices; an effect on what it has not.
    """
    path = plan.model.own.get(plan.article, "")
    users = reading.load(path) if path else None
    if users is None or not isinstance(users.model, Structure):
        problem = f"{plan.article} has no matrices, mesh or frame"
        raise BadInput(plan.model.source, "article", problem, "Name its file in [structure.own]")
    damping, made = users.damping, users.model
    where = {one.place: position(one.place) for one in (*plan.drives, *plan.responses)}
    written = {name: place_rows(made, at, plan.model.source, name)[0] for name, at in where.items() if at is not None}
    made = replace(made, places={**made.places, **written})
    ratio = plan.model.damping_ratio
    losses: dict[str, float] = dict(damping.loss_factors) if damping is not None and ratio is None else {}
    usual = 0.003 if not losses else 0.0
    spread, rng = plan.tolerances, plan.drawn("structure")
    K, M, shares = made.stiffness, made.mass, dict(made.part_stiffness)
    tied = (*made.supports, *made.joints)
    for part in shares if len(shares) > 1 or not made.part_mass else ():
        own = made.part_tolerances.get(part, {}).get("modulus", plan.model.structure.modulus)
        if part not in tied:
            shares[part] = float(np.exp(spread * own * rng.standard_normal())) * shares[part]
            K = K + shares[part] - made.part_stiffness[part]
    losses = {part: eta * float(np.exp(0.1 * spread * rng.standard_normal())) for part, eta in losses.items()}

    def share(of: Mapping[str, Sparse], named: Named) -> Sparse:
        if of is made.places and (at := position(named.target)) is not None:
            try:
                return place_rows(made, at)[0]
            except BadInput as error:
                raise BadInput("--effect", named.id, error.problem, error.remedy) from None
        if named.target not in of:
            problem, remedy = "the structure has nothing of that name", f"{nearest(named.target, of)}There are {', '.join(of)}"
            raise BadInput("--effect", named.id, problem, remedy)
        return of[named.target]

    for one in (*(added.named for added in plan.model.effects), *plan.effects):
        value = one.value
        if one.family == "modulus":
            K = K + value * share(shares, one)
        elif one.family == "support-stiffness":
            K = K + (value - 1) * share(shares, one)
        elif one.family == "mass":
            M = M + value * share(made.part_mass, one)
        elif one.family == "thickness":
            linear, cubed = share(made.sections, one)
            K, M = K + value * linear + ((1 + value) ** 3 - 1) * cubed, M + value * share(made.part_mass, one)
        elif one.family == "structural-damping":
            share(shares, one)
            losses[one.target] = losses.get(one.target, 0.0) + value
        elif one.family == "gravity-stiffness":
            K = K + value * sum(made.geometric.values())
        elif one.family in ("point-mass", "cable"):
            rows = share(made.places, one)[list(ALONG["".join(one.targets[1:])])]
            K, M = (K, M + value * (rows.T @ rows)) if one.family == "point-mass" else (K + value * (rows.T @ rows), M)
        elif one.family not in plan.planted:
            raise BadInput("--effect", one.id, f"no --test {plan.kind} can hide it", f"These can: {', '.join(plan.planted)}")
    structure = replace(made, stiffness=K, mass=M, part_stiffness=shares)
    return TestedStructure(highest=plan.band[1], structure=structure, losses=losses, ratio=usual if ratio is None else ratio)


@dataclass(frozen=True, eq=False, kw_only=True)
class StructureTest:
    """What a laboratory would hand over, and what was hidden in it.

    Attributes
    ----------
    table : the description, as a TOML has it
    signals : by file beside it
    truth : what was planted and drawn
    campaign : of a base that moves, instead of both
    """

    table: Mapping[str, Any] = field(default_factory=dict)
    signals: Mapping[str, Signals] = field(default_factory=dict)
    truth: Mapping[str, Any] = field(default_factory=dict)
    campaign: Campaign | None = None

    def fill(self, folder: Path) -> None:
        """Write the test into `folder`."""
        if self.campaign is not None:
            campaign_file.write(folder, self.campaign)
            return
        folder.mkdir(parents=True, exist_ok=True)
        for name, signals in self.signals.items():
            files.write(folder / name, signals)
        lines = [f"{key} = {toml_file.inline(value)}" for key, value in self.table.items()]
        (folder / "test.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _row(structure: Structure, at: Point, faults: Sequence[Named], points: Mapping[str, Point]) -> Array:
    """(n,) what moves a point along its direction, with the faults that name it."""
    d, place, shift = np.array(at.direction), at.place, np.zeros(3)
    for one in faults:
        if one.target != at.name:
            continue
        word = one.targets[-1]
        if one.family.endswith("-misalignment"):
            d = rotation_by(one.value * np.array(AXES[word])) @ d
        elif one.family.endswith("-position"):
            shift = shift + one.value * np.array(AXES[word])
        elif one.family == "wrong-direction":
            d = np.array(AXES[word])
        elif one.family == "wrong-place":
            place = word
        elif one.family == "wrong-reference":
            d, place = np.array(points[word].direction), points[word].place
    if place not in structure.places:
        raise BadInput("simulate", place, "the structure has no such place", f"Its places are {', '.join(structure.places)}")
    rows = structure.places[place]
    if np.any(shift):
        rows = rows_beside(structure, _where(structure, place) + shift)
    return np.asarray(d @ rows.toarray())


def simulate(plan: StructurePlan) -> StructureTest:
    """The test of `plan`.

    Raises
    ------
    BadInput : as `tested`; a point that the structure has not.
    """
    lab = tested(plan)
    squares, highest = lab.lossy[0], (2 * np.pi * PULLED * plan.band[1]) ** 2  # beyond, joints that give nothing lose nothing
    elastic = squares[(squares.real > 0.01 * plan.band[0] ** 2) & (squares.real < highest)]
    slowest = float(np.min(elastic.imag / (2 * np.sqrt(elastic.real)) + lab.ratio * np.sqrt(elastic.real), initial=1e3))
    truth = {
        "effects": {one.id: dict(one.values) for one in plan.effects},
        "seed": plan.seed,
        "test": plan.kind,
        "article": plan.article,
        "frequency_hz": [float(np.sqrt(x.real) / (2 * np.pi)) for x in sorted(lab.lossy[0], key=abs)[:40] if x.real > 0],
    }
    if plan.on_base:
        campaign, drawn = _swept(plan, lab, slowest)
        return StructureTest(campaign=campaign, truth={**truth, "tolerances": drawn})
    points = {one.name: one for one in plan.responses}
    of_drives = [one for one in plan.effects if one.family in OF_DRIVES]
    rows = [_row(lab.structure, one, [e for e in plan.effects if e not in of_drives], points) for one in plan.responses]
    forces = [_row(lab.structure, one, of_drives, points) for one in plan.drives]
    if plan.kind == MODES:
        return StructureTest(table=_table(plan, lab, rows), truth=truth)
    about = {"format": 1, "kind": test_file.RESPONSE_FUNCTIONS, "title": plan.kind, "article": plan.article}
    about |= {"band": [float(one) for one in plan.band], "gain": GAIN, "force_gain": GAIN}
    places = dict.fromkeys(one.place for one in (*plan.drives, *plan.responses))
    where = {name: at for name in places if (at := position_of(lab.structure, name)) is not None}
    about |= {"coordinates": {name: [float(x) for x in at] for name, at in where.items()}} if where else {}
    block = plan.block or min(LONGEST, max(RINGS_DOWN / slowest, 4 / plan.band[0]))
    gains = 1 + GAIN * plan.tolerances * plan.drawn("gains").standard_normal(len(rows) + 1)
    names, signals = (*points, "force"), dict[str, Signals]()
    if plan.kind == FUNCTIONS:
        f = np.arange(max(1, round(plan.band[0] * block)), round(plan.band[1] * block) + 1) / block
        read = _heard(plan, names, gains, f, lab, rows, forces)
        A = read[:, :-1] / read[:, -1:]
        rng, share = plan.drawn("noise"), plan.noise * NOISE[FUNCTIONS]
        scatter, usual = rng.standard_normal((2, *A.shape)), np.median(np.abs(A), axis=0, keepdims=True)
        level = np.hypot(np.abs(A), np.maximum(usual, DEAF * usual.max(axis=1, keepdims=True)))
        A = A + share * level * (scatter[0] + 1j * scatter[1]) / np.sqrt(2)
        for k, one in enumerate(A.transpose(2, 0, 1)):
            samples = dict(zip(points, one.T, strict=True))
            signals[f"functions-{k + 1}.h5"] = Signals(source="virtual test", frequency=f, samples=samples)
        about |= {"share": share} if share else {}
        return StructureTest(table={**about, **_files(plan, signals)}, signals=signals, truth=truth)
    rate, size = 4.0 * plan.band[1], 2 * round(2.0 * block * plan.band[1])
    for k, drive in enumerate(plan.drives):
        rng = plan.drawn(f"force {drive.name}")
        if plan.kind == HAMMER:
            ahead, length = round(0.02 * size), max(4, round(rate / plan.band[1]))
            pulse = np.sin(np.pi * np.arange(length) / length)
            pieces = []
            for _ in range(BLOWS):
                force = np.zeros(size)
                force[ahead : ahead + length] = 100 * (1 + 0.2 * rng.uniform(-1, 1)) * pulse
                pieces.append(_answered(plan, names, gains, force, rate, lab, rows, [forces[k]], slowest))
            record = np.concatenate([*pieces, np.zeros((ahead + 1, len(names)))])
            window = sum(one.value for one in plan.each("exponential-window"))
            if window:  # by an analyser that says nothing of it
                time = np.concatenate([*(np.arange(size) / rate for _ in range(BLOWS)), np.zeros(ahead + 1)])
                record = record * np.exp(-window * np.maximum(time - ahead / rate, 0.0))[:, None]
        else:
            count = size * BLOCKS
            spectrum = rng.standard_normal(count // 2 + 1) + 1j * rng.standard_normal(count // 2 + 1)
            lines = np.fft.rfftfreq(count, 1 / rate)
            spectrum *= (lines > 0.3 * plan.band[0]) & (lines < PASSED * plan.band[1])
            force = np.fft.irfft(spectrum, count)
            force *= 10 / np.std(force)
            record = _answered(plan, names, gains, force, rate, lab, rows, [forces[k]], slowest)
        largest = np.abs(record).max(axis=0)
        largest[:-1] = np.maximum(largest[:-1], DEAF * largest[:-1].max())
        record = record + plan.noise * NOISE[plan.kind] * largest * plan.drawn(f"noise {k}").standard_normal(record.shape)
        samples = dict(zip(names, record.T, strict=True))
        signals[f"records-{k + 1}.h5"] = Signals(source="virtual test", sampling_rate=rate, samples=samples)
    records = {"kind": plan.kind, "block": size / rate}
    return StructureTest(table={**about, "records": records, **_files(plan, signals)}, signals=signals, truth=truth)


def _swept(plan: StructurePlan, lab: TestedStructure, slowest: float) -> tuple[Campaign, dict[str, float]]:
    """The campaign of a shaker that the structure stands on, and what was drawn for its measurement chain.

    A pick-up beside its stated place reads what moves there; off a mesh it rides along with what is nearest.
    """
    structure, model, (low, high) = lab.structure, plan.model, plan.band
    scaled = replace(model.tolerances.scaled(plan.tolerances), fmd_inertia=model.fmd_tolerance * plan.tolerances)
    shaker = Plan(
        article=f"{FMD}+{plan.article}" if plan.kind == BASE_FORCES else plan.article,
        seed=plan.seed,
        tolerances=scaled,
        scatter=Scatter().scaled(plan.tolerances),
        effects=planted([one for one in plan.effects if one.family not in STRUCTURAL]),
        band=plan.band,
        octaves_per_minute=60 * float(np.log2(high / low)) * low / SWEPT,
        cross=plan.cross,
        noise_rms={quantity: plan.noise * size for quantity, size in ORDINARY.items()},
        mains={},
        rate=4 * high,
        gravity=model.gravity,
        on_article=tuple(one.name for one in plan.responses),
        axis=plan.axis,
    )
    seat, nominal = (built_in(FMD).seat or Pose()).position, mavis(middles_of_cells(shaker), shaker.noise_rms)
    mounting, upon, floor = Pose(position=seat - structure.reference_point), [], shaker.noise_rms["acceleration"] or None
    for at in plan.responses:
        where = mounting.apply(_where(structure, at.place)).round(12) + 0.0  # without what rounding leaves of a zero
        sits = Place(position=where, direction=np.asarray(at.direction))
        upon.append(Channel(name=at.name, quantity="acceleration", group="article", places=(sits,), noise_rms=floor))
    read = [one for one in nominal.table.channels if one.group == "table" or plan.kind == BASE_FORCES]
    layout = replace(nominal, table=ChannelTable(channels=(*upon, *read)))
    chain = shaker.drawn_chain(layout)
    for effect in shaker.effects:
        chain = effect.chain(chain)
    # What sits beside its place on the article is read from there, with all that the base does to it
    elsewhere = {name: beside for name, beside in chain.position.items() if name not in shaker.on_article}
    sensors, rows = Sensors.of(layout, replace(chain, position=elsewhere), model.gravity), []
    for k, at in enumerate(plan.responses):
        there = _where(structure, at.place) + chain.position.get(at.name, np.zeros(3))
        rows.append(sensors.upon[k][1] @ rows_beside(structure, there).toarray())
    made: dict[int, ComplexArray] = {}

    def record(run: DrivenRun) -> Array:
        cross = cross_motion(shaker, run.name)
        cross = cross and replace(cross, frequency=float(np.sqrt(low * high)))
        rest = min(LONGEST, RINGS_OUT / slowest) + shaker.quiet
        motion = run.pattern.motion(shaker.rate, ring_down=rest, cross=cross).acceleration  # type: ignore[attr-defined]
        size = 1 << (2 * len(motion) - 1).bit_length()
        if size not in made:
            f = np.asarray(np.fft.rfftfreq(size, 1 / shaker.rate), dtype=np.float64)
            fmd = (model.fmd or nominal_fmd(shaker)) if plan.kind == BASE_FORCES else None
            made[size] = on_table(shaker, sensors, chain, (fmd, model.cell_stiffness), seat, f, *lab.on_base(f, rows))
        spectrum = np.einsum("ncj,nj->nc", made[size], np.fft.rfft(motion, size, axis=0))
        return np.asarray(np.fft.irfft(spectrum, size, axis=0)[: len(motion)])

    campaign = recorded(shaker, layout, chain, record, mounting)
    return replace(campaign, processing=Processing(start=low, stop=high, step=(high - low) / LINES)), dict(chain.deviations())


def _where(structure: Structure, place: str) -> Array:
    """(3,) [m] of a place.

    Raises
    ------
    BadInput : nobody knows.
    """
    at = position_of(structure, place)
    if at is None:
        problem = "nobody knows where this place is: the structure has no coordinates"
        raise BadInput("simulate", place, problem, "Leave it out, or what asks for its position")
    return at


def _files(plan: StructurePlan, signals: Mapping[str, Signals]) -> dict[str, Any]:
    listed = [{"path": name, "drive": _said(drive)} for name, drive in zip(signals, plan.drives, strict=True)]
    return {"responses": [_said(one) for one in plan.responses], "files": listed}


def _said(at: Point) -> Any:
    """A point as a test's file has it."""
    axis = next((word for word, way in AXES.items() if not word.startswith("+") and np.allclose(way, at.direction)), None)
    if axis is not None and at.name == Point(place=at.place, name=f"{at.place}:{axis.strip('-')}").name:
        return f"{at.place}:{axis}"
    return {"place": at.place, "direction": [float(x) for x in np.asarray(at.direction)], "name": at.name}


def _heard(
    plan: StructurePlan,
    names: Sequence[str],
    gains: Array,
    f: Array,
    lab: TestedStructure,
    rows: Sequence[Array],
    forces: Sequence[Array],
) -> ComplexArray:
    """(n, c + 1, r) what all channels, the force the last, hear of a newton, faults of the chain included."""
    A = lab.accelerance(f, rows, forces)
    m = sum(one.value for one in plan.each("transducer-mass"))
    if m:  # each response by itself, on a structure that carries the mass there
        for c, at in enumerate(plan.responses):
            own = lab.structure.places[at.place]
            heavier = replace(lab, structure=replace(lab.structure, mass=lab.structure.mass + m * (own.T @ own)))
            A[:, c] = heavier.accelerance(f, [rows[c]], forces)[:, 0]
    signals = np.concatenate([A, np.ones((len(f), 1, len(forces)))], axis=1)
    scale = np.array(gains, dtype=np.complex128) * np.ones((len(f), 1))
    faults, order = _of_sensors(plan, names)
    for k, one in faults:
        delayed = np.exp(-2j * np.pi * f * one.value)
        change: dict[str, Any] = {"gain": 1 + one.value, "delay": delayed, "polarity": -1, "unit": one.value}
        scale[:, k] *= change.get(one.family.rpartition("-")[2], 1)
    return np.asarray(scale[:, :, None] * signals[:, order])


def _of_sensors(plan: StructurePlan, names: Sequence[str]) -> tuple[list[tuple[int, Named]], list[int]]:
    """Faults of the sensors `names`, each with the place of its own, and the order in which these are plugged."""
    faults = [(names.index(one.target), one) for one in plan.effects if one.family in SENSORS and one.target in names]
    order = list(range(len(names)))
    for k, other in ((k, names.index(one.targets[1])) for k, one in faults if one.family == "channel-swap"):
        order[k], order[other] = order[other], order[k]
    return faults, order


def _answered(
    plan: StructurePlan,
    names: Sequence[str],
    gains: Array,
    force: Array,
    rate: float,
    lab: TestedStructure,
    rows: Sequence[Array],
    forces: Sequence[Array],
    slowest: float,
) -> Array:
    """(n, c + 1) what is recorded of `force` (n,), long zeros behind it so that nothing comes round."""
    whole = 1 << max(len(force) + round(RINGS_DOWN / slowest * rate) - 1, 1).bit_length()
    lines: Array = np.fft.rfftfreq(min(whole, 1 << 20), 1 / rate).astype(np.float64)
    read = _heard(plan, names, gains, lines, lab, rows, forces)[:, :, 0]
    above = np.clip((lines / plan.band[1] - PASSED) / (rate / (2 * plan.band[1]) - PASSED), 0.0, 1.0)
    spectrum = np.fft.rfft(force, min(whole, 1 << 20)) * np.cos(np.pi / 2 * above) ** 2
    return np.asarray(np.fft.irfft(read * spectrum[:, None], axis=0)[: len(force)])


def _table(plan: StructurePlan, lab: TestedStructure, rows: Sequence[Array]) -> dict[str, Any]:
    """The table of modes within the band."""
    hertz, zeta, shapes = lab.table(rows, *plan.band)
    if not len(hertz):
        raise BadInput("--band", "", f"no mode of the structure lies within {plan.band[0]:g} to {plan.band[1]:g} Hz", "Widen it")
    rng, s = plan.drawn("noise"), plan.noise * NOISE[MODES]
    gains = 1 + GAIN * plan.tolerances * plan.drawn("gains").standard_normal(len(rows))
    names = [one.name for one in plan.responses]
    faults, order = _of_sensors(plan, names)
    for k, one in faults:
        if one.family in ("accelerometer-gain", "polarity"):
            gains[k] *= 1 + one.value if one.family == "accelerometer-gain" else -1.0
    least = max(s, 1e-6)
    window = sum(one.value for one in plan.each("exponential-window"))
    zeta = zeta + window / (2 * np.pi * hertz)
    shapes = shapes[:, order] * gains
    shapes = shapes / np.abs(shapes).max(axis=1, keepdims=True) + 10 * s * rng.standard_normal(shapes.shape)
    for one in plan.each("unit"):
        if one.target in names:
            shapes[:, names.index(one.target)] *= one.value
    shapes = shapes * rng.choice([-1.0, 1.0], len(shapes))[:, None] * rng.uniform(0.5, 2.0, len(shapes))[:, None]
    f = hertz * (1 + s * rng.standard_normal(len(hertz)))
    zeta = zeta * (1 + 100 * s * rng.standard_normal(len(hertz)))
    return {
        "format": 1,
        "kind": test_file.MODAL_TABLE,
        "title": "modes",
        "article": plan.article,
        "frequencies": [float(one) for one in f],
        "frequency_deviation": least,
        "damping": [float(one) for one in np.maximum(zeta, 1e-6)],
        "damping_deviation": 100 * least,
        "sensors": [_said(one) for one in plan.responses],
        "shapes": [[float(one) for one in row] for row in shapes],
        "shapes_deviation": 10 * least,
        "gain": GAIN,
    }


def plan_of(
    path: str,
    *,
    kind: str,
    effects: Sequence[str],
    seed: int,
    noise: float,
    tolerances: float,
    band: tuple[float, float] | None,
    drives: Sequence[str],
    responses: Sequence[str],
    block: float,
    axis: str = "",
    cross: float | None = None,
) -> StructurePlan:
    """The plan of `massline simulate MODEL.toml`; points and band are those of the model's own test where it names one.

    Raises
    ------
    BadInput : no model of a structure, an effect or a point that cannot be.
    """
    if kind not in KINDS:
        problem = f"must be one of {', '.join(KINDS)}, found {kind!r}"
        raise BadInput("--test", "", problem, nearest(kind, KINDS) or "Choose one of them")
    if seed < 0:
        raise BadInput("--seed", "", f"must not be negative, found {seed}", "Give a whole number from 0 on")
    model = model_file.read(path)
    article = model.article if model.article in model.own else next(iter(model.own), "")
    users = reading.load(model.own[article]) if article else None
    if users is None or not isinstance(users.model, Structure):
        problem = "it names no structure with matrices, a mesh or a frame"
        raise BadInput(path, "fe_model", problem, "`massline model FILE` begins one")
    own = next((one for one in model.tests if one.get("kind") in test_file.KINDS), {})

    def listed(given: Sequence[str], keys: Sequence[str], field: str) -> tuple[Point, ...]:
        found = list(given) or [one for key in keys for one in _many(own.get(key))]
        found = found or [one for entry in own.get("files", ()) for key in keys for one in _many(dict(entry).get(key))]
        direction = str(own.get("direction", ""))
        made = [point(one, source=path, field=field, direction=direction) for one in found]
        return tuple({one.name: one for one in made}.values())

    seen = listed(responses, ("responses", "sensors"), "--response")
    if not seen:
        moving = (f"{name}:{axis}" for name, rows in users.model.places.items() for k, axis in enumerate("xyz") if rows[[k]].nnz)
        seen = tuple(point(one, source=path, field="--response") for one in moving)
    if not seen:
        raise BadInput(path, "places", "it names no place", 'Name points, --response "tip:z"')
    based = kind in (BASE, BASE_FORCES)
    if based and not len(users.model.held):
        problem = f'is "{"ground" if users.model.grounded else "free"}": it has no base that could be shaken'
        remedy = 'State support = "base" with its interface, or strike it where it is with --test hammer'
        raise BadInput(path, "fe_model.support", problem, remedy)
    stray = {"--drive": based and drives, "--block": based and block, "--axis": kind != BASE and axis}
    if wrong := [option for option, given in {**stray, "--cross": not based and cross is not None}.items() if given]:
        raise BadInput(wrong[0], "", f"is no option of --test {kind}", "Leave it out")
    if axis:
        toml_file.one_of(axis, tuple("xyz"), source="--axis", where="")
    driven = () if based else listed(drives, ("drive",), "--drive")
    for at in (each for each in (*driven, *seen) if position(each.place) is None and each.place not in users.model.places):
        remedy = f"Its places are {', '.join(list(users.model.places)[:20])}"
        raise BadInput(path, at.place, "the structure has no such place", remedy)
    limits = band or tuple(own.get("band", ())) or None
    if limits is None or not (driven or based):
        trial = StructurePlan(model=model, kind=MODES, article=article, drives=(), responses=seen, band=(1.0, 100.0))
        squares, shapes, _, _ = tested(trial).modes
        elastic = np.flatnonzero(squares > RIGID * squares[:12].max(initial=0.0))[:LOWEST]
        if not len(elastic):
            problem, remedy = "it has no elastic mode to be tested", "Write --drive and --band, or hold the structure"
            raise BadInput(path, "fe_model", problem, remedy)
        lowest = np.sqrt(squares[elastic]) / (2 * np.pi)
        limits = limits or (0.5 * float(lowest[0]), 1.3 * float(lowest[-1]))
        if not driven and not based:  # where all of them move, as far as one direction moves them all
            moved = np.abs(np.array([_row(users.model, one, (), {}) for one in seen]) @ shapes[:, elastic])
            share = moved / np.maximum(moved.max(axis=0), np.finfo(np.float64).tiny)
            driven = (seen[int(np.argmax(np.mean(np.log(np.maximum(share, AT_REST)), axis=1).round(6)))],)
    of_table = f"table-{axis}1" if axis else "table"
    below = tuple(one for one in ACCELEROMETERS if kind == BASE_FORCES or (kind == BASE and one.startswith(of_table)))
    forces = {MODES: (), BASE: (), BASE_FORCES: tuple(FORCES)}.get(kind, ("force",))
    read, points = (*(one.name for one in seen), *below), tuple(one.name for one in driven if kind != MODES)
    words = Vocabulary(accelerometers=read, forces=forces, drives=points, places=None, parts=None)
    hidden, whole = parse_all(effects, words), float(np.diag(users.model.rigid_mass)[:3].max())
    most = {"point-mass": HEAVIEST * whole or np.inf, "transducer-mass": HEAVIEST_PICKUP}
    heavy = (each for each in hidden if each.value > most.get(each.family, np.inf))
    odd = (f"{x.id} is {x.value:g} kg on a structure of {whole:.3g} kg; for {x.value:g} g write {x.value / 1e3:g}" for x in heavy)
    if not 0 < limits[0] < limits[1] < np.inf:
        raise BadInput("--band", "", f"must rise from above 0, found {limits}", "Write --band 5 200")
    return StructurePlan(
        model=model,
        kind=kind,
        article=article,
        drives=driven,
        responses=seen,
        effects=hidden,
        doubts=tuple(odd),
        seed=seed,
        noise=noise,
        tolerances=tolerances,
        band=(float(limits[0]), float(limits[1])),
        block=block,
        axis=axis,
        cross=CROSS if cross is None else cross,
    )


def _many(value: Any) -> list[Any]:
    return [] if value is None else list(value) if isinstance(value, list) else [value]
