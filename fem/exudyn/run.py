"""Exudyn at work: quiet, and in words when it fails.

Exudyn says most of what is wrong by raising errors of its own, SciPy's functions inside it raise theirs, and a solution may come
back as NaN without a word. All three leave here as `CheckFailed`, with what exudyn said and the version that said it.
"""

import signal
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from types import FrameType
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from geometry.inertia import Inertia, require_physical

# The door to exudyn: the inertia of a rigid body.
#
# Exudyn's `RigidBodyInertia` holds the mass, the centre of mass and the tensor about the body's reference point, products as
# matrix entries; its list of six orders them Jxx, Jyy, Jzz, Jyz, Jxz, Jxy. Asked for something impossible it prints a line and
# goes on, so what enters is judged first and what it says to the console is held back: standard output belongs to the user's
# result.

ORDER_OF_SIX = [0, 1, 2, 5, 4, 3]
"""Exudyn's xx, yy, zz, yz, xz, xy read as xx, yy, zz, xy, xz, yz; the exchange is its own inverse."""

ExudynInertia = Any
"""An `exudyn.rigidBodyUtilities.RigidBodyInertia`; the library has no types of its own."""


Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; what it raises ends the run."""

TOLD = 200
"""Times in a run that progress is told."""


@contextmanager
def quiet() -> Iterator[Any]:
    """The exudyn module with its console output held back, restored at the end."""
    import exudyn

    before = exudyn.config.printToConsole
    exudyn.config.printToConsole = False
    try:
        yield exudyn
    finally:
        exudyn.config.printToConsole = before


def to_exudyn(inertia: Inertia, source: str = "inertia") -> ExudynInertia:
    """`inertia` as exudyn's `RigidBodyInertia`; the body's reference point there is `inertia.reference_point`.

    Raises
    ------
    BadInput : no body has these parameters; `source` says where they came from. Exudyn itself would only print a line.
    """
    body = require_physical(inertia, source)
    with quiet():
        from exudyn import rigidBodyUtilities

        make: Any = rigidBodyUtilities.RigidBodyInertia
        return make(mass=body.mass, inertiaTensor=body.tensor, com=body.first_moment / body.mass)


# Ctrl-C while exudyn integrates: kept until exudyn has stopped, and then raised.
#
# Exudyn looks for signals in the middle of a step. An exception that it finds there stays set while it calls back, and the first
# thing that Python does in the callback then fails with a SystemError that nobody meant. So nothing is raised while it runs:
# what the handler of SIGINT raises is kept, and the next callback ends the run.

BeforeStep = Callable[[Any, float], bool]
"""Exudyn's callback before every step, with the system and the time [s] at its end; False ends the run."""


class Kept:
    """What was raised meanwhile, if anything."""

    reason: BaseException | None = None


@contextmanager
def kept() -> Iterator[Kept]:
    """Inside the block, what the handler of SIGINT raises is kept; it is raised at the end of the block, whatever else happened.

    Does nothing outside the main thread, which alone hears signals, and where no Python function listens to SIGINT.

    Raises
    ------
    BaseException : what the handler raised, KeyboardInterrupt as a rule.
    """
    found, before = Kept(), signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield found
        return
    handler: Callable[[int, FrameType | None], Any] = before

    def keep(number: int, frame: FrameType | None) -> None:
        try:
            handler(number, frame)
        except BaseException as reason:
            found.reason = reason

    signal.signal(signal.SIGINT, keep)
    try:
        yield found
    finally:
        signal.signal(signal.SIGINT, handler)
        if found.reason is not None:
            raise found.reason from None


def integrated(system: Any, settings: Any, before_step: BeforeStep | None = None) -> bool:
    """Whether exudyn integrated `system` to the end of `settings`; `before_step` and Ctrl-C may stop it.

    Raises
    ------
    KeyboardInterrupt : Ctrl-C, once exudyn has stopped.
    Exception : exudyn gave up; it raises errors of several kinds.
    """
    with kept() as interruption:

        def ask(system: Any, time: float) -> bool:
            return interruption.reason is None and (before_step is None or before_step(system, time))

        system.SetPreStepUserFunction(ask)
        return bool(system.SolveDynamic(settings))


def is_interruption(error: BaseException | None) -> bool:
    """Whether `error` is what exudyn made of a Ctrl-C: it has a KeyboardInterrupt behind it, or its name in the text."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt) or "KeyboardInterrupt" in str(error):
            return True
        error = error.__cause__ or error.__context__
    return False


def exudyn_version() -> str:
    """Version of the installed exudyn, without importing it."""
    return version("exudyn")


@contextmanager
def running(task: str) -> Iterator[Any]:
    """The exudyn module, held back from standard output, while it does `task`.

    Raises
    ------
    CheckFailed : exudyn, or what it calls, failed; with what it said.
    KeyboardInterrupt : Ctrl-C, of which exudyn made an error of its own.
    """
    try:
        with quiet() as exudyn, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # SciPy tells exudyn's authors about storage formats
            yield exudyn
    except (BadInput, CheckFailed):
        raise
    except Exception as error:
        if is_interruption(error):
            raise KeyboardInterrupt from None
        said = " ".join(str(error).split("[Python file")[0].split()) or type(error).__name__
        raise failed(task, said) from error


def finite(value: npt.ArrayLike, task: str) -> Array:
    """`value` as an array.

    Raises
    ------
    CheckFailed : NaN or infinity in it, which is how exudyn says that a solver went wrong.
    """
    array = np.array(value, dtype=np.float64)
    if not np.all(np.isfinite(array)):
        raise failed(task, "its result holds NaN or infinity")
    return array


def failed(task: str, said: str) -> CheckFailed:
    """The failure of `task`, with what exudyn said."""
    return CheckFailed(f"exudyn {exudyn_version()} failed when it should {task}: {said}", task=task, said=said)
