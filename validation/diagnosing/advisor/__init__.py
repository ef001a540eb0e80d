"""Which measurement would tell explanations apart that the present data do not, or confirm the only one.

menu        tests that a laboratory can do, in words, and what each changes of what is there
planned     a test as a prediction: base motions, noise and lines as the present data have them
knowledge   what the present data say of every parameter by each explanation, carried over to the test
expected    how many nats the test would give, in closed form
advised     the best of the menu
"""
