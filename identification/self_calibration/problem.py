"""The joint problem: campaigns that share blocks of one vector, and the classical facts."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, freeze, frozen
from geometry.inertia import PARAMETERS, Inertia
from identification import request
from identification.chain import Chain, chain
from identification.elastic import model
from identification.elastic.model import ElasticTerms
from identification.plain import CHAIN_ERROR, Setup, drift, setup
from identification.request import Evidence, Fact, Known, Settings, TareSpectra
from identification.rigid_body import BASIS
from identification.self_calibration import likelihood
from identification.self_calibration.likelihood import Observed, Rows, observed
from identification.self_calibration.solve import Normal
from identification.spectra.line_spectra import Spectra

# `Layout`: the one vector of everything that is estimated, in blocks, and what is known of it beforehand.
#
# Knowledge is whitened rows, each a measurement with standard deviation 1: ``rows @ x = values``. Data and knowledge add, and
# the posterior covariance C = (J^T J + sum A_b^T A_b)^-1 splits into the part of every input: C J^T J C + sum C A_b^T A_b C = C.


@dataclass(frozen=True, eq=False, kw_only=True)
class Block:
    """Parameters that belong together.

    Attributes
    ----------
    name : unique in a layout
    names : (k,) of the parameters
    start : (k,) where the iteration begins
    rows : (p, k) whitened
    values : (p,)
    families : (p,) the input that each row belongs to
    """

    name: str
    names: tuple[str, ...]
    start: Array
    rows: Array
    values: Array
    families: tuple[str, ...]

    def __post_init__(self) -> None:
        k, p = len(self.names), len(self.families)
        freeze(self, start=(k,), rows=(p, k), values=(p,))

    def __len__(self) -> int:
        return len(self.names)


def block(
    name: str,
    names: Sequence[str],
    start: npt.ArrayLike,
    *,
    deviation: npt.ArrayLike = np.inf,
    mean: npt.ArrayLike = 0.0,
    families: Sequence[str] | str = "",
) -> Block:
    """A block whose parameters are known one by one: `mean` (k,) within `deviation` (k,), infinite where one is free."""
    k = len(names)
    sd, mu = np.broadcast_to(np.asarray(deviation, dtype=np.float64), k), np.broadcast_to(np.asarray(mean, dtype=np.float64), k)
    known = np.flatnonzero(np.isfinite(sd))
    called = (families,) * k if isinstance(families, str) else tuple(families)
    return Block(
        name=name,
        names=tuple(names),
        start=np.asarray(start, dtype=np.float64),
        rows=np.eye(k)[known] / sd[known, None],
        values=mu[known] / sd[known],
        families=tuple(called[i] for i in known),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Layout:
    """Blocks one after the other."""

    blocks: tuple[Block, ...]

    def __len__(self) -> int:
        return sum(len(one) for one in self.blocks)

    def at(self, name: str) -> slice:
        """Where the block `name` stands in the vector.

        Raises
        ------
        KeyError : there is none.
        """
        begin = 0
        for one in self.blocks:
            if one.name == name:
                return slice(begin, begin + len(one))
            begin += len(one)
        raise KeyError(name)

    def block(self, name: str) -> Block:
        """The block `name`."""
        return next(one for one in self.blocks if one.name == name)

    @property
    def owners(self) -> tuple[str, ...]:
        """(k,) name of the block of every parameter."""
        return tuple(one.name for one in self.blocks for _ in one.names)

    @property
    def start(self) -> Array:
        """(k,) of all blocks."""
        return np.concatenate([one.start for one in self.blocks])

    @property
    def knowledge(self) -> tuple[Array, Array, tuple[str, ...]]:
        """Rows (p, k), values (p,) and families (p,) of all blocks."""
        rows = np.zeros((sum(len(one.families) for one in self.blocks), len(self)))
        begin = 0
        for one in self.blocks:
            rows[begin : begin + len(one.families), self.at(one.name)] = one.rows
            begin += len(one.families)
        values = np.concatenate([one.values for one in self.blocks])
        return rows, values, tuple(family for one in self.blocks for family in one.families)


# The dynamic mass of one campaign as a function of the joint vector: FMD, what stands on it, and elastic terms.
#
# H = sum of M_F(bodies) + omega² L^T (Omega² - omega² + i omega C)^-1 L + omega² R                  (paper Eq. 8b)


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """Ten parameters ``mean + root @ z`` with z the block `block` of the joint vector; no block where it is known exactly.

    Attributes
    ----------
    block : name in the layout
    mean : (10,) about F, order of Eq. 4
    root : (10, k)
    """

    block: str = ""
    mean: Array = field(default_factory=lambda: np.zeros(10))
    root: Array = field(default_factory=lambda: np.eye(10))

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", frozen(self.mean, (10,), "mean"))

    def ten(self, layout: Layout, x: Array) -> Array:
        """(10,) at the joint vector `x`."""
        return np.asarray(self.mean + (self.root @ x[layout.at(self.block)] if self.block else 0.0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Structure:
    """What stands on the load cells in one campaign.

    Attributes
    ----------
    bodies : whose ten parameters add up
    elastic : layout of the elastic terms; None for a rigid structure
    elastic_block : its name in the joint layout
    """

    bodies: tuple[Body, ...]
    elastic: model.ElasticLayout | None = None
    elastic_block: str = ""

    def ten(self, layout: Layout, x: Array) -> Array:
        """(10,) of all bodies together."""
        return np.asarray(np.sum([body.ten(layout, x) for body in self.bodies], axis=0))

    def terms(self, layout: Layout, x: Array) -> ElasticTerms:
        """The elastic terms at `x`; none for a rigid structure."""
        if self.elastic is None:
            return ElasticTerms()
        return model.unpack(np.concatenate([np.zeros(10), x[layout.at(self.elastic_block)]]), self.elastic)[1]

    def dynamic_mass(self, layout: Layout, x: Array, frequency: Array) -> ComplexArray:
        """H (n, 6, 6)."""
        mass = Inertia(parameters=self.ten(layout, x)).mass_matrix
        return model.dynamic_mass(mass, self.terms(layout, x), frequency)

    def derivatives(self, layout: Layout, x: Array, frequency: Array) -> ComplexArray:
        """dH (k, n, 21) of the entries in `UPPER`: by the ten in SI, then by the elastic terms."""
        ten = np.broadcast_to(BASIS[:, None, *model.UPPER], (10, len(frequency), 21)).astype(np.complex128)
        if self.elastic is None:
            return ten
        return np.concatenate([ten, model.upper_derivatives(self.terms(layout, x), frequency, self.elastic)[10:]])

    def selection(self, layout: Layout) -> Array:
        """(k, len(layout)): how the ten and the elastic parameters follow from the joint vector."""
        own = 0 if self.elastic is None else self.elastic.size - 10
        chosen = np.zeros((10 + own, len(layout)))
        for body in self.bodies:
            if body.block:
                chosen[:10, layout.at(body.block)] += body.root
        if own:
            chosen[10:, layout.at(self.elastic_block)] = np.eye(own)
        return chosen


@dataclass(eq=False, kw_only=True)
class Kept:
    """What is observed of a campaign at one floor; chain, dynamic mass and the cost near them where it was told last."""

    observed: Observed
    about: tuple[Array, ComplexArray, likelihood.Near] | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Part:
    """One campaign.

    Attributes
    ----------
    name : for messages
    observed : at the lines that are used
    chain : of its channels
    offsets : (p,) where the offsets of its chain stand in the joint vector; campaigns of the same hardware share them
    structure : what stood on the load cells
    kept : what does not change with the joint vector
    """

    name: str
    observed: Observed
    chain: Chain
    offsets: npt.NDArray[np.int64]
    structure: Structure
    kept: Kept

    def rows(self, layout: Layout, x: Array, *, changes: bool = True) -> Rows:
        """The linear model at `x`, with its derivatives where `changes`."""
        theta, f = x[self.offsets], self.observed.frequency
        H = self.structure.dynamic_mass(layout, x, f)
        a0, a1 = self.chain.rows(theta, f)
        if not changes:
            return Rows(a0=a0, a1=a1, dynamic_mass=H)
        structure = model.whole(self.structure.derivatives(layout, x, f)).transpose(1, 2, 3, 0)
        return Rows(a0=a0, a1=a1, dynamic_mass=H, chain=self.chain.derivatives(theta, f, H), structure=structure)

    def cost(self, layout: Layout, x: Array) -> float:
        """Half the sum of squares at `x`."""
        return likelihood.cost(self.observed, self.rows(layout, x, changes=False))

    def near(self, layout: Layout, x: Array, within: float) -> "NearPart":
        """The cost near `x`: the one that was told before where it says that of `x` to `within`, else anew."""
        of = partial(NearPart, part=self, layout=layout, selection=self.selection(layout), exact=self.cost(layout, x))
        if self.kept.about is not None:
            last = of(about=self.kept.about, known=True)
            if abs(last.cost(x) - last.exact) <= within:
                return last
        theta, f = x[self.offsets], self.observed.frequency
        H, (a0, a1) = self.structure.dynamic_mass(layout, x, f), self.chain.rows(theta, f)
        rows = Rows(a0=a0, a1=a1, dynamic_mass=H, chain=self.chain.derivatives(theta, f, H))
        self.kept.about = theta, H, likelihood.near(self.observed, rows)
        return of(about=self.kept.about, known=False)

    def selection(self, layout: Layout) -> Array:
        """(own, len(layout)): chain offsets, the ten and the elastic parameters from the joint vector."""
        chain = np.zeros((len(self.offsets), len(layout)))
        chain[np.arange(len(self.offsets)), self.offsets] = 1.0
        return np.vstack([chain, self.structure.selection(layout)])


@dataclass(frozen=True, eq=False, kw_only=True)
class NearPart:
    """The cost of one campaign near a point, see `likelihood.Near`: `exact` where it was asked for, `known` before or not."""

    part: Part
    layout: Layout
    selection: Array
    about: tuple[Array, ComplexArray, likelihood.Near]
    exact: float
    known: bool

    def cost(self, x: Array) -> float:
        """At the joint vector `x`."""
        return self.about[2].cost(*self._away(x))

    def normal(self, x: Array) -> Normal:
        """The same to second order."""
        part, S = self.part, self.selection
        own = self.about[2].normal(*self._away(x), part.structure.derivatives(self.layout, x, part.observed.frequency))
        return Normal(cost=own.cost, gradient=S.T @ own.gradient, matrix=S.T @ own.matrix @ S)

    def _away(self, x: Array) -> tuple[Array, ComplexArray]:
        theta, H, _ = self.about
        now = self.part.structure.dynamic_mass(self.layout, x, self.part.observed.frequency)
        return x[self.part.offsets] - theta, (now - H)[:, *model.UPPER]


def normals(parts: Sequence[Part], layout: Layout, x: Array) -> list[Normal]:
    """The normal equations of every campaign in the joint vector."""
    found = []
    for part in parts:
        own, S = likelihood.normal(part.observed, part.rows(layout, x)), part.selection(layout)
        found.append(Normal(cost=own.cost, gradient=S.T @ own.gradient, matrix=S.T @ own.matrix @ S))
    return found


# Elastic terms as a block of the joint vector: where they begin, and the little that is known of them before.
#
# What no measurement of ours says: participation cannot exceed the mass that there is, a residual is at most of the size of the
# mass matrix at 20 Hz, coupled damping is a share below 1. Frequencies and damping are free within far more than any fit leaves.

FAMILY = "elasticity"

FREQUENCY = 0.3
"""Standard deviation of ln f about the start."""

DAMPING = 1.0
"""Standard deviation of ln zeta about the start."""

COUPLED = 0.5
"""Standard deviation of the damping of a pair, as a share of what its two modes have; a layer that both shear gives nearly 1."""

FELT = 1e-3
"""How much of another mode's participation a resonance must be able to take over, through damping, for the pair to count."""

