"""A rope pendulum simulated, recorded and reduced as a measured one: what each imperfection costs, and what is taken off again."""
