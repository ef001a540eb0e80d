"""`massline verify`: elements, modes, dynamic mass and time integration held against closed forms and published benchmarks."""
