"""A user's own article: STEP, STL, PLY or OBJ files and what they are made of, turned into the nouns of geometry.

`load` reads and checks everything, `require_file` only that there is something to read; `inertias` integrates it by every route
that the files allow; `agreement` holds the routes against each other. ``docs/own-article.md`` shows the files.
"""

from geometry.user_article.loading import ENDINGS, load, require_file
from geometry.user_article.nouns import UserArticle, UserPart
from geometry.user_article.routes import agreement, inertias, tessellation_error

__all__ = ["ENDINGS", "UserArticle", "UserPart", "agreement", "inertias", "load", "require_file", "tessellation_error"]
