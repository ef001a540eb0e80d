"""A user's mesh with named groups, or a STEP assembly: read, given materials, and assembled into a `Structure`."""
