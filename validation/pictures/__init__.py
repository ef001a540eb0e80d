"""The door to pyvista and matplotlib: pictures of articles with CoG, principal axes and equivalent inertia ellipsoid.

`picture` draws one page; `drawn_bodies` makes its meshes from an `Article`; `contact_sheet` puts several pages on one.
"""

from validation.pictures.bodies import DrawnBody, drawn_bodies
from validation.pictures.contact import contact_sheet
from validation.pictures.files import said_about
from validation.pictures.page import picture

__all__ = ["DrawnBody", "contact_sheet", "drawn_bodies", "picture", "said_about"]
