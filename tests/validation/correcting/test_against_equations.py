"""Signs and sizes of corrections are those of the measurement chain and of the catalogue's equations, a user's own among them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from geometry.errors import BadInput
from identification import campaign_file
from identification.campaign import Campaign, Recording
from identification.chain import chain
from validation.correct import corrected
from validation.effects import catalogue
from validation.effects import own as own_effects
from validation.effects.catalogue import FAMILIES, Named, parse
from validation.effects.effect import CHANNEL_STAGE, FORCES, Family, SizeSpec
from validation.effects.stages import ChannelResponse

LINES = np.linspace(5.0, 30.0, 6)
MASS = np.diag([40.0, 41.0, 42.0, 3.0, 3.5, 0.8]).astype(complex)


def spectra(campaign: Campaign, values: np.ndarray) -> Campaign:
    """`campaign` with one run of these spectra (n, c)."""
    run = replace(campaign.runs[0], name="r")
    recording = Recording(names=campaign.table.names, values=values, frequency=LINES)
    return replace(campaign, runs=(run,), recordings={"r": recording})


def read_by_chain(campaign: Campaign, named: Named | None) -> np.ndarray:
    """(n, c) what the channels of its table read of some motion, with or without a fault."""
    made = chain(campaign.table, gravity=campaign.gravity, overrides={} if named is None else {named.id: 1.0})
    theta = made.theta({} if named is None else {named.id: named.value})
    A0, A1 = made.rows(theta, LINES)
    motion = np.array([1.0, -0.7, 0.9, 2.0 + 1j, -1.5, 0.8j])
    values = np.empty((len(LINES), len(campaign.table)), dtype=complex)
    values[:, list(made.columns)] = (A0 + A1 @ MASS) @ motion
    return values


def read_by_equation(campaign: Campaign, named: Named, values: np.ndarray) -> np.ndarray:
    change = FAMILIES[named.family].change
    assert change is not None
    reading = ChannelResponse(frequency=LINES, channels=campaign.table.names, rows=values[:, :, None])
    return np.asarray(change(reading, named.targets, named.values).rows[:, :, 0])


@pytest.fixture
def grown(monkeypatch) -> Callable[[Family], None]:
    """``grown(family)``: it is in the catalogue while the test runs."""
    return lambda family: monkeypatch.setitem(catalogue._found, family.name, family)


def own(change: Callable[..., ChannelResponse]) -> Family:
    size = SizeSpec(unit="1", low=-10.0, high=10.0)
    return Family(
        name="mine",
        side=FORCES,
        what="mine",
        targets=("force channel",),
        sizes=(size,),
        example="",
        stage=CHANNEL_STAGE,
        change=change,
    )


def leaking(reading: ChannelResponse, targets: tuple[str, ...], values: dict[str, float]) -> ChannelResponse:
    """A channel leaks into its neighbour, and droops."""
    rows = np.array(reading.rows)
    k = reading.column(targets[0])
    rows[:, k] /= 1 + 0.01j * reading.frequency[:, None]
    rows[:, k + 1] += values[""] * rows[:, k]
    return replace(reading, rows=rows)


def test_a_users_own_equation_is_inverted(tested, grown):
    grown(own(leaking))
    clean, named = read_by_chain(tested(), None), Named(family="mine", targets=("fmd-z1",), values={"": 0.3})
    faulty = spectra(tested(), read_by_equation(tested(), named, clean))
    made = corrected(faulty, named)
    assert made.channels == ("fmd-z1", "fmd-z2")
    np.testing.assert_allclose(made.campaign.recordings["r"].values, clean, rtol=1e-12)


def test_what_leaks_in_from_a_channel_that_is_right_is_taken_out(tested, grown):
    def leaking_alone(reading, targets, values):
        rows = np.array(reading.rows)
        k = reading.column(targets[0])
        rows[:, k + 1] += values[""] * rows[:, k]
        return replace(reading, rows=rows)

    grown(own(leaking_alone))
    clean, named = read_by_chain(tested(), None), Named(family="mine", targets=("fmd-z1",), values={"": 0.3})
    made = corrected(spectra(tested(), read_by_equation(tested(), named, clean)), named)
    assert made.channels == ("fmd-z2",)
    np.testing.assert_allclose(made.campaign.recordings["r"].values, clean, rtol=1e-12)


def test_an_equation_that_leaves_nothing_cannot_be_inverted(tested, grown):
    def dead(reading, targets, values):
        rows = np.array(reading.rows)
        rows[reading.frequency > 20, reading.column(targets[0])] = 0.0
        return replace(reading, rows=rows)

    grown(own(dead))
    named = Named(family="mine", targets=("fmd-z1",), values={"": 0.3})
    with pytest.raises(BadInput, match="mine:fmd-z1: cannot be taken out of a record: at 25 Hz its equation leaves nothing"):
        corrected(spectra(tested(), read_by_chain(tested(), None)), named)


def test_the_example_of_ones_own_is_taken_out_of_a_record(tested, root, grown):
    """Planted by the bilinear rule at 2048 Hz, which is off by (2 pi 32/2048)²/12 of omega tau = 0.2 at 32 Hz: 2e-4."""
    grown(own_effects.read(root / "examples" / "effects" / "force_lowpass.py"))
    effect = "force-lowpass:fmd-z2=1e-3"
    clean, faulty = tested(), tested(effect)
    made = corrected(faulty, parse(effect)).campaign
    for name, recording in clean.recordings.items():
        right = recording.channel("fmd-z2")
        before, after = (np.abs(one.recordings[name].channel("fmd-z2") - right).max() for one in (faulty, made))
        assert before > 0.02 * np.abs(right).max()
        assert after < 3e-4 * np.abs(right).max()


def test_ones_own_effects_take_part_in_both_commands(tested, run, refused, root):
    """``--effects-from`` comes before what it is needed for; the catalogue of this process is left as it was."""
    own, effect, campaign = str(root / "examples" / "effects"), "force-lowpass:fmd-z2=1e-3", tested()
    kept = campaign.runs[0]
    single = replace(campaign, runs=(kept,), recordings={kept.name: campaign.recordings[kept.name]})
    campaign_file.write("test", single)
    Path("mine.toml").write_text("format = 1\n[model]\narticle = 'fmd'\n[[effect]]\nid = 'force-lowpass:fmd-z2'\nvalue = 1e-3\n")
    assert "no effect is called 'force-lowpass'" in refused("model", "mine.toml")
    try:
        code, printed, _ = run("model", "mine.toml", "--effects-from", own)
        assert (code, 'id = "force-lowpass:fmd-z2"' in printed) == (0, True)
        assert run("correct", "test", effect, "--out", "clean", "--effects-from", own)[0] == 0
        found = campaign_file.read("clean").recordings[kept.name].channel("fmd-z2")
        right = corrected(single, parse(effect)).campaign.recordings[kept.name].channel("fmd-z2")
        np.testing.assert_allclose(found, right, atol=1e-12 * np.abs(right).max())
    finally:
        for path in [path for path in catalogue._files if str(path).startswith(own)]:
            catalogue._forget(catalogue._files.pop(path))
