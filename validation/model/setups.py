"""What stands on the FMD in a tare campaign: the inertia of a known article from its drawing, carried to where it is mounted."""

from pathlib import Path

from geometry import robot, routes
from geometry.articles import NAMES, built_in
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.inertia import Inertia
from geometry.toml_file import nearest
from identification.campaign import Campaign
from identification.request import Request


def is_stack(name: str) -> bool:
    """Whether `name` is made of built-in parts only."""
    return set(name.split("+")) <= set(NAMES)


def is_file(name: str) -> bool:
    """Whether `name` is a user's own file or folder; the name of a built-in stack always means that."""
    if not name.strip() or is_stack(name):
        return False
    return (
        Path(name).exists()
        or name.lower().endswith((".step", ".stp", ".stl", ".ply", ".obj", ".toml", *robot.ENDINGS))
        or "/" in name
    )


FMD = "fmd"
"""The lowest part of every stack on load cells."""


def above_fmd(article: str) -> str:
    """What `article`, bottom to top, has on the FMD; empty for the FMD alone, and the whole where it does not begin with it."""
    bottom, _, rest = article.partition("+")
    return rest if bottom == FMD else article


def on_fmd(campaign: Campaign) -> bool:
    """Whether what was tested stands on an FMD: its name begins with it, or load cells carry it."""
    return campaign.article.partition("+")[0] == FMD or bool(campaign.table.select(group="fmd"))


def takes_fmd_off(request: Request) -> bool:
    """Whether the FMD can be taken off: it was given, or a tare of the same hardware tells it."""
    own = request.campaign.hardware
    told = (tare.campaign.hardware in ("", own) or not own for tare in request.tares)
    return request.fmd is not None or any(told)


def known(name: str, campaign: Campaign, source: str = "--known") -> tuple[Inertia | None, tuple[str, ...]]:
    """The article `name` as it stands in `campaign`: its inertia in the frame of F, and what was assumed for it.

    None for an FMD with nothing on it.

    Raises
    ------
    BadInput : `name` is no built-in article and no file of which a body can be made, or is not what the campaign says it has.
    """
    if above_fmd(name) == "":
        return None, ()
    # Refuse a known article that is another one than the campaign's; what a user's own file holds is the user's to know
    there = above_fmd(campaign.article)
    if above_fmd(name) == there or is_file(name):
        pass
    else:
        problem = f"{name} is not what stands on the FMD in {campaign.source}, whose article is {campaign.article}"
        remedy = f"{nearest(name, (there,))}Leave {source} out to take {there}, or correct `campaign.article`"
        raise BadInput(source, "", problem, remedy)
    pose, said = mounted(campaign)
    return _inertia(above_fmd(name), source).placed(pose), said


def mounted(campaign: Campaign) -> tuple[Pose, tuple[str, ...]]:
    """Where the article's frame sits, seen from F: as `campaign` states, else on the built-in FMD if there is one; said."""
    pose = stated(campaign)
    if pose is not None:
        return pose, ()
    if not campaign.table.select(group="fmd"):
        words = f"{campaign.source}: [mounting] is missing; without load cells the article has the origin of the channels' places"
        return Pose(position=-campaign.table.origin), (words,)
    seat = built_in(FMD).seat or Pose()
    words = (
        f"{campaign.source}: [mounting] is missing; the known article is taken to stand {1e3 * seat.position[2]:g} mm above F, "
        "on the cover plate of the built-in FMD, which is a reconstruction"
    )
    return seat, (words,)


def stated(campaign: Campaign) -> Pose | None:
    """The pose of the article's frame seen from F that `campaign` states; None where it states none."""
    there = campaign.mounting
    return None if there is None else Pose(position=there.position - campaign.table.origin, rotation=there.rotation)


def _inertia(name: str, source: str) -> Inertia:

    if is_file(name):
        from geometry import user_article

        return next(iter(user_article.inertias(user_article.load(name, unit=None, material=None, chord=None)).values()))
    try:
        return routes.inertia(built_in(name))
    except BadInput as error:
        raise BadInput(source, "", error.problem, error.remedy) from None
