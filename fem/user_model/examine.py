"""A doctor for models: all that can be seen to be wrong with a user's model, before it is believed, in words and with where.

`reading.read` refuses a model at the first thing that is wrong. Here the same file is looked at as it stands, everything that can
still be looked at is, and causes come before what follows from them. What the reader would refuse is a finding here, always.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fem.mesh.places import ENERGY_TOO_HIGH, Elements
from fem.modes import Modes, floating_shift, lowest
from fem.structure import Sparse, Structure, check_connected, check_stiff, hold
from fem.user_model import freedoms, frequency_checks, matrices, matrix_checks, reading
from fem.user_model.description import Contents, Description
from fem.user_model.frequency_checks import refusal
from fem.user_model.matrix_checks import Finding, Submitted
from geometry.errors import BadInput, CheckFailed


@dataclass(frozen=True, eq=False, kw_only=True)
class Examination:
    """What a model was found to be.

    Attributes
    ----------
    source : the file
    name : of the model
    kind : as described: matrices, modal ...
    findings : what is wrong, causes first; empty when nothing is
    facts : what it says of itself, in sentences
    unexamined : what could not be looked at, or may be no more than a consequence of what was found
    """

    source: str
    name: str
    kind: str
    findings: tuple[Finding, ...]
    facts: tuple[str, ...] = ()
    unexamined: tuple[str, ...] = ()


def examine(path: str | Path) -> Examination:
    """Everything that is wrong with the model in `path`.

    Raises
    ------
    BadInput : the file or its description cannot be read at all.
    """
    if made := reading.described_whole(path):
        return _as_read(path, made)
    contents, description = reading.opened(path)
    facts: tuple[str, ...] = ()
    if description.kind == "modal":
        findings, missing = frequency_checks.modal(contents, description)
        unread = tuple(f"`{name}` cannot be read, so nothing that needs it was looked at" for name in missing)
    elif description.kind == "matrices":
        model, findings = submitted(contents, description)
        unread = ()
        if model is not None:
            examined = examine_matrices(model, findings, description)
            findings, facts, unread = list(examined.findings), examined.facts, examined.unexamined
    else:
        findings, unread = [], (f"a model of the kind {description.kind} is looked at as the reader makes it",)
    if not findings:
        try:
            findings = lossless(reading.load(path).model)
        except BadInput as error:
            findings = [refusal(error)]
    return Examination(
        source=str(path), name=description.name, kind=description.kind, findings=tuple(findings), facts=facts, unexamined=unread
    )


def _as_read(path: str | Path, kind: str) -> Examination:
    """What the reader says of a `kind` of model whose matrices are made here: it checks all that may be wrong."""
    try:
        found = reading.load(path)
    except BadInput as error:
        return Examination(source=str(path), name=Path(path).stem, kind=kind, findings=(refusal(error),))
    if not isinstance(found.model, Structure):
        return Examination(source=str(path), name=found.name, kind=kind, findings=())
    facts, findings, worst = [f"{found.model.mass.shape[0]} degrees of freedom"], lossless(found.model), None
    try:
        worst = coarsest(found.model)
    except CheckFailed as error:
        what, _, remedy = str(error).rstrip(".").partition(". ")
        findings.append(
            Finding(check="support", what=what[:1].lower() + what[1:], where="how it is held", amount="", remedy=remedy)
        )
    if worst:
        hertz, part, share = worst
        facts.append(f"a finer mesh may move a frequency by about {100 * share:.2g} %, that of {hertz:.4g} Hz")
        if share > TOO_COARSE:
            what = "strains jump so much from element to element that the mesh is no longer the structure"
            blocks = found.model.elements.blocks if isinstance(found.model.elements, Elements) else ()
            first = any(block.part == part and block.kind in ("tet4", "wedge6", "hex8") for block in blocks)
            remedy = f"Mesh it finer there{', or with elements of the second order' if first else ''}"
            amount = f"about {100 * share:.2g} % of the frequency of the mode at {hertz:.4g} Hz"
            findings.append(Finding(check="mesh", what=what, where=part, amount=amount, remedy=remedy))
    return Examination(source=str(path), name=found.name, kind=kind, findings=tuple(findings), facts=tuple(facts))


def lossless(model: Structure | Modes) -> list[Finding]:
    """Parts of which no loss is stated while others have one: the modes that strain them alone ring for ever."""
    if not isinstance(model, Structure) or not model.loss_factors:
        return []
    stated = {*model.loss_factors, *model.supports, *model.joints}
    silent = [part for part in model.part_stiffness if part not in stated]
    what = "loses nothing, since others state a loss and it does not: modes that strain it alone have no damping"
    remedy = "State its loss_factor; 0 says that none is meant"
    return [Finding(check="damping", what=what, where=part, amount="a loss factor of 0", remedy=remedy) for part in silent]


LOOKED_AT = 10
"""[count] of modes by which a mesh is judged: what a test of a structure usually has. By definition."""

TOO_COARSE = 0.05
"""[share of a frequency] that a mesh may be off before it is wrong: as much as a modulus a tenth off. Held by test_examine.py."""


def coarsest(structure: Structure) -> tuple[float, str, float] | None:
    """Of the lowest modes the one that the mesh leaves most unsure: its frequency [Hz], the part that has most of that, and the
    share of the frequency that a finer mesh would take off; None where no solid elements tell.

    Raises
    ------
    CheckFailed : part of it is not held, or swings freely.
    """
    check_connected(structure)
    free = hold(structure)
    K, M = free.stiffness, free.mass
    count = min(LOOKED_AT + 6 * structure.floating, len(free.free))
    if not count:
        return None
    pairs = lowest(K, M, count, shift=floating_shift(K, M) if structure.floating else 0.0)
    if not structure.floating:
        check_stiff(free, structure, pairs.values, pairs.vectors)
    if structure.elements is None:
        return None
    elastic = pairs.values > RIGID * pairs.values.max()
    squares = pairs.values[elastic]
    unsure = structure.elements.unresolved(free.expand(pairs.vectors[:, elastic]), squares)
    shares = {part: ENERGY_TOO_HIGH * np.diag(one) / squares / 2 for part, one in unsure.items()}
    total = np.sum(list(shares.values()), axis=0)
    if not shares or np.max(total, initial=0.0) < RIGID:  # elements alone, of which none has a neighbour, tell nothing
        return None
    worst = int(np.argmax(total))
    part = max(shares, key=lambda name: float(shares[name][worst]))
    return float(np.sqrt(squares[worst]) / (2 * np.pi)), part, float(total[worst])


RIGID = 1e-6
"""[share of the highest square asked for] below which a mode moves without strain. By definition."""


def submitted(contents: Contents, description: Description) -> tuple[Submitted | None, list[Finding]]:
    """The matrices in `contents` as they stand, in SI, and what is wrong with single arrays; None without K and M of one size."""
    from scipy.sparse import csr_array, diags_array

    found: list[Finding] = []
    read = {}
    shares: dict[str, dict[str, Sparse]] = {"stiffness": {}, "mass": {}}
    for name, into in shares.items():
        for part in contents.shares(name):
            try:
                into[part] = contents.matrix(f"{name}/{part}")
            except BadInput as error:
                found.append(refusal(error))
    for name in ("stiffness", "mass", "viscous", "structural"):
        if name in contents or name in ("stiffness", "mass"):
            try:
                of_parts = list(shares.get(name, {}).values())
                read[name] = sum(of_parts[1:], of_parts[0]) if of_parts and name not in contents else contents.matrix(name)
            except (BadInput, ValueError) as error:
                if isinstance(error, BadInput):
                    found.append(refusal(error))
    K, M = read.get("stiffness"), read.get("mass")
    if K is None or M is None:
        return None, found
    for name, A in read.items():
        if A.shape != K.shape:
            what = f"the {name} is {A.shape[0]} x {A.shape[1]} where the stiffness is {K.shape[0]} x {K.shape[1]}"
            remedy = "Write both for the same degrees of freedom, in the same order"
            amount = f"{abs(A.shape[0] - K.shape[0])} rows"
            found.append(Finding(check="size", what=what, where=f"array `{name}`", amount=amount, remedy=remedy))
    if M.shape != K.shape:
        return None, found
    n, u, nothing = K.shape[0], description.units, np.zeros((0, 2), dtype=np.intp)
    try:
        dofs = freedoms.dof_map(contents, description, n)
    except BadInput as error:
        found.append(refusal(error))
        none = np.zeros((0, 3), dtype=np.intp)
        dofs = freedoms.DofMap(
            labels=nothing,
            scale=np.ones(n),
            rigid=np.zeros((n, 6)),
            held=none[:, 0],
            points=np.zeros((0, 3)),
            translations=none,
            rotations=none,
        )
    if not np.any(dofs.rigid):
        dofs = replace(dofs, rigid=dofs.rigid[:0])
    S, powers = diags_array(1 / dofs.scale), {"stiffness": 0, "mass": 2, "viscous": 1, "structural": 0}
    si = {name: csr_array(u.energy * u.time ** powers[name] * (S @ A @ S)) for name, A in read.items() if A.shape == K.shape}
    whole = {name: si[name] for name in ("stiffness", "mass") if name in contents}
    scaled = {
        name: {
            part: csr_array(u.energy * u.time ** powers[name] * (S @ A @ S)) if A.shape == K.shape else A
            for part, A in into.items()
        }
        for name, into in shares.items()
    }
    known = len(dofs.labels) and "nodes" in contents and "coordinates" in contents
    model = Submitted(
        stiffness=si["stiffness"],
        mass=si["mass"],
        dofs=dofs,
        support=description.named.support,
        nodes=contents.whole("nodes", (-1,)) if known else np.zeros(0, dtype=np.intp),
        places=contents.numbers("coordinates", (-1, 3)) * u.length if known else np.zeros((0, 3)),
        reference_point=description.reference_point,
        viscous=si.get("viscous"),
        structural=si.get("structural"),
        part_stiffness={part: A for part, A in scaled["stiffness"].items() if A.shape == K.shape},
        part_mass={part: A for part, A in scaled["mass"].items() if A.shape == K.shape},
        stated=description.stated,
    )
    found += matrix_checks.parts(whole, scaled, model)
    if description.named.joints and not found:  # springs that the description adds
        try:
            joined = matrices.structure(contents, description)[0]
        except BadInput:
            return model, found
        model = replace(model, stiffness=joined.stiffness, part_stiffness=joined.part_stiffness)
    return model, found


FOLLOWS = {
    "grounded": {"diagonal", "parts", "loose part", "no stiffness", "penalty"},
    "restrained": {"loose part", "no stiffness"},
    "mass by axis": {"diagonal", "symmetry", "loose part"},
    "rigid body": {"diagonal", "symmetry", "grounded", "link"},
    "mechanism": {"order of rows", "penalty", "coordinates"},
    "indefinite stiffness": {"order of rows", "diagonal", "penalty"},
    "indefinite mass": {"order of rows", "diagonal"},
    "total mass": {"orphan", "no stiffness", "loose part"},
}
"""What may be nothing but a consequence of another finding, by check; frequencies may be one of any."""


def examine_matrices(model: Submitted, findings: list[Finding], described: Description) -> Examination:
    """All checks of matrices, each on what the ones before it left; `findings` are those of single arrays."""
    findings = list(findings)
    later: list[str] = []
    facts = [f"{model.mass.shape[0]} degrees of freedom, {model.stiffness.count_nonzero()} entries in the stiffness"]
    model, found = matrix_checks.entries(model)
    findings += found
    model, found = matrix_checks.connections(model)
    findings += found
    known = len(model.dofs.rigid) > 0
    heavy = stiff = None
    follows: list[Finding] = []
    if known or model.support == "ground":
        heavy, follows = frequency_checks.definiteness(model, "mass")
        stiff, found = frequency_checks.definiteness(model, "stiffness")
        follows += found
    else:
        later.append("what the rows are is not known, so rigid motions, mass and frequencies were not looked at")
    if known and model.support != "ground":
        lowest = None
        if stiff is not None and model.support == "base":
            # From above: the static answer to gravity, as the reader takes it
            momenta = np.asarray(model.mass @ model.dofs.rigid)[model.free]
            K, M = (A[model.free][:, model.free] for A in (model.stiffness, model.mass))
            sag = stiff.solve(momenta)
            inert = np.sum(sag * (M @ sag), axis=0)
            lowest = min((np.sum(sag * (K @ sag), axis=0)[inert > 0] / inert[inert > 0]).tolist(), default=None)
        model, found = matrix_checks.rigid_motions(model, lowest)
        findings += found
        if not {finding.check for finding in findings} & {"coordinates", "restrained"}:
            findings += matrix_checks.mass(model, described.units)
    total = float((model.dofs.rigid.T @ (model.mass @ model.dofs.rigid))[0, 0]) if known else 0.0
    if model.support == "ground" and described.units.known:
        findings += matrix_checks.too_dense(model, total)
    findings += follows
    if known and model.support == "base":
        findings += frequency_checks.reduction(model)
    if heavy is not None and stiff is not None:
        own, found = frequency_checks.frequencies(model)
        facts.append(
            f"lowest frequencies {', '.join(f'{one:.4g}' for one in own[:6])} Hz" if len(own) else "no frequency was found"
        )
        if findings:
            later += [
                f"{one.what}, which may follow from what is said above: examine again once that is corrected" for one in found
            ]
        else:
            findings += found
    elif known or model.support == "ground":
        later.append("frequencies were not looked at: stiffness and mass must be positive definite first")
    findings += frequency_checks.damping(model)
    if known:
        facts.append(f"mass {total:.6g} kg")
    said, kept = {finding.check for finding in findings}, []
    for one in findings:
        if FOLLOWS.get(one.check, set()) & said:
            later.append(
                f"{one.what} ({one.where}), which may follow from what is said above: examine again once that is corrected"
            )
        else:
            kept.append(one)
    return Examination(
        source="", name=described.name, kind="matrices", findings=tuple(kept), facts=tuple(facts), unexamined=tuple(later)
    )
