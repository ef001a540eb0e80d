"""The four packages come from where we think they do: the repository, or the built wheel when that is under test."""

import importlib
import importlib.machinery
import json
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGES = ("massline", "geometry", "fem", "identification", "validation")


@pytest.mark.parametrize("package", PACKAGES)
def test_this_process_tests_the_code_that_it_claims_to_test(package: str, code: Path) -> None:
    assert origin(importlib.import_module(package).__file__) == code / package


def test_a_fresh_python_in_a_neutral_directory_finds_the_same_packages(code: Path, tmp_path: Path) -> None:
    statement = (
        f"import json; from importlib import import_module; print(json.dumps([import_module(p).__file__ for p in {PACKAGES}]))"
    )
    run = subprocess.run([sys.executable, "-P", "-c", statement], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert [origin(file) for file in json.loads(run.stdout)] == [code / package for package in PACKAGES]


@pytest.mark.parametrize("package", PACKAGES)
def test_no_other_package_on_the_path_bears_the_name(package: str, code: Path, root: Path) -> None:
    specs = [importlib.machinery.PathFinder.find_spec(package, [entry]) for entry in sys.path]
    assert {origin(spec.origin) for spec in specs if spec is not None} <= {code / package, root / package}


def origin(file: str | None) -> Path:
    """Folder of a package's `file`, symbolic links resolved."""
    assert file is not None
    return Path(file).resolve().parent
