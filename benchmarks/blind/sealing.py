"""A case becomes a folder, as a laboratory would hand it over, and its truth, which goes elsewhere.

The folder holds the campaigns, the model file, and the settings (`benchmarks.blind.names`). Neither seed nor truth is
in it, nor the name of the case, nor its kind.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.blind.drawing import foreign
from benchmarks.blind.drawing.case import BLADE, Case, Planted
from benchmarks.blind.names import MODEL, SETTINGS, Json
from benchmarks.cross_check_proof import STIFFNESS, SWEEPS, words
from geometry.atomic import write_text
from identification import campaign_file
from identification.campaign import Processing
from validation.effects.catalogue import Named, parse
from validation.model import model_file
from validation.model.model import Model
from validation.virtual_test.plan import Plan, PlantedEffect
from validation.virtual_test.planted import planted, reaching
from validation.virtual_test.simulate import simulate

TITLE = "a laboratory"


def sealed(
    case: Case,
    folder: Path,
    *,
    driven: Mapping[str, Any] = SWEEPS,
    processing: Processing | None = None,
) -> Json:
    """The truth of `case`, whose campaigns are simulated into `folder`.

    Parameters
    ----------
    driven : how every virtual test is driven, fields of `Plan`
    processing : lines that the campaign files ask for; those of the paper where nothing is said

    Raises
    ------
    BadInput, CheckFailed : an effect that cannot be planted, a rig that cannot be driven.
    OSError : the folder cannot be written.
    """
    drawn: dict[str, float] = {}
    for article in case.articles:
        test = simulate(_planned(case, Plan(article=article, seed=case.laboratory, **driven)))
        campaign_file.write(folder / article, replace(test.campaign, processing=processing), ending=".h5")
        tolerances: Any = test.truth["tolerances"]
        drawn |= {name: value for name, value in tolerances.items() if isinstance(value, float)}
    write_text(folder / MODEL, model_file.text(known()))
    settings = {"data": list(case.articles), "hold_out": list(case.hold_out), "leave_out": list(case.leave_out)}
    write_text(folder / SETTINGS, json.dumps(settings))
    return truth(case, drawn)


def known() -> Model:
    """What the laboratory knows beforehand."""
    return Model(source=MODEL, title=TITLE, article=BLADE, cell_stiffness=np.array(STIFFNESS))


def truth(case: Case, drawn: Mapping[str, float]) -> Json:
    """What `case` is, and the sizes that really are: what was planted on top of what the laboratory has `drawn` of the same."""
    return {
        "name": case.name,
        "kind": case.kind,
        "laboratory": case.laboratory,
        "articles": list(case.articles),
        "leave_out": list(case.leave_out),
        "hold_out": list(case.hold_out),
        "null": case.null,
        "planted": [_stated(one, drawn) for one in case.planted],
    }


def _stated(one: Planted, drawn: Mapping[str, float]) -> Json:
    if one.text.startswith(foreign.PREFIX):
        id, _, size = one.text.partition("=")
        return {"id": id, "sizes": {"": float(size)}, "multiple": one.multiple, "told": one.told}
    named = parse(one.text, words())
    sizes = {key: drawn.get(named.id, value) if not key else value for key, value in named.values.items()}
    return {"id": named.id, "sizes": sizes, "multiple": one.multiple, "told": one.told}


def _planned(case: Case, plan: Plan) -> Plan:
    """`plan` with the effects of `case` that reach it."""
    texts = [one.text for one in case.planted]
    of_catalogue: list[Named] = [parse(text, words()) for text in texts if not text.startswith(foreign.PREFIX)]
    nobodys: list[PlantedEffect] = [foreign.of_text(text) for text in texts if text.startswith(foreign.PREFIX)]
    return replace(plan, effects=(*planted(reaching(of_catalogue, plan)), *nobodys))
