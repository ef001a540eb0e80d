"""The effects of the catalogue in a virtual test: what each of them changes, and where on the way from table to record."""
