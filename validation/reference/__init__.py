"""Reference values of articles: mass, centre of gravity and inertia by three routes, beside what is in print."""
