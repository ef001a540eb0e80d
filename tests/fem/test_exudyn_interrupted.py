"""Ctrl-C from outside ends every exudyn run as KeyboardInterrupt, wherever in a step it comes."""

import os
import signal
import subprocess
import sys

import pytest

from fem.exudyn.run import is_interruption, kept

TIMES = 6
"""Runs of one kind; before Ctrl-C was kept, every second one ended as something else."""

CHILD = f"""
import signal, sys
import numpy as np
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation import rig
from fem.exudyn import driven_run, large_motion, rope_pendulum, rope_statics
from geometry.inertia import Inertia
from validation.cli.main import held_while_importing

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell makes children in the background deaf to it
block = Inertia.from_cog(7.0, [0.0, 0.0, 0.1], np.diag([0.3, 0.25, 0.1]))
t = np.arange(60 * 4096)[:, None] / 4096
push = np.array([1e-3, 0, 0, 0, 0, 0])
moves = [push * x for x in (1 - np.cos(9 * t), 9 * np.sin(9 * t), 81 * np.cos(9 * t))]
motion = BaseMotion(sampling_rate=4096, displacement=moves[0], velocity=moves[1], acceleration=moves[2], driven=60.0)
ropes = rope_statics.on_three_ropes(0.3, length=2.0, amplitude=0.1)
told = lambda share: print(f"at {{share}}", flush=True)
runs = {{
    "driven": lambda: driven_run.respond(rig.Rig(article=rig.rigid("block", block, {{}})), motion, progress=told),
    "large": lambda: large_motion.respond("cuboid", motion, elements=None, progress=told),
    "swing": lambda: rope_pendulum.swing(block, ropes, duration=600.0, progress=told),
}}
for _ in range({TIMES}):
    try:
        with held_while_importing():
            runs[sys.argv[1]]()
    except BaseException as reason:
        print("ended as", type(reason).__name__, reason, flush=True)
"""


@pytest.mark.parametrize("kind", ["driven", "large", "swing"])
def test_ctrl_c_from_another_process_always_ends_a_run_as_ctrl_c(kind: str) -> None:
    """Sent at some moment after the first, second, ... word of progress."""
    ended: list[str] = []
    with subprocess.Popen([sys.executable, "-c", CHILD, kind], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        heard = 0
        for line in child.stdout:
            if line.startswith("ended as"):
                ended.append(line.strip())
                heard = 0
                continue
            heard += 1
            if heard == 1 + len(ended):
                os.kill(child.pid, signal.SIGINT)
    assert ended == ["ended as KeyboardInterrupt"] * TIMES


@pytest.mark.usefixtures("keyboard")
def test_what_is_kept_is_raised_at_the_end_even_where_the_work_failed_and_the_handler_is_restored() -> None:
    before = signal.getsignal(signal.SIGINT)

    def fail() -> None:
        with kept() as found:
            assert found.reason is None
            signal.raise_signal(signal.SIGINT)
            assert isinstance(found.reason, KeyboardInterrupt)
            raise ValueError("the solver gave up")

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.usefixtures("keyboard")
def test_a_handler_that_raises_nothing_stays_in_charge() -> None:
    heard: list[int] = []
    signal.signal(signal.SIGINT, lambda number, frame: heard.append(number))
    with kept() as found:
        signal.raise_signal(signal.SIGINT)
    assert heard == [signal.SIGINT]
    assert found.reason is None


def test_an_error_that_exudyn_made_of_ctrl_c_is_known() -> None:
    made = SystemError("returned a result with an exception set")
    assert not is_interruption(made)
    made.__context__ = KeyboardInterrupt()
    assert is_interruption(made)
    assert is_interruption(RuntimeError("in a user function: KeyboardInterrupt: <EMPTY MESSAGE>"))
