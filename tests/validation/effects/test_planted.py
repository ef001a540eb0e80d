"""Every measurement-side effect makes of the channels what its equation in the catalogue says, in size, sign and unit.

All six axes are driven at once and nothing else is drawn, so a record with an effect is held against the same without, channel by
channel and line by line; what an effect does not name must stay as it is to the last bit.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from geometry.errors import BadInput
from geometry.sensors import Channel, Tolerances, row, summation
from validation.effects.catalogue import FAMILIES, parse_all
from validation.virtual_test.planted import planted

RATE = 256.0
F_X, F_Y, F_Z, M_X, M_Y = range(5)
ROUNDING = 1e-9
"""Of the largest value: what sums of thousands of samples leave."""

FILTERED = 2e-4
"""Of the largest value: rule and step of what is computed from sample to sample, at 64 samples a period and more."""


def close(found: npt.ArrayLike, expected: npt.ArrayLike, share: float = ROUNDING) -> None:
    """Equal to `share` of the largest expected value."""
    assert_allclose(found, expected, rtol=0, atol=share * np.max(np.abs(expected)))


def untouched(found: Any, plain: Any, *names: str) -> None:
    """All channels but `names` are the same, to what another order of the same sums leaves."""
    for k, name in enumerate(plain.table.names):
        if name not in names:
            close(found.values[:, k], plain.values[:, k], 1e-11)


@pytest.mark.parametrize(
    ("effect", "channels", "factor"),
    [
        ("force-gain:fmd-z2=0.08", ["fmd-z2"], 1.08),
        ("accelerometer-gain:cover-z3=-0.05", ["cover-z3"], 0.95),
        ("load-path-shunt:x=0.03", ["fmd-x12", "fmd-x34"], 0.97),
        ("load-path-shunt:z=0.2", ["fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4"], 0.8),
        ("polarity:table-y1", ["table-y1"], -1.0),
        ("polarity:fmd-y23", ["fmd-y23"], -1.0),
        ("unit:cover-z3=g", ["cover-z3"], 1 / 9.80665),
        ("unit:fmd-z1=0.001", ["fmd-z1"], 1e-3),
    ],
)
def test_a_channel_is_multiplied_and_no_other_touched(recorder, plain, effect, channels, factor):
    found = recorder(effect)
    for name in channels:
        close(found.values[:, found.column(name)], factor * plain.values[:, plain.column(name)])
    untouched(found, plain, *channels)


@pytest.mark.parametrize(
    ("effect", "channels", "seconds"),
    [
        ("force-delay:fmd-y14=0.002", ["fmd-y14"], 0.002),
        ("accelerometer-delay:cover-x2=-0.0005", ["cover-x2"], -0.0005),
        ("board-delay:table=300e-6", ["table-z1", "table-z2", "table-z3", "table-x1", "table-y1", "table-y2"], 300e-6),
        ("board-delay:cover=300e-6", [f"cover-{k}" for k in ("z1", "z2", "z3", "z4", "x1", "x2", "y1", "y2")], 300e-6),
        ("board-delay:force=300e-6", [f"fmd-{k}" for k in ("x12", "x34", "y14", "y23", "z1", "z2", "z3", "z4")], 300e-6),
    ],
)
def test_a_late_channel_turns_by_minus_omega_tau(recorder, plain, effect, channels, seconds):
    found = recorder(effect)
    for name in channels:
        close(found.spectrum(name), np.exp(-1j * found.omega * seconds) * plain.spectrum(name), FILTERED)
    untouched(found, plain, *channels)


def test_two_delays_of_a_channel_add_and_a_charge_amplifier_has_a_corner_of_first_order(recorder, plain):
    found = recorder("board-delay:force=200e-6", "force-delay:fmd-z1=300e-6")
    close(found.spectrum("fmd-z1"), np.exp(-1j * found.omega * 500e-6) * plain.spectrum("fmd-z1"), FILTERED)
    close(found.spectrum("fmd-z2"), np.exp(-1j * found.omega * 200e-6) * plain.spectrum("fmd-z2"), FILTERED)
    found = recorder("force-highpass:fmd-x12=2.5")
    close(found.spectrum("fmd-x12"), plain.spectrum("fmd-x12") / (1 - 2.5j / found.frequency), FILTERED)
    untouched(found, plain, "fmd-x12")


@pytest.mark.parametrize(("pair", "shown", "source"), [("zx", F_Z, F_X), ("xz", F_X, F_Z), ("yx", F_Y, F_X), ("zy", F_Z, F_Y)])
def test_crosstalk_shows_one_resultant_in_another(recorder, plain, pair, shown, source):
    found, X = recorder(f"force-crosstalk:{pair}=0.04"), np.eye(6)
    X[shown, source] = 0.04
    close(found.loads(), plain.loads() @ X.T)
    untouched(found, plain, *(name for name in plain.table.names if name.startswith(f"fmd-{pair[0]}")))


@pytest.mark.parametrize(("axis", "moment", "force", "sign"), [("x", M_Y, F_X, -1.0), ("y", M_X, F_Y, 1.0)])
def test_a_force_off_the_plane_takes_its_moment_along(recorder, plain, axis, moment, force, sign):
    found, expected = recorder(f"force-plane-offset:{axis}=0.004"), plain.loads().copy()
    expected[:, moment] += sign * 0.004 * expected[:, force]
    close(found.loads(), expected)
    untouched(found, plain, "fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4")


@pytest.mark.parametrize(("direction", "axes", "stiffness"), [("lateral", (F_X, F_Y), 4e8), ("vertical", (F_Z,), 2e9)])
def test_a_compliant_fmd_lets_the_table_run_ahead(recorder, direction, axes, stiffness):
    """a_table = a_cover - omega² C f along an axis, for cells in the plane of F; C a hundred times that of four in parallel."""
    found = recorder(f"fmd-compliance:{direction}=100", simulation_rate=16 * RATE)
    for axis in axes:
        ahead = (found.motion("table") - found.motion("cover"))[:, axis]
        force = -(found.omega**2) * found.loads()[:, axis]
        compliance = np.vdot(force, ahead) / np.vdot(force, force)
        assert_allclose(compliance.real, 100 / (4 * stiffness), rtol=0.02)  # the step's own error, which falls with its square


@pytest.mark.parametrize(("cell", "change"), [("1x", 0.5), ("3z", -0.3), ("2y", 2.0)])
def test_a_stiff_cell_takes_load_from_the_others(recorder, cell, change):
    """S K_c B (B^T K_c B)^-1 F: eight channels hold six loads, so that the other two must follow from how stiff the cells are."""
    found = recorder(f"cell-stiffness:{cell}={change}")
    channels = [found.table.channels[k] for k in found.table.select(quantity="force")]
    measured = found.spectra[:, found.table.select(quantity="force")]
    of, alike = summation(channels, found.table.origin), np.array([4e8, 4e8, 2e9])
    k = alike[np.argmax(np.abs(of.gives[:3]), axis=0)]
    changed = np.where(np.array(names_of_elements(channels)) == cell, 1 + change, 1.0)

    def unexplained(stiffness):
        shares = of.adds @ (stiffness[:, None] * of.gives.T) @ np.linalg.inv(of.gives @ (stiffness[:, None] * of.gives.T))
        left = measured - measured @ np.linalg.pinv(shares).T @ shares.T
        return float(np.linalg.norm(left) / np.linalg.norm(measured))

    assert unexplained(changed * k) < 1e-4 < 1e-2 * unexplained(k)  # cells damp as well, a little


def names_of_elements(channels: Sequence[Channel]) -> list[str]:
    """``1x`` and so on, cells counter-clockwise from +x +y."""
    corners = {(1, 1): 1, (-1, 1): 2, (-1, -1): 3, (1, -1): 4}
    places = [place for channel in channels for place in channel.places]
    signs = [tuple(int(np.sign(value)) for value in place.position[:2]) for place in places]
    return [f"{corners[at]}{'xyz'[int(np.argmax(p.direction))]}" for at, p in zip(signs, places, strict=True)]  # type: ignore[index]


@pytest.mark.parametrize(("channel", "axis"), [("cover-z3", "x"), ("cover-x1", "z"), ("table-y2", "x")])
def test_a_displaced_accelerometer_reads_its_true_place(recorder, plain, channel, axis):
    found = recorder(f"accelerometer-position:{channel}:{axis}=0.02")
    nominal, offset = plain.table.channels[plain.column(channel)], 0.02 * np.eye(3)["xyz".index(axis)]
    place = nominal.places[0]
    moved = type(place)(position=place.position + offset, direction=place.direction)
    motion = plain.motion(nominal.group)
    close(found.spectrum(channel), motion @ row(moved, plain.table.origin))
    untouched(found, plain, channel)
    assert np.max(np.abs(found.spectrum(channel) - plain.spectrum(channel))) > 1e-3 * np.max(np.abs(plain.spectrum(channel)))


@pytest.mark.parametrize(("channel", "axis", "leans"), [("cover-z3", "x", (0, -1, 0)), ("cover-x1", "z", (0, 1, 0))])
def test_a_misaligned_accelerometer_is_turned_about_its_axis(recorder, plain, channel, axis, leans):
    """Turned by a small v about an axis e, a direction d leans by v e x d."""
    found = recorder(f"accelerometer-misalignment:{channel}:{axis}=0.01")
    nominal = plain.table.channels[plain.column(channel)]
    place = nominal.places[0]
    turned = type(place)(position=place.position, direction=np.cos(0.01) * place.direction + np.sin(0.01) * np.array(leans))
    close(found.spectrum(channel), plain.motion(nominal.group) @ row(turned, plain.table.origin))
    untouched(found, plain, channel)


@pytest.mark.parametrize(("effect", "sign"), [("accelerometer-tilt=0", -1.0), ("gravity=0", 1.0)])
@pytest.mark.parametrize("group", ["table", "cover"])
def test_one_half_of_gravity_leaves_g_over_omega_squared(recorder, plain, effect, sign, group):
    """A tilting sensor reads g/omega² beta more along x, g/omega² alpha less along y; the structure's half mirrors that."""
    found, motion = recorder(effect), plain.motion(group)
    tilt = 9.81 / plain.omega**2
    expected = motion.copy()
    expected[:, F_X] += sign * tilt * motion[:, 4]
    expected[:, F_Y] -= sign * tilt * motion[:, 3]
    close(found.motion(group), expected, 1e-5)
    untouched(found, plain, *plain.table.names[:14])
    assert np.max(np.abs(expected - motion)) > 1e-3 * np.max(np.abs(motion))


