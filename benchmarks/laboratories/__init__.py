"""Laboratories that another simulator draws from data sheets: are sound tests said to be sound?

`drawing` says what a laboratory of a class does not know, from data sheets and a list of its own; `shaking` makes its campaigns,
line by line from the equilibrium of a plate on cells; `python -m benchmarks.laboratories` counts the nulls that come out quiet.
Of massline these use reduced matrices of an article, nominal places of channels and the noun `Campaign`: no
equation of motion, no damping law, no sensor model and no tolerance of the virtual test.
"""
