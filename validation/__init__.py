"""Cross-check: reference tables, classical measurements, comparison of model and measurement, and the command line."""
