"""Any prediction held against any data: likelihood, fits, errors, screening. Knows no channel, effect or structure."""
