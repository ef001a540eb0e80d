"""Classical measurements: weighing, centre of gravity by crane and balance, pendulum periods, each with its tolerance."""
