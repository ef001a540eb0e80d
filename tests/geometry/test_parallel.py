"""Work in several processes: the answers of a loop, and nothing lost by a process that dies or by an interruption."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

from geometry import parallel
from geometry.errors import BadInput

WORK = """
import os, signal, subprocess, time
from pathlib import Path
import numpy as np

def solved(task):
    number, folder = task
    if number == 3 and not (Path(folder) / "died").exists():  # the first time
        (Path(folder) / "died").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 5:
        os.kill(os.getpid(), signal.SIGKILL)
    matrix = np.random.default_rng(number).normal(size=(40, 40))
    return np.linalg.solve(matrix, np.ones(40)), os.getpid()

def endless(task):
    number, folder = task
    if number:
        (Path(folder) / str(number)).touch()
        subprocess.run(["sleep", "300"])
    return number
"""


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory):
    """A module that every process finds."""
    folder = tmp_path_factory.mktemp("work")
    (folder / "work_of_a_test.py").write_text(WORK)
    sys.path.insert(0, str(folder))
    import work_of_a_test

    yield work_of_a_test
    sys.path.remove(str(folder))
    del sys.modules["work_of_a_test"]


ALIKE = """
import os, sys
from pathlib import Path
import numpy as np
sys.path.insert(0, sys.argv[1])
import work_of_a_test as work
from geometry import parallel

tasks = [(number, sys.argv[2]) for number in range(7)]
found = dict(parallel.finished(work.solved, tasks, processes=2))
assert (Path(sys.argv[2]) / "died").exists()
lost = found.pop(tasks[5])
assert isinstance(lost, parallel.WorkerLost), lost
assert "died 4 times" in str(lost), lost
assert os.getpid() not in {process for _, process in found.values()}
alone = dict(parallel.finished(work.solved, [one for one in tasks if one in found], processes=1))
assert {process for _, process in alone.values()} == {os.getpid()}
assert list(alone) == [one for one in tasks if one in found]  # a loop keeps their order
assert len(alone) == 6
for one, (x, _) in alone.items():
    np.testing.assert_array_equal(found[one][0], x)
print("alike")
"""


def test_processes_answer_as_a_loop_does_bit_for_bit_and_one_that_dies_loses_nothing(work, tmp_path: Path) -> None:
    # In a process of its own, as a user's: one that has run thousands of other tests before has died of it
    command = [sys.executable, "-P", "-c", ALIKE, str(Path(work.__file__).parent), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, cwd=tmp_path)
    assert done.stdout.split() == ["alike"], done.stderr


def test_an_interruption_keeps_what_was_handed_out_and_leaves_no_process(work, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        f"""
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a suite in the background of a shell ignores it, and so would this
sys.path.insert(0, {str(Path(work.__file__).parent)!r})
import work_of_a_test
from geometry.parallel import finished
try:  # without a guard: no process reads the script again
    for (number, _), answer in finished(work_of_a_test.endless, [(k, {str(tmp_path)!r}) for k in range(3)], processes=2):
        print(answer, flush=True)
except KeyboardInterrupt:
    print("interrupted")
"""
    )
    of = subprocess.Popen([sys.executable, "-P", script], stdout=subprocess.PIPE, text=True, start_new_session=True)
    assert of.stdout is not None
    assert of.stdout.readline().split() == ["0"]
    until = time.monotonic() + 60
    while not all((tmp_path / name).exists() for name in ("1", "2")) and time.monotonic() < until:
        time.sleep(0.05)
    os.killpg(of.pid, signal.SIGINT)  # as a terminal does
    said, _ = of.communicate(timeout=60)
    assert said.split() == ["interrupted"]
    left = [one for one in psutil.process_iter() if _is_of(one, of.pid)]
    assert psutil.wait_procs(left, timeout=10)[1] == []


def _is_of(one: psutil.Process, group: int) -> bool:
    """Whether it lives, in this group of processes."""
    with suppress(psutil.Error, ProcessLookupError):
        return os.getpgid(one.pid) == group and one.status() != psutil.STATUS_ZOMBIE
    return False


def test_what_nobody_answers_and_what_other_code_answers_is_refused(work, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel, "CONNECTING", "0.2s")
    with pytest.raises(BadInput, match=r"`tcp://127.0.0.1:9`: no Dask scheduler answers there"):
        list(parallel.finished(work.solved, [(0, "")], scheduler="tcp://127.0.0.1:9"))
    with pytest.raises(BadInput, match="another version of massline's code"):
        parallel.SameCode(work.solved, "another")((0, ""))


def test_nothing_to_do_needs_no_process(work) -> None:
    assert list(parallel.finished(work.solved, [], processes=4)) == []
    assert list(parallel.finished(work.solved, [], scheduler="tcp://127.0.0.1:9")) == []