STIFF = (20.0 / 150.0) ** 2
"""Standard deviation of the residual of a nearly rigid body, as a share of its mass matrix at 20 Hz: a first mode at 150 Hz."""


def of_article(
    name: str, ten: Array, terms: ElasticTerms, *, pairs: tuple[tuple[int, int], ...] | None = None
) -> tuple[model.ElasticLayout, Block]:
    """The block of an elastic article beginning at `terms`, with the set-up's ten parameters (10,) for its size.

    Damping is coupled in `pairs`, by default wherever it could show.
    """
    layout = model.ElasticLayout(modes=len(terms.frequency), pairs=felt(terms) if pairs is None else pairs)
    start = model.pack(np.zeros(10), terms, layout)[10:]
    size = _size(ten)
    deviation, mean = np.full(len(start) + 10, np.inf), np.zeros(len(start) + 10)
    mean[10:] = start
    places = layout.blocks
    deviation[places["frequency"]], deviation[places["damping"]] = FREQUENCY, DAMPING
    deviation[places["pairs"]], mean[places["pairs"]] = COUPLED, 0.0
    deviation[places["participation"]], mean[places["participation"]] = np.tile(size, layout.modes), 0.0
    deviation[places["residual"]], mean[places["residual"]] = np.outer(size, size)[model.UPPER], 0.0
    made = block(name, layout.names[10:], start, deviation=deviation[10:], mean=mean[10:], families=FAMILY)
    return layout, made


