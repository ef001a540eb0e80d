"""The families of the catalogue as data: what their targets are, in which unit they are sized, and which sizes are physical.

Equations, confusions and references stand with the code that applies or fits a family; here is what an identifier needs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

from validation.effects.targets import ACCELEROMETER, CHANNEL, FORCE, PLACE

STRUCTURE, FORCES, ACCELERATIONS, MISTAKE, AMPLITUDE, PROCESSING, PENDULUM = (
    "structure",
    "force side",
    "acceleration side",
    "discrete mistake",
    "amplitude-dependent",
    "processing",
    "pendulum",
)


@dataclass(frozen=True, kw_only=True)
class Size:
    """One number that says how large an effect is.

    Attributes
    ----------
    unit : SI; "1" for a ratio
    low, high : beyond is no physics of a test, or a unit was mistaken
    key : by which it is written, ``key:number``; empty for the one that stands alone
    default : what holds where it is not written; None for one that must be
    whole : whether it is a whole number, as a switch is
    """

    unit: str
    low: float
    high: float
    key: str = ""
    default: float | None = None
    whole: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Family:
    """A family of effects.

    Attributes
    ----------
    side : the heading under which the catalogue lists it
    what : in a few words
    targets : kind of each target, in the order of the identifier
    optional : whether the last of them may be left out
    sizes : what its value holds; nothing for a mistake that is there or not
    varying : the sizes that depend on the first target, by that
    example : one that can be typed
    """

    side: str
    what: str
    targets: tuple[str, ...] = ()
    optional: bool = False
    sizes: tuple[Size, ...] = ()
    varying: Mapping[str, tuple[Size, ...]] = field(default_factory=dict)
    example: str

    def sizes_at(self, targets: tuple[str, ...]) -> tuple[Size, ...]:
        """What the value holds of an effect on `targets`."""
        return self.varying.get(targets[0], self.sizes) if targets else self.sizes


def _relative(low: float, high: float) -> tuple[Size, ...]:
    return (Size(unit="1", low=low, high=high),)


def _resonator(mass: float) -> tuple[Size, ...]:
    return (
        Size(key="m", unit="kg", low=1e-6, high=mass),
        Size(key="f", unit="Hz", low=0.01, high=1000.0),
        Size(key="zeta", unit="1", low=1e-5, high=0.99),
    )


GAIN = _relative(-0.9, 9.0)
DELAY = (Size(unit="s", low=-0.1, high=0.1),)
LENGTH = (Size(unit="m", low=-0.5, high=0.5),)
ANGLE = (Size(unit="rad", low=-0.5, high=0.5),)
SWITCH = (Size(unit="1", low=0.0, high=1.0, default=1.0, whole=True),)
TURNING, SHIFTING = (Size(unit="rad/(N m)", low=1e-12, high=1e-2),), (Size(unit="m/N", low=1e-13, high=1e-3),)
MASS, FIRST, SECOND = (
    (Size(unit="kg", low=-1e3, high=1e3),),
    (Size(unit="kg m", low=-1e3, high=1e3),),
    (Size(unit="kg m^2", low=-1e3, high=1e3),),
)
RATIO = _relative(-1.0, 1.0)

FAMILIES: Mapping[str, Family] = {
    "point-mass": Family(
        side=STRUCTURE, what="a mass at a place", targets=(PLACE,), sizes=MASS, example="point-mass:mast-top=0.5"
    ),
    "rigid-inertia": Family(
        side=STRUCTURE,
        what="a parameter of the article, about its centre of gravity",
        targets=("parameter",),
        sizes=SECOND,
        varying={"m": MASS, "mx": FIRST, "my": FIRST, "mz": FIRST},
        example="rigid-inertia:Ixx=0.2",
    ),
    "modulus": Family(
        side=STRUCTURE,
        what="relative change of a part's modulus of elasticity",
        targets=("part",),
        sizes=_relative(-0.9, 9.0),
        example="modulus:mast=0.05",
    ),
    "joint-compliance": Family(
        side=STRUCTURE,
        what="compliance of the joint between flange and cover plate",
        targets=("direction of the joint",),
        sizes=SHIFTING,
        varying={"rotation": TURNING, "torsion": TURNING},
        example="joint-compliance:rotation=1e-6",
    ),
    "structural-damping": Family(
        side=STRUCTURE,
        what="loss factor added to a part",
        targets=("part",),
        sizes=_relative(0.0, 1.0),
        example="structural-damping:mast=0.01",
    ),
    "layer-damping": Family(
        side=STRUCTURE,
        what="loss factor added to the layer in a blade",
        targets=("part with a layer",),
        sizes=_relative(0.0, 1.0),
        example="layer-damping:upper-short=0.03",
    ),
    "appendage": Family(
        side=STRUCTURE,
        what="a resonator on the cover plate",
        targets=("axis",),
        sizes=_resonator(100.0),
        example="appendage:z=m:0.05,f:21,zeta:0.01",
    ),
    "absorber": Family(
        side=STRUCTURE,
        what="a resonator at a place of the article",
        targets=(PLACE,),
        sizes=_resonator(100.0),
        example="absorber:mast-top=m:0.05,f:21,zeta:0.01",
    ),
    "slosh": Family(
        side=STRUCTURE,
        what="a liquid that swings along x and y at a place",
        targets=(PLACE,),
        sizes=_resonator(100.0),
        example="slosh:mast-top=m:0.5,f:6,zeta:0.02",
    ),
    "cable": Family(
        side=STRUCTURE,
        what="a spring from a place to the ground",
        targets=(PLACE, "direction of a cable"),
        optional=True,
        sizes=(Size(unit="N/m", low=1e-3, high=1e9),),
        example="cable:mast-top:lateral=1000",
    ),
    "orientation": Family(
        side=STRUCTURE,
        what="the article turned on the cover plate",
        targets=("turning axis",),
        sizes=(Size(unit="rad", low=-pi, high=pi),),
        example="orientation:z=0.01",
    ),
    "mounting-offset": Family(
        side=STRUCTURE,
        what="the article shifted on the cover plate",
        targets=("lateral axis",),
        sizes=LENGTH,
        example="mounting-offset:x=0.002",
    ),
    "gravity": Family(side=STRUCTURE, what="the structure's half of gravity, 1 on or 0 off", sizes=SWITCH, example="gravity=0"),
    "force-gain": Family(
        side=FORCES,
        what="relative gain of a force channel",
        targets=(FORCE,),
        sizes=GAIN,
        example="force-gain:fmd-z2=0.08",
    ),
    "load-path-shunt": Family(
        side=FORCES,
        what="share of the force along an axis that passes the cells by",
        targets=("axis",),
        sizes=_relative(0.0, 0.95),
        example="load-path-shunt:x=0.03",
    ),
    "force-delay": Family(
        side=FORCES, what="a force channel is late", targets=(FORCE,), sizes=DELAY, example="force-delay:fmd-z2=200e-6"
    ),
    "board-delay": Family(
        side=FORCES,
        what="all channels of a board are late",
        targets=("board",),
        sizes=DELAY,
        example="board-delay:force=200e-6",
    ),
    "force-highpass": Family(
        side=FORCES,
        what="first-order corner of a charge amplifier",
        targets=(FORCE,),
        sizes=(Size(unit="Hz", low=0.0, high=100.0),),
        example="force-highpass:fmd-x12=0.3",
    ),
    "force-crosstalk": Family(
        side=FORCES,
        what="a resultant shows in the channels along another axis; zx is x seen in z",
        targets=("pair of axes",),
        sizes=RATIO,
        example="force-crosstalk:zx=0.02",
    ),
    "force-plane-offset": Family(
        side=FORCES,
        what="height of a lateral force whose moment the cells miss",
        targets=("lateral axis",),
        sizes=LENGTH,
        example="force-plane-offset:x=0.004",
    ),
    "fmd-compliance": Family(
        side=FORCES,
        what="factor on the compliance of all load cells",
        targets=("direction of the FMD",),
        sizes=(Size(unit="1", low=1e-3, high=1e3),),
        example="fmd-compliance:lateral=3",
    ),
    "cell-stiffness": Family(
        side=FORCES,
        what="relative change of one cell's stiffness",
        targets=("cell and axis",),
        sizes=_relative(-0.99, 99.0),
        example="cell-stiffness:1x=0.3",
    ),
    "accelerometer-gain": Family(
        side=ACCELERATIONS,
        what="relative gain of an accelerometer",
        targets=(ACCELEROMETER,),
        sizes=GAIN,
        example="accelerometer-gain:cover-z3=0.05",
    ),
    "accelerometer-delay": Family(
        side=ACCELERATIONS,
        what="an accelerometer is late",
        targets=(ACCELEROMETER,),
        sizes=DELAY,
        example="accelerometer-delay:cover-z3=200e-6",
    ),
    "accelerometer-position": Family(
        side=ACCELERATIONS,
        what="an accelerometer sits elsewhere than stated",
        targets=(ACCELEROMETER, "axis"),
        sizes=LENGTH,
        example="accelerometer-position:cover-z3:x=0.01",
    ),
    "accelerometer-misalignment": Family(
        side=ACCELERATIONS,
        what="an accelerometer is turned about an axis",
        targets=(ACCELEROMETER, "axis"),
        sizes=ANGLE,
        example="accelerometer-misalignment:cover-z3:x=0.02",
    ),
    "accelerometer-tilt": Family(
        side=ACCELERATIONS, what="the sensors' half of gravity, 1 on or 0 off", sizes=SWITCH, example="accelerometer-tilt=0"
    ),
    "cover-plate-flexibility": Family(
        side=ACCELERATIONS,
        what="the cover plate gives under the vertical force",
        sizes=(Size(unit="m/N", low=0.0, high=1e-4),),
        example="cover-plate-flexibility=1e-9",
    ),
    "polarity": Family(side=MISTAKE, what="a channel is inverted", targets=(CHANNEL,), example="polarity:fmd-z2"),
    "channel-swap": Family(
        side=MISTAKE,
        what="the plugs of two channels are swapped",
        targets=(CHANNEL, CHANNEL),
        example="channel-swap:cover-z1:cover-z2",
    ),
    "unit": Family(
        side=MISTAKE,
        what="factor by which the numbers of a channel are wrong, or the unit that they really are in",
        targets=(CHANNEL,),
        sizes=(Size(unit="1", low=1e-6, high=1e6),),
        example="unit:cover-z3=0.102, or unit:cover-z3=g",
    ),
    "friction": Family(
        side=AMPLITUDE,
        what="slip force of a loose part on the flange",
        targets=("joint", "lateral axis"),
        sizes=(
            Size(unit="N", low=1e-3, high=1e6),
            Size(key="mass", unit="kg", low=1e-3, high=1e3, default=2.0),
        ),
        example="friction:flange:x=3",
    ),
    "gap": Family(
        side=AMPLITUDE,
        what="preload at which a load cell lifts off",
        targets=("cell",),
        sizes=(Size(unit="N", low=1e-3, high=1e6),),
        example="gap:1=500",
    ),
    "saturation": Family(
        side=AMPLITUDE,
        what="share of its peak that a channel loses there, by a cubic term",
        targets=(CHANNEL,),
        sizes=_relative(-0.3, 0.3),
        example="saturation:fmd-z1=0.05",
    ),
    "sweep-bias": Family(side=PROCESSING, what="peak-hold near a lightly damped mode", example="sweep-bias"),
    "noise": Family(
        side=PROCESSING,
        what="root mean square of more noise on a channel, in its SI unit",
        targets=(CHANNEL,),
        sizes=(Size(unit="m/s^2 or N", low=0.0, high=1e6),),
        example="noise:cover-z3=0.05",
    ),
    "mains": Family(
        side=PROCESSING,
        what="mains hum in every channel, as a factor on the ordinary one",
        sizes=(Size(unit="1", low=0.0, high=1e4),),
        example="mains=5",
    ),
    **{
        name: Family(side=PENDULUM, what="an error of a pendulum's period", example=name)
        for name in (
            "pendulum-amplitude",
            "pendulum-damping",
            "rope-mass",
            "rope-elasticity",
            "air-inertia",
            "off-centre-suspension",
        )
    },
}
"""Every family by name, in the order of the catalogue."""
