"""What examples/three_storey_frame.py is told with: its data, what they say by themselves, fits, tables and pictures."""