def of_rigid(name: str, ten: Array) -> tuple[model.ElasticLayout, Block]:
    """The block of a body that is nearly rigid: a residual about zero."""
    layout = model.ElasticLayout(modes=0)
    size = _size(ten)
    deviation = STIFF * np.outer(size, size)[model.UPPER]
    return layout, block(name, layout.names[10:], np.zeros(21), deviation=deviation, families=FAMILY)


def felt(terms: ElasticTerms) -> tuple[tuple[int, int], ...]:
    """Pairs (r, s), r < s, in which coupled damping can show: at resonance r, omega_r C_rs / (omega_s² - omega_r²) of mode s."""
    w2, C = (2 * np.pi * terms.frequency) ** 2, np.diag(terms.damping)
    most = np.sqrt(np.outer(C, C)) * np.sqrt(np.maximum(w2[:, None], w2))
    apart = np.maximum(np.abs(w2[:, None] - w2), most)
    felt = np.triu(most > FELT * np.maximum(apart, np.finfo(np.float64).tiny), 1)
    return tuple((int(r), int(s)) for r, s in zip(*np.nonzero(felt), strict=True))


def _size(ten: Array) -> Array:
    """(6,) [kg^0.5]: square roots of the diagonal of the mass matrix in the units of `identification.elastic.model`."""
    diagonal = np.abs(np.diag(Inertia(parameters=ten).mass_matrix)) / np.square(model.SCALE)
    return np.asarray(np.sqrt(np.maximum(diagonal, 1e-6 * diagonal.max())))


