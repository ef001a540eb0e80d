"""Every family of the catalogue, one file each; `validation.effects.catalogue` finds them."""
