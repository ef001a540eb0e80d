"""A laboratory learns itself: how far mountings scatter, what is left of its tolerances, and what is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.laboratories.__main__ import ARTICLES, analyst
from benchmarks.laboratories.shaking import series
from geometry.errors import BadInput
from identification import campaign_file
from validation.diagnose.diagnose import diagnosed
from validation.diagnose.diagnosis import NOTHING
from validation.identify.laboratory import laboratory
from validation.model import model_file
from validation.model.learnt import Spread
from validation.study import Data, Study

CUBOID, BLADE = ARTICLES


def test_the_scatter_of_mountings_is_in_its_interval_as_often_as_it_says():
    """Of 400 laboratories with six draws each, whose scatter is drawn from the prior itself, 90 % but for chance."""
    rng, before, inside = np.random.default_rng(5), 1e-3, 0
    for _ in range(400):
        true = before * np.exp2(rng.standard_normal())
        sd_of_data = 0.2e-3
        seen = true * rng.standard_normal(6) + sd_of_data * rng.standard_normal(6)
        posterior = 1 / (1 / sd_of_data**2 + 1 / before**2)
        told = Spread.of_draws([(x * posterior / sd_of_data**2, np.sqrt(posterior), before) for x in seen])
        inside += told.low <= true <= told.high
    assert abs(inside / 400 - 0.9) < 3 * np.sqrt(0.9 * 0.1 / 400)


def test_a_class_that_admits_nothing_learns_nothing_and_a_file_that_is_there_says_its_class(refused, tmp_path: Path):
    model = model_file.of_text('format = 1\n[model]\narticle = "fmd+disc+cuboid"\n', "m.toml")
    with pytest.raises(BadInput, match="metrology"):
        laboratory(model, ())
    campaign_file.write(tmp_path / "one", replace(series(1, [CUBOID], "calibrated")[0], source="one"))
    (tmp_path / "m.toml").write_text('format = 1\n[model]\narticle = "fmd+disc+cuboid"\n')
    one, file = str(tmp_path / "one"), str(tmp_path / "m.toml")
    assert "metrology" in refused("laboratory", one, "--model", file)
    assert "[tolerances]" in refused("laboratory", one, "--model", file, "--class", "calibrated")
    assert "as-delivered" in refused("laboratory", one, "--class", "delivered")
    assert "no such folder" in refused("laboratory", str(tmp_path / "two"))


@pytest.mark.proof
def test_three_mountings_teach_and_the_fourth_is_quiet():
    """Beside it Clumod, which the laboratory has never seen; delays are told more than twice as well."""
    model = model_file.of_text(analyst("as-delivered"), "drawn.toml")
    campaigns = series(1, [CUBOID, CUBOID, CUBOID, CUBOID, BLADE], "as-delivered")
    found = laboratory(model, campaigns[:3])
    assert [one.quiet for one in found.held_out] == [True] * 3
    smallest = {}
    for what, one in {"class": model, "learnt": model.knowing(found.learnt)}.items():
        answer = diagnosed(Study.of(one, Data(campaigns=campaigns[3:])))
        assert answer.verdict == NOTHING, answer.text
        smallest[what] = {each.id: each.size for each in answer.detectable}
    assert smallest["learnt"]["force-delay:fmd-x12"] < 0.5 * smallest["class"]["force-delay:fmd-x12"]