# From the evidence to the joint problem: what campaigns share, what is known beforehand, where the iteration begins.

HELD = (
    "spectra of peak-reference-hold are biased near lightly damped modes, by tens of per cent at the peak; elastic terms "
    "follow the bias. Full-record spectra have none of it"
)


@dataclass(frozen=True, eq=False, kw_only=True)
class CampaignProblem:
    """One campaign of the joint problem.

    Attributes
    ----------
    name : for messages
    spectra : as measured
    chain : of its channels
    chain_block : in the joint layout, that of its hardware
    structure : what stood on the load cells
    lines : indices that are used
    kept : by floor and lines; whatever the structure becomes
    """

    name: str
    spectra: Spectra
    chain: Chain
    chain_block: str
    structure: Structure
    lines: likelihood.Indices
    kept: dict[tuple[float, bytes], Kept] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class Assembly:
    """The joint problem, ready to be solved; the article's ten parameters are the block "article".

    Attributes
    ----------
    layout : of the joint vector
    campaigns : the article's first
    facts : classical results on the article
    drift : (10,) how far a rigid fit of the article moves over the band; zero where elastic terms are fitted
    warnings : sentences
    """

    layout: Layout
    campaigns: tuple[CampaignProblem, ...]
    facts: tuple[Fact, ...] = ()
    drift: Array = field(default_factory=lambda: np.zeros(10))
    warnings: tuple[str, ...] = ()

    def knowledge(self, x: Array) -> tuple[Array, Array]:
        """Whitened residuals (p,) at `x` of all that is known beforehand or from elsewhere, and their derivatives (p, k)."""
        rows, values, _ = self.layout.knowledge
        if not self.facts:
            return rows @ x - values, rows
        article = self.layout.at("article")
        left, change = request.equations(self.facts, x[article])
        own = np.zeros((len(left), len(x)))
        own[:, article] = change
        return np.concatenate([rows @ x - values, left]), np.vstack([rows, own])

    @property
    def families(self) -> tuple[str, ...]:
        """(p,) the input that every row of `knowledge` belongs to."""
        return (*self.layout.knowledge[2], *(request.name(fact) for fact in self.facts))

    def parts(self, floor: float) -> list[Part]:
        """The campaigns with weights by a model-error `floor`."""
        found = []
        for one in self.campaigns:
            at, names = self.layout.at(one.chain_block), self.layout.block(one.chain_block).names
            offsets = [at.start + names.index(parameter.name) for parameter in one.chain.parameters]
            which = floor, one.lines.tobytes()
            if which not in one.kept:
                one.kept[which] = Kept(observed=observed(one.spectra, one.chain.columns, one.lines, floor))
            found.append(
                Part(
                    name=one.name,
                    observed=one.kept[which].observed,
                    chain=one.chain,
                    offsets=np.array(offsets, dtype=np.int64),
                    structure=one.structure,
                    kept=one.kept[which],
                )
            )
        return found

    @property
    def modes(self) -> int:
        """Poles of the article."""
        elastic = self.campaigns[0].structure.elastic
        return 0 if elastic is None else elastic.modes

    def modes_beyond(self, x: Array) -> int:
        """Poles of the article above the band at `x` (k,)."""
        return int(np.sum(self.campaigns[0].structure.terms(self.layout, x).frequency > self.band[1]))

    @property
    def band(self) -> tuple[float, float]:
        """(low, high) [Hz] of the article's lines."""
        frequency = self.campaigns[0].spectra.frequency[self.campaigns[0].lines]
        return float(frequency[0]), float(frequency[-1])


