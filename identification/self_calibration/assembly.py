"""From the evidence to the joint problem: what campaigns share, what is known beforehand, where the iteration begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.inertia import PARAMETERS
from identification import classical
from identification.drift import drift
from identification.evidence import Evidence, Settings, TareSpectra
from identification.measurement_chain import Chain, chain
from identification.request import Fact
from identification.self_calibration import elastic_block, hardware, lines
from identification.self_calibration.layout import Block, Layout, block
from identification.self_calibration.likelihood import observed
from identification.self_calibration.problem import Part
from identification.self_calibration.structure import Body, Structure, rooted
from identification.setup import CHAIN_ERROR, Setup, setup
from identification.spectra.line_spectra import Spectra

HELD = (
    "spectra of peak-reference-hold are biased near lightly damped modes, by tens of per cent at the peak; elastic terms "
    "follow the bias. Full-record spectra have none of it"
)

WITHOUT_TARE = "no tare and no known FMD: the result includes the moving part of the FMD"


@dataclass(frozen=True, eq=False, kw_only=True)
class Campaign:
    """One campaign of the joint problem.

    Attributes
    ----------
    name : for messages
    spectra : as measured
    chain : of its channels
    chain_block : in the joint layout, that of its hardware
    structure : what stood on the load cells
    lines : indices that are used
    """

    name: str
    spectra: Spectra
    chain: Chain
    chain_block: str
    structure: Structure
    lines: lines.Indices


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
    campaigns: tuple[Campaign, ...]
    facts: tuple[Fact, ...] = ()
    drift: Array = field(default_factory=lambda: np.zeros(10))
    warnings: tuple[str, ...] = ()

    def knowledge(self, x: Array) -> tuple[Array, Array]:
        """Whitened residuals (p,) at `x` of all that is known beforehand or from elsewhere, and their derivatives (p, k)."""
        rows, values, _ = self.layout.knowledge
        if not self.facts:
            return rows @ x - values, rows
        article = self.layout.at("article")
        left, change = classical.equations(self.facts, x[article])
        own = np.zeros((len(left), len(x)))
        own[:, article] = change
        return np.concatenate([rows @ x - values, left]), np.vstack([rows, own])

    @property
    def families(self) -> tuple[str, ...]:
        """(p,) the input that every row of `knowledge` belongs to."""
        return (*self.layout.knowledge[2], *(classical.name(fact) for fact in self.facts))

    def parts(self, floor: float) -> list[Part]:
        """The campaigns with weights by a model-error `floor`."""
        return [_part(self.layout, one, floor) for one in self.campaigns]

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
    classical.require_known(evidence.facts)
    groups, warnings = hardware.groups(evidence, settings)
    tares = [setup(tare.spectra, replace(settings, modes=0)) for tare in evidence.tares]
    whole = setup(evidence.article, settings)
    bodies, blocks = _fmds(evidence, tares, groups)
    own = bodies.get(0)
    if own is None and evidence.facts:
        raise _facts_without_tare(evidence.facts[0])
    start = whole.ten if own is None else whole.ten - own[1]
    blocks.append(block("article", PARAMETERS, start))
    standing = (Body(block="article"),) if own is None else (own[0], Body(block="article"))
    campaigns = [_campaign("article", evidence.article, 0, standing, whole, settings, blocks)]
    for k, (tare, found, group) in enumerate(zip(evidence.tares, tares, groups, strict=True)):
        standing = (bodies[group][0], _known(k, tare, blocks))
        campaigns.append(_campaign(f"tare:{k}", tare.spectra, group, standing, found, settings, blocks))
    said = (*warnings, *([] if own is not None else [WITHOUT_TARE]), *([HELD] if _held(evidence) and settings.modes != 0 else []))
    layout = Layout(blocks=(*_chains(campaigns), *blocks))
    moved = drift(whole.estimate.dynamic_mass, CHAIN_ERROR) if settings.modes == 0 else np.zeros(10)
    return Assembly(layout=layout, campaigns=tuple(campaigns), facts=evidence.facts, drift=moved, warnings=said)


def _held(evidence: Evidence) -> bool:
    return evidence.article.method == "peak-reference-hold"


def _facts_without_tare(fact: Fact) -> BadInput:
    return BadInput(
        source=fact.source or "facts",
        field=fact.quantity,
        problem="it is about the article alone, and nothing tells the FMD from the article",
        remedy="Give a tare, or the FMD's inertia",
    )


def of_fmd(tares: Sequence[TareSpectra], settings: Settings) -> Assembly:
    """The joint problem of several `tares` of one hardware, in which the FMD is what is asked for: the block "article"."""
    found = [setup(tare.spectra, replace(settings, modes=0)) for tare in tares]
    left = [one.ten - tare.known.inertia.parameters for one, tare in zip(found, tares, strict=True)]
    blocks, campaigns = [block("article", PARAMETERS, np.mean(left, axis=0))], []
    for k, (tare, one) in enumerate(zip(tares, found, strict=True)):
        known = _known(k, tare, blocks)
        campaigns.append(_campaign(f"tare:{k}", tare.spectra, 0, (Body(block="article"), known), one, settings, blocks))
    return Assembly(layout=Layout(blocks=(*_chains(campaigns), *blocks)), campaigns=tuple(campaigns))


def _known(k: int, tare: TareSpectra, blocks: list[Block]) -> Body:
    """The known article of a tare; what is not exact of it is added to `blocks`."""
    known = rooted(f"known:{k}", tare.known.inertia.parameters, tare.known.covariance)
    if known.block:
        blocks.append(_unit(known, "tare"))
    return known


def _fmds(evidence: Evidence, tares: list[Setup], groups: list[int]) -> tuple[dict[int, tuple[Body, Array]], list[Block]]:
    """By group of hardware the FMD and its ten parameters at the start; only what a tare or `evidence.fmd` tells is there."""
    bodies: dict[int, tuple[Body, Array]] = {}
    blocks: list[Block] = []
    if evidence.fmd is not None:
        body = rooted("fmd:0", evidence.fmd.inertia.parameters, evidence.fmd.covariance)
        bodies[0] = (body, body.mean)
        blocks += [_unit(body, "tare")] if body.block else []
    for group in sorted(set(groups) - set(bodies)):
        left = [s.ten - t.known.inertia.parameters for s, t, g in zip(tares, evidence.tares, groups, strict=True) if g == group]
        start = np.mean(left, axis=0)
        bodies[group] = (Body(block=f"fmd:{group}"), start)
        blocks.append(block(f"fmd:{group}", PARAMETERS, start))
    return bodies, blocks


def _unit(body: Body, family: str) -> Block:
    """The block of a `rooted` body."""
    count = body.root.shape[1]
    return block(body.block, [f"{body.block}[{k}]" for k in range(count)], np.zeros(count), deviation=1.0, families=family)


def _campaign(
    name: str, spectra: Spectra, group: int, standing: tuple[Body, ...], found: Setup, settings: Settings, blocks: list[Block]
) -> Campaign:
    """One campaign; its elastic terms are added to `blocks`."""
    layout = None
    if settings.modes != 0:
        called = f"elastic:{name}"
        bends = name == "article" and len(found.terms.frequency) > 0  # what has no pole in reach of the band is nearly rigid
        layout, made = (
            elastic_block.of_article(called, found.ten, found.terms) if bends else elastic_block.of_rigid(called, found.ten)
        )
        blocks.append(made)
    return Campaign(
        name=name,
        spectra=spectra,
        chain=chain(spectra.table, settings.tolerances, stiffness=settings.stiffness, gravity=settings.gravity),
        chain_block=f"chain:{group}",
        structure=Structure(bodies=standing, elastic=layout, elastic_block=f"elastic:{name}"),
        lines=lines.chosen(spectra.frequency, found.terms),
    )


def _chains(campaigns: list[Campaign]) -> list[Block]:
    """One block for each hardware: every parameter that the chain of one of its campaigns has."""
    made = []
    for called in dict.fromkeys(one.chain_block for one in campaigns):
        known = {p.name: p for one in campaigns if one.chain_block == called for p in one.chain.parameters}
        deviation, families = [p.tolerance for p in known.values()], [p.family for p in known.values()]
        made.append(block(called, list(known), np.zeros(len(known)), deviation=deviation, families=families))
    return made


def _part(layout: Layout, one: Campaign, floor: float) -> Part:
    at, names = layout.at(one.chain_block), layout.block(one.chain_block).names
    offsets = [at.start + names.index(parameter.name) for parameter in one.chain.parameters]
    return Part(
        name=one.name,
        observed=observed(one.spectra, one.chain.columns, one.lines, floor),
        chain=one.chain,
        offsets=np.array(offsets, dtype=np.int64),
        structure=one.structure,
    )
