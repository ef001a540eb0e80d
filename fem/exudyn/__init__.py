"""The door to exudyn: bodies, beams and their linearised equations. Nothing else in massline imports it."""
