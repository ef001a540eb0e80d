"""Random structures that are not Clumod: ``python -m benchmarks.blind --structures``.

shapes    frames, trusses, plates with ribs, stacked boxes and barrels, as mesh files of any fineness with what describes them
drawing   a seed becomes structures, laboratories and faults
sealing   a case becomes a folder: the model and its coarse mesh, and a test of a finer mesh with the fault in it
"""