def test_both_halves_of_gravity_off_are_both_on_swaps_hold_each_other_and_a_flexible_plate_rides_on_the_force(recorder, plain):
    assert_array_equal(recorder("gravity=0", "accelerometer-tilt=0").values, plain.values)
    found, names = recorder("channel-swap:cover-z1:fmd-x12"), list(plain.table.names)
    one, other = names.index("cover-z1"), names.index("fmd-x12")
    assert_array_equal(found.values[:, [one, other]], plain.values[:, [other, one]])
    untouched(found, plain, "cover-z1", "fmd-x12")
    found = recorder("cover-plate-flexibility=2e-9")
    bending = -(plain.omega**2) * 2e-9 * plain.loads()[:, F_Z]
    names = [f"cover-z{k}" for k in range(1, 5)]
    for name in names:
        close(found.spectrum(name) - plain.spectrum(name), bending, 2e-3)  # short by (omega / rate)² / 12 at the highest line
    untouched(found, plain, *names)


def test_a_saturating_channel_loses_a_quarter_of_that_at_half_the_level(recorder, plain):
    k, effect = plain.column("fmd-z1"), "saturation:fmd-z1=0.08"
    for level, lost in ((1.0, 0.08), (0.5, 0.02)):
        saturated, linear = recorder(effect, levels=(level,)), recorder(levels=(level,))
        untouched(saturated, linear, "fmd-z1")
        peak = np.argmax(np.abs(linear.values[:, k]))
        ratio = saturated.values[peak, k] / linear.values[peak, k]
        assert ratio == pytest.approx(1 - lost, abs=0.02 * lost)  # the record's peak is not quite the simulation's


