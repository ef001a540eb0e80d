"""Parts of the measurement chain; `identification.measurement_chain` puts them together and is the door."""
