"""What `massline excite` does: an article on a table driven in time, and what came of it in words, figures and pictures.

=================== ================================================================================================
asked, attached     what was typed, checked at the door: drive, route, rates; cells, flange, cables, friction
rig                 from a name and options to a `Rig`: the FMD split off the stack, the article reduced about its own origin
drives              from a pattern to base motions, run by run
runs                which route, and every run through it, with progress
rig_modes           resonances of the whole rig, cells and joint included
passage             when a sweep passes them, and what that does to the load
figures             levels, peak loads, what is left of the ringing, cells against their preload
table, as_json      the same for a reader and for a program
signals             runs as files: universal files, HDF5, CSV, npz, MATLAB
plots, moving       pictures and the animation
=================== ================================================================================================"""
