"""MAC, COMAC, cross-orthogonality and FRAC: their identities, what they are blind to, and the footbridge."""

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import sparse
from scipy.linalg import eigh

from geometry.frames import Array
from geometry.sensors import Point
from identification import test_file
from identification.modal_table import ModalTable, mac
from validation.compare import correlation
from validation.compare.correlation import (
    FunctionCorrelation,
    ModalCorrelation,
    comac,
    cross_orthogonality,
    frac,
    of_modes,
)
from validation.effects.stages import Matrices
from validation.output import from_json, to_json
from validation.prediction.modal_table import RealModes, real_modes
from validation.report.compare import correlation_tables

COUNT = 5


def modes(mass: Array | None = None, factor: float = 1.0) -> RealModes:
    drift = np.diff(np.eye(COUNT), axis=0, prepend=0.0)
    drift[0, 0] = 1.0
    K, none = factor * 1e4 * drift.T @ drift, np.zeros((COUNT, COUNT))
    rows = {f"p{k}": np.vstack([row, np.zeros((2, COUNT))]) for k, row in enumerate(np.eye(COUNT))}
    own = np.eye(COUNT) if mass is None else mass
    return real_modes(Matrices(base=0, mass=own, stiffness=K, viscous=none, structural=none, places=rows))


def table(of: RealModes, count: int = 3) -> ModalTable:
    f = of.frequency[:count]
    return ModalTable(
        source="t.toml",
        title="t",
        article="chain",
        frequency=f,
        frequency_deviation=0.005 * f,
        sensors=tuple(Point(place=f"p{k}") for k in range(COUNT)),
        shapes=of.shapes[:, :count].T,
        shapes_deviation=np.full((count, COUNT), 0.01),
    )


def test_a_model_beside_its_own_modes_is_all_ones() -> None:
    own = modes(np.diag([1.0, 2.0, 1.5, 1.0, 3.0]))
    found = of_modes(own, table(own))
    assert [one.model for one in found.pairs] == [1, 2, 3]
    assert_allclose([one.mac for one in found.pairs], 1.0, rtol=1e-12)
    assert_allclose([one.percent for one in found.pairs], 0.0, atol=1e-9)
    assert_allclose(list(found.comac.values()), 1.0, rtol=1e-12)
    assert_allclose(found.cross_orthogonality, np.eye(3, len(found.modes)), atol=1e-9)
    assert np.all(found.mac[~np.eye(3, len(found.modes), dtype=bool)] < 0.5)
    assert not found.remarks


def test_a_factor_of_a_shape_says_nothing_not_even_a_complex_one() -> None:
    rng = np.random.default_rng(2)
    a, b = rng.standard_normal((3, 7)), rng.standard_normal((4, 7))
    factors = np.array([[2.0], [-0.1], [1j]])
    assert_allclose(mac(factors * a, b), mac(a, b), rtol=1e-12)
    assert_allclose(comac(factors * a, b[:3]), comac(a, b[:3]), rtol=1e-12)
    assert_allclose(np.diag(mac(a, a)), 1.0, rtol=1e-12)
    assert_allclose(cross_orthogonality(factors * a, b), cross_orthogonality(a, b), rtol=1e-9)


def test_comac_points_at_the_sensor_that_is_wrong() -> None:
    own = modes()
    wrong = np.array(table(own).shapes)
    wrong[:, 3] *= [1.0, -1.0, 0.2]
    found = of_modes(own, replace(table(own), shapes=wrong)).comac
    assert min(found, key=lambda name: found[name]) == "p3"


def test_few_sensors_have_no_cross_orthogonality_instead_of_a_wrong_one() -> None:
    assert cross_orthogonality(np.ones((1, 2)), np.eye(3, 2)).size == 0
    assert cross_orthogonality(np.ones((1, 3)), np.ones((2, 3))).size == 0


def test_a_model_that_is_wrong_where_every_mac_is_green_is_said() -> None:
    found = of_modes(modes(factor=1.2), table(modes()))  # everything a fifth too stiff: shapes stay
    assert min(one.mac or 0.0 for one in found.pairs) > 0.999
    assert_allclose([one.percent for one in found.pairs], 100 * (np.sqrt(1.2) - 1), rtol=1e-9)
    assert any("the model is wrong" in one and "does not see frequencies" in one for one in found.remarks)
    assert not any("the model is wrong" in one for one in of_modes(modes(factor=1.001), table(modes())).remarks)
    assert not any("the model is wrong" in one for one in of_modes(modes(factor=1.2), table(modes()), 0.05).remarks)


