"""Proof on data whose answer is sealed: ``python -m benchmarks.blind``, then ``python -m benchmarks.blind.score``.

drawing      a seed becomes cases: nulls, single effects, pairs, effects left out of the catalogue, physics that nobody wrote down
sealing      a case becomes a folder of campaigns, and its truth, which goes elsewhere
answering    a process of its own, which gets that folder and nothing else, diagnoses it
running      all cases of a draw, over processes; what is finished is kept under a hash of the code
score        a program of its own, which alone sees truths and answers together
ledger       which seeds are for development, which one is for the test, and how often that has been looked at
"""
