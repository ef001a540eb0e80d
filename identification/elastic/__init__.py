"""Elastic influence: the modal terms of Eq. 8b as auxiliary parameters, with poles that all 36 entries share."""