def assembled(evidence: Evidence, settings: Settings) -> Assembly:
    """The joint problem of `evidence`.

    Raises
    ------
    BadInput : tare and article of different hardware without `settings.any_hardware`; facts that cannot be used.
    """
    request.require_known(evidence.facts)
    groups, warnings = request.hardware_groups(evidence, settings)
    tares = [setup(tare.spectra, replace(settings, modes=0)) for tare in evidence.tares]
    whole = setup(evidence.article, settings)
    # By group of hardware the FMD and its ten parameters at the start, where a tare or `evidence.fmd` tells them
    bodies: dict[int, tuple[Body, Array]] = {}
    blocks: list[Block] = []
    if evidence.fmd is not None:
        bodies[0] = (_rooted("fmd:0", evidence.fmd, blocks), evidence.fmd.inertia.parameters)
    for group in sorted(set(groups) - set(bodies)):
        left = [s.ten - t.known.inertia.parameters for s, t, g in zip(tares, evidence.tares, groups, strict=True) if g == group]
        mean = np.mean(left, axis=0)
        bodies[group] = (Body(block=f"fmd:{group}"), mean)
        blocks.append(block(f"fmd:{group}", PARAMETERS, mean))
    own = bodies.get(0)
    if own is None and evidence.facts:
        fact = evidence.facts[0]
        problem = "it is about the article alone, and nothing tells the FMD from the article"
        raise BadInput(fact.source or "facts", fact.quantity, problem, "Give a tare, or the FMD's inertia")
    start = whole.ten if own is None else whole.ten - own[1]
    blocks.append(block("article", PARAMETERS, start))
    standing = (Body(block="article"),) if own is None else (own[0], Body(block="article"))
    campaigns = [_campaign("article", evidence.article, 0, standing, whole, settings, blocks)]
    for k, (tare, found, group) in enumerate(zip(evidence.tares, tares, groups, strict=True)):
        standing = (bodies[group][0], _rooted(f"known:{k}", tare.known, blocks))
        campaigns.append(_campaign(f"tare:{k}", tare.spectra, group, standing, found, settings, blocks))
    said = (
        *warnings,
        *([] if own is not None else [request.WITHOUT_TARE]),
        *([HELD] if evidence.article.method == "peak-reference-hold" and settings.modes != 0 else []),
    )
    moved = drift(whole.estimate.dynamic_mass, CHAIN_ERROR) if settings.modes == 0 else np.zeros(10)
    layout = _layout(campaigns, blocks)
    return Assembly(layout=layout, campaigns=tuple(campaigns), facts=evidence.facts, drift=moved, warnings=said)


