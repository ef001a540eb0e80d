"""A reference table in print: `grid` lays it out as strings, and one module a format writes that down."""