def test_more_noise_is_white_independent_and_adds_by_variances(recorder, plain):
    found = recorder("noise:cover-z3=0.05", "noise:fmd-z1=2")
    for name, rms in (("cover-z3", 0.05), ("fmd-z1", 2.0)):
        added = found.values[:, found.column(name)] - plain.values[:, plain.column(name)]
        assert np.std(added) == pytest.approx(rms, rel=4 / np.sqrt(2 * len(added)))  # four standard deviations
    untouched(found, plain, "cover-z3", "fmd-z1")
    before, after = (recorder(*effects, noise_rms={"acceleration": 0.03}) for effects in ((), ("noise:cover-z3=0.04",)))
    clean = recorder()
    rms = [np.std((one.values - clean.values)[:, clean.column("cover-z3")]) for one in (before, after)]
    assert_allclose(rms, [0.03, 0.05], rtol=4 / np.sqrt(2 * len(clean.values)))


def test_mains_hum_is_in_every_channel_at_50_hz_and_effects_add_to_what_was_drawn(recorder, plain):
    added = recorder("mains=10").values - plain.values
    amplitude = np.sqrt(2) * np.std(added, axis=0)  # at this rate the fundamental is all of it
    assert_allclose(amplitude, [0.03] * 14 + [2.0] * 8, rtol=0.01)  # a whole number of periods but for one
    spectrum = np.abs(np.fft.rfft(added[:, 0]))
    assert np.argmax(spectrum) / (len(added) / RATE) == pytest.approx(50.0, abs=0.5 * RATE / len(added) + 0.1)
    drawn = {"tolerances": Tolerances()}
    before, after = recorder(**drawn), recorder("force-gain:fmd-z2=0.08", **drawn)
    k = before.column("fmd-z2")
    close(after.values[:, k], 1.08 * before.values[:, k])


def test_no_family_of_the_measurement_side_is_left_out():
    measured = {
        name for name, family in FAMILIES.items() if family.side in ("force side", "acceleration side", "discrete mistake")
    }
    left_out = {name for name in measured | {"gravity", "saturation", "noise", "mains"} if FAMILIES[name].plant is None}
    assert left_out == {"transducer-mass", "exponential-window", "leakage", "force-misalignment", "force-position"} | {
        "wrong-direction",
        "wrong-place",
        "wrong-reference",
    }  # of tests that no base drives: tests/validation/prediction/test_points.py simulates them


@pytest.mark.parametrize("name", [name for name, family in FAMILIES.items() if family.plant is None])
def test_what_cannot_be_planted_is_refused_in_words(name):
    example = FAMILIES[name].example.split(", or ")[0]
    with pytest.raises(BadInput, match=f"--effect: `{name}") as refused:
        planted(parse_all([example]))
    assert refused.value.remedy