def of_fmd(tares: Sequence[TareSpectra], settings: Settings) -> Assembly:
    """The joint problem of several `tares` of one hardware, in which the FMD is what is asked for: the block "article"."""
    found = [setup(tare.spectra, replace(settings, modes=0)) for tare in tares]
    left = [one.ten - tare.known.inertia.parameters for one, tare in zip(found, tares, strict=True)]
    blocks, campaigns = [block("article", PARAMETERS, np.mean(left, axis=0))], []
    for k, (tare, one) in enumerate(zip(tares, found, strict=True)):
        standing = (Body(block="article"), _rooted(f"known:{k}", tare.known, blocks))
        campaigns.append(_campaign(f"tare:{k}", tare.spectra, 0, standing, one, settings, blocks))
    return Assembly(layout=_layout(campaigns, blocks), campaigns=tuple(campaigns))


def _layout(campaigns: Sequence[CampaignProblem], blocks: Sequence[Block]) -> Layout:
    """One block for each hardware, with every parameter that the chain of one of its campaigns has, and then `blocks`."""
    chains = []
    for called in dict.fromkeys(one.chain_block for one in campaigns):
        known = {p.name: p for one in campaigns if one.chain_block == called for p in one.chain.parameters}
        deviation, families = [p.tolerance for p in known.values()], [p.family for p in known.values()]
        chains.append(block(called, list(known), np.zeros(len(known)), deviation=deviation, families=families))
    return Layout(blocks=(*chains, *blocks))


def _rooted(name: str, known: Known, blocks: list[Block]) -> Body:
    """What stood in a tare, or the FMD from before; what is not exact of it is added to `blocks`."""
    # A body known to be `known.inertia.parameters` (10,) with `known.covariance` (10, 10): z is of unit variance, as long as the
    # covariance has rank
    scale = np.sqrt(np.diag(known.covariance))
    safe = np.where(scale > 0, scale, 1.0)
    values, vectors = np.linalg.eigh(known.covariance / np.outer(safe, safe))
    kept = values > 1e-12 * max(float(values[-1]), 1e-300) if np.any(scale > 0) else np.zeros(10, dtype=bool)
    root = safe[:, None] * vectors[:, kept] * np.sqrt(values[kept])
    body = Body(block=name if np.any(kept) else "", mean=known.inertia.parameters, root=root)
    if body.block:
        names = [f"{name}[{k}]" for k in range(body.root.shape[1])]
        blocks.append(block(name, names, np.zeros(len(names)), deviation=1.0, families="tare"))
    return body


def _campaign(
    name: str, spectra: Spectra, group: int, standing: tuple[Body, ...], found: Setup, settings: Settings, blocks: list[Block]
) -> CampaignProblem:
    """One campaign; its elastic terms are added to `blocks`."""
    layout = None
    if settings.modes != 0:
        called = f"elastic:{name}"
        bends = name == "article" and len(found.terms.frequency) > 0  # what has no pole in reach of the band is nearly rigid
        layout, made = of_article(called, found.ten, found.terms) if bends else of_rigid(called, found.ten)
        blocks.append(made)
    return CampaignProblem(
        name=name,
        spectra=spectra,
        chain=chain(spectra.table, settings.tolerances, stiffness=settings.stiffness, gravity=settings.gravity),
        chain_block=f"chain:{group}",
        structure=Structure(bodies=standing, elastic=layout, elastic_block=f"elastic:{name}"),
        lines=likelihood.chosen(spectra.frequency, found.terms),
    )
