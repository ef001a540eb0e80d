"""What `examples/table_2.py` is told with."""