def test_frac_is_one_but_for_a_factor() -> None:
    rng = np.random.default_rng(1)
    H = rng.standard_normal(50) + 1j * rng.standard_normal(50)
    assert frac(H, (2 - 1j) * H) == pytest.approx(1.0)
    assert frac(H, rng.standard_normal(50) + 0j) < 0.3
    assert frac(H, 0 * H) == 0.0


def test_a_result_goes_to_json_and_back_and_to_csv() -> None:
    found = of_modes(modes(factor=1.2), table(modes()))
    text = json.loads(json.dumps(to_json(found)))
    assert text["pairs"][0]["measured"] == "mode 1"
    back = from_json(ModalCorrelation, text)
    assert [vars(one) for one in back.pairs] == [vars(one) for one in found.pairs]
    assert_allclose(back.mac, found.mac, rtol=1e-15)
    for name, one in found.tables().items():
        rows = list(csv.reader(io.StringIO(one)))
        assert len({len(row) for row in rows}) == 1, name
    pairs = list(csv.DictReader(io.StringIO(found.tables()["pairs"])))
    assert float(pairs[2]["percent"]) == pytest.approx(found.pairs[2].percent)


BRIDGE = {
    "kind": "modal-table",
    "article": "bridge",
    "frequencies": {"file": "frequencies.csv", "frequency": "frequency_hz", "deviation": "sd_hz"},
    "shapes": {"file": "shapes.csv", "sensor": "dof", "modes": "mode{}", "deviations": "sd{}"},
}


def test_the_first_modes_of_the_footbridge_have_changed_places(data: Path) -> None:
    folder = data / "footbridge"
    if not folder.is_dir():
        pytest.skip(f"{folder} is absent; data/README.md of the shared folder says where it comes from")
    measured = test_file.read(folder / "test.toml", BRIDGE)
    assert isinstance(measured, ModalTable)
    arrays = np.load(folder / "model.npz")
    parts = {name.split("/")[1] for name in arrays if name.startswith("stiffness/")}
    K, M = (sum(_matrix(arrays, f"{name}") for name in names) for names in ([f"stiffness/{one}" for one in parts], ["mass"]))
    inverse, shapes = eigh(M, K, subset_by_index=[len(M) - 20, len(M) - 1])  # M is singular: 1 / omega²
    shapes = shapes / np.sqrt(inverse)
    squares, none = 1 / inverse, np.zeros((20, 20))
    places = {one.place: np.vstack([shapes[int(one.place.split()[1])], np.zeros((2, 20))]) for one in measured.sensors}
    reduced = Matrices(base=0, mass=np.eye(20), stiffness=np.diag(squares), viscous=none, structural=none, places=places)
    found = of_modes(real_modes(reduced), measured)
    assert found.swapped == (("mode 1", "mode 2"),)
    assert sum("mode 1 and mode 2 have changed places" in one for one in found.remarks) == 1
    # data/README.md of the shared folder: what the nominal model is off by, to the digits that it states
    assert_allclose([one.percent for one in found.pairs], [20.0, 2.4, -2.5, 14.4, -1.0], atol=0.06)


def _matrix(arrays: np.lib.npyio.NpzFile, name: str) -> Array:
    parts = tuple(arrays[f"{name}/{one}"] for one in ("data", "indices", "indptr"))
    return np.asarray(sparse.csr_matrix(parts, shape=arrays[f"{name}/shape"]).toarray())


def test_nothing_is_said_of_sensors_where_a_table_has_no_shapes() -> None:
    own = modes()
    bare = replace(table(own), shapes=None, shapes_deviation=None, sensors=())
    found = of_modes(own, bare)
    assert found.pairs[0].mac is None
    assert set(found.tables()) == {"pairs"}
    assert "MAC" not in found.rule
    assert found.rule != correlation.RULE


def test_a_function_that_is_zero_but_for_rounding_has_no_level() -> None:
    """It had one of -181 dB, where a floor moves across the only direction that the model has."""
    levels = {"r/rounding": -181.0, "r/low": -90.0}
    found = FunctionCorrelation(data_set="lab", frac=dict.fromkeys(levels, 0.5), ratio=levels, remarks=())
    shown = correlation_tables([found])[1]
    level = next(one for one in shown.columns if one.head == "level")
    assert [level.of(row) for row in shown.rows] == [None, -90.0]
