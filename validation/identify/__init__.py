"""Identification of mass, centre of gravity and inertia: what is asked, the known article, the band, the plan of a test."""
