"""A rope pendulum simulated, recorded and reduced as a measured one: what an imperfection costs, and what is taken off again."""
