"""Structures whose truth is none of ours, a mesh of CalculiX or beams of another element code, tested and diagnosed."""
